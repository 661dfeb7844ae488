! SPDX-License-Identifier: MIT
!> From how many turns of a loop on its work is shared among threads.
module brz_threads
    implicit none
    private
    public :: worth_threads

    integer, parameter :: worth_threads = 2048 !! fewer particles are faster on one thread
end module brz_threads
