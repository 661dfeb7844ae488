! SPDX-License-Identifier: MIT
!> What of a charge lies where bodies are: no gas is there, so it is lost.
module brz_charge_loss
    use brz_air_state, only: air_t, cell_centre
    use brz_case, only: case_t, label
    use brz_cell_shells, only: cell_at
    use brz_charge_shape, only: charge_shape_t, filled_part, make_shape
    use brz_coupling_state, only: coupling_t
    use brz_errors, only: error_t, exit_deck, failed, raise
    use brz_exact_sum, only: exact_sum
    use brz_kinds, only: dp, int32, real32
    use brz_ranks, only: several
    use brz_particles, only: particles_t
    use brz_bodies, only: bodies_t
    use brz_text, only: to_text
    implicit none
    private
    public :: weigh_loss

    real(dp), parameter :: most = 0.05_dp !! part of a charge that may be lost

contains

    !> Weigh what every charge on the grid has lost to bodies, and refuse a charge that lies in one.
    !>
    !> A charge that starts in one or two dimensions keeps its distance from bodies.
    subroutine weigh_loss(case, air, solid, coupling, err)
        type(case_t), intent(in) :: case
        type(air_t), intent(inout) :: air !! its walls are up
        class(bodies_t), intent(in) :: solid
        type(coupling_t), intent(in) :: coupling
        type(error_t), intent(inout) :: err
        integer :: m

        do m = 1, size(case%charges)
            if (case%charges(m)%start /= '3d') cycle
            if (several(solid%ranks)) then
                call weigh(case, m, air, coupling%ghost_bodies, coupling%ghosts, coupling, err)
            else
                call weigh(case, m, air, solid, solid, coupling, err)
            end if
            if (failed(err)) return
        end do
    end subroutine weigh_loss

    !> The same for charge m.
    subroutine weigh(case, m, air, solid, p, coupling, err)
        type(case_t), intent(in) :: case
        integer, intent(in) :: m
        type(air_t), intent(inout) :: air
        class(bodies_t), intent(in) :: solid !! bodies
        class(particles_t), intent(in) :: p !! particles that are sorted into the cells
        type(coupling_t), intent(in) :: coupling
        type(error_t), intent(inout) :: err
        type(charge_shape_t) :: shape
        real(dp), allocatable :: lost(:)
        real(dp) :: bare, of_body(size(solid%bodies)), part
        integer :: c, ijk(3)

        call make_shape(case%charges(m), air%whole > 1, product(air%dx, mask=air%whole == 1), &
                        shape, err)
        if (failed(err)) return
        of_body = 0
        allocate (lost(merge(coupling%wall%filled%n, coupling%wall%cells%n, coupling%paper)))
        lost = 0
        do c = 1, size(lost)
            call look_at_cell(air, p, coupling, c, ijk, bare)
            if (any(ijk < 1 .or. ijk > air%n)) cycle ! of another process
            part = filled_part(shape, cell_centre(air, ijk(1), ijk(2), ijk(3)), air%dx)
            lost(c) = part*(1 - bare)*product(air%dx)*air%charge(m)%scale*case%charges(m)%density
            if (lost(c) > 0) call blame(solid, particles_of(coupling, c), lost(c), of_body)
        end do
        of_body = [(exact_sum(coupling%ranks, of_body(c:c)), c=1, size(of_body))]
        associate (report => air%charge(m), charge => case%charges(m))
            report%lost = exact_sum(coupling%ranks, lost)
            if (report%lost <= most*report%mass) return
            call raise(err, exit_deck, label('charge', charge%id, charge%place)// &
                       percent(report%lost/report%mass)//' % of it ('// &
                       to_text(real(report%lost, real32))//' of '// &
                       to_text(real(report%mass, real32))//" kg in the model) lies in body '"// &
                       trim(solid%bodies(maxloc(of_body, 1))%id)//"', where there is no gas, "// &
                       'and would be lost: move it until the two touch at most, or make room '// &
                       'for it in the body; where they touch, use smaller cells')
        end associate
    end subroutine weigh

    !> Where a listed cell is, and what part of it bodies leave to the gas.
    subroutine look_at_cell(air, p, coupling, c, ijk, bare)
        type(air_t), intent(in) :: air
        class(particles_t), intent(in) :: p !! particles
        type(coupling_t), intent(in) :: coupling
        integer, intent(in) :: c !! place in the list
        integer, intent(out) :: ijk(3) !! indices in the box of this process
        real(dp), intent(out) :: bare

        if (coupling%paper) then
            ijk = coupling%wall%filled%cell(:, c)
            bare = 0
            if (coupling%wall%filled%touches(c)) &
                bare = max(1 - sum(real(p%volume(particles_of(coupling, c)), dp)) &
                           /product(air%dx), 0.0_dp)
        else
            associate (cells => coupling%wall%cells)
                ijk = cell_at(cells%nodes%n, cells%cell(c)) - cells%nodes%own(:, 1) + 1
                bare = cells%gas(c)
            end associate
        end if
    end subroutine look_at_cell

    !> Particles of a listed cell.
    pure function particles_of(coupling, c) result(p)
        type(coupling_t), intent(in) :: coupling
        integer, intent(in) :: c !! place in the list
        integer(int32), allocatable :: p(:)

        if (coupling%paper) then
            associate (filled => coupling%wall%filled)
                p = filled%binned(filled%ends(c) + 1:filled%ends(c + 1))
            end associate
        else
            associate (cells => coupling%wall%cells)
                p = cells%binned(cells%bin_ends(c) + 1:cells%bin_ends(c + 1))
            end associate
        end if
    end function particles_of

    !> Add what a cell loses to the bodies that have particles in it.
    pure subroutine blame(solid, p, lost, of_body)
        class(bodies_t), intent(in) :: solid
        integer(int32), intent(in) :: p(:) !! particles of the cell
        real(dp), intent(in) :: lost !! [kg]
        real(dp), intent(inout) :: of_body(:) !! [kg]
        integer :: b

        do b = 1, size(of_body)
            associate (body => solid%bodies(b))
                if (any(p >= body%first .and. p <= body%last)) of_body(b) = of_body(b) + lost
            end associate
        end do
    end subroutine blame

    !> Whole per cent.
    function percent(part) result(text)
        real(dp), intent(in) :: part
        character(:), allocatable :: text

        text = to_text(nint(100*part))
    end function percent
end module brz_charge_loss
