! SPDX-License-Identifier: MIT
!> What the kernels of the coupling share with the host: names and plain data.
module brz_gpu_coupling_layout
    use brz_kinds, only: dp, int8, rk
    implicit none
    private
    public :: box_gpu_t, book_threads, n_book
    public :: is_gas, is_solid, is_uncovered, is_buried
    public :: count_moved, count_outside, count_covered, count_uncovered, count_over, count_kept, &
              n_count
    public :: book_work, book_taken_work, book_given, book_taken, book_low, book_high

    ! the map `mark` of a step: what the particles make of a cell
    integer(int8), parameter :: is_gas = 0, is_solid = 1
    integer(int8), parameter :: is_uncovered = 2 !! gas: the solid has left it
    integer(int8), parameter :: is_buried = 3 !! solid that has lost touch with the gas

    ! what the kernels count
    integer, parameter :: count_moved = 1 !! 1: some particle has changed its cell
    integer, parameter :: count_outside = 2 !! particles outside the box
    integer, parameter :: count_covered = 3, count_uncovered = 4 !! cells
    integer, parameter :: count_over = 5 !! ledgers beyond their band
    integer, parameter :: count_kept = 6 !! buried ledgers that found no taker
    integer, parameter :: n_count = 6

    ! the books, as partial results of `book_threads` threads: part(book_threads, n_book)
    integer, parameter :: book_threads = 4096
    integer, parameter :: book_work = 1 !! energy that the air spent on moving walls [J]
    integer, parameter :: book_taken_work = 2 !! part of it that the reference pressure did
    integer, parameter :: book_given = 2 !! + 1..3: impulse given to the solid [N s]
    integer, parameter :: book_taken = 5 !! + 1..3: what was taken off
    integer, parameter :: book_low = 9, book_high = 10 !! least and largest ledger
    integer, parameter :: n_book = 10

    !> The box of the air, and how loads are spread.
    type :: box_gpu_t
        integer :: n(3) !! cells
        integer :: cells !! their product
        integer :: n_var !! conserved variables
        integer :: layers !! solid cells behind the first that a face may load
        integer :: bc(2, 3) !! boundary conditions, as in air_t
        logical :: wraps(3) !! periodic directions
        real(rk) :: spread !! depth over which a load is spread, in cells
        real(rk) :: reference !! pressure that is taken off [Pa]
        real(rk) :: floors(3) !! of the gas, see floors_of
        real(dp) :: lo(3), dx(3) !! low corner, sides of a cell [m]
        real(dp) :: area(3) !! of the faces normal to each direction [m2]
    end type box_gpu_t
end module brz_gpu_coupling_layout
