! SPDX-License-Identifier: MIT
!> Numbers of listed cells or particles, into a row and back: what packs and unpacks messages.
!>
!> Number c of element p of an array is array((p - 1)*step_p + (c - 1)*step_d + 1): so it serves
!> fields (step_p = 1) and rows (step_d = 1). A list may name an element twice; both times the same
!> numbers come for it.
module brz_place_items
    use brz_kinds, only: int64, int8, rk
    implicit none
    private
    public :: pick_reals, put_reals, pick_bytes, put_bytes

contains

    !> The numbers of a listed element, into its row.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine pick_reals(t, wide, step_p, step_d, place, array, row)
        integer, intent(in) :: t !! elements of the list
        integer, intent(in) :: wide !! numbers of each
        integer, intent(in) :: step_p
        integer(int64), intent(in) :: step_d
        integer(int64), intent(in) :: place(*) !! of each element, from 1
        real(rk), intent(in) :: array(*)
        real(rk), intent(inout) :: row(*) !! (wide, elements)
        integer :: c

        do c = 1, wide
            row(c + (t - 1)*int(wide, int64)) = array((place(t) - 1)*step_p + (c - 1)*step_d + 1)
        end do
    end subroutine pick_reals

    !> Its row, into the numbers of a listed element.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine put_reals(t, wide, step_p, step_d, place, row, array)
        integer, intent(in) :: t !! elements of the list
        integer, intent(in) :: wide !! numbers of each
        integer, intent(in) :: step_p
        integer(int64), intent(in) :: step_d
        integer(int64), intent(in) :: place(*) !! of each element, from 1
        real(rk), intent(in) :: row(*) !! (wide, elements)
        real(rk), intent(inout) :: array(*)
        integer :: c

        do c = 1, wide
            array((place(t) - 1)*step_p + (c - 1)*step_d + 1) = row(c + (t - 1)*int(wide, int64))
        end do
    end subroutine put_reals

    !> The mark of a listed element, into its row.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine pick_bytes(t, place, array, row)
        integer, intent(in) :: t !! elements of the list
        integer(int64), intent(in) :: place(*) !! of each element, from 1
        integer(int8), intent(in) :: array(*)
        integer(int8), intent(inout) :: row(*)

        row(t) = array(place(t))
    end subroutine pick_bytes

    !> Its row, into the mark of a listed element.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine put_bytes(t, place, row, array)
        integer, intent(in) :: t !! elements of the list
        integer(int64), intent(in) :: place(*) !! of each element, from 1
        integer(int8), intent(in) :: row(*)
        integer(int8), intent(inout) :: array(*)

        array(place(t)) = row(t)
    end subroutine put_bytes
end module brz_place_items
