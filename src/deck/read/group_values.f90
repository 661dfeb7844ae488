! SPDX-License-Identifier: MIT
!> Values of a converted group, set by the program in place of those of the deck.
module brz_group_values
    use brz_deck, only: add_entry, entry_t, find_entry, group_t
    use brz_key, only: key_t
    use brz_kinds, only: dp
    use brz_text, only: string_t
    implicit none
    private
    public :: set_numbers, set_text, set_texts, take_entry

contains

    !> Give a key numbers.
    subroutine set_numbers(group, key, numbers)
        type(group_t), intent(inout) :: group
        character(*), intent(in) :: key
        real(dp), intent(in) :: numbers(:)
        type(string_t) :: words(size(numbers))
        integer :: i

        do i = 1, size(words)
            words(i)%s = ''
        end do
        call set_entry(group, key, numbers, words)
    end subroutine set_numbers

    !> Give a key a text.
    subroutine set_text(group, key, text)
        type(group_t), intent(inout) :: group
        character(*), intent(in) :: key, text

        call set_texts(group, key, [text])
    end subroutine set_text

    !> Give a key several texts.
    subroutine set_texts(group, key, texts)
        type(group_t), intent(inout) :: group
        character(*), intent(in) :: key, texts(:)
        type(string_t) :: words(size(texts))
        integer :: i

        do i = 1, size(words)
            words(i)%s = trim(texts(i))
        end do
        call set_entry(group, key, spread(0.0_dp, 1, size(words)), words)
    end subroutine set_texts

    subroutine set_entry(group, key, numbers, words)
        type(group_t), intent(inout) :: group
        character(*), intent(in) :: key
        real(dp), intent(in) :: numbers(:)
        type(string_t), intent(in) :: words(:)
        integer :: e

        e = find_entry(group, key)
        if (e == 0) then
            call add_entry(group, key, group%line)
            e = group%n
        end if
        group%entries(e)%n = size(numbers)
        group%entries(e)%number = numbers
        group%entries(e)%word = words
        group%entries(e)%default = .false.
    end subroutine set_entry

    !> Take a key out of a group; where it has a default, that stands there afterwards.
    subroutine take_entry(group, keys, defaults, key)
        type(group_t), intent(inout) :: group
        type(key_t), intent(in) :: keys(:)
        type(entry_t), intent(in) :: defaults(:)
        character(*), intent(in) :: key
        integer :: e, i

        e = find_entry(group, key)
        if (e == 0) return
        do i = 1, size(keys)
            if (keys(i)%group /= group%name .or. keys(i)%key /= key) cycle
            if (defaults(i)%row /= i) cycle
            group%entries(e) = defaults(i)
            group%entries(e)%default = .true.
            return
        end do
        do i = e, group%n - 1
            group%entries(i) = group%entries(i + 1)
        end do
        group%n = group%n - 1
    end subroutine take_entry
end module brz_group_values
