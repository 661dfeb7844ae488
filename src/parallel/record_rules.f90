! SPDX-License-Identifier: MIT
!> Records of words of 4 B: what a message holds of a particle, from several arrays one after the
!> other. Point physics: compiled for the CPU and for the GPU.
module brz_record_rules
    use brz_kinds, only: int32, int64, rk
    implicit none
    private
    public :: record_t, most_arrays, words_of_real, add_array, find_word

    integer, parameter :: words_of_real = storage_size(1.0_rk)/32
    integer, parameter :: most_arrays = 8

    !> How a record is made. Of array k it has words(k) words of the row of each particle, in each
    !> of its columns; rows are pitch(k) words apart, columns stride(k).
    type :: record_t
        integer :: arrays = 0
        integer :: wide = 0 !! words of all arrays
        integer :: before(most_arrays) = huge(0) !! words of the arrays before
        integer :: words(most_arrays) = 1, pitch(most_arrays) = 1
        integer(int64) :: stride(most_arrays) = 0
    end type record_t

contains

    !> Put the words of another array behind the others; there are most_arrays of them at most.
    pure subroutine add_array(words, pitch, columns, stride, record)
        integer, intent(in) :: words !! of a particle in a column
        integer, intent(in) :: pitch !! words from a particle to the next
        integer, intent(in) :: columns
        integer(int64), intent(in) :: stride !! words from a column to the next
        type(record_t), intent(inout) :: record

        record%arrays = record%arrays + 1
        record%before(record%arrays) = record%wide
        record%words(record%arrays) = words
        record%pitch(record%arrays) = pitch
        record%stride(record%arrays) = stride
        record%wide = record%wide + words*columns
    end subroutine add_array

    !> Which array a word of a record is from, and where it lies there for a particle. The steps for
    !> all arrays are spelled out, so that a kernel indexes nothing at run time: a record that is
    !> indexed lies in local memory, a spelled one in registers.
    !@cuf attributes(host,device) &
    pure subroutine find_word(record, word, place, array, at)
        type(record_t), intent(in) :: record
        integer, intent(in) :: word !! words of the record before this one
        integer(int32), intent(in) :: place !! of the particle, from 1
        integer, intent(out) :: array
        integer(int64), intent(out) :: at !! from 1
        integer :: before, column, pitch, words
        integer(int64) :: stride
        logical :: here

        array = 1
        before = 0
        words = record%words(1)
        pitch = record%pitch(1)
        stride = record%stride(1)
        here = word >= record%before(2)
        array = merge(2, array, here)
        before = merge(record%before(2), before, here)
        words = merge(record%words(2), words, here)
        pitch = merge(record%pitch(2), pitch, here)
        stride = merge(record%stride(2), stride, here)
        here = word >= record%before(3)
        array = merge(3, array, here)
        before = merge(record%before(3), before, here)
        words = merge(record%words(3), words, here)
        pitch = merge(record%pitch(3), pitch, here)
        stride = merge(record%stride(3), stride, here)
        here = word >= record%before(4)
        array = merge(4, array, here)
        before = merge(record%before(4), before, here)
        words = merge(record%words(4), words, here)
        pitch = merge(record%pitch(4), pitch, here)
        stride = merge(record%stride(4), stride, here)
        here = word >= record%before(5)
        array = merge(5, array, here)
        before = merge(record%before(5), before, here)
        words = merge(record%words(5), words, here)
        pitch = merge(record%pitch(5), pitch, here)
        stride = merge(record%stride(5), stride, here)
        here = word >= record%before(6)
        array = merge(6, array, here)
        before = merge(record%before(6), before, here)
        words = merge(record%words(6), words, here)
        pitch = merge(record%pitch(6), pitch, here)
        stride = merge(record%stride(6), stride, here)
        here = word >= record%before(7)
        array = merge(7, array, here)
        before = merge(record%before(7), before, here)
        words = merge(record%words(7), words, here)
        pitch = merge(record%pitch(7), pitch, here)
        stride = merge(record%stride(7), stride, here)
        here = word >= record%before(8)
        array = merge(8, array, here)
        before = merge(record%before(8), before, here)
        words = merge(record%words(8), words, here)
        pitch = merge(record%pitch(8), pitch, here)
        stride = merge(record%stride(8), stride, here)
        column = (word - before)/words
        at = column*stride + (place - 1)*int(pitch, int64) + (word - before - column*words) + 1
    end subroutine find_word
end module brz_record_rules
