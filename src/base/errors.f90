! SPDX-License-Identifier: MIT
!> One error type for the whole library, and the exit codes of the program.
!>
!> Library code reports through `error_t` and returns; only main prints and stops.
module brz_errors
    implicit none
    private
    public :: error_t, raise, failed
    public :: exit_ok, exit_internal, exit_deck, exit_numerical, exit_io, exit_device, exit_stopped

    integer, parameter :: exit_ok = 0 !! done
    integer, parameter :: exit_internal = 1 !! a fault of the program
    integer, parameter :: exit_deck = 2 !! usage or deck
    integer, parameter :: exit_numerical = 3 !! NaN, time step below its floor, energy out of band
    integer, parameter :: exit_io = 4 !! input/output, or a checkpoint that does not fit
    integer, parameter :: exit_device = 5 !! device or MPI resource
    integer, parameter :: exit_stopped = 75 !! stopped early with a checkpoint

    !> What went wrong: `code` is the exit code it leads to (0: nothing), `text` the message.
    type :: error_t
        integer :: code = exit_ok
        character(:), allocatable :: text
    end type error_t

contains

    !> Record an error unless one is recorded already: the first cause is the one that counts.
    subroutine raise(err, code, text)
        type(error_t), intent(inout) :: err
        integer, intent(in) :: code !! one of the exit codes above
        character(*), intent(in) :: text !! the whole message, with the remedy

        if (failed(err)) return
        err%code = code
        err%text = text
    end subroutine raise

    !> True once an error has been recorded.
    pure logical function failed(err)
        type(error_t), intent(in) :: err

        failed = err%code /= exit_ok
    end function failed
end module brz_errors
