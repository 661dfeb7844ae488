! SPDX-License-Identifier: MIT
!> Bodies that carry particles, in the gas: what it does to them, and how they move in its next
!> step.
module brz_coupling_carriers
    use brz_carrier_motion, only: foresee_carriers, read_carriers
    use brz_carrier_rules, only: carrier_t, carries_all, carries_none, is_carried, n_push
    use brz_column_items, only: add_load, add_push, add_shift
    use brz_coupling_box, only: is_own
    use brz_coupling_state, only: coupling_t
    use brz_exact_sum, only: add_terms, close_sums, limbs, open_sums, scale_t, widen
    use brz_kinds, only: dp, int64
    use brz_ranks, only: several
    use brz_solid_state, only: form_rigid, is_held, solid_t
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

    !> Where the middles of the cells are, against the particles of rigid bodies: exact sums, as all
    !> that acts back. On several processes of the particles that each steps.
    subroutine sum_shifts(solid, coupling)
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        type(scale_t) :: scales(3)
        integer(int64) :: limb(limbs, 3)
        real(dp) :: largest(3)
        integer :: b, p

        if (.not. allocated(solid%bodies)) return
        if (.not. allocated(coupling%shift)) &
            allocate (coupling%shift(3, size(solid%bodies)), source=0.0_dp)
        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b))
                if (body%formulation /= form_rigid) cycle
                largest = 0
                do p = body%first, body%last
                    call widen(shift_of(p), largest)
                end do
                call open_sums(solid%ranks, largest, scales)
                limb = 0
                do p = body%first, body%last
                    call add_terms(scales, shift_of(p), limb)
                end do
                call close_sums(solid%ranks, scales, limb, coupling%shift(:, b))
            end associate
        end do

    contains

        pure function shift_of(p) result(shift)
            integer, intent(in) :: p
            real(dp) :: shift(3)

            shift = 0
            call add_shift(coupling%box, solid%x(:, p), solid%mass(p), shift)
        end function shift_of
    end subroutine sum_shifts

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

    !> What the gas does to each rigid body if that keeps its motion: exact sums, as it acts back.
    subroutine sum_push(solid, coupling, push)
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(in) :: coupling
        real(dp), intent(out) :: push(:, :) !! (n_push, bodies)
        type(scale_t) :: scales(n_push)
        integer(int64) :: limb(limbs, n_push)
        real(dp) :: largest(n_push)
        integer :: b, p

        push = 0
        do b = 1, size(coupling%carrier)
            associate (carrier => coupling%carrier(b))
                if (carrier%carries /= carries_all) cycle
                largest = 0
                do p = carrier%first, carrier%last
                    if (is_pushed(p)) call widen(push_on(carrier, p), largest)
                end do
                call open_sums(solid%ranks, largest, scales)
                limb = 0
                do p = carrier%first, carrier%last
                    if (is_pushed(p)) call add_terms(scales, push_on(carrier, p), limb)
                end do
                call close_sums(solid%ranks, scales, limb, push(:, b))
            end associate
        end do

    contains

        !> True for a particle in a cell of this process that a wall face loads.
        pure logical function is_pushed(p)
            integer, intent(in) :: p

            is_pushed = .false.
            if (coupling%place_of(p) == 0) return
            if (all(coupling%above(:, coupling%place_of(p)) == 0)) return
            is_pushed = is_own(coupling%box, coupling%cell_of(p))
        end function is_pushed

        pure function push_on(carrier, p) result(sums)
            type(carrier_t), intent(in) :: carrier
            integer, intent(in) :: p
            real(dp) :: sums(n_push)

            sums = 0
            call add_push(coupling%box, carrier, solid%x(:, p), solid%mass(p), &
                          coupling%above(:, coupling%place_of(p)), coupling%gas, &
                          coupling%surface, coupling%weight, coupling%force, &
                          coupling%impedance, sums)
        end function push_on
    end subroutine sum_push

    !> Force and torque of the air on the bodies that carry particles, from the loads of these:
    !> exact sums, as they act back.
    subroutine load_carriers(solid, coupling)
        type(solid_t), intent(inout) :: solid
        type(coupling_t), intent(in) :: coupling
        type(scale_t) :: scales(6)
        integer(int64) :: limb(limbs, 6)
        real(dp) :: largest(6)
        integer :: b, p

        if (.not. allocated(solid%bodies)) return
        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b))
                body%rigid%load = 0
                if (coupling%carrier(b)%carries == carries_none) cycle
                largest = 0
                do p = body%first, body%last
                    if (is_loaded(p)) call widen(load_on(p), largest)
                end do
                call open_sums(solid%ranks, largest, scales)
                limb = 0
                do p = body%first, body%last
                    if (is_loaded(p)) call add_terms(scales, load_on(p), limb)
                end do
                call close_sums(solid%ranks, scales, limb, body%rigid%load)
            end associate
        end do

    contains

        pure logical function is_loaded(p)
            integer, intent(in) :: p

            is_loaded = is_carried(coupling%carrier(b)%carries, solid%fixed(p) == is_held)
            if (is_loaded) is_loaded = any(abs(solid%load(:, p)) > 0)
        end function is_loaded

        pure function load_on(p) result(sums)
            integer, intent(in) :: p
            real(dp) :: sums(6)

            sums = 0
            call add_load(coupling%box, coupling%carrier(b), solid%x(:, p), solid%load(:, p), sums)
        end function load_on
    end subroutine load_carriers
end module brz_coupling_carriers
