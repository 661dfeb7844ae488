! SPDX-License-Identifier: MIT
!> Gas that comes in through open faces: its values, and what they need.
module brz_check_inflow
    use brz_case, only: case_t, inflow_case_t, name_len
    use brz_check_start, only: is_radial
    use brz_csv_table, only: read_columns
    use brz_deck, only: complain, deck_t, may_be_misspelt, place
    use brz_errors, only: error_t, failed
    use brz_get, only: get, get_list, get_path, is_given
    use brz_kinds, only: dp
    use brz_text, only: to_text
    implicit none
    private
    public :: check_inflows

    character(*), parameter :: axes = 'xyz'
    character(2), parameter :: faces(6) = ['x-', 'x+', 'y-', 'y+', 'z-', 'z+']
    character(8), parameter :: of_state(4) = [character(8) :: 'density', 'pressure', 'velocity', &
                                              'mach']

contains

    !> Fill and check what comes in; the air must be there.
    subroutine check_inflows(deck, case)
        type(deck_t), intent(inout) :: deck
        type(case_t), intent(inout) :: case
        integer :: g, k

        allocate (case%inflows(count(deck%groups(:deck%n)%name == 'inflow')))
        k = 0
        do g = 1, deck%n
            if (deck%groups(g)%name /= 'inflow') cycle
            k = k + 1
            call fill(deck, g, case, case%inflows(k))
            if (deck%groups(g)%bad) cycle
            call check_face(deck, g, case, case%inflows(:k))
        end do
    end subroutine check_inflows

    subroutine fill(deck, g, case, inflow)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(inflow_case_t), intent(inout) :: inflow
        character(name_len) :: face
        real(dp), allocatable :: density(:), pressure(:), velocity(:), mach(:)
        integer :: i

        inflow%place = place(deck, deck%groups(g)%line)
        inflow%id = deck%groups(g)%id
        face = ''
        call get(deck%groups(g), 'face', face)
        i = findloc(faces, face(1:2), 1)
        inflow%axis = (i + 1)/2
        inflow%side = 2 - mod(i, 2)
        call get_list(deck%groups(g), 'time', inflow%time)
        call get_list(deck%groups(g), 'overpressure', inflow%overpressure)
        call get_list(deck%groups(g), 'density', density)
        call get_list(deck%groups(g), 'pressure', pressure)
        call get_list(deck%groups(g), 'velocity', velocity)
        call get_list(deck%groups(g), 'mach', mach)
        if (is_given(deck%groups(g), 'table')) &
            call read_table(deck, g, inflow, density, pressure, velocity, mach)
        if (deck%groups(g)%bad) return
        inflow%wave = size(inflow%overpressure) > 0
        call check_kind(deck, g, inflow, size(density) + size(pressure) + size(velocity) &
                        + size(mach))
        if (deck%groups(g)%bad) return
        if (inflow%wave) then
            allocate (inflow%state(0, 5))
            if (size(inflow%overpressure) /= max(1, size(inflow%time))) call complain(deck, g, &
                'overpressure', counted('overpressure', size(inflow%overpressure), &
                                        size(inflow%time)))
            if (any(inflow%overpressure <= -case%air%pressure)) call complain(deck, g, &
                'overpressure', 'it must stay above that of a vacuum, -'// &
                to_text(case%air%pressure)//' Pa')
        else
            call fill_state(deck, g, case, density, pressure, velocity, mach, inflow)
        end if
    end subroutine fill

    !> A wave, or a state, with times that grow.
    subroutine check_kind(deck, g, inflow, values)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(inflow_case_t), intent(in) :: inflow
        integer, intent(in) :: values !! of the state

        if (inflow%wave .and. values > 0) call complain(deck, g, 'overpressure', &
            'a wave has an overpressure alone, a state density, pressure and velocity or mach; '// &
            'take one of them out')
        if (.not. inflow%wave .and. values == 0) call complain(deck, g, 'face', &
            'what comes in? give overpressure, or density, pressure and velocity or mach')
        if (size(inflow%time) == 1) call complain(deck, g, 'time', 'a history needs two times; '// &
            'take time out for what never changes')
        if (any(inflow%time(2:) <= inflow%time(:max(size(inflow%time) - 1, 0)))) &
            call complain(deck, g, 'time', 'the times must grow')
    end subroutine check_kind

    !> Density, velocity and pressure at all times.
    subroutine fill_state(deck, g, case, density, pressure, velocity, mach, inflow)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        real(dp), intent(in) :: density(:), pressure(:), velocity(:), mach(:) !! none, one, or all
        type(inflow_case_t), intent(inout) :: inflow
        real(dp), allocatable :: speed(:)
        integer :: n(4), c, k, points

        points = max(1, size(inflow%time))
        n = [size(density), size(pressure), size(velocity)/3, size(mach)]
        if (mod(size(velocity), 3) /= 0) call complain(deck, g, 'velocity', &
            'it takes three numbers for each time')
        if (n(3) > 0 .and. n(4) > 0) call complain(deck, g, 'mach', &
            'give velocity or mach, not both')
        do k = 1, 4
            if (all(n(k) /= [0, 1, points])) call complain(deck, g, trim(of_state(k)), &
                counted(trim(of_state(k)), n(k), size(inflow%time)))
        end do
        allocate (inflow%state(points, 5), source=0.0_dp)
        if (deck%groups(g)%bad) return
        inflow%state(:, 1) = case%air%density
        inflow%state(:, 5) = case%air%pressure
        do k = 1, points
            if (n(1) > 0) inflow%state(k, 1) = density(min(k, n(1)))
            if (n(2) > 0) inflow%state(k, 5) = pressure(min(k, n(2)))
            do c = 1, merge(3, 0, n(3) > 0)
                inflow%state(k, 1 + c) = velocity(3*min(k, n(3)) - 3 + c)
            end do
        end do
        if (n(4) == 0) return
        speed = mach([(min(k, n(4)), k=1, points)])*sqrt(case%air%gamma*inflow%state(:, 5) &
                                                        /inflow%state(:, 1))
        inflow%state(:, 1 + inflow%axis) = merge(speed, -speed, inflow%side == 1)
    end subroutine fill_state

    !> History from a table.
    subroutine read_table(deck, g, inflow, density, pressure, velocity, mach)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(inflow_case_t), intent(inout) :: inflow
        real(dp), allocatable, intent(inout) :: density(:), pressure(:), velocity(:), mach(:)
        character(12), parameter :: names(8) = [character(12) :: 'time', 'overpressure', &
            'density', 'pressure', 'velocity_x', 'velocity_y', 'velocity_z', 'mach']
        character(512) :: path
        real(dp), allocatable :: values(:, :)
        type(error_t) :: err
        logical :: found(8)

        if (size(inflow%time) + size(inflow%overpressure) + size(density) + size(pressure) &
            + size(velocity) + size(mach) > 0) then
            call complain(deck, g, 'table', 'a table has times and values of a history; take '// &
                          'these keys out of the group')
            return
        end if
        path = ''
        call get_path(deck, g, 'table', path)
        call read_columns(trim(path), names, values, found, err)
        if (failed(err)) then
            call complain(deck, g, 'table', err%text)
        else if (.not. (found(1) .and. any(found(2:)))) then
            call complain(deck, g, 'table', trim(path)//': its first row must name the columns '// &
                          'time and overpressure, or time, density, pressure, velocity_x, ...')
        else if (size(values, 2) < 2) then
            call complain(deck, g, 'table', trim(path)//': a history needs two rows')
        else if ((found(3) .and. any(values(3, :) <= 0)) .or. &
                 (found(4) .and. any(values(4, :) <= 0))) then
            call complain(deck, g, 'table', trim(path)//': density and pressure must be positive')
        else
            inflow%time = values(1, :)
            if (found(2)) inflow%overpressure = values(2, :)
            if (found(3)) density = values(3, :)
            if (found(4)) pressure = values(4, :)
            if (any(found(5:7))) velocity = reshape(values(5:7, :), [3*size(values, 2)])
            if (found(8)) mach = values(8, :)
        end if
    end subroutine read_table

    !> An open face of a box that nothing else has changed.
    subroutine check_face(deck, g, case, inflows)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(inflow_case_t), intent(in) :: inflows(:) !! so far; the last one is asked about
        integer :: a, k

        associate (inflow => inflows(size(inflows)))
            a = inflow%axis
            if (.not. case%air%present) then
                if (.not. may_be_misspelt(deck)) &
                    call complain(deck, g, 'face', 'gas comes into a box of &air; add it')
                return
            end if
            if (is_radial(case)) then
                call complain(deck, g, 'face', "gas comes into a box; geometry='"// &
                              trim(case%air%geometry)//"' has none: use 'cartesian'")
                return
            end if
            if (case%air%cells(a) == 1) call complain(deck, g, 'face', 'along '// &
                axes(a:a)//' the air has one cell, which is not modelled; take another face')
            if (case%air%bc(inflow%side, a) /= 'outflow') call complain(deck, g, 'face', &
                "the face must be open: bc='outflow' of &air there, found '"// &
                trim(case%air%bc(inflow%side, a))//"'")
            do k = 1, size(inflows) - 1
                if (inflows(k)%axis == a .and. inflows(k)%side == inflow%side) call complain(deck, &
                    g, 'face', 'another &inflow has this face; take one of them out')
            end do
        end associate
        if (any(case%charges%start /= '3d')) call complain(deck, g, 'face', 'a charge that '// &
            "starts in one or two dimensions knows no inflow; use start='3d'")
    end subroutine check_face

    !> '3 values of mach for 2 times; give as many of both, or one'.
    pure function counted(key, n, times) result(text)
        character(*), intent(in) :: key
        integer, intent(in) :: n, times
        character(:), allocatable :: text

        text = to_text(n)//' values of '//key//' for '//to_text(times)//' times; give as many '// &
               'of both, or one and no times'
        if (key /= 'overpressure') text = to_text(n)//' values of '//key//' for '// &
                                          to_text(times)//' times; give as many of both, or one'
    end function counted
end module brz_check_inflow
