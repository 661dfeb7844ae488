! SPDX-License-Identifier: MIT
!> Requests from outside while a run goes on: signals and a stop file.
!>
!> USR1: write a checkpoint and go on. USR2, TERM, INT, HUP, QUIT: write a checkpoint and stop; a
!> second INT (Ctrl-C) or QUIT ends the program at once. INT, HUP and QUIT stay ignored where the
!> program was started so (nohup, in the background of a script). A stop file `<job>.stop` in the
!> output folder or in the current folder works like USR2. The handlers only set flags; the step
!> asks for them when a step is complete. Writing beyond a file size limit, or to a pipe that
!> nothing reads, becomes an ordinary write error.
module brz_signals
    use, intrinsic :: iso_c_binding, only: c_funloc, c_funptr, c_int, c_intptr_t, c_null_funptr
    use brz_files, only: file_exists, is_folder, remove_file
    implicit none
    private
    public :: listen_to_signals, checkpoint_asked, stop_asked, look_for_stop_file, stop_name
    public :: signal_hup, signal_int, signal_quit, signal_usr1, signal_usr2, signal_term

    ! numbers of Linux
    integer(c_int), parameter :: signal_hup = 1, signal_int = 2, signal_quit = 3, signal_usr1 = 10
    integer(c_int), parameter :: signal_usr2 = 12, signal_pipe = 13, signal_term = 15
    integer(c_int), parameter :: signal_size_limit = 25
    integer(c_intptr_t), parameter :: by_default = 0, ignored = 1

    ! set by the handlers, cleared by the questions
    logical, volatile, save :: want_checkpoint = .false.
    integer(c_int), volatile, save :: want_stop = 0
    logical, save :: told = .false. !! of a folder in the place of a stop file

    interface
        type(c_funptr) function c_signal(number, handler) bind(c, name='signal')
            import :: c_funptr, c_int
            integer(c_int), value :: number
            type(c_funptr), value :: handler
        end function c_signal
    end interface

contains

    !> Take over the signals, and forget requests that came before.
    subroutine listen_to_signals()
        type(c_funptr) :: old

        want_checkpoint = .false.
        want_stop = 0
        old = c_signal(signal_usr1, c_funloc(on_checkpoint))
        old = c_signal(signal_usr2, c_funloc(on_stop))
        old = c_signal(signal_term, c_funloc(on_stop))
        call take_unless_ignored(signal_hup)
        call take_unless_ignored(signal_int)
        call take_unless_ignored(signal_quit)
        old = c_signal(signal_size_limit, transfer(ignored, c_null_funptr))
        old = c_signal(signal_pipe, transfer(ignored, c_null_funptr))
    end subroutine listen_to_signals

    subroutine take_unless_ignored(number)
        integer(c_int), intent(in) :: number
        type(c_funptr) :: old

        old = c_signal(number, c_funloc(on_stop))
        if (transfer(old, ignored) == ignored) old = c_signal(number, old)
    end subroutine take_unless_ignored

    subroutine on_checkpoint(number) bind(c, name='brz_on_checkpoint')
        integer(c_int), value :: number

        want_checkpoint = number /= 0
    end subroutine on_checkpoint

    subroutine on_stop(number) bind(c, name='brz_on_stop')
        integer(c_int), value :: number
        type(c_funptr) :: old

        want_stop = number
        if (number == signal_int .or. number == signal_quit) &
            old = c_signal(number, transfer(by_default, c_null_funptr))
    end subroutine on_stop

    !> True once for every USR1 or several of them since the last question.
    logical function checkpoint_asked()
        checkpoint_asked = want_checkpoint
        if (checkpoint_asked) want_checkpoint = .false.
    end function checkpoint_asked

    !> True once a signal has asked for a stop, and from then on; `name` says which.
    logical function stop_asked(name)
        character(:), allocatable, intent(out), optional :: name

        stop_asked = want_stop /= 0
        if (present(name)) name = stop_name(want_stop)
    end function stop_asked

    !> Name of a signal that asks for a stop; '' for none.
    pure function stop_name(number) result(name)
        integer(c_int), intent(in) :: number
        character(:), allocatable :: name

        select case (number)
        case (0); name = ''
        case (signal_hup); name = 'SIGHUP'
        case (signal_quit); name = 'SIGQUIT'
        case (signal_int); name = 'SIGINT'
        case (signal_usr2); name = 'SIGUSR2'
        case (signal_term); name = 'SIGTERM'
        case default; name = 'a signal'
        end select
    end function stop_name

    !> True if there is a stop file. It is removed, so that a restart does not stop at once.
    logical function look_for_stop_file(folder, job, note) result(found)
        character(*), intent(in) :: folder !! of the output
        character(*), intent(in) :: job
        character(:), allocatable, intent(out) :: note !! once, of a folder with that name; or ''
        character(:), allocatable :: path
        integer :: i

        note = ''
        found = .false.
        do i = 1, 2
            path = trim(job)//'.stop'
            if (i == 2) path = trim(folder)//'/'//path
            if (.not. file_exists(path)) cycle
            if (is_folder(path)) then
                if (.not. told) note = path//': is a folder, no request to stop'
                told = .true.
                cycle
            end if
            found = .true.
            call remove_file(path)
        end do
    end function look_for_stop_file
end module brz_signals
