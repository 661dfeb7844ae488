! SPDX-License-Identifier: MIT
!> Values of a converted group by key. A key that is absent or in error leaves its variable alone.
module brz_get
    use brz_deck, only: complain, deck_t, find_entry, group_t
    use brz_files, only: file_exists
    use brz_kinds, only: dp
    use brz_text, only: to_text
    implicit none
    private
    public :: count_values, get, get_box, get_boxes, get_list, get_path, is_given, is_usable
    public :: need_file

    interface get
        module procedure :: get_real, get_reals, get_integer, get_integers, get_logical
        module procedure :: get_text, get_texts
    end interface get

contains

    !> True if the key has a value without errors, given or default.
    pure logical function is_usable(group, key)
        type(group_t), intent(in) :: group
        character(*), intent(in) :: key
        integer :: e

        is_usable = .false.
        e = find_entry(group, key)
        if (e > 0) is_usable = .not. group%entries(e)%bad
    end function is_usable

    !> Values of a key, 0 where it is absent or in error.
    pure integer function count_values(group, key) result(n)
        type(group_t), intent(in) :: group
        character(*), intent(in) :: key

        n = 0
        if (is_usable(group, key)) n = group%entries(find_entry(group, key))%n
    end function count_values

    !> True if the key stands in the deck, with a value other than the default.
    pure logical function is_given(group, key)
        type(group_t), intent(in) :: group
        character(*), intent(in) :: key
        integer :: e

        is_given = .false.
        e = find_entry(group, key)
        if (e > 0) is_given = .not. group%entries(e)%default
    end function is_given

    subroutine get_real(group, key, value)
        type(group_t), intent(in) :: group
        character(*), intent(in) :: key
        real(dp), intent(inout) :: value

        if (is_usable(group, key)) value = group%entries(find_entry(group, key))%number(1)
    end subroutine get_real

    subroutine get_reals(group, key, values)
        type(group_t), intent(in) :: group
        character(*), intent(in) :: key
        real(dp), intent(inout) :: values(:)
        integer :: e, n

        if (.not. is_usable(group, key)) return
        e = find_entry(group, key)
        n = min(size(values), size(group%entries(e)%number))
        values(:n) = group%entries(e)%number(:n)
    end subroutine get_reals

    subroutine get_integer(group, key, value)
        type(group_t), intent(in) :: group
        character(*), intent(in) :: key
        integer, intent(inout) :: value

        if (is_usable(group, key)) value = nint(group%entries(find_entry(group, key))%number(1))
    end subroutine get_integer

    subroutine get_integers(group, key, values)
        type(group_t), intent(in) :: group
        character(*), intent(in) :: key
        integer, intent(inout) :: values(:)
        integer :: e, n

        if (.not. is_usable(group, key)) return
        e = find_entry(group, key)
        n = min(size(values), size(group%entries(e)%number))
        values(:n) = nint(group%entries(e)%number(:n))
    end subroutine get_integers

    subroutine get_logical(group, key, value)
        type(group_t), intent(in) :: group
        character(*), intent(in) :: key
        logical, intent(inout) :: value

        if (is_usable(group, key)) value = nint(group%entries(find_entry(group, &
             key))%number(1)) /= 0
    end subroutine get_logical

    subroutine get_text(group, key, value)
        type(group_t), intent(in) :: group
        character(*), intent(in) :: key
        character(*), intent(inout) :: value

        if (is_usable(group, key)) value = group%entries(find_entry(group, key))%word(1)%s
    end subroutine get_text

    !> Texts of a list; n says how many there are.
    subroutine get_texts(group, key, values, n)
        type(group_t), intent(in) :: group
        character(*), intent(in) :: key
        character(*), intent(inout) :: values(:)
        integer, intent(out) :: n
        integer :: e, i

        n = 0
        if (.not. is_usable(group, key)) return
        e = find_entry(group, key)
        n = min(size(values), size(group%entries(e)%word))
        do i = 1, n
            values(i) = group%entries(e)%word(i)%s
        end do
    end subroutine get_texts

    !> The values of a key, none if it is absent.
    subroutine get_list(group, key, list)
        type(group_t), intent(in) :: group
        character(*), intent(in) :: key
        real(dp), allocatable, intent(out) :: list(:)
        integer :: n

        n = 0
        if (is_given(group, key) .and. is_usable(group, key)) &
            n = group%entries(find_entry(group, key))%n
        allocate (list(n))
        if (n > 0) call get(group, key, list)
    end subroutine get_list

    !> Corners from 'box': x0, x1, y0, y1, z0, z1.
    subroutine get_box(group, lo, hi)
        type(group_t), intent(in) :: group
        real(dp), intent(inout) :: lo(3), hi(3)
        real(dp) :: box(6)

        if (.not. is_usable(group, 'box')) return
        box = 0
        call get(group, 'box', box)
        lo = box(1:5:2)
        hi = box(2:6:2)
    end subroutine get_box

    !> Path of a file. One that is not absolute is beside the deck.
    subroutine get_path(deck, g, key, path)
        type(deck_t), intent(in) :: deck
        integer, intent(in) :: g !! place of the group
        character(*), intent(in) :: key
        character(*), intent(inout) :: path

        call get(deck%groups(g), key, path)
        if (path /= '' .and. path(1:1) /= '/') &
            path = deck%file(:index(deck%file, '/', back=.true.))//path
    end subroutine get_path

    !> Complain where there is no file at a path that get_path has found.
    subroutine need_file(deck, g, key, path)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g !! place of the group
        character(*), intent(in) :: key
        character(*), intent(in) :: path !! '': none is wanted

        if (path == '') return
        if (.not. file_exists(trim(path))) call complain(deck, g, key, "there is no file '"// &
            trim(path)//"' (paths start at the folder of the deck)")
    end subroutine need_file

    !> Boxes of a key, six numbers each: x0, x1, y0, y1, z0, z1. Another count is complained of.
    subroutine get_boxes(deck, g, key, boxes, n)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g !! place of the group
        character(*), intent(in) :: key
        real(dp), intent(inout) :: boxes(:, :) !! (6, most)
        integer, intent(inout) :: n !! how many there are
        real(dp) :: numbers(size(boxes))
        integer :: given

        if (.not. is_usable(deck%groups(g), key)) return
        given = deck%groups(g)%entries(find_entry(deck%groups(g), key))%n
        numbers = 0
        call get(deck%groups(g), key, numbers)
        boxes = reshape(numbers, shape(boxes))
        n = given/6
        if (mod(given, 6) /= 0) call complain(deck, g, key, key//' takes six numbers for '// &
            'each region: x0, x1, y0, y1, z0, z1; found '//to_text(given))
        if (any(boxes(1::2, :n) > boxes(2::2, :n))) call complain(deck, g, key, key//' ends '// &
            'before it begins; the lower corner of x, y and z comes first')
    end subroutine get_boxes
end module brz_get
