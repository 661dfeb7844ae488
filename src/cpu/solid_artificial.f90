! SPDX-License-Identifier: MIT
!> Artificial stress of pass 2, pair by pair.
module brz_solid_artificial
    use brz_body, only: body_t
    use brz_force_layout, only: at_stiff, n_terms
    use brz_kernel, only: kernel_slope, pair_kernel
    use brz_kinds, only: int64, rk
    use brz_pair_layout, only: pair_affine
    use brz_pair_rows, only: artificial_force, mirror_tensor
    use brz_solid_arrays, only: group_of
    use brz_solid_lanes, only: centre_t
    use brz_solid_mirror, only: signs
    use brz_listed_bodies, only: listed_bodies_t
    implicit none
    private
    public :: add_artificial

contains

    !> Add the artificial stress of all pairs of a particle, images included.
    subroutine add_artificial(solid, body, i, p, f)
        class(listed_bodies_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        integer, intent(in) :: i
        type(centre_t), intent(in) :: p !! kernel
        real(rk), intent(inout) :: f(n_terms)
        integer(int64) :: k
        integer :: g

        g = group_of(body, i)
        do k = solid%first(g), solid%first(g + 1) - 1
            call add_pair(solid, body, i, p, solid%list(k), 0, f)
        end do
        if (.not. any(solid%mirror)) return
        do k = solid%image_first(g), solid%image_first(g + 1) - 1
            call add_pair(solid, body, i, p, solid%image(k), int(solid%mask(k)), f)
        end do
    end subroutine add_artificial

    !> Add that of one pair, if either is in tension.
    subroutine add_pair(solid, body, i, p, j, mask, f)
        type(listed_bodies_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        integer, intent(in) :: i
        type(centre_t), intent(in) :: p
        integer, intent(in) :: j, mask !! mirrored axes, bits 0..2
        real(rk), intent(inout) :: f(n_terms)
        type(centre_t) :: q
        real(rk) :: s(3), r(3), other(9), g(3), distance

        s = signs(mask)
        r = real(solid%x(:, i) - s*solid%x(:, j), rk)
        other = solid%pair(pair_affine + 1:pair_affine + 9, j)
        call mirror_tensor(s, other)
        q = p
        if (body%variable) call pair_kernel(solid%dimension, real(solid%depth, rk), &
                                            solid%h(i), solid%h(j), q%h, &
                                            q%scale, q%half_over_h)
        distance = norm2(r)
        call artificial_force(body%body_numbers_t, q%half_over_h, distance, solid%mass(i) &
                              *solid%mass(j)*kernel_slope(q%scale, q%half_over_h, distance), &
                              solid%pair(pair_affine + 1, i), other, r, g)
        f(at_stiff + 1:at_stiff + 3) = f(at_stiff + 1:at_stiff + 3) + g
    end subroutine add_pair
end module brz_solid_artificial
