! SPDX-License-Identifier: MIT
!> Tilt of the gradients in the outermost layers of laminates and of plates, from the unloaded
!> body.
module brz_solid_tilts
    use brz_contact_items, only: owner_of
    use brz_kernel, only: kernel_scale, kernel_slope
    use brz_kinds, only: int64, real32, rk
    use brz_solid_lanes, only: group_of
    use brz_solid_links, only: first_link, is_bonded, last_link, link_mask, link_partner
    use brz_solid_mirror, only: signs
    use brz_solid_state, only: body_t, solid_t, worth_threads
    implicit none
    private
    public :: find_tilts

    real(rk), parameter :: level = 0.05_rk !! less tilt over a spacing is none
    real(rk), parameter :: one_sided = 0.5_rk !! more of it over a spacing is a free face

contains

    !> Tilts of all particles; lists and bonds must be known.
    subroutine find_tilts(solid)
        type(solid_t), intent(inout) :: solid
        integer :: i, k

        if (.not. allocated(solid%tilt)) return
        !$omp parallel do if(solid%n >= worth_threads) schedule(static) private(i)
        do k = 1, size(solid%block, 2)
            associate (body => solid%bodies(solid%block(1, k)))
                if (.not. any(body%normal > 0)) cycle
                do i = solid%block(2, k), solid%block(3, k)
                    solid%tilt(i) = real(tilt_of(solid, body, i), real32)
                end do
            end associate
        end do
    end subroutine find_tilts

    !> c with sum w t^2 (z - d) (1 + c z) = 0 over the neighbours of particle i, t along the layer
    !> and z across it [1/m]: u = t z then has the gradient of a place d from it. d is 0 but at the
    !> faces of plates, which see the strain further out.
    pure real(rk) function tilt_of(solid, body, i) result(tilt)
        type(solid_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        integer, intent(in) :: i
        real(rk) :: sums(3), scale, d
        integer(int64) :: k
        integer :: g, j

        sums = 0
        scale = kernel_scale(body%h, solid%dimension)
        g = group_of(body, i)
        do k = solid%first(g), solid%first(g + 1) - 1
            call add(solid, body, i, solid%list(k), 0, scale, 1/(2*body%h), sums)
        end do
        if (any(solid%mirror)) then
            do k = solid%image_first(g), solid%image_first(g + 1) - 1
                call add(solid, body, i, solid%image(k), int(solid%mask(k)), scale, 1/(2*body%h), &
                         sums)
            end do
        end if
        if (solid%links%bonds) then
            do k = first_link(solid%links, i), last_link(solid%links, i)
                j = link_partner(solid%links, k)
                if (.not. is_bonded(solid%links, i, j)) cycle
                associate (m => solid%links%table(owner_of(solid%links%ends, i), &
                                                  owner_of(solid%links%ends, j)))
                    call add(solid, body, i, j, link_mask(solid%links, k), m%scale, &
                             m%half_over_h, sums)
                end associate
            end do
        end if
        tilt = 0
        if (sums(2) > 0) tilt = -sums(1)/sums(2)
        if (abs(tilt)*body%spacing < level) tilt = 0
        if (abs(tilt)*body%spacing < one_sided) return
        d = -sign(body%outward, sums(1))
        tilt = (d*sums(3) - sums(1))/(sums(2) - d*sums(1))
    end function tilt_of

    !> Add a neighbour, or its image in the planes of the mask, to the sums of w t^2 z, of w t^2 z^2
    !> and of w t^2.
    pure subroutine add(solid, body, i, j, mask, scale, half_over_h, sums)
        type(solid_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        integer, intent(in) :: i, j, mask
        real(rk), intent(in) :: scale, half_over_h !! see brz_kernel
        real(rk), intent(inout) :: sums(3)
        real(rk) :: r(3), w, z

        r = real(solid%x_ref(:, i) - signs(mask)*solid%x_ref(:, j), rk)
        z = dot_product(body%normal, r)
        w = solid%volume(j)*kernel_slope(scale, half_over_h, norm2(r))
        w = w*(dot_product(r, r) - z*z)
        sums = sums + w*[z, z*z, 1.0_rk]
    end subroutine add
end module brz_solid_tilts
