! SPDX-License-Identifier: MIT
!> What a run prints while its scene is set up: one line that grows, and in it how far a blast in
!> one dimension is.
module brz_setup_progress
    use brz_host_calls, only: enter_part
    use brz_kinds, only: dp
    use brz_screen, only: say, show
    use brz_timer, only: wall_seconds
    implicit none
    private
    public :: begin_setup, setup_stage, setup_blast, end_setup

    logical, save :: loud = .false. !! between begin_setup and end_setup
    logical, save :: line_begun = .false.
    character(13), save :: head = '' !! of the next line
    real(dp), save :: wall_begin = 0, wall_next = 0, wall_every = 0 !! of the lines of a blast [s]

contains

    !> From here on the stages are told.
    subroutine begin_setup(every)
        real(dp), intent(in) :: every !! wall-clock time between two lines of a blast [s]

        loud = .true.
        line_begun = .false.
        head = 'set-up'
        wall_begin = wall_seconds()
        wall_every = every
        wall_next = wall_begin + every
    end subroutine begin_setup

    !> What is being done now.
    subroutine setup_stage(what)
        character(*), intent(in) :: what

        if (.not. loud) return
        call enter_part('set-up: '//what)
        if (line_begun) call show(', '//what)
        if (.not. line_begun) call show(head//what)
        line_begun = .true.
        head = ''
    end subroutine setup_stage

    !> How far a blast in one or two dimensions is, from time to time.
    subroutine setup_blast(dimensions, time, radius, last)
        integer, intent(in) :: dimensions !! of the blast
        real(dp), intent(in) :: time !! [s]
        real(dp), intent(in) :: radius, last !! of the front, now and when it is mapped [m]
        character(80) :: line

        if (.not. loud) return
        if (wall_seconds() < wall_next) return
        write (line, '(2a, es12.5, a, es11.4, a, es11.4, a)') head, 't =', time, &
            merge(' s, front at  ', ' s, still free', dimensions == 1), radius, ' of', last, ' m'
        if (line_begun) call say('')
        line_begun = .false.
        call say(trim(line))
        wall_next = wall_seconds() + wall_every
    end subroutine setup_blast

    !> The set-up has ended, well or not.
    subroutine end_setup()
        character(12) :: seconds

        if (.not. loud) return
        write (seconds, '(f12.1)') wall_seconds() - wall_begin
        if (line_begun) call show(': ')
        if (.not. line_begun) call show(head)
        call say(trim(adjustl(seconds))//' s')
        loud = .false.
        call enter_part('start')
    end subroutine end_setup
end module brz_setup_progress
