! SPDX-License-Identifier: MIT
!> What the loops over the direct neighbours of a particle share: eight pairs at a time, each in a
!> lane of its own, and the lanes added in a fixed order.
module brz_solid_lanes
    use brz_kinds, only: rk
    use brz_solid_state, only: lanes
    implicit none
    private
    public :: centre_t, add_lanes

    !> The particle whose pairs are summed over, and the kernel.
    type :: centre_t
        integer :: i = 0 !! particle
        integer :: count = 0 !! direct entries of its list
        real(rk) :: scale = 0, half_over_h = 0 !! see brz_kernel
        real(rk) :: h = 0 !! smoothing length [m]
    end type centre_t

contains

    !> Add the lanes of m sums; what f has beyond them is 0.
    pure subroutine add_lanes(m, acc, f)
        integer, intent(in) :: m
        real(rk), intent(in) :: acc(lanes, m)
        real(rk), intent(out) :: f(:)
        integer :: t

        f(m + 1:) = 0
        do t = 1, m
            f(t) = ((acc(1, t) + acc(5, t)) + (acc(2, t) + acc(6, t))) &
                   + ((acc(3, t) + acc(7, t)) + (acc(4, t) + acc(8, t)))
        end do
    end subroutine add_lanes
end module brz_solid_lanes
