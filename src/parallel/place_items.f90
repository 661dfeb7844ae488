! SPDX-License-Identifier: MIT
!> Numbers of listed cells or particles, into a row and back: what packs and unpacks messages.
!>
!> Number c of element p of an array is array((p - 1)*step_p + (c - 1)*step_d + 1): so it serves
!> fields (step_p = 1) and rows (step_d = 1). A list may name an element twice; both times the same
!> numbers come for it.
module brz_place_items
    use brz_kinds, only: int32, int64, int8, rk
    implicit none
    private
    public :: pick_reals, put_reals, pick_bytes, put_bytes, pick_words, put_words, carry_words, &
        give_place, list_marked

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

    !> A word of 4 B of a listed particle, into its record, which has those of other arrays, too.
    !> One after the other they are those of a record.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine pick_words(t, words, columns, stride, wide, before, place, array, record)
        integer, intent(in) :: t !! words of all records
        integer, intent(in) :: words !! of a particle in a column
        integer, intent(in) :: columns
        integer(int64), intent(in) :: stride !! words from a column to the next
        integer, intent(in) :: wide, before !! words of a record, before those of this array
        integer(int32), intent(in) :: place(*) !! of each particle, from 1
        integer(int32), intent(in) :: array(*) !! (words, particles) in each column
        integer(int32), intent(inout) :: record(*) !! (wide, particles of the list)
        integer :: c, p

        p = (t - 1)/(words*columns)
        c = t - 1 - p*(words*columns)
        record(p*int(wide, int64) + before + c + 1) = array(word_of(place(p + 1), c, words, stride))
    end subroutine pick_words

    !> The way back.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine put_words(t, words, columns, stride, wide, before, place, record, array)
        integer, intent(in) :: t !! words of all records
        integer, intent(in) :: words !! of a particle in a column
        integer, intent(in) :: columns
        integer(int64), intent(in) :: stride !! words from a column to the next
        integer, intent(in) :: wide, before !! words of a record, before those of this array
        integer(int32), intent(in) :: place(*) !! of each particle, from 1
        integer(int32), intent(in) :: record(*) !! (wide, particles of the list)
        integer(int32), intent(inout) :: array(*) !! (words, particles) in each column
        integer :: c, p

        p = (t - 1)/(words*columns)
        c = t - 1 - p*(words*columns)
        array(word_of(place(p + 1), c, words, stride)) = record(p*int(wide, int64) + before + c + 1)
    end subroutine put_words

    !> A word of a listed particle, to the particle of another list in another array.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine carry_words(t, wide, words, stride, place, array, words_to, stride_to, &
                                place_to, array_to)
        integer, intent(in) :: t !! words of all particles
        integer, intent(in) :: wide !! of each
        integer, intent(in) :: words, words_to !! of a particle in a column
        integer(int64), intent(in) :: stride, stride_to !! words from a column to the next
        integer(int32), intent(in) :: place(*), place_to(*) !! of each particle, from 1
        integer(int32), intent(in) :: array(*)
        integer(int32), intent(inout) :: array_to(*)
        integer :: c, p

        p = (t - 1)/wide
        c = t - 1 - p*wide
        array_to(word_of(place_to(p + 1), c, words_to, stride_to)) = &
            array(word_of(place(p + 1), c, words, stride))
    end subroutine carry_words

    !> Where a word of a particle lies in an array of columns.
    !@cuf attributes(host,device) &
    pure integer(int64) function word_of(place, before, words, stride) result(at)
        integer(int32), intent(in) :: place !! of the particle
        integer, intent(in) :: before !! its words before this one
        integer, intent(in) :: words !! of a particle in a column
        integer(int64), intent(in) :: stride !! words from a column to the next
        integer :: column

        column = before/words
        at = column*stride + (place - 1)*int(words, int64) + (before - column*words) + 1
    end function word_of

    !> Places of the entries of a list that is made of pieces.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine give_place(k, pieces, piece, place)
        integer, intent(in) :: k !! entries
        integer, intent(in) :: pieces
        integer(int32), intent(in) :: piece(*) !! (2, pieces) last entry, what an entry is short of
        integer(int32), intent(inout) :: place(*)
        integer :: j

        do j = 1, pieces
            if (k <= piece(2*j - 1)) exit
        end do
        place(k) = k + piece(2*j)
    end subroutine give_place

    !> List the places that are marked: `mark`, a row for each process, was 1 there, and is now how
    !> many were marked before.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine list_marked(k, row, before, mark, place)
        integer, intent(in) :: k !! marks
        integer, intent(in) :: row !! places of a process
        integer, intent(in) :: before !! marks that are not listed
        integer(int32), intent(in) :: mark(*)
        integer(int32), intent(inout) :: place(*)

        if (mark(k + 1) > mark(k)) place(mark(k) - before + 1) = mod(k - 1, row) + 1
    end subroutine list_marked
end module brz_place_items
