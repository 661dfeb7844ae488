! SPDX-License-Identifier: MIT
!> Forces of a pair that keep it at its place in the unloaded body (hourglass control), or apart
!> (artificial stress), from what pass 1 left of both particles in rows; and rows as the images of
!> particles have them. Point physics.
module brz_pair_rows
    use brz_body_numbers, only: body_numbers_t
    use brz_force_layout, only: at_drag, at_friction, at_stiff, at_work, n_terms
    use brz_hold_layout, only: control_affine, control_stiffness, control_whole, n_control
    use brz_kernel, only: kernel_shape
    use brz_kinds, only: real32, rk
    use brz_pair_force, only: hourglass_stiff, hourglass_viscous, most_in_tension, stress_force
    use brz_pair_layout, only: n_pair, pair_affine, pair_stress, pair_zeta
    implicit none
    private
    public :: add_drag, add_hold, axes_of_pair, artificial_force, mirror_row, mirror_tensor

contains

    !> Add the viscous hourglass force.
    !@cuf attributes(host,device) &
    pure subroutine add_drag(y, r, dv, own, other, f)
        real(rk), intent(in) :: y !! see hourglass_viscous
        real(rk), intent(in) :: r(3), dv(3) !! x_ij, v_ij [m, m/s]
        real(rk), intent(in) :: own(n_pair), other(n_pair) !! rows of `pair`
        real(rk), intent(inout) :: f(n_terms)
        real(rk) :: g(3), heat
        integer :: t

        call hourglass_viscous(y*own(pair_zeta), y*other(pair_zeta), own(pair_affine + 1), &
                               other(pair_affine + 1), dv, r, g, heat)
        do t = 1, 3
            f(at_drag + t) = f(at_drag + t) + g(t)
        end do
        f(at_friction) = f(at_friction) + heat
    end subroutine add_drag

    !> Add the tensile control, if either particle is drawn.
    !@cuf attributes(host,device) &
    pure subroutine add_hold(y, s, r, dv, dx, own, other, f)
        real(rk), intent(in) :: y !! see hourglass_stiff
        real(rk), intent(in) :: s(3) !! signs of the axes where the other is an image
        real(rk), intent(in) :: r(3), dv(3), dx(3) !! x_ij, v_ij, X_ij [m, m/s, m]
        real(rk), intent(in) :: own(n_control), other(n_control) !! rows of `control`
        real(rk), intent(inout) :: f(n_terms)
        real(rk) :: q(9), g(3), work
        integer :: t

        if (.not. own(control_stiffness) + other(control_stiffness) > 0) return
        do t = 1, 9
            q(t) = other(control_affine + t)
        end do
        call mirror_tensor(s, q)
        call hourglass_stiff(most_in_tension, y*own(control_whole)*other(control_whole), &
                             own(control_stiffness) + other(control_stiffness), &
                             own(control_affine + 1), q, dx, r, g)
        work = dot_product(g, dv)
        do t = 1, 3
            f(at_stiff + t) = f(at_stiff + t) + g(t)
        end do
        f(at_work) = f(at_work) - work/2
    end subroutine add_hold

    !> Sum of the hourglass stiffnesses of a pair along the axes of the material.
    !@cuf attributes(host,device) &
    pure subroutine axes_of_pair(s, own, other, k)
        real(rk), intent(in) :: s(3) !! signs of the axes where the other is an image
        real(real32), intent(in) :: own(6), other(6) !! xx, yy, zz, xy, yz, xz [Pa]
        real(rk), intent(out) :: k(6) !! [Pa]
        integer :: t

        do t = 1, 6
            k(t) = real(other(t), rk)
        end do
        k(4) = k(4)*(s(1)*s(2))
        k(5) = k(5)*(s(2)*s(3))
        k(6) = k(6)*(s(1)*s(3))
        do t = 1, 6
            k(t) = real(own(t), rk) + k(t)
        end do
    end subroutine axes_of_pair

    !> Force of the artificial stress, if either particle is in tension.
    !@cuf attributes(host,device) &
    pure subroutine artificial_force(body, half, distance, w, own, other, r, g)
        type(body_numbers_t), intent(in) :: body
        real(rk), intent(in) :: half, distance !! of the kernel, see brz_kernel; of the pair [m]
        real(rk), intent(in) :: w !! product of the masses times F_ij
        real(rk), intent(in) :: own(9), other(9) !! artificial stress of both
        real(rk), intent(in) :: r(3) !! x_ij [m]
        real(rk), intent(out) :: g(3) !! on i [N]
        real(rk) :: shape
        integer :: t

        do t = 1, 3
            g(t) = 0
        end do
        if (own(1) + own(5) + own(9) + other(1) + other(5) + other(9) <= 0 .or. w == 0) return
        shape = kernel_shape(half, distance)/body%shape_at_spacing
        call stress_force(-w*shape**body%artificial_power, own, other, r, g)
    end subroutine artificial_force

    !> A row of `pair` as the image of its particle has it: its tensors change.
    !@cuf attributes(host,device) &
    pure subroutine mirror_row(s, row)
        real(rk), intent(in) :: s(3) !! signs of the axes
        real(rk), intent(inout) :: row(n_pair)

        call mirror_tensor(s, row(pair_stress + 1))
        call mirror_tensor(s, row(pair_affine + 1))
    end subroutine mirror_row

    !> A tensor, column by column, as an image has it.
    !@cuf attributes(host,device) &
    pure subroutine mirror_tensor(s, a)
        real(rk), intent(in) :: s(3) !! signs of the axes
        real(rk), intent(inout) :: a(9)
        integer :: c, t

        do t = 1, 3
            do c = 1, 3
                a(3*(t - 1) + c) = s(t)*s(c)*a(3*(t - 1) + c)
            end do
        end do
    end subroutine mirror_tensor
end module brz_pair_rows
