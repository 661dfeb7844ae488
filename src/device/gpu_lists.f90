! SPDX-License-Identifier: MIT
!> Lists that grow, on the GPU: as brz_lists has them, for steps that stand once.
module brz_gpu_lists
    use brz_buffers, only: buffer_t, bytes_each, integers_t
    use brz_common_launches, only: common_kernels
    use brz_device, only: clear_buffer, copy_in, copy_out, copy_within, reserve_buffer
    use brz_errors, only: error_t, failed
    use brz_kinds, only: int64
    implicit none
    private
    public :: at_least, clear_list, clear_map, clear_reals, copy_first, put_changed, put_list, &
        read_first, room_of, swap, count_in_bins, put_in_bins

    !> Make room for n entries, or n columns of some rows; what was there is lost where it grows.
    interface at_least
        module procedure list_at_least, columns_at_least
    end interface at_least

    !> Copy the first n entries, or columns.
    interface copy_first
        module procedure copy_list, copy_columns
    end interface copy_first

    !> Set the first n entries of a map to zero.
    interface clear_map
        module procedure clear_list
    end interface clear_map

    !> The same of numbers.
    interface clear_reals
        module procedure clear_list
    end interface clear_reals

contains

    subroutine list_at_least(a, n, err)
        class(buffer_t), intent(inout) :: a
        integer, intent(in) :: n
        type(error_t), intent(inout) :: err

        call reserve_buffer(a, bytes_each(a)*n, err)
    end subroutine list_at_least

    subroutine columns_at_least(a, rows, n, err)
        class(buffer_t), intent(inout) :: a
        integer, intent(in) :: rows, n
        type(error_t), intent(inout) :: err

        call reserve_buffer(a, bytes_each(a)*rows*n, err)
    end subroutine columns_at_least

    !> Set the first n entries of a list to zero.
    subroutine clear_list(n, a, err)
        integer, intent(in) :: n
        class(buffer_t), intent(in) :: a
        type(error_t), intent(inout) :: err

        call clear_buffer(a, err, bytes_each(a)*n)
    end subroutine clear_list

    !> Count the entries of each bin in the place behind its own.
    subroutine count_in_bins(n, bin, ends, err)
        integer, intent(in) :: n
        type(integers_t), intent(in) :: bin !! (n) bin of each entry, 0: none
        type(integers_t), intent(in) :: ends !! (bins + 1) added to
        type(error_t), intent(inout) :: err

        call common_kernels%bin_count([n, 1, 1], n, bin, ends, err)
    end subroutine count_in_bins

    !> Put entries into their bins: the place behind each bin goes from its start to its end.
    subroutine put_in_bins(n, bin, ends, binned, err)
        integer, intent(in) :: n
        type(integers_t), intent(in) :: bin, ends, binned
        type(error_t), intent(inout) :: err

        call common_kernels%bin_fill([n, 1, 1], n, 0, bin, ends, binned, err)
    end subroutine put_in_bins

    !> Entries that a list has room for.
    pure integer function room_of(a) result(n)
        type(integers_t), intent(in) :: a

        n = 0
        if (a%address /= 0) n = int(a%bytes/4)
    end function room_of

    !> A list of the host, with room for it.
    subroutine put_list(from, to, err)
        integer, intent(in) :: from(:)
        type(integers_t), intent(inout) :: to
        type(error_t), intent(inout) :: err

        call at_least(to, size(from), err)
        call copy_in(from, to, bytes_each(to)*size(from), err)
    end subroutine put_list

    !> A small table of the host, unless the GPU has the same one: no kernel writes into it.
    subroutine put_changed(table, was, to, err)
        integer, intent(in) :: table(:) !! as words of 4 B
        integer, allocatable, intent(inout) :: was(:) !! what the GPU has
        class(buffer_t), intent(inout) :: to
        type(error_t), intent(inout) :: err

        if (allocated(was)) then
            if (size(was) == size(table)) then
                if (all(was == table)) return
            end if
        end if
        call reserve_buffer(to, 4_int64*size(table), err)
        call copy_in(table, to, 4_int64*size(table), err)
        was = table
    end subroutine put_changed

    !> Bring the first n entries to the host; 0 where the GPU fails.
    subroutine read_first(n, from, to, err)
        integer, intent(in) :: n
        type(integers_t), intent(in) :: from
        integer, intent(out) :: to(:)
        type(error_t), intent(inout) :: err

        to = 0
        call copy_out(from, to, bytes_each(from)*n, err)
    end subroutine read_first

    subroutine copy_list(n, from, to, err)
        integer, intent(in) :: n
        class(buffer_t), intent(in) :: from, to
        type(error_t), intent(inout) :: err

        call copy_within(from, to, bytes_each(from)*n, err)
    end subroutine copy_list

    subroutine copy_columns(n, rows, from, to, err)
        integer, intent(in) :: n, rows
        class(buffer_t), intent(in) :: from, to
        type(error_t), intent(inout) :: err

        call copy_within(from, to, bytes_each(from)*rows*n, err)
    end subroutine copy_columns

    !> Two lists change places.
    subroutine swap(a, b, err)
        class(buffer_t), intent(inout) :: a, b
        type(error_t), intent(inout) :: err
        type(buffer_t) :: c

        if (failed(err)) return
        c%address = a%address
        c%bytes = a%bytes
        a%address = b%address
        a%bytes = b%bytes
        b%address = c%address
        b%bytes = c%bytes
    end subroutine swap
end module brz_gpu_lists
