! SPDX-License-Identifier: MIT
!> Bodies that carry particles, on their way to a GPU.
module brz_driven_body_driver
    use brz_coupling_state, only: coupling_t
    use brz_device_data, only: update_device_bytes
    use brz_errors, only: error_t
    use brz_kinds, only: int64
    implicit none
    private
    public :: put_driven_bodies

contains

    !> Tell the GPU how the bodies move.
    subroutine put_driven_bodies(c, err)
        type(coupling_t), intent(in) :: c
        type(error_t), intent(inout) :: err

        if (c%on_gpu) call update_device_bytes(c%driven, &
            size(c%driven)*(storage_size(c%driven)/8_int64), err)
    end subroutine put_driven_bodies
end module brz_driven_body_driver
