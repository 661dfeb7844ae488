! SPDX-License-Identifier: MIT
!> What a run has done so far, and at its last progress line.
module brz_run_counts
    use brz_kinds, only: dp, int64
    implicit none
    private
    public :: progress_t

    !> Counters between two lines, and the wall clock.
    type :: progress_t
        real(dp) :: wall_start = 0 !! wall clock when the run started [s]
        real(dp) :: wall_line = 0 !! wall clock of the last line [s]
        real(dp) :: time_line = 0 !! simulated time of the last line [s]
        integer :: cycle_line = 0 !! cycle of the last line
        integer(int64) :: cell_steps = 0, particle_steps = 0 !! since the start of the run
        integer(int64) :: cells_line = 0, particles_line = 0 !! the same at the last line
        real(dp) :: air_seconds = 0, solid_seconds = 0, coupling_seconds = 0 !! time spent
        real(dp) :: rate = 0 !! moving mean of simulated time per wall-clock time [-]
    end type progress_t
end module brz_run_counts
