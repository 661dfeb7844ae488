! SPDX-License-Identifier: MIT
!> Numbers of listed cells or particles, into a row and back: what packs and unpacks messages.
!>
!> The messages to all other processes are one row of tiles of 32 places, each message whole tiles:
!> one kernel packs them, another one unpacks those that come.
module brz_place_loop_bodies
    use brz_kinds, only: int32, int64, int8, rk
    use brz_record_rules, only: find_word, record_t
    implicit none
    private
    public :: tile, pick_reals, pick_cells, put_cells, pick_marks, put_marks, pick_bytes, put_bytes
    public :: pick_record, put_record, carry_words, give_place, join_place

    integer, parameter :: tile = 32 !! cells or particles whose numbers lie one by one
    integer, parameter :: real_bytes = storage_size(1.0_rk)/8

contains

    !> The numbers of a listed cell of a field, each into the row of such numbers.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine pick_reals(t, length, wide, step, place, array, row)
        integer, intent(in) :: t !! cells of the list
        integer, intent(in) :: length !! cells of a row
        integer, intent(in) :: wide !! numbers of a cell
        integer(int64), intent(in) :: step !! numbers between those of a cell
        integer(int64), intent(in) :: place(*) !! of each cell, from 1
        real(rk), intent(in) :: array(*)
        real(rk), intent(inout) :: row(*) !! (length, wide)
        integer :: c

        do c = 0, wide - 1
            row(t + c*int(length, int64)) = array(place(t) + c*step)
        end do
    end subroutine pick_reals

    !> The numbers of a listed cell of a field, into its message, if its block is marked.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine pick_cells(t, wide, step, message, place, block, near, array, row)
        integer, intent(in) :: t !! places of the tiles
        integer, intent(in) :: wide !! numbers of a cell
        integer(int64), intent(in) :: step !! numbers between those of a cell
        integer(int64), intent(in) :: message(*) !! (5, processes), see find_entry
        integer(int32), intent(in) :: place(*) !! of each cell, from 1
        integer(int32), intent(in) :: block(*) !! of each cell
        integer(int8), intent(in) :: near(*) !! (blocks)
        real(rk), intent(in) :: array(*)
        real(rk), intent(inout) :: row(*) !! (places of a tile, wide, tiles)
        integer(int64) :: away, to
        integer :: c, k

        call find_entry(t - 1, real_bytes*wide, message, k, away)
        if (near(block(k)) == 0) return
        to = first_of(t, wide) + away/real_bytes
        do c = 0, wide - 1
            row(to + c*tile) = array(place(k) + c*step)
        end do
    end subroutine pick_cells

    !> The way back.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine put_cells(t, wide, step, message, place, block, near, row, array)
        integer, intent(in) :: t !! places of the tiles
        integer, intent(in) :: wide !! numbers of a cell
        integer(int64), intent(in) :: step !! numbers between those of a cell
        integer(int64), intent(in) :: message(*) !! (5, processes), see find_entry
        integer(int32), intent(in) :: place(*) !! of each cell, from 1
        integer(int32), intent(in) :: block(*) !! of each cell
        integer(int8), intent(in) :: near(*) !! (blocks)
        real(rk), intent(in) :: row(*) !! (places of a tile, wide, tiles)
        real(rk), intent(inout) :: array(*)
        integer(int64) :: away
        integer :: c, k

        call find_entry(t - 1, real_bytes*wide, message, k, away)
        if (near(block(k)) == 0) return
        do c = 0, wide - 1
            array(place(k) + c*step) = row(first_of(t, wide) + c*tile)
        end do
    end subroutine put_cells

    !> The first number of a place of the tiles.
    !@cuf attributes(host,device) &
    pure integer(int64) function first_of(t, wide) result(at)
        integer, intent(in) :: t !! places of the tiles
        integer, intent(in) :: wide !! numbers of each

        at = t + int((t - 1)/tile, int64)*(tile*(wide - 1))
    end function first_of

    !> The entry of a list that has a place in the tiles of its messages, and how many bytes from
    !> here its message is to be written. What is known of the message of each process: places up to
    !> its end, what an entry is short of, its last entry; bytes and places from where it would be
    !> here to where it is to be. The last entry comes again until a tile is full.
    !@cuf attributes(host,device) &
    pure subroutine find_entry(before, bytes, message, k, away)
        integer, intent(in) :: before !! places of the tiles of all messages, before this one
        integer, intent(in) :: bytes !! of an entry
        integer(int64), intent(in) :: message(*) !! (5, processes)
        integer, intent(out) :: k !! from 1
        integer(int64), intent(out) :: away
        integer :: at

        at = 1
        do while (before >= message(at))
            at = at + 5
        end do
        k = int(min(before + message(at + 1), message(at + 2)))
        away = message(at + 3) + message(at + 4)*bytes
    end subroutine find_entry

    !> The marks of four listed cells, into their message.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine pick_marks(t, message, place, array, row)
        integer, intent(in) :: t !! words of four places of the tiles
        integer(int64), intent(in) :: message(*) !! (5, processes), see find_entry
        integer(int32), intent(in) :: place(*) !! of each cell, from 1
        integer(int8), intent(in) :: array(*)
        integer(int32), intent(inout) :: row(*)
        integer(int64) :: away
        integer(int32) :: word
        integer :: c, k

        word = 0
        do c = 0, 3
            call find_entry(4*(t - 1) + c, 1, message, k, away)
            word = ior(word, shiftl(iand(int(array(place(k)), int32), 255), 8*c))
        end do
        row(t + away/4) = word
    end subroutine pick_marks

    !> The way back.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine put_marks(t, message, place, row, array)
        integer, intent(in) :: t !! words of four places of the tiles
        integer(int64), intent(in) :: message(*) !! (5, processes), see find_entry
        integer(int32), intent(in) :: place(*) !! of each cell, from 1
        integer(int32), intent(in) :: row(*)
        integer(int8), intent(inout) :: array(*)
        integer(int64) :: away
        integer :: c, k

        do c = 0, 3
            call find_entry(4*(t - 1) + c, 1, message, k, away)
            array(place(k)) = int(shifta(shiftl(row(t), 24 - 8*c), 24), int8)
        end do
    end subroutine put_marks

    !> The mark of a listed element, into its row.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine pick_bytes(t, place, array, row)
        integer, intent(in) :: t !! elements of the list
        integer(int64), intent(in) :: place(*) !! of each element, from 1
        integer(int8), intent(in) :: array(*)
        integer(int8), intent(inout) :: row(*)

        row(t) = array(place(t))
    end subroutine pick_bytes

    !> Its row, into the mark of a listed element.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine put_bytes(t, place, row, array)
        integer, intent(in) :: t !! elements of the list
        integer(int64), intent(in) :: place(*) !! of each element, from 1
        integer(int8), intent(in) :: row(*)
        integer(int8), intent(inout) :: array(*)

        array(place(t)) = row(t)
    end subroutine put_bytes

    !> A word of 4 B of a listed particle, into its record of `wide` words, of which the last may be
    !> of no array. Records lie in tiles, a word of all particles of a tile behind the other:
    !> threads beside each other are at the same word of their particles.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine pick_record(t, wide, record, message, place, a1, a2, a3, a4, a5, a6, a7, a8, &
    row)
        integer, intent(in) :: t !! words of all tiles
        integer, intent(in) :: wide !! words of a record in the message
        type(record_t), intent(in) :: record
        integer(int64), intent(in) :: message(*) !! (5, processes), see find_entry
        integer(int32), intent(in) :: place(*) !! of each particle, from 1
        integer(int32), intent(in) :: a1(*), a2(*), a3(*), a4(*), a5(*), a6(*), a7(*), a8(*)
        integer(int32), intent(inout) :: row(*) !! (particles of a tile, wide, tiles)
        integer :: array, c, k
        integer(int64) :: at, away

        call find_particle(t, wide, message, k, c, away)
        if (c >= record%wide) return
        call find_word(record, c, place(k), array, at)
        row(t + away/4) = word_of(array, at, a1, a2, a3, a4, a5, a6, a7, a8)
    end subroutine pick_record

    !> The way back.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine put_record(t, wide, record, message, place, row, a1, a2, a3, a4, a5, a6, a7, a8)
        integer, intent(in) :: t !! words of all tiles
        integer, intent(in) :: wide !! words of a record in the message
        type(record_t), intent(in) :: record
        integer(int64), intent(in) :: message(*) !! (5, processes), see find_entry
        integer(int32), intent(in) :: place(*) !! of each particle, from 1
        integer(int32), intent(in) :: row(*) !! (particles of a tile, wide, tiles)
        integer(int32), intent(inout) :: a1(*), a2(*), a3(*), a4(*), a5(*), a6(*), a7(*), a8(*)
        integer :: array, c, k
        integer(int64) :: at, away

        call find_particle(t, wide, message, k, c, away)
        if (c >= record%wide) return
        call find_word(record, c, place(k), array, at)
        call set_word(array, at, row(t), a1, a2, a3, a4, a5, a6, a7, a8)
    end subroutine put_record

    !> The particle of a word of the tiles, and the word.
    !@cuf attributes(host,device) &
    pure subroutine find_particle(t, wide, message, k, c, away)
        integer, intent(in) :: t, wide
        integer(int64), intent(in) :: message(*) !! (5, processes)
        integer, intent(out) :: k !! entry of the list
        integer, intent(out) :: c !! words of its record before this one
        integer(int64), intent(out) :: away !! bytes, see find_entry
        integer :: rows

        rows = (t - 1)/tile ! before this one
        c = mod(rows, wide)
        call find_entry(rows/wide*tile + mod(t - 1, tile), 4*wide, message, k, away)
    end subroutine find_particle

    !> A word of a listed particle, to the particle of another list in another array.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine carry_words(t, wide, words, pitch, stride, place, array, words_to, pitch_to, &
                                stride_to, place_to, array_to)
        integer, intent(in) :: t !! words of all particles
        integer, intent(in) :: wide !! of each
        integer, intent(in) :: words, words_to !! of a particle in a column
        integer, intent(in) :: pitch, pitch_to !! words from a particle to the next
        integer(int64), intent(in) :: stride, stride_to !! words from a column to the next
        integer(int32), intent(in) :: place(*), place_to(*) !! of each particle, from 1
        integer(int32), intent(in) :: array(*)
        integer(int32), intent(inout) :: array_to(*)
        integer :: c, p

        p = (t - 1)/wide
        c = t - 1 - p*wide
        array_to(place_of_word(place_to(p + 1), c, words_to, pitch_to, stride_to)) = &
            array(place_of_word(place(p + 1), c, words, pitch, stride))
    end subroutine carry_words

    !> Where a word of a particle lies in an array of columns.
    !@cuf attributes(host,device) &
    pure integer(int64) function place_of_word(place, before, words, pitch, stride) result(at)
        integer(int32), intent(in) :: place !! of the particle
        integer, intent(in) :: before !! its words before this one
        integer, intent(in) :: words !! of a particle in a column
        integer, intent(in) :: pitch !! words from a particle to the next
        integer(int64), intent(in) :: stride !! words from a column to the next
        integer :: column

        column = before/words
        at = column*stride + (place - 1)*int(pitch, int64) + (before - column*words) + 1
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
    !@loop_body
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
    !@loop_body
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
end module brz_place_loop_bodies
