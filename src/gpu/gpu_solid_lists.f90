! SPDX-License-Identifier: MIT
!> Lists of particles on the GPU, of neighbours and of links: where each begins, and which move when
!> some are written anew.
module brz_gpu_solid_lists
    use brz_buffers, only: from, integers_t
    use brz_device, only: copy_out, copy_within, reserve_buffer
    use brz_errors, only: error_t
    use brz_gpu_common, only: gpu_common_t, pick
    use brz_gpu_solid_layout, only: slice_width
    use brz_solid_device, only: solid_device_t, lists_t
    use brz_kinds, only: int64
    use brz_solid_launches, only: solid_kernels
    implicit none
    private
    public :: lay_lists, move_lists, pick_chosen

contains

    !> Give lists that have been counted their places, and room behind them where they may move: a
    !> part of what they need, and `beyond`.
    subroutine lay_lists(lists, common, count, spare, part, beyond, err)
        class(lists_t), intent(inout) :: lists
        type(gpu_common_t), intent(inout) :: common
        type(integers_t), intent(in) :: count
        integer, intent(in) :: spare !! entries more than each list needs
        integer, intent(in) :: part, beyond !! one over the part; rows
        type(error_t), intent(inout) :: err
        integer :: longest

        call solid_kernels%slice_widths([lists%slices, 1, 1], lists%slices, lists%first, &
                                        lists%last - lists%gone, spare, count, lists%slice, err)
        if (lists%spare > 0) then
            call reserve_buffer(lists%width, 4_int64*lists%slices, err)
            call copy_within(lists%slice, lists%width, 4_int64*lists%slices, err)
        end if
        call common%running_sum(lists%slice, lists%slices, err, longest)
        lists%filled = longest
        if (lists%spare > 0) longest = longest + longest/part + beyond
        call reserve_buffer(lists%list, 4_int64*slice_width*(longest + 1_int64), err)
    end subroutine lay_lists

    !> Put slices with lists that have no room any more behind all others, and choose their
    !> particles.
    subroutine move_lists(lists, count, chosen, fits, err)
        class(lists_t), intent(inout) :: lists
        type(integers_t), intent(in) :: count, chosen
        logical, intent(out) :: fits !! else there is no room behind them, and no list is right
        type(error_t), intent(inout) :: err
        integer :: end(1)

        call solid_kernels%move_slices([lists%slices, 1, 1], lists%slices, lists%first, &
                                       lists%last, lists%spare, count, chosen, lists%slice, &
                                       lists%width, err)
        end = 0
        call copy_out(from(lists%slice, lists%slices + 1_int64), end, 4_int64, err)
        fits = 4_int64*slice_width*(end(1) + 1_int64) <= lists%list%bytes
        if (fits) lists%filled = end(1)
    end subroutine move_lists

    !> List the particles of body b that are chosen, so that the threads of a warp all have work;
    !> none of them is counted yet.
    subroutine pick_chosen(gpu, b, err)
        type(solid_device_t), intent(in) :: gpu
        integer, intent(in) :: b
        type(error_t), intent(inout) :: err

        associate (first => gpu%bodies(b)%first, last => gpu%bodies(b)%last)
            call pick(from(gpu%chosen, int(first, int64)), first - 1, last - first + 1, &
                      from(gpu%picked, int(first, int64)), from(gpu%found, int(b, int64)), err)
        end associate
    end subroutine pick_chosen
end module brz_gpu_solid_lists
