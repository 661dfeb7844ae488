! SPDX-License-Identifier: MIT
!> What the driver prints at the end, as JUnit XML, and as TAP.
module pf_report
    use pf_core, only: test_t
    use pf_run, only: outcome_t, passed, failed, broken, disabled, not_chosen
    implicit none
    private
    public :: print_summary, write_junit, write_tap

contains

    subroutine print_summary(unit, tests, outcomes)
        integer, intent(in) :: unit
        type(test_t), intent(in) :: tests(:)
        type(outcome_t), intent(in) :: outcomes(:)
        integer :: i, n_run, n_failed, n_broken, n_disabled

        do i = 1, size(tests)
            if (outcomes(i)%status == failed) write (unit, '(a)') 'Failure in: '//name_of(tests(i))
            if (outcomes(i)%status == broken) write (unit, '(a)') 'Error in: '//name_of(tests(i))
            if (any(outcomes(i)%status == [failed, broken])) write (unit, '(a)') outcomes(i)%text
        end do
        n_failed = count(outcomes%status == failed)
        n_broken = count(outcomes%status == broken)
        n_disabled = count(outcomes%status == disabled)
        n_run = count(outcomes%status == passed) + n_failed + n_broken
        write (unit, '("Time: ", f12.3, " seconds", /)') sum(outcomes%seconds)
        if (n_failed + n_broken == 0) then
            write (unit, '(a)') ' OK'
            write (unit, '(" (", i0, " tests", a, ")")') n_run, also(n_disabled)
        else
            write (unit, '(a)') ' FAILURES!!!'
            write (unit, '("Tests run: ", i0, ", Failures: ", i0, ", Errors: ", i0, a)') &
                n_run, n_failed, n_broken, also(n_disabled)
        end if
    end subroutine print_summary

    subroutine write_junit(file, tests, outcomes)
        character(*), intent(in) :: file
        type(test_t), intent(in) :: tests(:)
        type(outcome_t), intent(in) :: outcomes(:)
        character(16) :: seconds, core
        integer :: i, unit

        open (newunit=unit, file=file, action='write', status='replace')
        write (unit, '(a)') '<?xml version="1.0" encoding="UTF-8"?>'
        write (unit, '("<testsuites><testsuite name=""pf"" tests=""", i0, """ failures=""", i0, &
            &""" errors=""", i0, """ skipped=""", i0, """>")') [ &
            count(outcomes%status /= not_chosen), count(outcomes%status == failed), &
            count(outcomes%status == broken), count(outcomes%status == disabled)]
        do i = 1, size(tests)
            if (outcomes(i)%status == not_chosen) cycle
            write (seconds, '(f16.6)') outcomes(i)%seconds
            write (core, '(f16.6)') outcomes(i)%core
            write (unit, '(a)') '<testcase classname="'//tests(i)%suite//'" name="'// &
                tests(i)%name//'" time="'//trim(adjustl(seconds))//'" core="'// &
                trim(adjustl(core))//'">'// &
                xml_of(outcomes(i))//'</testcase>'
        end do
        write (unit, '(a)') '</testsuite></testsuites>'
        close (unit)
    end subroutine write_junit

    subroutine write_tap(file, tests, outcomes)
        character(*), intent(in) :: file
        type(test_t), intent(in) :: tests(:)
        type(outcome_t), intent(in) :: outcomes(:)
        character(:), allocatable :: word
        integer :: i, n, unit

        open (newunit=unit, file=file, action='write', status='replace')
        write (unit, '("1..", i0)') count(outcomes%status /= not_chosen)
        n = 0
        do i = 1, size(tests)
            if (outcomes(i)%status == not_chosen) cycle
            n = n + 1
            word = 'not ok '
            if (outcomes(i)%status == passed .or. outcomes(i)%status == disabled) word = 'ok '
            write (unit, '(a, i0, a)', advance='no') word, n, ' - '//name_of(tests(i))
            if (outcomes(i)%status == disabled) write (unit, '(a)', advance='no') ' # SKIP'
            write (unit, '(a)') ''
        end do
        close (unit)
    end subroutine write_tap

    function name_of(test) result(text)
        type(test_t), intent(in) :: test
        character(:), allocatable :: text

        text = test%suite//'.'//test%name
    end function name_of

    function also(n) result(text)
        integer, intent(in) :: n !! disabled tests
        character(:), allocatable :: text
        character(24) :: buffer

        buffer = ''
        if (n > 0) write (buffer, '(", ", i0, " disabled")') n
        text = trim(buffer)
    end function also

    function xml_of(outcome) result(text)
        type(outcome_t), intent(in) :: outcome
        character(:), allocatable :: text
        integer :: i

        text = ''
        if (outcome%status == disabled) text = '<skipped/>'
        if (outcome%status /= failed .and. outcome%status /= broken) return
        do i = 1, len(outcome%text)
            select case (outcome%text(i:i))
            case ('<')
                text = text//'&lt;'
            case ('>')
                text = text//'&gt;'
            case ('&')
                text = text//'&amp;'
            case default
                text = text//outcome%text(i:i)
            end select
        end do
        text = merge('<failure>', '<error>  ', outcome%status == failed)//text
        text = text//trim(merge('</failure>', '</error>  ', outcome%status == failed))
    end function xml_of
end module pf_report
