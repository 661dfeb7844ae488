! SPDX-License-Identifier: MIT
!> What the coupling has on a GPU besides the arrays of coupling_t: books that its threads keep, and
!> who exchanges windows of the air.
module brz_coupling_device
    use brz_buffers, only: doubles_t, from
    use brz_gpu_fetch, only: gpu_fetch_t
    use brz_kinds, only: int64
    use brz_tallies, only: tally_threads
    implicit none
    private
    public :: coupling_device_t, book_at, n_sums
    public :: book_work, book_images, book_low, book_high, n_book

    integer, parameter :: n_sums = 11 !! numbers in a row of sums_in

    ! columns of the books
    integer, parameter :: book_work = 1 !! to 8: work and impulses, as sums_in has them
    integer, parameter :: book_images = 9 !! to 11: what images took
    integer, parameter :: book_low = n_sums + 1, book_high = n_sums + 2 !! least, largest cell store
    integer, parameter :: n_book = n_sums + 2

    type :: coupling_device_t
        logical :: walls_fetched = .false. !! no cell has changed hands since the last fetch
        type(doubles_t) :: book !! (tally_threads, n_book) see coupling_books_t
        type(doubles_t) :: speed !! (tally_threads) of the fastest wall [1/s]
        type(gpu_fetch_t) :: window !! gas and cell stores of other processes
    end type coupling_device_t

contains

    !> A column of the books, as a loop body adds to it and to those behind; nowhere on the CPU.
    pure type(doubles_t) function book_at(device, column) result(book)
        type(coupling_device_t), pointer, intent(in) :: device
        integer, intent(in) :: column

        if (associated(device)) book = from(device%book, tally_threads*(column - 1_int64) + 1)
    end function book_at
end module brz_coupling_device
