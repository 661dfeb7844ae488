! SPDX-License-Identifier: MIT
!> The program: understand the command, do it, end with the right exit code.
program brisance
    use, intrinsic :: iso_c_binding, only: c_int
    use, intrinsic :: iso_fortran_env, only: error_unit
    use brz_command_line, only: options_t, read_command_line, usage
    use brz_describe, only: describe, describe_markdown
    use brz_errors, only: error_t, failed
    use brz_key, only: key_t
    use brz_key_table, only: all_keys
    use brz_material_driver, only: drive_material
    use brz_ranks, only: reduce_errors, end_ranks, ranks_t, start_ranks
    use brz_screen, only: check_screen, hold_standard_units, say, show
    use brz_run, only: run_deck
    use brz_version, only: commit, compiler, flags, precision, version
    implicit none

    interface
        subroutine c_exit(code) bind(c, name='exit')
            import :: c_int
            integer(c_int), value :: code
        end subroutine c_exit
    end interface

    type(options_t) :: options
    type(ranks_t) :: ranks
    type(error_t) :: err
    type(key_t), allocatable :: keys(:)
    character(:), allocatable :: text

    call hold_standard_units()
    call start_ranks(ranks, err)
    if (.not. failed(err)) call read_command_line(options, err)
    if (failed(err)) options%command = 'none'
    if (options%command == 'run') then
        call run_deck(options, ranks, err)
    else if (ranks%rank == 0 .and. .not. failed(err)) then
        select case (options%command)
        case ('mat')
            call drive_material(options, err)
        case ('version')
            call say('Brisance '//version//' ('//trim(commit)//')')
            call say(compiler)
            call say(flags)
            call say('working precision: '//precision)
        case ('describe')
            call all_keys(keys)
            if (options%markdown) then
                call describe_markdown(keys, text)
            else
                call describe(keys, options%group, options%every, text, err)
            end if
            if (.not. failed(err)) call show(text)
        case default
            call say(usage())
        end select
    end if
    call check_screen(err)
    if (.not. (failed(err) .and. options%command == 'run')) call reduce_errors(ranks, err)
    if (allocated(err%text)) then
        if (err%text /= '') write (error_unit, '(a)') err%text
    end if
    call end_ranks()
    call c_exit(int(err%code, c_int))
end program brisance
