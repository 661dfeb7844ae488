! SPDX-License-Identifier: MIT
!> Bonds between bodies on the CPU: the loops, and the calls from both passes.
module brz_solid_bonds
    use brz_bond_loop_bodies, only: pull_bonds, sum_bonds
    use brz_bond_loops, only: each_break_bond
    use brz_force_layout, only: at_drag, at_heat, n_terms
    use brz_formulation_names, only: form_rigid
    use brz_hold_layout, only: n_control
    use brz_kinds, only: dp, int32, real32, rk
    use brz_moment_layout, only: n_moments
    use brz_pair_layout, only: pair_tilt
    use brz_listed_bodies, only: listed_bodies_t
    implicit none
    private
    public :: add_bonded_gradients, add_bonded_forces, push_rigid_bonds, break_bonds

    real(real32), target :: no_axes(6, 1) = 0
    real(rk), target :: none_held(n_control, 1) = 0

contains

    !> Add the bonded partners of particle i to its moments and gradients (see pass 1).
    subroutine add_bonded_gradients(solid, i, sums)
        class(listed_bodies_t), intent(in) :: solid
        integer, intent(in) :: i
        real(rk), intent(inout) :: sums(n_moments)
        integer(int32) :: found, none(1)

        none = 0
        associate (s => solid, l => solid%links)
            call sum_bonds(i, l%lay, s%pair(pair_tilt, i), l%ends, l%table, s%x, s%x_ref, s%v, &
                           s%volume, s%mass, l%bond, l%row, l%slice(1:), l%count(1:), l%list, &
                           .false., found, none, sums)
        end associate
    end subroutine add_bonded_gradients

    !> Add the forces of the bonded partners of particle i (see pass 2).
    subroutine add_bonded_forces(solid, i, f)
        class(listed_bodies_t), intent(in), target :: solid
        integer, intent(in) :: i
        real(rk), intent(inout) :: f(n_terms)
        real(real32), pointer :: k_axes(:, :)
        real(rk), pointer :: control(:, :)

        k_axes => no_axes
        control => none_held
        if (allocated(solid%k_axes)) k_axes => solid%k_axes
        if (allocated(solid%control)) control => solid%control
        associate (s => solid, l => solid%links)
            call pull_bonds(i, l%lay, l%ends, l%table, s%x, s%x_ref, s%v, s%mass, s%pair, k_axes, &
                            control, l%bond, l%row, l%slice(1:), l%count(1:), l%list, f)
        end associate
    end subroutine add_bonded_forces

    !> Forces of the bonded partners on the particles of rigid bodies, to those of contact; their
    !> share of the heat over dt, the step just made.
    subroutine push_rigid_bonds(solid, dt)
        class(listed_bodies_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        real(rk) :: f(n_terms)
        integer :: b, i

        do b = 1, merge(size(solid%bodies), 0, solid%links%bonds)
            associate (body => solid%bodies(b))
                if (body%formulation /= form_rigid .or. body%inactive .and. dt > 0) cycle
                do i = body%first, body%last
                    if (solid%links%row(i) == 0) cycle
                    f = 0
                    call add_bonded_forces(solid, i, f)
                    associate (push => solid%links%push(:, solid%links%row(i)))
                        push(1:3) = push(1:3) + f(1:3)
                        push(4:6) = push(4:6) + f(at_drag + 1:at_drag + 3)
                    end associate
                    solid%energy(i) = solid%energy(i) + real(dt, rk)*f(at_heat)/solid%mass(i)
                    body%account%contact_heat = body%account%contact_heat + dt*f(at_heat)
                end do
            end associate
        end do
    end subroutine push_rigid_bonds

    !> Break the bonds of particles whose traction on the bond exceeds its strength.
    subroutine break_bonds(solid)
        class(listed_bodies_t), intent(inout) :: solid

        if (.not. solid%links%bonds) return
        associate (s => solid, l => solid%links)
            call each_break_bond(s%n, 1, l%lay, l%ends, l%table, s%x, s%v, s%pair, s%stress, &
                                 l%row, l%slice(1:), l%count(1:), l%list, l%bond)
        end associate
    end subroutine break_bonds
end module brz_solid_bonds
