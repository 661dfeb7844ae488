! SPDX-License-Identifier: MIT
!> May a run branch off a checkpoint with another deck?
!>
!> Besides what a restart may change (brz_checkpoint_match) the decks may differ in gauges at
!> points, and in the histories of loads, inflows and motions as far as they lie behind the
!> checkpoint: up to it both must be the same function of time.
module brz_branch_match
    use brz_checkpoint_match, only: first_difference, quoted
    use brz_key, only: key_t
    use brz_kinds, only: dp, real32
    use brz_text, only: string_t, to_text
    implicit none
    private
    public :: branch_fault

    !> Keys of a group that are a history.
    type :: late_t
        character(8) :: group
        character(12) :: key
        integer :: rows !! numbers at each time
        logical :: ends !! it is 0 before its first time and after its last, and does not stay
    end type late_t

    type(late_t), parameter :: late(*) = [ &
        late_t('&load', 'pressure', 1, .true.), late_t('&load', 'scale', 1, .true.), &
        late_t('&inflow', 'overpressure', 1, .true.), late_t('&inflow', 'density', 1, .false.), &
        late_t('&inflow', 'pressure', 1, .false.), late_t('&inflow', 'velocity', 3, .false.), &
        late_t('&inflow', 'mach', 1, .false.), late_t('&motion', 'velocity', 3, .false.)]
    real(dp), parameter :: same = 1e-9_dp !! of the largest value: rounding of the deck
    character(*), parameter :: lf = new_line('a')

contains

    !> Why a run with a deck cannot branch off a checkpoint of another one; '' if it can.
    subroutine branch_fault(keys, theirs, ours, time, fault)
        type(key_t), intent(in) :: keys(:)
        character(*), intent(in) :: theirs, ours !! complete decks: of the checkpoint, of the run
        real(dp), intent(in) :: time !! of the checkpoint [s]
        character(:), allocatable, intent(out) :: fault
        type(string_t), allocatable :: there(:), here(:)
        character(:), allocatable :: line_a, line_b
        logical :: differ
        integer :: g

        fault = ''
        call first_difference(keys, common(theirs), common(ours), differ, line_a, line_b)
        if (differ) then
            fault = 'belongs to another deck: there '//quoted(line_a)//', here '// &
                quoted(line_b)//'; a branch may change histories of &load, &inflow and '// &
                '&motion behind the checkpoint, gauges at points, &output, and t_end, '// &
                'max_steps, dt_min, energy_band, title and backend of &run; run the deck from '// &
                'its start'
            return
        end if
        call histories(theirs, there)
        call histories(ours, here)
        do g = 1, min(size(there), size(here))
            if (fault == '') call compare(there(g)%s, here(g)%s, time, fault)
        end do
    end subroutine branch_fault

    !> A deck without what may differ.
    pure function common(deck) result(text)
        character(*), intent(in) :: deck
        character(:), allocatable :: text, group, line, name
        integer :: at

        text = ''
        name = ''
        group = ''
        at = 1
        do while (at <= len(deck))
            call next_line(deck, at, line)
            if (index(line, '&') == 1) name = line
            if (any(late%key == key_of(line) .and. late%group == name) .or. &
                key_of(line) == 'time' .and. any(late%group == name)) cycle
            group = group//line//lf
            if (line /= '/') cycle
            if (name /= '&gauge' .or. sums_up(group)) text = text//group
            group = ''
        end do
    end function common

    !> True for a gauge whose value depends on all that was before.
    pure logical function sums_up(group)
        character(*), intent(in) :: group !! its lines

        sums_up = index(value_of(group, 'quantity'), 'impulse') > 0 .or. &
                  value_of(group, 'with') /= ''
    end function sums_up

    !> Groups with histories, each as its lines.
    pure subroutine histories(deck, groups)
        character(*), intent(in) :: deck
        type(string_t), allocatable, intent(out) :: groups(:)
        character(:), allocatable :: group, line, name
        integer :: at

        allocate (groups(0))
        name = ''
        group = ''
        at = 1
        do while (at <= len(deck))
            call next_line(deck, at, line)
            if (index(line, '&') == 1) then
                name = line
                group = ''
            end if
            group = group//line//lf
            if (line /= '/') cycle
            if (any(late%group == name)) groups = [groups, string_t(group)]
            group = ''
        end do
    end subroutine histories

    !> Compare the histories of one group up to a time.
    pure subroutine compare(there, here, time, fault)
        character(*), intent(in) :: there, here !! lines of the group
        real(dp), intent(in) :: time !! [s]
        character(:), allocatable, intent(inout) :: fault
        real(dp), allocatable :: t_a(:), t_b(:), a(:), b(:), times(:)
        real(dp) :: at, scale, x, y
        character(:), allocatable :: name
        integer :: k, q, r

        name = there(:index(there, lf) - 1)//' id='//value_of(there, 'id')
        call read_numbers(value_of(there, 'time'), t_a)
        call read_numbers(value_of(here, 'time'), t_b)
        call between([t_a, t_b], time, times)
        do k = 1, size(late)
            if (late(k)%group /= there(:index(there, lf) - 1)) cycle
            call read_numbers(value_of(there, trim(late(k)%key)), a)
            call read_numbers(value_of(here, trim(late(k)%key)), b)
            if (size(a) == 0 .and. size(b) == 0) cycle
            if (size(a) == 0 .or. size(b) == 0) then
                fault = name//': '//trim(late(k)%key)//' is given in one of the decks alone; '// &
                    'give it in both'
                return
            end if
            scale = max(maxval(abs(a)), maxval(abs(b)))
            do q = 1, size(times)
                at = times(q)
                do r = 1, late(k)%rows
                    x = history_at(t_a, a(r::late(k)%rows), at, late(k)%ends)
                    y = history_at(t_b, b(r::late(k)%rows), at, late(k)%ends)
                    if (abs(x - y) <= same*scale) cycle
                    fault = name//': '//trim(late(k)%key)//' at t = '// &
                        to_text(real(at, real32))//' s is '//to_text(real(x, real32))// &
                        ' in the deck of the checkpoint and '//to_text(real(y, real32))// &
                        ' here, but a branch may change only what comes after its checkpoint '// &
                        'at '//to_text(real(time, real32))//' s; branch off an earlier one, '// &
                        'or run the deck from its start'
                    return
                end do
            end do
        end do
    end subroutine compare

    !> Two times within each interval in which both histories are straight lines.
    pure subroutine between(all, end, times)
        real(dp), intent(in) :: all(:), end !! times of both, time of the checkpoint [s]
        real(dp), allocatable, intent(out) :: times(:)
        real(dp) :: from, to

        allocate (times(0))
        from = 0
        do while (from < end)
            to = min(end, minval(all, mask=all > from))
            times = [times, from + 0.25_dp*(to - from), from + 0.75_dp*(to - from)]
            from = to
        end do
    end subroutine between

    !> Value of a history of straight lines; without times it is constant.
    pure real(dp) function history_at(time, value, at, ends) result(now)
        real(dp), intent(in) :: time(:), value(:), at
        logical, intent(in) :: ends !! 0 outside of its times
        integer :: i, n

        n = min(size(time), size(value))
        now = value(1)
        if (size(time) == 0 .or. size(value) == 1 .and. .not. ends) return
        if (at < time(1) .or. at > time(n)) then
            if (at > time(n)) now = value(n)
            if (ends) now = 0
            return
        end if
        do i = 1, n - 1
            if (at > time(i + 1)) cycle
            now = value(i) + (value(i + 1) - value(i))*(at - time(i))/(time(i + 1) - time(i))
            return
        end do
    end function history_at

    !> The next line without blanks around it and without the mark of a default.
    pure subroutine next_line(deck, at, line)
        character(*), intent(in) :: deck
        integer, intent(inout) :: at !! where it begins
        character(:), allocatable, intent(out) :: line
        integer :: length

        length = index(deck(at:)//lf, lf)
        line = trim(adjustl(deck(at:at + length - 2)))
        at = at + length
        if (index(line, ' ! default') > 0) line = line(:index(line, ' ! default') - 1)
    end subroutine next_line

    !> The key of a line 'key = values', '' for another line.
    pure function key_of(line) result(key)
        character(*), intent(in) :: line
        character(:), allocatable :: key

        key = ''
        if (index(line, ' = ') > 0) key = trim(line(:index(line, ' = ')))
    end function key_of

    !> The text behind a key in the lines of a group, '' where it is absent.
    pure function value_of(group, key) result(text)
        character(*), intent(in) :: group, key
        character(:), allocatable :: text
        integer :: at, length

        text = ''
        at = index(group, lf//key//' = ')
        if (at == 0) return
        at = at + len(key) + 4
        length = index(group(at:), lf)
        text = group(at:at + length - 2)
    end function value_of

    !> Numbers of a list with commas.
    pure subroutine read_numbers(text, list)
        character(*), intent(in) :: text
        real(dp), allocatable, intent(out) :: list(:)
        integer :: i, io, n

        n = 0
        if (text /= '') n = 1 + count([(text(i:i) == ',', i=1, len(text))])
        allocate (list(n), source=0.0_dp)
        if (n > 0) read (text, *, iostat=io) list
    end subroutine read_numbers
end module brz_branch_match
