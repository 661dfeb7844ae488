! SPDX-License-Identifier: MIT
!> Running sums of integers on the GPU, by the kernels of cuda/solid_search.CUF.
module brz_gpu_scan
    use brz_device, only: arguments_t, buffer_t, clear_buffer, copy_out, device_t, find_kernel, &
        kernel_t, launch, reserve_buffer
    use brz_errors, only: error_t
    use brz_gpu_solid_layout, only: scan_chunk
    use brz_kinds, only: int64
    implicit none
    private
    public :: gpu_scan_t, open_gpu_scan, running_sum

    type :: gpu_scan_t
        type(kernel_t) :: up, down
        type(buffer_t) :: levels
    end type gpu_scan_t

contains

    subroutine open_gpu_scan(device, scan, err)
        type(device_t), intent(in) :: device
        type(gpu_scan_t), intent(inout) :: scan
        type(error_t), intent(inout) :: err

        call find_kernel(device, 'scan_up', scan%up, err)
        call find_kernel(device, 'scan_down', scan%down, err)
    end subroutine open_gpu_scan

    !> Every one of n integers becomes the sum of those before it; one more, behind them, becomes
    !> the sum of all and is brought to the host if asked for.
    subroutine running_sum(scan, x, n, err, total)
        type(gpu_scan_t), intent(inout) :: scan
        class(buffer_t), intent(in) :: x !! (n + 1)
        integer, intent(in) :: n
        type(error_t), intent(inout) :: err
        integer, intent(out), optional :: total
        type(buffer_t) :: level(0:4), last_word
        integer :: length(0:4), l, last, word(1)

        last_word = x
        last_word%address = x%address + 4_int64*n
        last_word%bytes = 4
        call clear_buffer(last_word, err)
        length(0) = n + 1
        level(0) = x
        last = 0
        call reserve_buffer(scan%levels, 4_int64*(n/scan_chunk + 1)*2 + 1024, err)
        level(1) = scan%levels
        do while (length(last) > 1)
            length(last + 1) = (length(last) - 1)/scan_chunk + 1
            call sweep(scan%up, length(last), level(last), level(last + 1), err)
            last = last + 1
            if (length(last) == 1) exit
            level(last + 1) = level(last)
            level(last + 1)%address = level(last)%address + (4_int64*length(last)/256 + 1)*256
        end do
        level(last)%bytes = 4
        call clear_buffer(level(last), err)
        do l = last - 1, 0, -1
            call sweep(scan%down, length(l), level(l + 1), level(l), err)
        end do
        if (.not. present(total)) return
        word = 0
        call copy_out(last_word, word, 4_int64, err)
        total = word(1)
    end subroutine running_sum

    subroutine sweep(kernel, n, from, to, err)
        type(kernel_t), intent(in) :: kernel
        integer, intent(in) :: n
        type(buffer_t), intent(in) :: from, to
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments

        call arguments%add(n)
        call arguments%add(from)
        call arguments%add(to)
        call launch(kernel, [(n - 1)/scan_chunk + 1, 1, 1], arguments, err)
    end subroutine sweep
end module brz_gpu_scan
