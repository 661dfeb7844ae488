! SPDX-License-Identifier: MIT
!> Is what a checkpoint holds a state? Places in arrays and marks that are out of their range would
!> end a run far from the cause.
module brz_checkpoint_check
    use brz_air_state, only: air_t
    use brz_bond_marks, only: bond_breaks
    use brz_clock, only: clock_t
    use brz_coupling_state, only: coupling_t
    use brz_cut_cells, only: cut_before_t
    use brz_errors, only: error_t, exit_io, failed, raise
    use brz_kinds, only: dp, int32
    use brz_particle_marks, only: is_gone
    use brz_interacting_bodies, only: interacting_bodies_t
    implicit none
    private
    public :: check_state

contains

    !> Raise an error that names the first array with an impossible value.
    subroutine check_state(path, clock, air, coupling, solid, err)
        character(*), intent(in) :: path !! of the checkpoint
        type(clock_t), intent(in) :: clock
        type(air_t), intent(in) :: air
        type(coupling_t), intent(in) :: coupling
        class(interacting_bodies_t), intent(in) :: solid
        type(error_t), intent(inout) :: err
        character(:), allocatable :: name

        if (failed(err)) return
        name = ''
        call check_clock(clock, name)
        if (air%present) call demand(all(within(int(air%reached), 1)), 'air/reached', name)
        if (solid%present) call check_solid(solid, name)
        if (coupling%present) then
            if (allocated(coupling%wall%solid)) &
                call demand(all(within(int(coupling%wall%solid), 1)), 'coupling/solid', name)
            if (coupling%wall%cells%present) call check_cut_cells(coupling%wall%cells%before, &
                                                                  air%whole + 1, name)
        end if
        if (name /= '') call raise(err, exit_io, path//": '"//name// &
                                   "' is out of its range: Brisance did not write this file")
    end subroutine check_state

    !> Cut cells are numbered among the nodes of the grid.
    subroutine check_cut_cells(cells, nodes, name)
        type(cut_before_t), intent(in) :: cells
        integer, intent(in) :: nodes(3)
        character(:), allocatable, intent(inout) :: name

        call demand(all(is_cell(cells%cell, nodes)), 'coupling/cell', name)
        call demand(all(cells%master >= 1 .and. cells%master <= cells%n), 'coupling/master', name)
        call demand(all(within(int(cells%shut), 1)), 'coupling/shut', name)
    end subroutine check_cut_cells

    !> True for numbers of cells of a grid.
    pure function is_cell(number, n)
        integer(int32), intent(in) :: number(:)
        integer, intent(in) :: n(3) !! cells of the grid
        logical :: is_cell(size(number))

        is_cell = number >= 1 .and. number <= product(real(n, dp))
    end function is_cell

    !> Note the name of an array unless its values are possible, or one is noted already.
    subroutine demand(possible, name, first)
        logical, intent(in) :: possible
        character(*), intent(in) :: name
        character(:), allocatable, intent(inout) :: first

        if (first == '' .and. .not. possible) first = name
    end subroutine demand

    elemental logical function within(mark, last)
        integer(int32), intent(in) :: mark
        integer, intent(in) :: last !! marks are 0..last

        within = mark >= 0 .and. mark <= last
    end function within

    subroutine check_clock(clock, name)
        type(clock_t), intent(in) :: clock
        character(:), allocatable, intent(inout) :: name

        call demand(clock%time >= 0, 'clock/time', name)
        call demand(clock%dt >= 0, 'clock/dt', name)
        call demand(clock%cycle >= 0, 'clock/cycle', name)
        call demand(clock%dump_number >= 0, 'clock/dump_number', name)
        call demand(all(clock%marks%bytes >= 0), 'clock/history_bytes', name)
    end subroutine check_clock

    subroutine check_solid(solid, name)
        class(interacting_bodies_t), intent(in) :: solid
        character(:), allocatable, intent(inout) :: name
        logical, allocatable :: there(:)
        integer :: b, i

        call demand(solid%time >= 0, 'solid/time', name)
        call demand(solid%dt_last >= 0, 'solid/dt_last', name)
        call demand(solid%dt_limit >= 0, 'solid/dt_limit', name)
        call demand(solid%steps >= 0, 'solid/steps', name)
        call demand(all(solid%mass > 0), 'solid/mass', name)
        call demand(all(within(solid%fixed, is_gone) .or. solid%fixed >= 0 .and. &
                        mod(solid%fixed, 4) == 0), 'solid/fixed', name)
        call demand(all(within(int(solid%unsupported), 1)), 'solid/limp', name)
        call demand(all(solid%support >= 0), 'solid/support', name)
        if (solid%links%present) &
            call demand(all(within(solid%links%bond, bond_breaks)), 'solid/bond', name)
        if (solid%cohesive%present) &
            call demand(all(solid%cohesive%damage >= 0 .and. solid%cohesive%damage <= 1), &
                        'solid/interface_damage', name)
        call demand(all(solid%ply >= 0), 'solid/ply', name)
        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b))
                if (.not. allocated(body%axes)) cycle
                call demand(all(solid%ply(body%first:body%last) <= ubound(body%axes, 3)), &
                            'solid/ply', name)
            end associate
        end do
        allocate (there(solid%n), source=.false.)
        do i = 1, solid%n
            if (solid%id(i) >= 1 .and. solid%id(i) <= solid%n) there(solid%id(i)) = .true.
        end do
        call demand(all(there), 'solid/id', name)
    end subroutine check_solid
end module brz_checkpoint_check
