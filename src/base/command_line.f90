! SPDX-License-Identifier: MIT
!> The command line as plain data, and its errors.
module brz_command_line
    use brz_errors, only: error_t, exit_deck, failed, raise
    use brz_kinds, only: dp
    use brz_text, only: nearest, string_t
    implicit none
    private
    public :: options_t, read_command_line, usage

    type :: options_t
        character(:), allocatable :: command !! 'run', 'mat', 'version', 'help', 'describe'
        character(:), allocatable :: deck !! path of the deck
        character(:), allocatable :: out !! run: folder of the results; mat: table; '' = out/<job>
        character(:), allocatable :: restart !! path of a checkpoint, 'latest', or ''
        character(:), allocatable :: branch !! path of a checkpoint of another deck, or ''
        character(:), allocatable :: backend !! 'cpu', 'gpu', 'auto', '' = as the deck says
        character(:), allocatable :: group !! group to describe, '' = all
        logical :: check = .false. !! parse, discretise and print the cost only
        logical :: markdown = .false. !! describe as a page of the manual
        logical :: every = .false. !! describe advanced and expert keys, too
        logical :: replace = .false. !! results of an earlier run may be removed
        logical :: profile = .false. !! time of each kernel at the end
        logical :: calls = .false. !! what the host asks of GPU and processes, at the end
        character(:), allocatable :: echo !! file for the complete deck of --check, or ''
        integer :: ranks = 0 !! processes that --check shall cut the scene for; 0: those there are
        real(dp) :: walltime = huge(1.0_dp) !! [s]
        type(string_t), allocatable :: overrides(:) !! texts group.key=value
    end type options_t

    character(*), parameter :: flags = '--check|--backend|--restart|--branch|--out|'// &
                               '--walltime|--set|--replace|--markdown|--all|--profile|'// &
                               '--calls|--ranks|--echo'
    character(*), parameter :: lf = new_line('a')

contains

    !> What the program can be asked for.
    function usage() result(text)
        character(:), allocatable :: text

        text = &
            'usage: brisance run DECK [options]      run a scene'//lf// &
            '       brisance mat DECK [options]      drive one material point'//lf// &
            '       brisance --describe [GROUP]      explain keys that a first deck needs'//lf// &
            '       brisance --describe GROUP --all  explain all keys of a group'//lf// &
            '       brisance --describe presets      list the materials that are built in'//lf// &
            '       brisance --version | --help'//lf// &
            ''//lf// &
            'options of run:'//lf// &
            '  --check                  read and discretise the deck, print its cost'//lf// &
            '  --echo FILE              with --check: write the deck with all defaults'//lf// &
            '  --ranks N                with --check: what each of N processes gets'//lf// &
            '  --out DIR                folder of the results (default out/<deck name>)'//lf// &
            '  --replace                remove results of an earlier run from that folder'//lf// &
            '  --restart FILE|latest    go on from a checkpoint'//lf// &
            '  --branch FILE            begin at the checkpoint of another run, with a deck'//lf// &
            '                           that differs in what comes after it'//lf// &
            '  --walltime HH:MM:SS      write a checkpoint and stop (code 75) by that time'//lf// &
            '  --set group.key=value    change a value of the deck, e.g. run.t_end=1e-4 or'//lf// &
            '                           body(plate).spacing=2e-3; may be repeated'//lf// &
            '  --backend cpu|gpu|auto   where to compute'//lf// &
            '  --profile                on a GPU: print the time of each kernel; slower'//lf// &
            '  --calls                  print what each process asks of its GPU and others'//lf// &
            'options of mat: --check, --replace, --set, and'//lf// &
            '  --out FILE               table of the results (default out/<deck name>.csv)'//lf// &
            ''//lf// &
            'signals: USR1 writes a checkpoint; USR2, TERM and a file <job>.stop in the'//lf// &
            '         folder of the results write a checkpoint and stop with code 75'//lf// &
            'exit codes: 0 done; 1 internal; 2 usage or deck; 3 numerical; 4 input/output;'//lf// &
            '            5 device or MPI; 75 stopped early with a checkpoint'
    end function usage

    !> Read the arguments of the program. Errors have code `exit_deck`.
    subroutine read_command_line(options, err)
        type(options_t), intent(out) :: options
        type(error_t), intent(inout) :: err
        type(string_t), allocatable :: args(:)

        options%command = 'help'
        options%deck = ''
        options%out = ''
        options%restart = ''
        options%branch = ''
        options%backend = ''
        options%group = ''
        options%echo = ''
        allocate (options%overrides(0))
        call get_arguments(args)
        if (size(args) == 0 .or. asks_for_help(args)) return
        select case (args(1)%s)
        case ('run')
            options%command = 'run'
            call read_options(args(2:), options, err)
            if (options%deck == '') call raise(err, exit_deck, 'run: no deck is named'//lf//usage())
        case ('mat')
            options%command = 'mat'
            call read_options(args(2:), options, err)
            if (options%deck == '') call raise(err, exit_deck, 'mat: no deck is named'//lf//usage())
        case ('--version', 'version')
            options%command = 'version'
        case ('--describe', 'describe')
            options%command = 'describe'
            call read_options(args(2:), options, err)
            options%group = options%deck
        case default
            call raise(err, exit_deck, "unknown command '"//args(1)%s//"'"//lf//usage())
        end select
    end subroutine read_command_line

    !> True where help is asked for, alone or behind a command.
    pure logical function asks_for_help(args)
        type(string_t), intent(in) :: args(:)
        integer :: i

        asks_for_help = args(1)%s == 'help'
        do i = 1, size(args)
            asks_for_help = asks_for_help .or. args(i)%s == '--help' .or. args(i)%s == '-h'
        end do
    end function asks_for_help

    !> All arguments of the program.
    subroutine get_arguments(args)
        type(string_t), allocatable, intent(out) :: args(:)
        integer :: i, length

        allocate (args(command_argument_count()))
        do i = 1, size(args)
            call get_command_argument(i, length=length)
            allocate (character(length) :: args(i)%s)
            call get_command_argument(i, args(i)%s)
        end do
    end subroutine get_arguments

    !> Options and the one path behind a command.
    subroutine read_options(args, options, err)
        type(string_t), intent(in) :: args(:)
        type(options_t), intent(inout) :: options
        type(error_t), intent(inout) :: err
        character(:), allocatable :: flag, value
        integer :: i, equal

        i = 1
        do while (i <= size(args) .and. .not. failed(err))
            flag = args(i)%s
            if (index(flag, '--') /= 1) then
                if (options%deck /= '') call raise(err, exit_deck, &
                    "more than one deck: '"//flag//"'")
                options%deck = flag
                i = i + 1
                cycle
            end if
            equal = index(flag, '=')
            value = ''
            if (equal > 0 .and. index(flag, '--set') /= 1) then
                value = flag(equal + 1:)
                flag = flag(:equal - 1)
            else if (takes_value(flag)) then
                i = i + 1
                if (i > size(args)) then
                    call raise(err, exit_deck, flag//' needs a value')
                    return
                end if
                value = args(i)%s
            end if
            call set_option(flag, value, options, err)
            i = i + 1
        end do
        if (options%branch == '' .or. failed(err)) return
        if (options%restart /= '') call raise(err, exit_deck, '--branch begins a run, '// &
            '--restart goes on with one; give one of them')
        if (options%branch == 'latest') call raise(err, exit_deck, '--branch: name the file of '// &
            'the checkpoint')
        if (options%replace) call raise(err, exit_deck, '--branch replaces no results; name '// &
            'another folder with --out')
    end subroutine read_options

    !> True for a flag with a value behind it.
    pure logical function takes_value(flag)
        character(*), intent(in) :: flag

        takes_value = any(flag == [character(10) :: '--backend', '--restart', '--branch', '--out', &
                                   '--walltime', '--set', '--ranks', '--echo'])
    end function takes_value

    !> Store one option.
    subroutine set_option(flag, value, options, err)
        character(*), intent(in) :: flag, value
        type(options_t), intent(inout) :: options
        type(error_t), intent(inout) :: err

        select case (flag)
        case ('--check')
            options%check = .true.
        case ('--markdown')
            options%markdown = .true.
        case ('--all')
            options%every = .true.
        case ('--replace')
            options%replace = .true.
        case ('--profile')
            options%profile = .true.
        case ('--calls')
            options%calls = .true.
        case ('--ranks')
            call read_ranks(value, options%ranks, err)
        case ('--echo')
            options%echo = value
            if (value == '') call raise(err, exit_deck, '--echo: name the file')
        case ('--out')
            options%out = value
        case ('--restart')
            options%restart = value
        case ('--branch')
            options%branch = value
        case ('--set')
            options%overrides = [options%overrides, string_t(value)]
        case ('--backend')
            options%backend = value
            if (.not. any(value == ['cpu ', 'gpu ', 'auto'])) call raise(err, exit_deck, &
                "--backend "//value//": must be 'cpu', 'gpu' or 'auto'")
        case ('--walltime')
            call read_walltime(value, options%walltime, err)
        case default
            call unknown_option(flag, err)
        end select
    end subroutine set_option

    !> Name the option that may have been meant.
    subroutine unknown_option(flag, err)
        character(*), intent(in) :: flag
        type(error_t), intent(inout) :: err
        character(12) :: list(14)
        integer :: i, first, last

        first = 1
        do i = 1, size(list)
            last = index(flags(first:)//'|', '|') + first - 2
            list(i) = flags(first:last)
            first = last + 2
        end do
        i = nearest(flag, list)
        if (i > 0) then
            call raise(err, exit_deck, "unknown option '"//flag//"'; did you mean "// &
                       trim(list(i))//'?')
        else
            call raise(err, exit_deck, "unknown option '"//flag//"'"//lf//usage())
        end if
    end subroutine unknown_option

    !> A number of processes.
    subroutine read_ranks(text, ranks, err)
        character(*), intent(in) :: text
        integer, intent(out) :: ranks
        type(error_t), intent(inout) :: err
        integer :: io

        ranks = 0
        io = 0
        if (verify(text, '0123456789') == 0) read (text, *, iostat=io) ranks
        if (io /= 0 .or. ranks < 1) call raise(err, exit_deck, "--ranks "//text// &
            ": must be a number of processes, 1 or more")
    end subroutine read_ranks

    !> HH:MM:SS, MM:SS or seconds.
    subroutine read_walltime(text, seconds, err)
        character(*), intent(in) :: text
        real(dp), intent(out) :: seconds !! [s]
        type(error_t), intent(inout) :: err
        real(dp) :: part
        integer :: first, last, io

        seconds = 0
        first = 1
        do
            last = index(text(first:)//':', ':') + first - 2
            part = -1
            read (text(first:last), *, iostat=io) part
            if (io /= 0 .or. .not. part >= 0 .or. part > 1e7_dp) then
                call raise(err, exit_deck, "--walltime "//text//": must be HH:MM:SS or seconds")
                return
            end if
            seconds = 60*seconds + part
            first = last + 2
            if (first > len(text) + 1) exit
        end do
    end subroutine read_walltime
end module brz_command_line
