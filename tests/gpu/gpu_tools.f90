! SPDX-License-Identifier: MIT
!> What the tests of the GPU share: one device for all of them.
module gpu_tools
    use brz_device, only: device_t, load_kernels, open_device
    use brz_errors, only: error_t, failed
    use brz_version, only: device_code
    implicit none
    private
    public :: get_device

    type(device_t), save :: the_device

contains

    !> The GPU, with the kernels that BRISANCE_PTX names.
    subroutine get_device(device, err)
        type(device_t), intent(out) :: device
        type(error_t), intent(inout) :: err
        character(200) :: file

        if (.not. the_device%open) then
            call get_environment_variable('BRISANCE_PTX', file)
            call open_device(the_device, err)
            if (.not. failed(err)) call load_kernels(the_device, trim(file), device_code, err)
            if (failed(err)) then
                print *, err%text
            else
                print *, the_device%name
            end if
        end if
        device = the_device
    end subroutine get_device
end module gpu_tools
