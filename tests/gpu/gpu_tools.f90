! SPDX-License-Identifier: MIT
!> What the tests of the GPU share: one device for all of them.
module gpu_tools
    use brz_device, only: device_t, load_kernels, open_device, wait_for_device
    use brz_errors, only: error_t, failed
    use brz_kinds, only: dp
    use brz_timer, only: wall_seconds
    use brz_version, only: device_code
    implicit none
    private
    public :: get_device, start_timer, stop_timer

    type(device_t), save :: the_device
    real(dp), save :: started = 0 !! wall clock [s]

contains

    !> The GPU, with the kernels that BRISANCE_PTX names.
    subroutine get_device(device, err)
        type(device_t), intent(out) :: device
        type(error_t), intent(inout) :: err
        character(200) :: file

        if (.not. the_device%open) then
            call get_environment_variable('BRISANCE_PTX', file)
            call open_device(the_device, err)
            if (.not. failed(err)) call load_kernels(trim(file), device_code, err)
            if (failed(err)) then
                print *, err%text
            else
                print *, the_device%name
            end if
        end if
        device = the_device
    end subroutine get_device

    subroutine start_timer(err)
        type(error_t), intent(inout) :: err

        call wait_for_device(err)
        started = wall_seconds()
    end subroutine start_timer

    !> Seconds since start_timer, when the GPU has done all its work.
    real(dp) function stop_timer(err) result(seconds)
        type(error_t), intent(inout) :: err

        call wait_for_device(err)
        seconds = wall_seconds() - started
    end function stop_timer
end module gpu_tools
