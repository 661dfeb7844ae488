! SPDX-License-Identifier: MIT
!> Bodies that carry particles, in the gas: what it does to them, and how they move in its next
!> step.
module brz_coupling_carriers
    use brz_carrier_loops, only: each_sum_air_load, each_sum_push, each_sum_shift
    use brz_carrier_motion, only: foresee_carriers, read_carriers
    use brz_carrier_rules, only: carries_all, carries_none, n_push
    use brz_coupling_state, only: coupling_t
    use brz_kinds, only: dp
    use brz_ranks, only: several
    use brz_solid_state, only: form_rigid, solid_t
    implicit none
    private
    public :: see_carriers, sum_shifts, move_carriers, load_carriers

contains

    !> Motion of the bodies at the step. A rigid body turns about the middle of its cells.
    subroutine see_carriers(solid, coupling)
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        integer :: b

        call read_carriers(solid, coupling%carrier)
        if (all(coupling%carrier%carries /= carries_all)) return
        if (.not. several(solid%ranks)) call sum_shifts(solid, coupling)
        do b = 1, size(coupling%carrier)
            associate (carrier => coupling%carrier(b))
                if (carrier%carries == carries_all) carrier%centre = carrier%centre &
                    + coupling%shift(:, b)/solid%bodies(b)%rigid%mass
            end associate
        end do
    end subroutine see_carriers

    !> Where the middles of the cells are, against the particles of rigid bodies. On several
    !> processes of the particles that each steps.
    subroutine sum_shifts(solid, coupling)
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        integer :: b

        if (.not. allocated(solid%bodies)) return
        if (.not. allocated(coupling%shift)) &
            allocate (coupling%shift(3, size(solid%bodies)), source=0.0_dp)
        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b))
                if (body%formulation == form_rigid) &
                    call each_sum_shift(body%last - body%first + 1, solid%ranks, body%first, &
                                        coupling%box, 3, solid%x, solid%mass, coupling%shift(:, b))
            end associate
        end do
    end subroutine sum_shifts

    !> Bring the bodies that carry particles to the middle of the coming step, from what the gas
    !> does to each rigid one if that keeps its motion.
    subroutine move_carriers(solid, coupling, dt)
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        real(dp), intent(in) :: dt !! of the air [s]
        real(dp) :: push(n_push, size(coupling%carrier))
        integer :: b

        if (all(coupling%carrier%carries == carries_none)) return
        push = 0
        do b = 1, size(coupling%carrier)
            associate (carrier => coupling%carrier(b), c => coupling)
                if (carrier%carries == carries_all) &
                    call each_sum_push(carrier%last - carrier%first + 1, solid%ranks, &
                                       carrier%first, c%box, carrier, 3, c%cell_of, c%place_of, &
                                       c%above, c%gas, c%surface, c%weight, c%force, &
                                       c%impedance, solid%x, solid%mass, push(:, b))
            end associate
        end do
        call foresee_carriers(solid, push, dt, coupling%carrier)
    end subroutine move_carriers

    !> Force and torque of the air on the bodies that carry particles, from the loads of these.
    subroutine load_carriers(solid, coupling)
        type(solid_t), intent(inout) :: solid
        type(coupling_t), intent(in) :: coupling
        integer :: b

        if (.not. allocated(solid%bodies)) return
        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b))
                body%rigid%load = 0
                if (coupling%carrier(b)%carries /= carries_none) &
                    call each_sum_air_load(body%last - body%first + 1, solid%ranks, body%first, &
                                           coupling%box, coupling%carrier(b), 3, 1, 3, &
                                           solid%fixed, solid%x, solid%load, body%rigid%load)
            end associate
        end do
    end subroutine load_carriers
end module brz_coupling_carriers
