! SPDX-License-Identifier: MIT
!> Numbers of listed cells or particles, into a row and back: what packs and unpacks messages.
!>
!> Number c of element p of an array is array((p - 1)*step_p + (c - 1)*step_d + 1): so it serves
!> fields (step_p = 1) and rows (step_d = 1). A list may name an element twice; both times the same
!> numbers come for it.
module brz_place_items
    use brz_kinds, only: int32, int64, int8, rk
    use brz_record_rules, only: find_word, record_t
    implicit none
    private
    public :: pick_reals, put_reals, pick_near, put_near, pick_bytes, put_bytes
    public :: pick_integer, pick_record, put_record, carry_words, give_place, join_place, &
        list_marked

    integer, parameter :: tile = 32 !! particles whose records lie word by word

contains

    !> The numbers of a listed element, each into the row of such numbers.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine pick_reals(t, length, wide, step_p, step_d, place, array, row)
        integer, intent(in) :: t !! elements of the list
        integer, intent(in) :: length !! elements of a row
        integer, intent(in) :: wide !! numbers of each
        integer, intent(in) :: step_p
        integer(int64), intent(in) :: step_d
        integer(int64), intent(in) :: place(*) !! of each element, from 1
        real(rk), intent(in) :: array(*)
        real(rk), intent(inout) :: row(*) !! (length, wide)
        integer :: c

        do c = 1, wide
            row(t + (c - 1)*int(length, int64)) = array((place(t) - 1)*step_p + (c - 1)*step_d + 1)
        end do
    end subroutine pick_reals

    !> The way back.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine put_reals(t, length, wide, step_p, step_d, place, row, array)
        integer, intent(in) :: t !! elements of the list
        integer, intent(in) :: length !! elements of a row
        integer, intent(in) :: wide !! numbers of each
        integer, intent(in) :: step_p
        integer(int64), intent(in) :: step_d
        integer(int64), intent(in) :: place(*) !! of each element, from 1
        real(rk), intent(in) :: row(*) !! (length, wide)
        real(rk), intent(inout) :: array(*)
        integer :: c

        do c = 1, wide
            array((place(t) - 1)*step_p + (c - 1)*step_d + 1) = row(t + (c - 1)*int(length, int64))
        end do
    end subroutine put_reals

    !> The same of a field where the block of the element is marked.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine pick_near(t, length, wide, step_d, place, block, near, array, row)
        integer, intent(in) :: t !! elements of the list
        integer, intent(in) :: length !! elements of a row
        integer, intent(in) :: wide !! numbers of each
        integer(int64), intent(in) :: step_d
        integer(int64), intent(in) :: place(*) !! of each element, from 1
        integer(int32), intent(in) :: block(*) !! of each element
        integer(int8), intent(in) :: near(*) !! (blocks)
        real(rk), intent(in) :: array(*)
        real(rk), intent(inout) :: row(*) !! (length, wide)

        if (near(block(t)) == 0) return
        call pick_reals(t, length, wide, 1, step_d, place, array, row)
    end subroutine pick_near

    !> The way back.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine put_near(t, length, wide, step_d, place, block, near, row, array)
        integer, intent(in) :: t !! elements of the list
        integer, intent(in) :: length !! elements of a row
        integer, intent(in) :: wide !! numbers of each
        integer(int64), intent(in) :: step_d
        integer(int64), intent(in) :: place(*) !! of each element, from 1
        integer(int32), intent(in) :: block(*) !! of each element
        integer(int8), intent(in) :: near(*) !! (blocks)
        real(rk), intent(in) :: row(*) !! (length, wide)
        real(rk), intent(inout) :: array(*)

        if (near(block(t)) == 0) return
        call put_reals(t, length, wide, 1, step_d, place, row, array)
    end subroutine put_near

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

    !> The number of a listed element, into its row.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine pick_integer(t, place, array, row)
        integer, intent(in) :: t !! elements of the list
        integer(int32), intent(in) :: place(*) !! of each element, from 1
        integer(int32), intent(in) :: array(*)
        integer(int32), intent(inout) :: row(*)

        row(t) = array(place(t))
    end subroutine pick_integer

    !> A word of 4 B of a listed particle, into its record of `wide` words, of which the last may be
    !> of no array. Records lie in tiles, a word of all particles of a tile behind the other:
    !> threads beside each other are at the same word of their particles.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine pick_record(t, number, wide, record, place, a1, a2, a3, a4, a5, a6, a7, a8, row)
        integer, intent(in) :: t !! words of all records
        integer, intent(in) :: number !! particles of the list
        integer, intent(in) :: wide !! words of a record in the message
        type(record_t), intent(in) :: record
        integer(int32), intent(in) :: place(*) !! of each particle, from 1
        integer(int32), intent(in) :: a1(*), a2(*), a3(*), a4(*), a5(*), a6(*), a7(*), a8(*)
        integer(int32), intent(inout) :: row(*) !! (particles of a tile, wide, tiles)
        integer :: array, c, p
        integer(int64) :: at

        call find_particle(t, number, wide, p, c)
        if (c >= record%wide) return
        call find_word(record, c, place(p), array, at)
        row(t) = word_of(array, at, a1, a2, a3, a4, a5, a6, a7, a8)
    end subroutine pick_record

    !> The way back.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine put_record(t, number, wide, record, place, row, a1, a2, a3, a4, a5, a6, a7, a8)
        integer, intent(in) :: t !! words of all records
        integer, intent(in) :: number !! particles of the list
        integer, intent(in) :: wide !! words of a record in the message
        type(record_t), intent(in) :: record
        integer(int32), intent(in) :: place(*) !! of each particle, from 1
        integer(int32), intent(in) :: row(*) !! (particles of a tile, wide, tiles)
        integer(int32), intent(inout) :: a1(*), a2(*), a3(*), a4(*), a5(*), a6(*), a7(*), a8(*)
        integer :: array, c, p
        integer(int64) :: at

        call find_particle(t, number, wide, p, c)
        if (c >= record%wide) return
        call find_word(record, c, place(p), array, at)
        call set_word(array, at, row(t), a1, a2, a3, a4, a5, a6, a7, a8)
    end subroutine put_record

    !> The particle of a word of the records in tiles, and the word.
    !@cuf attributes(host,device) &
    pure subroutine find_particle(t, number, wide, p, c)
        integer, intent(in) :: t, number, wide
        integer, intent(out) :: p !! particle of the list
        integer, intent(out) :: c !! words of its record before this one
        integer :: before, rest, some

        before = (t - 1)/(tile*wide)*tile
        rest = t - 1 - before*wide
        some = min(tile, number - before)
        c = rest/some
        p = before + rest - c*some + 1
    end subroutine find_particle

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
        array_to(place_of_word(place_to(p + 1), c, words_to, stride_to)) = &
            array(place_of_word(place(p + 1), c, words, stride))
    end subroutine carry_words

    !> Where a word of a particle lies in an array of columns.
    !@cuf attributes(host,device) &
    pure integer(int64) function place_of_word(place, before, words, stride) result(at)
        integer(int32), intent(in) :: place !! of the particle
        integer, intent(in) :: before !! its words before this one
        integer, intent(in) :: words !! of a particle in a column
        integer(int64), intent(in) :: stride !! words from a column to the next
        integer :: column

        column = before/words
        at = column*stride + (place - 1)*int(words, int64) + (before - column*words) + 1
    end function place_of_word

    !> A word of one of the arrays.
    !@cuf attributes(host,device) &
    pure function word_of(array, at, a1, a2, a3, a4, a5, a6, a7, a8) result(word)
        integer, intent(in) :: array !! 1 to most_arrays
        integer(int64), intent(in) :: at
        integer(int32), intent(in) :: a1(*), a2(*), a3(*), a4(*), a5(*), a6(*), a7(*), a8(*)
        integer(int32) :: word

        select case (array)
        case (1)
            word = a1(at)
        case (2)
            word = a2(at)
        case (3)
            word = a3(at)
        case (4)
            word = a4(at)
        case (5)
            word = a5(at)
        case (6)
            word = a6(at)
        case (7)
            word = a7(at)
        case default
            word = a8(at)
        end select
    end function word_of

    !> The way back.
    !@cuf attributes(host,device) &
    pure subroutine set_word(array, at, word, a1, a2, a3, a4, a5, a6, a7, a8)
        integer, intent(in) :: array !! 1 to most_arrays
        integer(int64), intent(in) :: at
        integer(int32), intent(in) :: word
        integer(int32), intent(inout) :: a1(*), a2(*), a3(*), a4(*), a5(*), a6(*), a7(*), a8(*)

        select case (array)
        case (1)
            a1(at) = word
        case (2)
            a2(at) = word
        case (3)
            a3(at) = word
        case (4)
            a4(at) = word
        case (5)
            a5(at) = word
        case (6)
            a6(at) = word
        case (7)
            a7(at) = word
        case default
            a8(at) = word
        end select
    end subroutine set_word

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

    !> The entries of a list that is made of pieces of two others, in turn.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine join_place(k, pieces, piece, one, other, place)
        integer, intent(in) :: k !! entries
        integer, intent(in) :: pieces
        integer(int32), intent(in) :: piece(*) !! (2, pieces) last entry, what an entry is short of
        integer(int32), intent(in) :: one(*), other(*)
        integer(int32), intent(inout) :: place(*)
        integer :: j

        do j = 1, pieces
            if (k <= piece(2*j - 1)) exit
        end do
        if (mod(j, 2) == 1) then
            place(k) = one(k + piece(2*j))
        else
            place(k) = other(k + piece(2*j))
        end if
    end subroutine join_place

    !> List the places that are marked: `mark`, a row for each process, was 1 there, and is now how
    !> many were marked before.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine list_marked(k, row, mark, place)
        integer, intent(in) :: k !! marks
        integer, intent(in) :: row !! places of a process
        integer(int32), intent(in) :: mark(*)
        integer(int32), intent(inout) :: place(*)

        if (mark(k + 1) > mark(k)) place(mark(k) + 1) = mod(k - 1, row) + 1
    end subroutine list_marked
end module brz_place_items
