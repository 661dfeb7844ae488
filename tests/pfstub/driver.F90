! SPDX-License-Identifier: MIT
!> Main program of a test executable. _TEST_SUITES names a file of lines ADD_TEST_SUITE(x_suite).
!>
!> Options: -v (or -d) names and times, -f TEXT only tests whose name holds TEXT, -q none whose name
!> ends in _slow, -o FILE report there, -x FILE JUnit XML, -t FILE TAP. Exit code 0, or 2 if a test
!> did not pass.
program driver
    use, intrinsic :: iso_fortran_env, only: output_unit
    use funit, only: TestSuite
    use pf_core, only: test_t
    use pf_mpi, only: run_as_process, there_is_mpirun
    use pf_run, only: outcome_t, run_tests, waiting, passed, disabled, not_chosen
    use pf_report, only: print_summary, write_junit, write_tap
    implicit none
#define ADD_TEST_SUITE(s) type(TestSuite), external :: s
#include _TEST_SUITES
#undef ADD_TEST_SUITE
    type(test_t), allocatable :: tests(:)
    type(outcome_t), allocatable :: outcomes(:)
    character(:), allocatable :: filter, report, junit, tap
    logical :: verbose, alone, quick
    integer :: i, unit

    allocate (tests(0))
#define ADD_TEST_SUITE(s) call add(s())
#include _TEST_SUITES
    call be_a_process()
    call read_options()
    alone = .not. there_is_mpirun()
    allocate (outcomes(size(tests)))
    do i = 1, size(tests)
        outcomes(i)%text = ''
        if (index(tests(i)%suite//'.'//tests(i)%name, filter) == 0) cycle
        if (quick .and. is_slow(tests(i)%name)) cycle
        outcomes(i)%status = merge(disabled, waiting, tests(i)%disabled)
        if (.not. alone .or. tests(i)%npes == 0) cycle
        outcomes(i)%status = disabled
        write (output_unit, '(a)') 'skipped, as there is no mpirun: '//tests(i)%suite//'.'// &
            tests(i)%name
    end do
    call run_tests(tests, outcomes, verbose)
    unit = output_unit
    if (report /= '') open (newunit=unit, file=report, action='write', status='replace')
    call print_summary(unit, tests, outcomes)
    if (junit /= '') call write_junit(junit, tests, outcomes)
    if (tap /= '') call write_tap(tap, tests, outcomes)
    flush (unit)
    if (.not. all(outcomes%status == passed .or. outcomes%status == disabled .or. &
                  outcomes%status == not_chosen)) stop 2, quiet = .true.

contains

    subroutine add(suite)
        type(TestSuite), intent(in) :: suite

        tests = [tests, suite%tests]
    end subroutine add

    !> Under mpirun, for one test: `--process SUITE.NAME RECORD`.
    subroutine be_a_process()
        character(256) :: word, record
        integer :: k

        call get_command_argument(1, word)
        if (word /= '--process') return
        call get_command_argument(2, word)
        call get_command_argument(3, record)
        do k = 1, size(tests)
            if (tests(k)%suite//'.'//tests(k)%name /= word) cycle
            call run_as_process(tests(k), trim(record))
            stop
        end do
        error stop 'no such test'
    end subroutine be_a_process

    !> Does a name, without its number of processes, end in _slow?
    pure logical function is_slow(name)
        character(*), intent(in) :: name

        is_slow = index(name//'[', '_slow[') > 0
    end function is_slow

    subroutine read_options()
        character(256) :: word
        integer :: k

        filter = ''
        report = ''
        junit = ''
        tap = ''
        verbose = .false.
        quick = .false.
        k = 0
        do while (k < command_argument_count())
            k = k + 1
            call get_command_argument(k, word)
            select case (word)
            case ('-v', '--verbose', '-d', '--debug')
                verbose = .true.
            case ('-f', '--filter')
                call next(k, filter)
            case ('-q')
                quick = .true.
            case ('-o', '--output')
                call next(k, report)
            case ('-x')
                call next(k, junit)
            case ('-t')
                call next(k, tap)
            case default
                write (output_unit, '(a)') 'options: [-v] [-q] [-f TEXT] [-o FILE] [-x FILE] '// &
                    '[-t FILE]'
                stop 2, quiet = .true.
            end select
        end do
    end subroutine read_options

    subroutine next(k, text)
        integer, intent(inout) :: k
        character(:), allocatable, intent(out) :: text
        character(256) :: word

        k = k + 1
        call get_command_argument(k, word)
        text = trim(word)
    end subroutine next
end program driver
