! SPDX-License-Identifier: MIT
!> Bodies that carry particles, in the gas: what it does to them, and how they move in its next
!> step.
module brz_coupling_carriers
    use brz_air_state, only: air_t
    use brz_carrier_motion, only: foresee_carriers, read_carriers
    use brz_carrier_rules, only: add_force, add_yield, carries_all, carries_none, &
                                 is_carried, n_push
    use brz_cell_place, only: cell_middle
    use brz_coupling_columns, only: weight_of
    use brz_coupling_state, only: coupling_t, side_of
    use brz_kinds, only: dp, rk
    use brz_solid_state, only: is_held, solid_t, worth_threads
    implicit none
    private
    public :: see_carriers, move_carriers, load_carriers

contains

    !> Motion of the bodies at the step. A rigid body turns about the middle of its cells.
    subroutine see_carriers(air, solid, coupling)
        type(air_t), intent(in) :: air
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        real(dp) :: shift(3)
        integer :: b, p

        call read_carriers(solid, coupling%carrier)
        !$omp parallel do if(solid%n >= worth_threads) schedule(dynamic) private(p, shift)
        do b = 1, size(coupling%carrier)
            associate (carrier => coupling%carrier(b))
                if (carrier%carries /= carries_all) cycle
                shift = 0
                do p = carrier%first, carrier%last
                    shift = shift + solid%mass(p) &
                            *(cell_middle(solid%x(:, p), air%lo, air%dx) - solid%x(:, p))
                end do
                carrier%centre = carrier%centre + shift/solid%bodies(b)%rigid%mass
            end associate
        end do
    end subroutine see_carriers

    !> Bring the bodies that carry particles to the middle of the coming step.
    subroutine move_carriers(air, solid, coupling, dt)
        type(air_t), intent(in) :: air
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        real(dp), intent(in) :: dt !! of the air [s]
        real(dp) :: push(n_push, size(coupling%carrier))

        if (all(coupling%carrier%carries == carries_none)) return
        call sum_push(air, solid, coupling, push)
        call foresee_carriers(solid, push, dt, coupling%carrier)
    end subroutine move_carriers

    !> What the gas does to each rigid body if that keeps its motion.
    subroutine sum_push(air, solid, coupling, push)
        type(air_t), intent(in) :: air
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(in) :: coupling
        real(dp), intent(out) :: push(:, :) !! (n_push, bodies)
        real(dp) :: part(n_push, size(solid%block, 2))
        integer :: k

        part = 0
        !$omp parallel do if(solid%n >= worth_threads) schedule(dynamic)
        do k = 1, size(solid%block, 2)
            if (coupling%carrier(solid%block(1, k))%carries == carries_all) &
                call push_block(air, solid, coupling, solid%block(:, k), part(:, k))
        end do
        push = 0
        do k = 1, size(solid%block, 2)
            push(:, solid%block(1, k)) = push(:, solid%block(1, k)) + part(:, k)
        end do
    end subroutine sum_push

    !> What the gas does to the particles of a block of a body.
    pure subroutine push_block(air, solid, coupling, block, sums)
        type(air_t), intent(in) :: air
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(in) :: coupling
        integer, intent(in) :: block(3) !! body, first and last particle
        real(dp), intent(inout) :: sums(n_push) !! added to
        real(dp) :: arm(3)
        real(rk) :: force(3), impedance(3), part
        integer :: d, f, p, s

        do p = block(2), block(3)
            if (coupling%place_of(p) == 0) cycle
            force = 0
            impedance = 0
            do d = 1, 3
                if (air%n(d) == 1) cycle
                do s = -1, 1, 2
                    f = coupling%above(side_of(d, s), coupling%place_of(p))
                    if (f == 0) cycle
                    part = weight_of(solid, coupling, f, p)/coupling%weight(f)
                    force(d) = force(d) + part*coupling%force(f)
                    impedance(d) = impedance(d) + part*coupling%impedance(f)
                end do
            end do
            arm = cell_middle(solid%x(:, p), air%lo, air%dx) - coupling%carrier(block(1))%centre
            call add_force(arm, force, sums)
            call add_yield(arm, impedance, sums)
        end do
    end subroutine push_block

    !> Force and torque of the air on the bodies that carry particles, from the loads of these.
    subroutine load_carriers(air, solid, coupling)
        type(air_t), intent(in) :: air
        type(solid_t), intent(inout) :: solid
        type(coupling_t), intent(in) :: coupling
        integer :: b, p

        if (.not. allocated(solid%bodies)) return
        !$omp parallel do if(solid%n >= worth_threads) schedule(dynamic) private(p)
        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b), carries => coupling%carrier(b)%carries)
                body%rigid%load = 0
                if (carries == carries_none) cycle
                do p = body%first, body%last
                    if (is_carried(carries, solid%fixed(p) == is_held)) call add_force( &
                        cell_middle(solid%x(:, p), air%lo, air%dx) - coupling%carrier(b)%centre, &
                        solid%load(:, p), body%rigid%load)
                end do
            end associate
        end do
    end subroutine load_carriers
end module brz_coupling_carriers
