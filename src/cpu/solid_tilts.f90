! SPDX-License-Identifier: MIT
!> Tilt of the gradients in the outermost layers of laminates, plates and bars, from the unloaded
!> body.
module brz_solid_tilts
    use brz_body, only: body_t
    use brz_kernel, only: kernel_scale, kernel_slope
    use brz_kinds, only: dp, int64, real32, rk
    use brz_solid_arrays, only: group_of
    use brz_link_rows, only: body_of, first_link, is_bonded, last_link, link_mask, &
        link_partner
    use brz_solid_mirror, only: signs
    use brz_listed_bodies, only: listed_bodies_t
    use brz_threads, only: worth_threads
    use brz_one_sided_arm, only: pack_tilt, radial_normal
    implicit none
    private
    public :: find_tilts

    real(rk), parameter :: level = 0.05_rk !! less tilt over a spacing is none
    real(rk), parameter :: one_sided = 0.5_rk !! more of it over a spacing is a free face

contains

    !> Tilts of all particles; lists and bonds must be known.
    subroutine find_tilts(solid)
        class(listed_bodies_t), intent(inout) :: solid
        real(rk) :: tilt
        integer :: i, k

        if (.not. allocated(solid%tilt)) return
        !$omp parallel do if(solid%n >= worth_threads) schedule(dynamic, 8) private(i, tilt)
        do k = 1, size(solid%block, 2)
            associate (body => solid%bodies(solid%block(1, k)))
                if (.not. any(body%normal > 0)) cycle
                do i = solid%block(2, k), solid%block(3, k)
                    call tilt_of(solid, body, i, tilt)
                    solid%tilt(i) = real(tilt, real32)
                end do
            end associate
        end do
    end subroutine find_tilts

    !> c with sum w t^2 (z - d) (1 + c z) = 0 over the neighbours of particle i, t along the layer
    !> and z across it [1/m]: u = t z then has the gradient of a place d from it. d is 0 but at the
    !> faces of plates and bars, which see the strain further out. In bars c and d are vectors.
    pure subroutine tilt_of(solid, body, i, tilt)
        type(listed_bodies_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        integer, intent(in) :: i
        real(rk), intent(out) :: tilt !! [1/m], of bars packed
        real(rk) :: sums(6), scale
        integer(int64) :: k
        real(rk) :: across(3, 2)
        integer :: g, j
        logical :: glued

        across = directions(body, solid%x_ref(:, i))
        sums = 0
        glued = body%curved ! no layer of a wall is quite even: its faces alone are tilted
        scale = kernel_scale(body%h, solid%dimension)/real(solid%depth, rk)
        g = group_of(body, i)
        do k = solid%first(g), solid%first(g + 1) - 1
            call add(solid, across, i, solid%list(k), 0, scale, 1/(2*body%h), sums)
        end do
        if (any(solid%mirror)) then
            do k = solid%image_first(g), solid%image_first(g + 1) - 1
                call add(solid, across, i, solid%image(k), int(solid%mask(k)), scale, &
                         1/(2*body%h), sums)
            end do
        end if
        if (solid%links%bonds) then
            do k = first_link(solid%links, i), last_link(solid%links, i)
                j = link_partner(solid%links, k)
                if (.not. is_bonded(solid%links, i, j)) cycle
                glued = .true.
                associate (m => solid%links%table(body_of(solid%links, i), body_of(solid%links, j)))
                    call add(solid, across, i, j, link_mask(solid%links, k), &
                             m%part(1)*m%scale/real(solid%depth, rk), m%half_over_h, sums)
                end associate
            end do
        end if
        if (.not. any(across(:, 2) > 0)) then
            tilt = one_way(body, glued, sums(1), sums(3), sums(6))
        else
            tilt = pack_tilt(both_ways(body, glued, sums)/maxval(body%normal))
        end if
    end subroutine tilt_of

    !> Directions across a body at a place: one of a plate or a wall, two of a bar.
    pure function directions(body, x) result(across)
        type(body_t), intent(in) :: body
        real(dp), intent(in) :: x(3) !! [m]
        real(rk) :: across(3, 2)
        integer :: a, b

        across = 0
        if (body%curved) then
            call radial_normal(body%normal, body%round%centre, x, across(:, 1))
            return
        end if
        a = findloc(body%normal > 0, .true., dim=1)
        b = findloc(body%normal > 0, .true., dim=1, back=.true.)
        across(a, 1) = 1
        if (b /= a) across(b, 2) = 1
    end function directions

    !> Tilt in one direction, from the sums of w t^2 z, of w t^2 z^2 and of w t^2 [1/m].
    pure real(rk) function one_way(body, glued, first, second, plain) result(tilt)
        type(body_t), intent(in) :: body
        logical, intent(in) :: glued !! to particles of another body, or in a wall round an axis: a
                                     !! free face alone is tilted
        real(rk), intent(in) :: first, second, plain
        real(rk) :: d

        tilt = 0
        if (second > 0) tilt = -first/second
        if (abs(tilt)*body%spacing < merge(one_sided, level, glued)) tilt = 0
        if (abs(tilt)*body%spacing < one_sided) return
        d = -sign(body%outward, first)
        tilt = (d*plain - first)/(second - d*first)
    end function one_way

    !> Tilts of a bar in both directions across it: on its edges they act together [1/m].
    pure function both_ways(body, glued, sums) result(tilt)
        type(body_t), intent(in) :: body
        logical, intent(in) :: glued !! see one_way
        real(rk), intent(in) :: sums(6) !! see add
        real(rk) :: tilt(2), d(2), a(2, 2), b(2), det
        integer :: k

        do k = 1, 2
            tilt(k) = one_way(body, glued, sums(k), sums(2 + k), sums(6))
        end do
        if (.not. all(abs(tilt) > 0)) return
        d = 0
        do k = 1, 2
            if (abs(sums(k)/sums(2 + k))*body%spacing >= one_sided) &
                d(k) = -sign(body%outward, sums(k))
        end do
        a(1, :) = [sums(3) - d(1)*sums(1), sums(5) - d(1)*sums(2)]
        a(2, :) = [sums(5) - d(2)*sums(1), sums(4) - d(2)*sums(2)]
        b = d*sums(6) - sums(1:2)
        det = a(1, 1)*a(2, 2) - a(1, 2)*a(2, 1)
        if (det > 0.01_rk*a(1, 1)*a(2, 2)) tilt = [b(1)*a(2, 2) - a(1, 2)*b(2), &
                                                   a(1, 1)*b(2) - b(1)*a(2, 1)]/det
    end function both_ways

    !> Add a neighbour, or its image in the planes of the mask, to the sums of w t^2 times y, z,
    !> y^2, z^2, y z and 1, with y and z the directions across; of a plate there is no z.
    pure subroutine add(solid, across, i, j, mask, scale, half_over_h, sums)
        type(listed_bodies_t), intent(in) :: solid
        real(rk), intent(in) :: across(3, 2)
        integer, intent(in) :: i, j, mask
        real(rk), intent(in) :: scale, half_over_h !! see brz_kernel
        real(rk), intent(inout) :: sums(6)
        real(rk) :: r(3), w, y, z

        r = real(solid%x_ref(:, i) - signs(mask)*solid%x_ref(:, j), rk)
        y = dot_product(across(:, 1), r)
        z = dot_product(across(:, 2), r)
        w = solid%volume(j)*kernel_slope(scale, half_over_h, norm2(r))
        w = w*(dot_product(r, r) - y*y - z*z)
        sums = sums + w*[y, z, y*y, z*z, y*z, 1.0_rk]
    end subroutine add
end module brz_solid_tilts
