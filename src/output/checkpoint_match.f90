! SPDX-License-Identifier: MIT
!> Does a checkpoint belong to a deck?
!>
!> The complete decks are compared line by line. These may differ, because they do not touch the
!> state: all of &output, and in &run title, t_end, max_steps, dt_min, energy_band and backend.
!> A checkpoint of an older version may have an older name of a key.
module brz_checkpoint_match
    use brz_key, only: key_t
    use brz_key_text, only: present_name
    implicit none
    private
    public :: first_difference, free_keys, quoted

    character(*), parameter :: line_end = new_line('a')
    character(11), parameter :: free_keys(6) = [character(11) :: 'title', 't_end', 'max_steps', &
                                                'dt_min', 'energy_band', 'backend']

contains

    !> The first line in which two complete decks differ; false and '' if there is none.
    subroutine first_difference(keys, deck_a, deck_b, differ, line_a, line_b)
        type(key_t), intent(in) :: keys(:)
        character(*), intent(in) :: deck_a, deck_b
        logical, intent(out) :: differ
        character(:), allocatable, intent(out) :: line_a, line_b !! with their group in front
        character(:), allocatable :: group_a, group_b
        integer :: a, b

        a = 1
        b = 1
        group_a = ''
        group_b = ''
        do
            call next_line(deck_a, a, group_a, line_a)
            call next_line(deck_b, b, group_b, line_b)
            line_a = present_line(keys, group_a, line_a)
            line_b = present_line(keys, group_b, line_b)
            differ = line_a /= line_b .or. group_a /= group_b
            if (differ .or. line_a == '') exit
        end do
        if (line_a /= '' .and. line_a(1:1) /= '&') line_a = group_a//' '//line_a
        if (line_b /= '' .and. line_b(1:1) /= '&') line_b = group_b//' '//line_b
    end subroutine first_difference

    !> A line of first_difference as a message has it.
    pure function quoted(line) result(text)
        character(*), intent(in) :: line
        character(:), allocatable :: text

        text = '"'//line//'"'
        if (line == '') text = 'nothing more'
    end function quoted

    !> A line 'key = values' with the present name of the key.
    pure function present_line(keys, group, line) result(text)
        type(key_t), intent(in) :: keys(:)
        character(*), intent(in) :: group, line
        character(:), allocatable :: text
        integer :: i

        text = line
        i = index(line, ' ')
        if (i > 1 .and. index(line, '=') > i) &
            text = present_name(keys, group(min(2, len(group) + 1):), line(:i - 1))//line(i:)
    end function present_line

    !> The next line that counts, without the mark of a default; '' at the end.
    subroutine next_line(deck, position, group, line)
        character(*), intent(in) :: deck
        integer, intent(inout) :: position !! where the next line begins
        character(:), allocatable, intent(inout) :: group !! that the line belongs to
        character(:), allocatable, intent(out) :: line
        character(*), parameter :: mark = ' ! default'
        integer :: length, n

        do while (position <= len(deck))
            length = index(deck(position:), line_end)
            if (length == 0) length = len(deck) - position + 2
            line = trim(adjustl(deck(position:position + length - 2)))
            position = position + length
            if (line == '') cycle
            if (line(1:1) == '&') group = line
            if (group == '' .or. group == '&output') cycle
            n = len(line) - len(mark)
            if (n > 0) then
                if (line(n + 1:) == mark) line = line(:n)
            end if
            if (group == '&run' .and. is_free(line)) cycle
            return
        end do
        line = ''
    end subroutine next_line

    !> True for a key of &run that may differ.
    pure logical function is_free(line)
        character(*), intent(in) :: line
        integer :: i

        is_free = .false.
        i = index(line, '=')
        if (i > 1) is_free = any(free_keys == adjustl(line(:i - 1)))
    end function is_free
end module brz_checkpoint_match
