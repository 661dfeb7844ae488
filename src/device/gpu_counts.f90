! SPDX-License-Identifier: MIT
!> What a loop body counts on the GPU: a few numbers that the host reads when it is done.
module brz_gpu_counts
    use brz_buffers, only: integers_t
    use brz_device, only: allocate_buffer, clear_buffer, copy_out, sessions
    use brz_errors, only: error_t
    use brz_kinds, only: int64
    implicit none
    private
    public :: begin_counts, read_counts

    integer, parameter :: most = 8 !! numbers of a loop body
    type(integers_t), save :: counts
    integer, save :: session = -1 !! for which there is memory

contains

    !> Numbers that are 0, for a launch.
    function begin_counts(err) result(buffer)
        type(error_t), intent(inout) :: err
        type(integers_t) :: buffer

        if (session /= sessions) call allocate_buffer(counts, 4_int64*most, err)
        session = sessions
        call clear_buffer(counts, err)
        buffer = counts
    end function begin_counts

    !> What has been counted since; 0 where the GPU fails.
    subroutine read_counts(number, err)
        integer, intent(out) :: number(:) !! most at most
        type(error_t), intent(inout) :: err

        number = 0
        call copy_out(counts, number, 4_int64*size(number), err)
    end subroutine read_counts
end module brz_gpu_counts
