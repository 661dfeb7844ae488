! SPDX-License-Identifier: MIT
!> Events: places in the order of the work of the GPU that the host can wait for.
module brz_device_events
    use, intrinsic :: iso_c_binding, only: c_associated, c_int, c_null_ptr, c_ptr
    use brz_cuda_driver, only: cu_event_create, cu_event_record, cu_event_synchronize
    use brz_device, only: check
    use brz_errors, only: error_t, failed
    use brz_host_calls, only: record_call, to_wait
    use brz_kinds, only: dp, int64
    use brz_timer, only: wall_seconds
    implicit none
    private
    public :: event_t, record_event, wait_for_event

    integer(c_int), parameter :: without_time = 2 !! CU_EVENT_DISABLE_TIMING

    type :: event_t
        type(c_ptr) :: handle = c_null_ptr
    end type event_t

contains

    !> Record the end of the work of the default stream so far.
    subroutine record_event(event, err)
        type(event_t), intent(inout) :: event
        type(error_t), intent(inout) :: err !! exit_device where the GPU fails

        if (failed(err)) return
        if (.not. c_associated(event%handle)) &
            call check(cu_event_create(event%handle, without_time), 'making an event', err)
        if (failed(err)) return
        call check(cu_event_record(event%handle, c_null_ptr), 'recording an event', err)
    end subroutine record_event

    !> Wait until the work before an event is done; what was launched after it may go on.
    subroutine wait_for_event(event, err)
        type(event_t), intent(in) :: event
        type(error_t), intent(inout) :: err !! exit_device where the GPU fails
        real(dp) :: began

        if (failed(err)) return
        began = wall_seconds()
        call check(cu_event_synchronize(event%handle), 'the work of the kernels', err)
        call record_call(to_wait, 0_int64, began)
    end subroutine wait_for_event
end module brz_device_events
