! SPDX-License-Identifier: MIT
!> What a total of brz_running_total consists of.
module brz_total_state
    use brz_kinds, only: int64
    implicit none
    private
    public :: running_total_t, limbs, room, total_numbers

    integer, parameter :: limbs = 4 !! of 31 bits
    integer, parameter :: room = 40 !! a term may be 2^room times what is expected of all of them
    integer, parameter :: total_numbers = limbs + 1 !! whole numbers that a total consists of

    type :: running_total_t
        integer :: top = room !! terms are below 2^top; the same in all processes and restarts
        integer(int64) :: limb(0:limbs) = 0 !! 0: terms that were too large, or no numbers
    end type running_total_t
end module brz_total_state
