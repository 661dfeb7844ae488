! SPDX-License-Identifier: MIT
!> Bodies that carry particles, in the gas: what it does to them, and how they move in its next
!> step.
module brz_coupling_carriers
    use brz_carrier_motion, only: foresee_carriers, read_carriers
    use brz_carrier_rules, only: carries_all, carries_none, is_carried, n_push
    use brz_column_items, only: add_load, add_push, add_shift
    use brz_coupling_state, only: coupling_t
    use brz_kinds, only: dp
    use brz_solid_state, only: is_held, solid_t, worth_threads
    implicit none
    private
    public :: see_carriers, move_carriers, load_carriers

contains

    !> Motion of the bodies at the step. A rigid body turns about the middle of its cells.
    subroutine see_carriers(solid, coupling)
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
                    call add_shift(coupling%box, solid%x(:, p), solid%mass(p), shift)
                end do
                carrier%centre = carrier%centre + shift/solid%bodies(b)%rigid%mass
            end associate
        end do
    end subroutine see_carriers

    !> Bring the bodies that carry particles to the middle of the coming step.
    subroutine move_carriers(solid, coupling, dt)
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        real(dp), intent(in) :: dt !! of the air [s]
        real(dp) :: push(n_push, size(coupling%carrier))

        if (all(coupling%carrier%carries == carries_none)) return
        call sum_push(solid, coupling, push)
        call foresee_carriers(solid, push, dt, coupling%carrier)
    end subroutine move_carriers

    !> What the gas does to each rigid body if that keeps its motion.
    subroutine sum_push(solid, coupling, push)
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(in) :: coupling
        real(dp), intent(out) :: push(:, :) !! (n_push, bodies)
        real(dp) :: part(n_push, size(solid%block, 2))
        integer :: k, p

        part = 0
        !$omp parallel do if(solid%n >= worth_threads) schedule(dynamic) private(p)
        do k = 1, size(solid%block, 2)
            associate (carrier => coupling%carrier(solid%block(1, k)))
                if (carrier%carries /= carries_all) cycle
                do p = solid%block(2, k), solid%block(3, k)
                    if (coupling%place_of(p) > 0) call add_push(coupling%box, carrier, &
                        solid%x(:, p), solid%mass(p), coupling%above(:, coupling%place_of(p)), &
                        coupling%gas, coupling%surface, coupling%weight, coupling%force, &
                        coupling%impedance, part(:, k))
                end do
            end associate
        end do
        push = 0
        do k = 1, size(solid%block, 2)
            push(:, solid%block(1, k)) = push(:, solid%block(1, k)) + part(:, k)
        end do
    end subroutine sum_push

    !> Force and torque of the air on the bodies that carry particles, from the loads of these.
    subroutine load_carriers(solid, coupling)
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
                    if (is_carried(carries, solid%fixed(p) == is_held)) &
                        call add_load(coupling%box, coupling%carrier(b), solid%x(:, p), &
                                      solid%load(:, p), body%rigid%load)
                end do
            end associate
        end do
    end subroutine load_carriers
end module brz_coupling_carriers
