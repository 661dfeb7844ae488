! SPDX-License-Identifier: MIT
!> Lists that grow: room for entries, running sums, and a list that takes the place of another.
!>
!> With `on_gpu` they are on a GPU: the array of the host has the same room and is the name of its
!> copy there (brz_present_table), nothing is written to it.
module brz_lists
    use brz_buffers, only: buffer_t, integers_t
    use brz_common_launches, only: common_kernels
    use brz_device, only: allocate_buffer, clear_buffer, copy_in, copy_out, copy_within, &
        free_buffer, reserve_buffer, sessions
    use brz_errors, only: error_t
    use brz_gpu_common, only: gpu_common_t
    use brz_kinds, only: int32, int64, int8, real32, real64, rk
    use brz_present_table, only: attach_bytes, buffer_of, detach, on_device
    implicit none
    private
    public :: at_least, clear_list, clear_map, clear_reals, copy_first, room_of, running_sum, swap
    public :: count_in_bins, put_changed, put_changed_table, put_in_bins, put_list, read_first

    !> Make room for n entries, or n columns of some rows; what was there is lost where it grows.
    interface at_least
        module procedure integers_at_least, singles_at_least, doubles_at_least, &
            single_columns_at_least, double_columns_at_least, integer_columns_at_least
    end interface at_least

    !> Copy the first n entries, or columns.
    interface copy_first
        module procedure copy_integers, copy_columns
    end interface copy_first

    type(gpu_common_t), save :: sums !! work arrays of running sums on a GPU
    integer, save :: session = -1 !! for which they are

    !> Two lists change places.
    interface swap
        module procedure swap_integers, swap_reals, swap_columns, swap_maps
    end interface swap

contains

    subroutine integers_at_least(on_gpu, a, n, err)
        integer(int32), allocatable, intent(inout) :: a(:)

        include 'list_at_least.inc'
    end subroutine integers_at_least

    subroutine singles_at_least(on_gpu, a, n, err)
        real(real32), allocatable, intent(inout) :: a(:)

        include 'list_at_least.inc'
    end subroutine singles_at_least

    subroutine doubles_at_least(on_gpu, a, n, err)
        real(real64), allocatable, intent(inout) :: a(:)

        include 'list_at_least.inc'
    end subroutine doubles_at_least

    subroutine single_columns_at_least(on_gpu, a, rows, n, err)
        real(real32), allocatable, intent(inout) :: a(:, :)

        include 'columns_at_least.inc'
    end subroutine single_columns_at_least

    subroutine double_columns_at_least(on_gpu, a, rows, n, err)
        real(real64), allocatable, intent(inout) :: a(:, :)

        include 'columns_at_least.inc'
    end subroutine double_columns_at_least

    subroutine integer_columns_at_least(on_gpu, a, rows, n, err)
        integer(int32), allocatable, intent(inout) :: a(:, :)

        include 'columns_at_least.inc'
    end subroutine integer_columns_at_least

    logical function has_copy(a) result(has)
        type(*), intent(in), target :: a(*)
        type(buffer_t) :: buffer

        buffer = buffer_of(a)
        has = buffer%address /= 0
    end function has_copy

    !> Room on the GPU for a list.
    subroutine give_copy(a, bytes, err)
        type(*), intent(in), target, contiguous :: a(..)
        integer(int64), intent(in) :: bytes
        type(error_t), intent(inout) :: err
        type(buffer_t) :: buffer

        call allocate_buffer(buffer, bytes, err)
        call attach_bytes(a, bytes, buffer)
    end subroutine give_copy

    subroutine drop_copy(a)
        type(*), intent(in), target :: a(*)
        type(buffer_t) :: buffer

        buffer = buffer_of(a)
        call free_buffer(buffer)
        call detach(a)
    end subroutine drop_copy

    !> The copy of a list, or of what is behind its first entry.
    type(buffer_t) function copy_at(a) result(buffer)
        type(*), intent(in), target :: a(*)

        buffer%address = on_device(a)
    end function copy_at

    !> Entries that a list has room for.
    pure integer function room_of(a) result(n)
        integer(int32), allocatable, intent(in) :: a(:)

        n = 0
        if (allocated(a)) n = size(a)
    end function room_of

    !> A list of the host, with room for it.
    subroutine put_list(on_gpu, from, to, err)
        logical, intent(in) :: on_gpu
        integer, intent(in) :: from(:)
        integer(int32), allocatable, intent(inout) :: to(:)
        type(error_t), intent(inout) :: err

        call at_least(on_gpu, to, size(from), err)
        if (on_gpu) then
            call copy_in(from, copy_at(to), 4_int64*size(from), err)
        else
            to(:size(from)) = from
        end if
    end subroutine put_list

    !> The same of a small table, unless the GPU has the same one: no kernel writes into it.
    subroutine put_changed(on_gpu, table, was, to, err)
        logical, intent(in) :: on_gpu
        integer, intent(in) :: table(:)
        integer, allocatable, intent(inout) :: was(:) !! what the GPU has
        integer(int32), allocatable, intent(inout) :: to(:)
        type(error_t), intent(inout) :: err

        if (on_gpu .and. allocated(was)) then
            if (size(was) == size(table)) then
                if (all(was == table)) return
            end if
        end if
        call put_list(on_gpu, table, to, err)
        if (on_gpu) was = table
    end subroutine put_changed

    !> The same into memory that the GPU alone has.
    subroutine put_changed_table(table, was, to, err)
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
    end subroutine put_changed_table

    !> Bring the first n entries to the host; 0 where a GPU fails.
    subroutine read_first(on_gpu, n, from, to, err)
        logical, intent(in) :: on_gpu
        integer, intent(in) :: n
        integer(int32), intent(in) :: from(:)
        integer, intent(out) :: to(:)
        type(error_t), intent(inout) :: err

        if (on_gpu) then
            to = 0
            call copy_out(copy_at(from), to, 4_int64*n, err)
        else
            to(:n) = from(:n)
        end if
    end subroutine read_first

    subroutine copy_integers(on_gpu, n, from, to, err)
        logical, intent(in) :: on_gpu
        integer, intent(in) :: n
        integer(int32), allocatable, intent(in) :: from(:)
        integer(int32), intent(inout) :: to(:)
        type(error_t), intent(inout) :: err

        if (n == 0) return
        if (on_gpu) then
            call copy_within(copy_at(from), copy_at(to), 4_int64*n, err)
        else
            to(:n) = from(:n)
        end if
    end subroutine copy_integers

    subroutine copy_columns(on_gpu, n, rows, from, to, err)
        logical, intent(in) :: on_gpu
        integer, intent(in) :: n, rows
        real(rk), allocatable, intent(in) :: from(:, :)
        real(rk), intent(inout) :: to(:, :)
        type(error_t), intent(inout) :: err

        if (n == 0) return
        if (on_gpu) then
            call copy_within(copy_at(from), copy_at(to), (storage_size(to)/8_int64)*rows*n, err)
        else
            to(:rows, :n) = from(:rows, :n)
        end if
    end subroutine copy_columns

    subroutine swap_integers(a, b)
        integer(int32), allocatable, intent(inout) :: a(:), b(:)
        integer(int32), allocatable :: c(:)

        call move_alloc(a, c)
        call move_alloc(b, a)
        call move_alloc(c, b)
    end subroutine swap_integers

    subroutine swap_reals(a, b)
        real(rk), allocatable, intent(inout) :: a(:), b(:)
        real(rk), allocatable :: c(:)

        call move_alloc(a, c)
        call move_alloc(b, a)
        call move_alloc(c, b)
    end subroutine swap_reals

    subroutine swap_maps(a, b)
        integer(int8), allocatable, intent(inout) :: a(:), b(:)
        integer(int8), allocatable :: c(:)

        call move_alloc(a, c)
        call move_alloc(b, a)
        call move_alloc(c, b)
    end subroutine swap_maps

    subroutine swap_columns(a, b)
        real(rk), allocatable, intent(inout) :: a(:, :), b(:, :)
        real(rk), allocatable :: c(:, :)

        call move_alloc(a, c)
        call move_alloc(b, a)
        call move_alloc(c, b)
    end subroutine swap_columns

    !> Every one of n integers becomes the sum of those before it, one more behind them that of all.
    subroutine running_sum(on_gpu, x, n, err, total)
        logical, intent(in) :: on_gpu
        integer(int32), intent(inout) :: x(*) !! (n + 1)
        integer, intent(in) :: n
        type(error_t), intent(inout) :: err
        integer, intent(out), optional :: total
        integer :: all, i, more

        if (on_gpu) then
            if (session /= sessions) sums = gpu_common_t()
            session = sessions
            call sums%running_sum(integers_t(address=on_device(x)), n, err, total)
            return
        end if
        all = 0
        do i = 1, n
            more = x(i)
            x(i) = all
            all = all + more
        end do
        x(n + 1) = all
        if (present(total)) total = all
    end subroutine running_sum

    !> Count the entries of each bin in the place behind its own.
    subroutine count_in_bins(on_gpu, n, bin, ends, err)
        logical, intent(in) :: on_gpu
        integer, intent(in) :: n
        integer(int32), intent(in) :: bin(:) !! (n) bin of each entry, 0: none
        integer(int32), intent(inout) :: ends(:) !! (bins + 1) added to
        type(error_t), intent(inout) :: err
        integer :: p

        if (on_gpu) then
            call common_kernels%bin_count([n, 1, 1], n, integers_t(address=on_device(bin)), &
                                          integers_t(address=on_device(ends)), err)
            return
        end if
        do p = 1, n
            if (bin(p) > 0) ends(bin(p) + 1) = ends(bin(p) + 1) + 1
        end do
    end subroutine count_in_bins

    !> Put entries into their bins: the place behind each bin goes from its start to its end.
    subroutine put_in_bins(on_gpu, n, bin, ends, binned, err)
        logical, intent(in) :: on_gpu
        integer, intent(in) :: n
        integer(int32), intent(in) :: bin(:) !! (n) bin of each entry, 0: none
        integer(int32), intent(inout) :: ends(:) !! (bins + 1)
        integer(int32), intent(inout) :: binned(:) !! (n) entries, bin by bin
        type(error_t), intent(inout) :: err
        integer :: p

        if (on_gpu) then
            call common_kernels%bin_fill([n, 1, 1], n, 0, integers_t(address=on_device(bin)), &
                integers_t(address=on_device(ends)), integers_t(address=on_device(binned)), err)
            return
        end if
        do p = 1, n
            if (bin(p) == 0) cycle
            ends(bin(p) + 1) = ends(bin(p) + 1) + 1
            binned(ends(bin(p) + 1)) = p
        end do
    end subroutine put_in_bins

    !> Set the first n entries of a map to zero.
    subroutine clear_map(on_gpu, n, x, err)
        logical, intent(in) :: on_gpu
        integer, intent(in) :: n
        integer(int8), intent(inout) :: x(*)
        type(error_t), intent(inout) :: err
        integer, parameter :: worth_threads = 20000
        integer :: i

        if (on_gpu) then
            call clear_buffer(copy_at(x), err, int(n, int64))
            return
        end if
        !$omp parallel do if(n >= worth_threads) schedule(static)
        do i = 1, n
            x(i) = 0
        end do
    end subroutine clear_map

    !> Set the first n numbers to zero.
    subroutine clear_reals(on_gpu, n, x, err)
        logical, intent(in) :: on_gpu
        integer, intent(in) :: n
        real(rk), intent(inout) :: x(*)
        type(error_t), intent(inout) :: err

        if (on_gpu) then
            call clear_buffer(copy_at(x), err, (storage_size(1.0_rk)/8_int64)*n)
        else
            x(1:n) = 0
        end if
    end subroutine clear_reals

    !> Set the first n entries of a list to zero.
    subroutine clear_list(on_gpu, n, x, err)
        logical, intent(in) :: on_gpu
        integer, intent(in) :: n
        integer(int32), intent(inout) :: x(*)
        type(error_t), intent(inout) :: err

        if (on_gpu) then
            call clear_buffer(copy_at(x), err, 4_int64*n)
        else
            x(1:n) = 0
        end if
    end subroutine clear_list
end module brz_lists
