! SPDX-License-Identifier: MIT
!> Lists that grow: room for entries, running sums, and a list that takes the place of another.
module brz_lists
    use brz_kinds, only: int32, int8, real32, real64, rk
    implicit none
    private
    public :: at_least, clear_list, clear_map, clear_reals, copy_first, room_of, running_sum, swap
    public :: count_in_bins, put_in_bins, put_list, read_first

    !> Make room for n entries, or n columns of some rows; what was there is lost where it grows.
    interface at_least
        module procedure integers_at_least, singles_at_least, doubles_at_least, &
            single_columns_at_least, double_columns_at_least, integer_columns_at_least
    end interface at_least

    !> Copy the first n entries, or columns.
    interface copy_first
        module procedure copy_integers, copy_columns
    end interface copy_first

    !> Two lists change places.
    interface swap
        module procedure swap_integers, swap_columns
    end interface swap

contains

    subroutine integers_at_least(a, n)
        integer(int32), allocatable, intent(inout) :: a(:)

        include 'list_at_least.inc'
    end subroutine integers_at_least

    subroutine singles_at_least(a, n)
        real(real32), allocatable, intent(inout) :: a(:)

        include 'list_at_least.inc'
    end subroutine singles_at_least

    subroutine doubles_at_least(a, n)
        real(real64), allocatable, intent(inout) :: a(:)

        include 'list_at_least.inc'
    end subroutine doubles_at_least

    subroutine single_columns_at_least(a, rows, n)
        real(real32), allocatable, intent(inout) :: a(:, :)

        include 'columns_at_least.inc'
    end subroutine single_columns_at_least

    subroutine double_columns_at_least(a, rows, n)
        real(real64), allocatable, intent(inout) :: a(:, :)

        include 'columns_at_least.inc'
    end subroutine double_columns_at_least

    subroutine integer_columns_at_least(a, rows, n)
        integer(int32), allocatable, intent(inout) :: a(:, :)

        include 'columns_at_least.inc'
    end subroutine integer_columns_at_least

    !> Entries that a list has room for.
    pure integer function room_of(a) result(n)
        integer(int32), allocatable, intent(in) :: a(:)

        n = 0
        if (allocated(a)) n = size(a)
    end function room_of

    !> A list of the host, with room for it.
    subroutine put_list(from, to)
        integer, intent(in) :: from(:)
        integer(int32), allocatable, intent(inout) :: to(:)

        call at_least(to, size(from))
        to(:size(from)) = from
    end subroutine put_list

    !> Bring the first n entries to the host.
    pure subroutine read_first(n, from, to)
        integer, intent(in) :: n
        integer(int32), intent(in) :: from(:)
        integer, intent(out) :: to(:)

        to(:n) = from(:n)
    end subroutine read_first

    subroutine copy_integers(n, from, to)
        integer, intent(in) :: n
        integer(int32), allocatable, intent(in) :: from(:)
        integer(int32), intent(inout) :: to(:)

        if (n > 0) to(:n) = from(:n)
    end subroutine copy_integers

    subroutine copy_columns(n, rows, from, to)
        integer, intent(in) :: n, rows
        real(rk), allocatable, intent(in) :: from(:, :)
        real(rk), intent(inout) :: to(:, :)

        if (n > 0) to(:rows, :n) = from(:rows, :n)
    end subroutine copy_columns

    subroutine swap_integers(a, b)
        integer(int32), allocatable, intent(inout) :: a(:), b(:)
        integer(int32), allocatable :: c(:)

        call move_alloc(a, c)
        call move_alloc(b, a)
        call move_alloc(c, b)
    end subroutine swap_integers

    subroutine swap_columns(a, b)
        real(rk), allocatable, intent(inout) :: a(:, :), b(:, :)
        real(rk), allocatable :: c(:, :)

        call move_alloc(a, c)
        call move_alloc(b, a)
        call move_alloc(c, b)
    end subroutine swap_columns

    !> Every one of n integers becomes the sum of those before it, one more behind them that of all.
    pure subroutine running_sum(x, n, total)
        integer(int32), intent(inout) :: x(*) !! (n + 1)
        integer, intent(in) :: n
        integer, intent(out), optional :: total
        integer :: all, i, more

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
    pure subroutine count_in_bins(n, bin, ends)
        integer, intent(in) :: n
        integer(int32), intent(in) :: bin(:) !! (n) bin of each entry, 0: none
        integer(int32), intent(inout) :: ends(:) !! (bins + 1) added to
        integer :: p

        do p = 1, n
            if (bin(p) > 0) ends(bin(p) + 1) = ends(bin(p) + 1) + 1
        end do
    end subroutine count_in_bins

    !> Put entries into their bins: the place behind each bin goes from its start to its end.
    pure subroutine put_in_bins(n, bin, ends, binned)
        integer, intent(in) :: n
        integer(int32), intent(in) :: bin(:) !! (n) bin of each entry, 0: none
        integer(int32), intent(inout) :: ends(:) !! (bins + 1)
        integer(int32), intent(inout) :: binned(:) !! (n) entries, bin by bin
        integer :: p

        do p = 1, n
            if (bin(p) == 0) cycle
            ends(bin(p) + 1) = ends(bin(p) + 1) + 1
            binned(ends(bin(p) + 1)) = p
        end do
    end subroutine put_in_bins

    !> Set the first n entries of a map to zero.
    subroutine clear_map(n, x)
        integer, intent(in) :: n
        integer(int8), intent(out) :: x(*)
        integer, parameter :: worth_threads = 20000
        integer :: i

        !$omp parallel do if(n >= worth_threads) schedule(static)
        do i = 1, n
            x(i) = 0
        end do
    end subroutine clear_map

    !> Set the first n numbers to zero.
    subroutine clear_reals(n, x)
        integer, intent(in) :: n
        real(rk), intent(out) :: x(*)

        x(1:n) = 0
    end subroutine clear_reals

    !> Set the first n entries of a list to zero.
    subroutine clear_list(n, x)
        integer, intent(in) :: n
        integer(int32), intent(out) :: x(*)

        x(1:n) = 0
    end subroutine clear_list
end module brz_lists
