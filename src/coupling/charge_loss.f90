! SPDX-License-Identifier: MIT
!> What of a charge lies in cells that bodies fill: no gas is there, so it is lost.
module brz_charge_loss
    use brz_air_state, only: air_t, cell_centre
    use brz_case, only: case_t, label
    use brz_charge_shape, only: charge_shape_t, filled_part, make_shape
    use brz_coupling_setup, only: empty_part
    use brz_coupling_state, only: coupling_t
    use brz_errors, only: error_t, exit_deck, failed, raise
    use brz_exact_sum, only: exact_sum
    use brz_kinds, only: dp, real32
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
        real(dp) :: lost(coupling%wall%n_cells), part, of_body(size(solid%bodies))
        integer :: b, c, ijk(3)

        call make_shape(case%charges(m), air%whole > 1, product(air%dx, mask=air%whole == 1), &
                        shape, err)
        if (failed(err)) return
        lost = 0
        of_body = 0
        do c = 1, coupling%wall%n_cells
            ijk = coupling%wall%cell(:, c)
            if (any(ijk < 1 .or. ijk > air%n)) cycle ! of another process
            part = filled_part(shape, cell_centre(air, ijk(1), ijk(2), ijk(3)), air%dx)
            if (.not. part > 0) cycle
            lost(c) = part*(1 - empty_part(air, p, coupling, c))*product(air%dx) &
                      *air%charge(m)%scale*case%charges(m)%density
            do b = 1, size(of_body)
                associate (body => solid%bodies(b), &
                           binned => coupling%binned(coupling%ends(c) + 1:coupling%ends(c + 1)))
                    if (any(binned >= body%first .and. binned <= body%last)) &
                        of_body(b) = of_body(b) + lost(c)
                end associate
            end do
        end do
        do b = 1, size(of_body)
            of_body(b) = exact_sum(coupling%ranks, [of_body(b)])
        end do
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

    !> Whole per cent.
    function percent(part) result(text)
        real(dp), intent(in) :: part
        character(:), allocatable :: text

        text = to_text(nint(100*part))
    end function percent
end module brz_charge_loss
