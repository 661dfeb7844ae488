! SPDX-License-Identifier: MIT
!> How a GPU adds up numbers of all items: each of a fixed number of threads adds those of every
!> tally_threads-th item to a number of its own.
module brz_tallies
    implicit none
    private
    public :: tally_threads

    integer, parameter :: tally_threads = 4096
end module brz_tallies
