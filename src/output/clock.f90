! SPDX-License-Identifier: MIT
!> The clock of a run: simulated time, wall-clock time, and what is due when.
!>
!> Output never changes the time step: an output that is due at t is written at the end of the
!> first step that reaches t. So results do not depend on what is written. What is due next
!> follows from the time alone (multiples of the interval, a list of times), so a run that
!> continues from a checkpoint, with the same intervals or others, needs no memory of it.
module brz_clock
    use brz_case, only: case_t
    use brz_history, only: mark_t
    use brz_kinds, only: dp, int64
    use brz_timer, only: wall_seconds
    implicit none
    private
    public :: clock_t, ticker_t, start_clock, resume_clock, tick, next_due, walltime_is_up

    real(dp), parameter :: slack = 1e-9_dp !! rounding that an interval forgives, in intervals

    !> Something that happens at the start, at whole multiples of an interval, and at listed times.
    type :: ticker_t
        real(dp) :: every = huge(1.0_dp) !! [s]; 0: at every step; huge: at the start only
        real(dp) :: from = 0 !! no multiple before [s]
        integer(int64) :: next = 0 !! due at next*every
        real(dp), allocatable :: times(:) !! listed, growing [s]
        integer :: listed = 1 !! due at times(listed)
    end type ticker_t

    type :: clock_t
        real(dp) :: time = 0 !! [s]
        real(dp) :: dt = 0 !! last time step [s]
        real(dp) :: t_end = 0 !! [s]
        integer :: cycle = 0 !! steps done
        integer :: dump_number = 0 !! of the next dump
        real(dp) :: dump_time = -huge(1.0_dp) !! of the last dump [s]
        type(ticker_t) :: dump, history, checkpoint
        type(mark_t) :: marks(3) !! of the histories: energy, bodies, gauges
        real(dp) :: wall_start = 0 !! wall clock at the start [s]
        real(dp) :: walltime = huge(1.0_dp) !! wall-clock time that the run may take [s]
    end type clock_t

contains

    !> Set the clock to the start of a scene. Dumps and histories are due at once.
    subroutine start_clock(case, clock, walltime)
        type(case_t), intent(in) :: case
        type(clock_t), intent(out) :: clock
        real(dp), intent(in), optional :: walltime !! [s]

        clock%t_end = case%run%t_end
        clock%dump%every = case%output%dump_every
        clock%dump%from = case%output%dump_from
        if (allocated(case%output%dump_times)) clock%dump%times = case%output%dump_times
        clock%history%every = case%output%history_every
        clock%checkpoint%every = case%output%checkpoint_every
        clock%checkpoint%next = 1
        if (present(walltime)) clock%walltime = walltime
        clock%wall_start = wall_seconds()
    end subroutine start_clock

    !> After `time` was read from a checkpoint: what was due until then has been done.
    subroutine resume_clock(clock)
        type(clock_t), intent(inout) :: clock

        call pass(clock%dump, clock%time)
        call pass(clock%history, clock%time)
        call pass(clock%checkpoint, clock%time)
    end subroutine resume_clock

    !> True if something is due at `time`, or overdue; then its next time is set.
    logical function tick(ticker, time)
        type(ticker_t), intent(inout) :: ticker
        real(dp), intent(in) :: time !! [s]

        if (ticker%next == 0) then
            tick = .true.
        else if (ticker%every > huge(1.0_dp)/2) then
            tick = .false.
        else
            tick = time >= (ticker%next - slack)*ticker%every
        end if
        if (allocated(ticker%times)) then
            if (ticker%listed <= size(ticker%times)) &
                tick = tick .or. time >= ticker%times(ticker%listed)*(1 - slack)
        end if
        if (tick) call pass(ticker, time)
    end function tick

    !> The next time after the present one at which something is due; huge where nothing is, or
    !> where it is due at every step [s].
    pure real(dp) function next_due(clock) result(time)
        type(clock_t), intent(in) :: clock

        time = minval([due_after(clock%dump, clock%time), due_after(clock%history, clock%time), &
                       due_after(clock%checkpoint, clock%time)])
    end function next_due

    pure real(dp) function due_after(ticker, time) result(due)
        type(ticker_t), intent(in) :: ticker
        real(dp), intent(in) :: time !! [s]

        due = huge(due)
        if (ticker%every > 0 .and. ticker%every < huge(due)/2) due = ticker%next*ticker%every
        if (allocated(ticker%times)) then
            if (ticker%listed <= size(ticker%times)) due = min(due, ticker%times(ticker%listed))
        end if
        if (due <= time) due = huge(due)
    end function due_after

    !> Set the first multiple and the first listed time after `time`.
    pure subroutine pass(ticker, time)
        type(ticker_t), intent(inout) :: ticker
        real(dp), intent(in) :: time !! [s]

        ticker%next = 1
        if (ticker%every > 0 .and. ticker%every < huge(1.0_dp)/2) &
            ticker%next = max(floor(time/ticker%every + slack, int64) + 1, &
                              ceiling(ticker%from/ticker%every - slack, int64))
        if (allocated(ticker%times)) ticker%listed = 1 + count(ticker%times*(1 - slack) <= time)
    end subroutine pass

    !> True if the run must write its last checkpoint now to keep its wall-clock limit.
    logical function walltime_is_up(clock, reserve)
        type(clock_t), intent(in) :: clock
        real(dp), intent(in) :: reserve !! time that a step and a checkpoint may take [s]

        walltime_is_up = .false.
        if (clock%walltime < huge(1.0_dp)/2) &
            walltime_is_up = wall_seconds() - clock%wall_start + reserve >= clock%walltime
    end function walltime_is_up
end module brz_clock
