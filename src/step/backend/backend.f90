! SPDX-License-Identifier: MIT
!> Where a scene is computed: air, bodies and their coupling on the CPU or on a GPU.
module brz_backend
    use, intrinsic :: iso_fortran_env, only: error_unit
    use brz_coupling_state, only: coupling_t
    use brz_device, only: device_t, load_kernels, open_device
    use brz_errors, only: error_t, exit_device, failed, raise
    use brz_files, only: program_path
    use brz_gpu_solid_bodies, only: cannot_run_solid
    use brz_ranks, only: ranks_t, several
    use brz_bodies, only: bodies_t
    use brz_text, only: to_text
    use brz_version, only: device_code
    implicit none
    private
    public :: backend_t, choose_backend, settle_backend

    type :: backend_t
        logical :: on_gpu = .false. !! the air
        logical :: bodies_on_gpu = .false.
        logical :: coupling_on_gpu = .false. !! both are there
        type(device_t) :: device
    end type backend_t

contains

    !> Open the GPU if it is wanted and there. 'auto' falls back to the CPU, in silence where there
    !> is no driver; where a GPU is there but cannot be used the note says why.
    subroutine choose_backend(wanted, has_air, has_solid, ranks, backend, note, err)
        character(*), intent(in) :: wanted !! 'cpu', 'gpu', 'auto'
        logical, intent(in) :: has_air, has_solid !! in the scene
        type(ranks_t), intent(in) :: ranks !! each has a GPU of its own where there are enough
        type(backend_t), intent(inout) :: backend
        character(:), allocatable, intent(out) :: note !! what the user should know, '' for nothing
        type(error_t), intent(inout) :: err !! exit_device if 'gpu' is not possible
        type(error_t) :: trial

        note = ''
        if (failed(err) .or. wanted == 'cpu') return
        call open_device(backend%device, trial, ranks%place)
        if (wanted == 'auto' .and. failed(trial)) return
        if (ranks%rank == 0 .and. .not. failed(trial)) call tell_of_first_start()
        call load_kernels(kernel_file(), device_code, trial)
        backend%on_gpu = has_air .and. .not. failed(trial)
        backend%bodies_on_gpu = has_solid .and. .not. failed(trial)
        if (.not. failed(trial)) then ! settle_backend has the last word where there are bodies
            if (.not. has_solid) note = 'the air runs on '//backend%device%name// &
                shares(ranks, backend)
        else if (wanted == 'gpu') then
            call raise(err, trial%code, trial%text)
        else
            note = 'the scene runs on the CPU: '//trial%text
        end if
    end subroutine choose_backend

    !> Say what a user waits for where the driver has not kept any code that it has compiled: it
    !> does so for the card at hand, once.
    subroutine tell_of_first_start()
        character(4096) :: folder
        logical :: kept

        call get_environment_variable('CUDA_CACHE_PATH', folder)
        if (folder == '') then
            call get_environment_variable('HOME', folder)
            folder = trim(folder)//'/.nv/ComputeCache'
        end if
        inquire (file=trim(folder)//'/index', exist=kept)
        if (.not. kept) write (error_unit, '(a)') &
            'the driver compiles the GPU code for this card, once: some 20 s'
    end subroutine tell_of_first_start

    !> Decide on what the scene holds once it is set up.
    subroutine settle_backend(wanted, solid, coupling, backend, note, err)
        character(*), intent(in) :: wanted !! 'cpu', 'gpu', 'auto'
        class(bodies_t), intent(in) :: solid
        type(coupling_t), intent(in) :: coupling
        type(backend_t), intent(inout) :: backend
        character(:), allocatable, intent(out) :: note !! what the user should know, '' for nothing
        type(error_t), intent(inout) :: err !! exit_device if 'gpu' is not possible
        character(:), allocatable :: why

        note = ''
        if (.not. backend%bodies_on_gpu) return
        call cannot_run_solid(solid, why)
        if (coupling%paper) why = "the coupling scheme='paper'"
        if (.not. allocated(why)) then
            note = 'the bodies run on '
            if (backend%on_gpu) note = 'air and bodies run on '
            note = note//backend%device%name//shares(solid%ranks, backend)
            backend%coupling_on_gpu = backend%on_gpu
            return
        end if
        backend%on_gpu = .false.
        backend%bodies_on_gpu = .false.
        note = 'the scene runs on the CPU: this version does not have '//why//' on the GPU'
        if (wanted == 'gpu') call raise(err, exit_device, 'this version does not have '//why// &
                                        ' on the GPU: run with --backend cpu')
    end subroutine settle_backend

    !> How several processes have GPUs, '' for one.
    function shares(ranks, backend) result(text)
        type(ranks_t), intent(in) :: ranks
        type(backend_t), intent(in) :: backend
        character(:), allocatable :: text

        text = ''
        if (.not. several(ranks)) return
        text = ', each of '//to_text(ranks%n)//' processes on one'
        if (ranks%here > backend%device%count) text = ', '//to_text(ranks%here)// &
            ' processes of a machine share the '//to_text(backend%device%count)// &
            ' that each of them sees'
    end function shares

    !> The GPU code: where the environment variable BRISANCE_PTX says, beside the program, or in
    !> ../lib/brisance from there (make install).
    function kernel_file() result(path)
        character(:), allocatable :: path, program
        character(4096) :: named
        logical :: there
        integer :: slash

        call get_environment_variable('BRISANCE_PTX', named)
        path = trim(named)
        if (path /= '') return
        program = program_path()
        path = program//'.ptx'
        slash = index(program, '/', back=.true.)
        inquire (file=path, exist=there)
        if (there .or. slash == 0) return
        inquire (file=installed(), exist=there)
        if (there) path = installed()

    contains

        function installed() result(path)
            character(:), allocatable :: path

            path = program(:slash)//'../lib/brisance/'//program(slash + 1:)//'.ptx'
        end function installed
    end function kernel_file
end module brz_backend
