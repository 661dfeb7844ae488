! SPDX-License-Identifier: MIT
!> Between the passes: what pass 2 needs of a particle.
module brz_solid_rows
    use brz_algebra, only: copy_matrix, inverse3, multiply3, to_matrix
    use brz_artificial_stress, only: artificial_none, artificial_stress
    use brz_gradient, only: shear_limiter
    use brz_kinds, only: int8, real32, rk
    use brz_material, only: class_elastic, strength_left
    use brz_pair_force, only: axial_stiffness
    use brz_solid_state, only: body_t, form_bending, form_corrected_hourglass, form_total, &
                               held_affine, held_energy, held_stiffness, held_whole, &
                               pair_affine, pair_hold, pair_keep, pair_linear, pair_quadratic, &
                               pair_tilt, pair_volume, solid_t
    use brz_tension_hold, only: deviation, hold_stiffness
    implicit none
    private
    public :: fill_row, fill_hold

contains

    !> What pass 2 needs of particle i, but for its stress.
    subroutine fill_row(solid, body, i, h, a, rho, c_bulk)
        type(solid_t), intent(inout) :: solid
        type(body_t), intent(in) :: body
        integer, intent(in) :: i
        real(rk), intent(in) :: h(3, 3) !! velocity gradient [1/s]
        real(rk), intent(in) :: a(3, 3) !! 'bending': dX/dx; 'total_lagrangian': dx/dX
        real(rk), intent(in) :: rho !! density [kg/m3]
        real(rk), intent(in) :: c_bulk !! sound speed in the viscosity [m/s]
        real(rk) :: q(3, 3), z

        z = shear_limiter(body%limiter, h, c_bulk/body%h)
        solid%pair(pair_volume, i) = solid%volume(i)
        solid%pair(pair_linear, i) = z*body%alpha*rho*c_bulk/2
        solid%pair(pair_quadratic, i) = z*body%beta*rho/2
        select case (body%formulation)
        case (form_bending, form_total)
            q = a
            if (body%formulation == form_bending) call invert_or_cut(a, q, solid%cut(i))
            call stiffen(solid, body, i, q, z)
            if (body%formulation == form_total .and. body%directional) z = solid%pair(pair_hold, i)
        case (form_corrected_hourglass)
            z = body%zeta_viscous*body%h*rho*c_bulk
            if (abs(solid%pair(pair_tilt, i)) > 0) z = 0 ! a tilted gradient would exert a torque
            q = h
        case default
            z = 0
            q = h
            if (body%artificial /= artificial_none) call artificial_stress(body%artificial, &
                body%artificial_strength, rho, solid%stress(:, i), q)
        end select
        solid%pair(pair_hold, i) = z
        call copy_matrix(q, solid%pair(pair_affine + 1, i))
        z = strength_left(solid%materials(body%material)%fails, solid%damage(i))
        if (body%formulation == form_bending .or. body%formulation == form_total) &
            z = z*(1 - solid%cut(i))
        solid%pair(pair_keep, i) = z
    end subroutine fill_row

    !> The hold of particle i: nothing where it was not in tension or has lost its support.
    subroutine fill_hold(solid, body, i, drawn, a, s, trace)
        type(solid_t), intent(inout) :: solid
        type(body_t), intent(in) :: body
        integer, intent(in) :: i
        logical, intent(in) :: drawn
        real(rk), intent(in) :: a(3, 3) !! dX/dx
        real(rk), intent(in) :: s(6), trace !! see deviation
        real(rk) :: f(3, 3), q, k, mu

        k = 0
        q = 0
        f = 0
        if (drawn .and. solid%cut(i) == 0) call invert_or_cut(a, f, solid%cut(i))
        if (drawn .and. solid%cut(i) == 0) then
            q = deviation(solid%dimension, f, s, trace)
            mu = solid%mu(i)
            if (solid%materials(body%material)%class == class_elastic) mu = 0
            k = hold_stiffness(body%tension_hold, solid%stress(:, i), mu, q/trace)
        end if
        solid%held(held_stiffness, i) = k
        call copy_matrix(k*f, solid%held(held_affine + 1, i))
        solid%held(held_energy, i) = solid%volume(i)*k*q/2
        solid%held(held_whole, i) = 1 - solid%cut(i)
    end subroutine fill_hold

    !> Stiffness of the hourglass force, and what it makes of the deformation f.
    subroutine stiffen(solid, body, i, f, z)
        type(solid_t), intent(inout) :: solid
        type(body_t), intent(in) :: body
        integer, intent(in) :: i
        real(rk), intent(inout) :: f(3, 3) !! dx/dX in; stiffness times it out [Pa]
        real(rk), intent(out) :: z !! stiffness without axes [Pa]
        real(rk) :: along(6), k(3, 3), g(3, 3)

        associate (material => solid%materials(body%material))
            z = body%zeta*material%shear
            if (body%directional) then
                call axial_stiffness(body%axes(:, 4, solid%ply(i)), &
                                     body%axes(:, :3, solid%ply(i)), f, along)
                solid%hold(:, i) = real(along, real32)
                call to_matrix(real(solid%hold(:, i), rk), k) ! as the pairs see it: no torque
                call multiply3(k, f, g)
                f = g
            else
                f = z*f
            end if
        end associate
    end subroutine stiffen

    !> Deformation dx/dX from dX/dx. Where that is singular the hourglass support ends.
    subroutine invert_or_cut(a, f, cut)
        real(rk), intent(in) :: a(3, 3)
        real(rk), intent(out) :: f(3, 3)
        integer(int8), intent(inout) :: cut
        logical :: ok

        call inverse3(a, f, ok)
        if (.not. ok) cut = 1
    end subroutine invert_or_cut
end module brz_solid_rows
