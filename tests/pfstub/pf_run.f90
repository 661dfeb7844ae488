! SPDX-License-Identifier: MIT
!> Runs tests in a child process, so that one that crashes, stops or hangs is reported and the
!> others still run. The child writes what happens into a file; the parent reads it.
module pf_run
    use, intrinsic :: iso_c_binding, only: c_int, c_long
    use, intrinsic :: iso_fortran_env, only: int64, output_unit, real64
    use pf_core, only: test_t, anyExceptions, forget_exceptions, thrown_text
    use pf_mpi, only: run_on_processes
    implicit none
    private
    public :: outcome_t, run_tests, passed, failed, broken, disabled, not_chosen, waiting

    integer, parameter :: not_chosen = 0, passed = 1, failed = 2, broken = 3, disabled = 4, &
                          waiting = 5 !! chosen, has not run yet
    integer, parameter :: time_limit = 600 !! of one test [s]

    type :: outcome_t
        integer :: status = not_chosen
        real(real64) :: seconds = 0
        real(real64) :: core = 0 !! seconds of all threads and processes
        character(:), allocatable :: text
    end type outcome_t

    interface
        integer(c_int) function fork() bind(c)
            import :: c_int
        end function fork
        integer(c_int) function waitpid(pid, status, options) bind(c)
            import :: c_int
            integer(c_int), value :: pid, options
            integer(c_int), intent(out) :: status
        end function waitpid
        integer(c_int) function getpid() bind(c)
            import :: c_int
        end function getpid
        integer(c_int) function alarm(seconds) bind(c)
            import :: c_int
            integer(c_int), value :: seconds
        end function alarm
        integer(c_int) function getrusage(who, usage) bind(c)
            import :: c_int, c_long
            integer(c_int), value :: who
            integer(c_long), intent(out) :: usage(18)
        end function getrusage
        subroutine quick_exit(status) bind(c, name='_exit')
            import :: c_int
            integer(c_int), value :: status
        end subroutine quick_exit
    end interface

contains

    !> Run the tests whose outcome is `waiting`.
    subroutine run_tests(tests, outcomes, verbose)
        type(test_t), intent(in) :: tests(:)
        type(outcome_t), intent(inout) :: outcomes(:)
        logical, intent(in) :: verbose
        character(64) :: record
        integer(c_int) :: pid, status
        integer :: next

        write (record, '("/tmp/pf_", i0)') getpid()
        next = 1
        do while (next <= size(tests))
            flush (output_unit)
            pid = fork()
            if (pid == 0) then
                call run_from(next, tests, outcomes, verbose, trim(record))
                call quick_exit(0_c_int)
            end if
            if (waitpid(pid, status, 0_c_int) /= pid) status = 1
            call read_record(trim(record), status, outcomes, next)
        end do
        if (.not. verbose) write (output_unit, '(a)') ''
        call delete(trim(record))
    end subroutine run_tests

    !> The child's part: tests first, first+1, ... one after the other.
    subroutine run_from(first, tests, outcomes, verbose, record)
        integer, intent(in) :: first
        type(test_t), intent(in) :: tests(:)
        type(outcome_t), intent(in) :: outcomes(:)
        logical, intent(in) :: verbose
        character(*), intent(in) :: record
        integer :: i, unit
        integer(int64) :: t0, t1, rate
        real(real64) :: core

        open (newunit=unit, file=record, action='write', status='replace')
        do i = first, size(tests)
            if (outcomes(i)%status /= waiting) cycle
            write (unit, '("start ", i0)') i
            flush (unit)
            if (verbose) write (output_unit, '(a)') ' Start: '//full_name(tests(i))
            flush (output_unit)
            call system_clock(t0, rate)
            core = core_seconds()
            call run_one(tests(i), record)
            call system_clock(t1)
            call write_record(unit, i, [real(t1 - t0, real64)/rate, core_seconds() - core])
            call show(tests(i), real(t1 - t0, real64)/rate, verbose)
        end do
        close (unit)
    end subroutine run_from

    subroutine run_one(test, record)
        type(test_t), intent(in) :: test
        character(*), intent(in) :: record
        integer(c_int) :: left

        call forget_exceptions()
        if (test%npes > 0) then
            call run_on_processes(test, record)
            return
        end if
        left = alarm(int(time_limit, c_int))
        if (associated(test%before)) call test%before()
        if (.not. anyExceptions()) call test%run()
        if (associated(test%after)) call test%after()
        left = alarm(0_c_int)
    end subroutine run_one

    !> What this process, its threads and its children that have ended have computed [s].
    real(real64) function core_seconds()
        integer(c_long) :: own(18), children(18) ! first: s and us of the user, of the system
        integer(c_int) :: status

        status = getrusage(0_c_int, own)
        status = getrusage(-1_c_int, children)
        own(:4) = own(:4) + children(:4)
        core_seconds = own(1) + own(3) + 1e-6_real64*(own(2) + own(4))
    end function core_seconds

    subroutine write_record(unit, i, seconds)
        integer, intent(in) :: unit, i
        real(real64), intent(in) :: seconds(2) !! by the clock, of all cores
        character(:), allocatable :: text
        integer :: j, k

        text = thrown_text()//new_line('a')
        j = 1
        do while (anyExceptions() .and. j <= len(text))
            k = index(text(j:), new_line('a'))
            write (unit, '("says ", a)') text(j:j + k - 2)
            j = j + k
        end do
        write (unit, '("end ", i0, 1x, i0, 2(1x, es13.6))') i, &
            merge(failed, passed, anyExceptions()), seconds
        flush (unit)
    end subroutine write_record

    subroutine show(test, seconds, verbose)
        type(test_t), intent(in) :: test
        real(real64), intent(in) :: seconds
        logical, intent(in) :: verbose

        if (verbose) then
            if (anyExceptions()) write (output_unit, '(a)') ' FAILED: '//thrown_text()
            write (output_unit, '("   end: ", a, f10.3, " s")') full_name(test), seconds
        else
            write (output_unit, '(a)', advance='no') merge('F', '.', anyExceptions())
        end if
        flush (output_unit)
    end subroutine show

    pure function full_name(test) result(text)
        type(test_t), intent(in) :: test
        character(:), allocatable :: text

        text = '<'//test%suite//'.'//test%name//'>'
    end function full_name

    !> Take over what a child has written; `next` is the first test that has not run.
    subroutine read_record(record, status, outcomes, next)
        character(*), intent(in) :: record
        integer(c_int), intent(in) :: status !! of the child, as waitpid gives it
        type(outcome_t), intent(inout) :: outcomes(:)
        integer, intent(inout) :: next
        character(2048) :: line
        integer :: unit, io, running, i

        running = 0
        open (newunit=unit, file=record, action='read', status='old', iostat=io)
        do while (io == 0)
            read (unit, '(a)', iostat=io) line
            if (io /= 0) exit
            select case (line(:index(line, ' ') - 1))
            case ('start')
                read (line(6:), *) running
                outcomes(running)%text = ''
            case ('says')
                outcomes(running)%text = outcomes(running)%text//trim(line(6:))//new_line('a')
            case ('end')
                read (line(4:), *) i, outcomes(i)%status, outcomes(i)%seconds, outcomes(i)%core
                next = i + 1
                running = 0
            end select
        end do
        close (unit, iostat=io)
        if (running > 0) then
            outcomes(running)%status = broken
            outcomes(running)%text = outcomes(running)%text//ending(status)//new_line('a')
            next = running + 1
        else if (status == 0) then
            next = size(outcomes) + 1
        else
            error stop 'the tests ended between two tests'
        end if
    end subroutine read_record

    !> What the status of a child means.
    function ending(status) result(text)
        integer(c_int), intent(in) :: status
        character(:), allocatable :: text
        character(12) :: number
        integer :: signal

        signal = iand(status, 127)
        write (number, '(i0)') merge(signal, ishft(status, -8), signal > 0)
        text = 'the test stopped the program with exit code '//trim(number)
        if (signal > 0) text = 'crash: killed by signal '//trim(number)
        if (signal == 11) text = text//' (segmentation fault)'
        if (signal == 8) text = text//' (floating-point exception)'
        if (signal == 6) text = text//' (abort)'
        if (signal == 14) text = text//' (time limit)'
    end function ending

    subroutine delete(name)
        character(*), intent(in) :: name
        integer :: unit, io

        open (newunit=unit, file=name, status='old', iostat=io)
        if (io == 0) close (unit, status='delete')
    end subroutine delete
end module pf_run
