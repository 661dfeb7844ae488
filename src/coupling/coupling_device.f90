! SPDX-License-Identifier: MIT
!> What the coupling has on a GPU besides the arrays of coupling_t: diagnostics that its threads
!> keep.
module brz_coupling_device
    use brz_buffers, only: doubles_t, from
    use brz_kinds, only: int64
    use brz_tallies, only: tally_threads
    implicit none
    private
    public :: coupling_device_t, diag_at, n_sums
    public :: diag_work, n_diag

    integer, parameter :: n_sums = 8 !! numbers in a row of sums_in

    ! columns of the diagnostics
    integer, parameter :: diag_work = 1 !! to 8: work and impulses, as sums_in has them
    integer, parameter :: n_diag = n_sums

    type :: coupling_device_t
        logical :: walls_fetched = .false. !! no cell has changed hands since the last fetch
        type(doubles_t) :: diag !! (tally_threads, n_diag) see coupling_diagnostics_t
        type(doubles_t) :: speed !! (tally_threads) of the fastest wall [1/s]
    end type coupling_device_t

contains

    !> A column of the diagnostics, as a loop body adds to it and to those behind; nowhere on the
    !> CPU.
    pure type(doubles_t) function diag_at(device, column) result(diag)
        type(coupling_device_t), pointer, intent(in) :: device
        integer, intent(in) :: column

        if (associated(device)) diag = from(device%diag, tally_threads*(column - 1_int64) + 1)
    end function diag_at
end module brz_coupling_device
