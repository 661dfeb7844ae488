! SPDX-License-Identifier: MIT
!> What the kernels of the coupling share with the host: names and plain data.
module brz_gpu_coupling_layout
    use brz_tallies, only: tally_threads
    implicit none
    private
    public :: book_threads, n_book
    public :: count_moved, count_outside, count_covered, count_uncovered, count_own, count_over, &
              count_kept, n_count
    public :: book_work, book_low, book_high

    ! what the kernels count
    integer, parameter :: count_moved = 1 !! particles that have changed their cell
    integer, parameter :: count_outside = 2 !! particles outside the box
    integer, parameter :: count_covered = 3, count_uncovered = 4 !! cells
    integer, parameter :: count_own = 4 !! + 1..2: both, of this process
    integer, parameter :: count_over = 7 !! ledgers beyond their band
    integer, parameter :: count_kept = 8 !! buried ledgers that found no taker
    integer, parameter :: n_count = 8

    ! the books, as partial results of `book_threads` threads: part(book_threads, n_book)
    integer, parameter :: book_threads = tally_threads
    integer, parameter :: book_work = 1 !! to 8: work and impulses, as sums_in has them
    integer, parameter :: book_low = 9, book_high = 10 !! least and largest ledger
    integer, parameter :: n_book = 10
end module brz_gpu_coupling_layout
