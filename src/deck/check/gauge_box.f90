! SPDX-License-Identifier: MIT
!> Where gauges of the air look: at their point, or at points spread evenly over a box about it.
module brz_gauge_box
    use brz_case, only: case_t, gauge_case_t
    use brz_check_start, only: is_axial, is_radial
    use brz_kinds, only: dp
    implicit none
    private
    public :: points_of_gauge, points_of_gauges

    integer, parameter :: most = 8 !! points along a side

contains

    !> Points of a gauge: those in the middle of equal parts of its box, a cell apart or less but
    !> at most `most` along a side, and only in the air. They are the same on any number of
    !> processes and while the air is a blast in one or two dimensions.
    pure subroutine points_of_gauge(case, gauge, points)
        type(case_t), intent(in) :: case
        type(gauge_case_t), intent(in) :: gauge
        real(dp), allocatable, intent(out) :: points(:, :) !! (3, n) [m]
        real(dp) :: all(3, most**3)
        real(dp) :: point(3)
        integer :: n(3), i, j, k, found
        logical :: active(3)

        active = case%air%cells > 1 .or. is_radial(case)
        n = 1
        where (active .and. gauge%width > 0) n = most
        if (.not. is_radial(case)) then
            where (n > 1) n = min(most, 1 + ceiling(gauge%width*case%air%cells &
                                                    /(case%air%hi - case%air%lo)))
        end if
        found = 0
        do k = 1, n(3)
            do j = 1, n(2)
                do i = 1, n(1)
                    point = gauge%at
                    where (n > 1) point = gauge%at + gauge%width*(([i, j, k] - 0.5_dp)/n - 0.5_dp)
                    if (product(n) > 1 .and. .not. in_air(case, active, point)) cycle
                    found = found + 1
                    all(:, found) = point
                end do
            end do
        end do
        if (found == 0) then
            found = 1
            all(:, 1) = gauge%at
        end if
        allocate (points(3, found), source=all(:, :found))
    end subroutine points_of_gauge

    !> Points of all gauges of the air, one gauge after the other.
    pure subroutine points_of_gauges(case, points)
        type(case_t), intent(in) :: case
        real(dp), allocatable, intent(out) :: points(:, :) !! (3, n) [m]
        real(dp), allocatable :: more(:, :), all(:)
        integer :: g

        allocate (all(0))
        if (allocated(case%gauges)) then
            do g = 1, size(case%gauges)
                if (case%gauges(g)%body_index > 0) cycle
                call points_of_gauge(case, case%gauges(g), more)
                all = [all, more]
            end do
        end if
        allocate (points(3, size(all)/3), source=reshape(all, [3, size(all)/3]))
    end subroutine points_of_gauges

    !> True for a point of the air, its sides included.
    pure logical function in_air(case, active, point)
        type(case_t), intent(in) :: case
        logical, intent(in) :: active(3) !! directions in which the air is modelled
        real(dp), intent(in) :: point(3) !! [m]

        if (.not. is_radial(case)) then
            in_air = all(point >= case%air%lo .and. point <= case%air%hi .or. .not. active)
        else
            in_air = .true.
            if (is_axial(case)) in_air = point(index('xyz', case%charges(1)%axis)) &
                                         >= case%air%floor
        end if
    end function in_air
end module brz_gauge_box
