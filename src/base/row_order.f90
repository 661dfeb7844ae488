! SPDX-License-Identifier: MIT
!> Sorting of rows of numbers.
module brz_row_order
    use brz_kinds, only: dp
    implicit none
    private
    public :: order_rows

contains

    !> Order that sorts the columns of `rows` by their first number, then by the next ones; equal
    !> ones keep their order (merge sort).
    subroutine order_rows(rows, order)
        real(dp), intent(in) :: rows(:, :) !! (numbers, n)
        integer, intent(out) :: order(:) !! (n)
        integer, allocatable :: buffer(:)
        integer :: i, n, width

        n = size(rows, 2)
        order = [(i, i=1, n)]
        allocate (buffer(n))
        width = 1
        do while (width < n)
            do i = 1, n, 2*width
                call merge_runs(rows, order, buffer, i, min(i + width, n + 1), &
                                min(i + 2*width, n + 1))
            end do
            order = buffer
            width = 2*width
        end do
    end subroutine order_rows

    !> Merge the sorted runs first..middle-1 and middle..last-1 of `order` into `buffer`.
    pure subroutine merge_runs(rows, order, buffer, first, middle, last)
        real(dp), intent(in) :: rows(:, :)
        integer, intent(in) :: order(:)
        integer, intent(inout) :: buffer(:)
        integer, intent(in) :: first, middle, last
        integer :: i, j, k
        logical :: left

        i = first
        j = middle
        do k = first, last - 1
            left = i < middle
            if (left .and. j < last) left = .not. before(rows(:, order(j)), rows(:, order(i)))
            if (left) then
                buffer(k) = order(i)
                i = i + 1
            else
                buffer(k) = order(j)
                j = j + 1
            end if
        end do
    end subroutine merge_runs

    pure logical function before(a, b)
        real(dp), intent(in) :: a(:), b(:)
        integer :: i

        before = .false.
        do i = 1, size(a)
            before = a(i) < b(i)
            if (a(i) < b(i) .or. b(i) < a(i)) return
        end do
    end function before
end module brz_row_order
