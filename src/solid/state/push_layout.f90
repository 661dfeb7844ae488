! SPDX-License-Identifier: MIT
!> How the forces of other bodies on particles lie.
module brz_push_layout
    implicit none
    private
    public :: push_layout_t

    !> Where sums of the pairs with other bodies lie, in rows or in columns.
    type :: push_layout_t
        integer :: compact !! 1: of each particle that has links; 0: of each particle
        integer :: step_c, stride_p !! distances of numbers, and of particles
        integer :: drag, torque !! numbers before the forces, the torques of drag
        integer :: heat !! place of the heat of the pairs; 0: it has been recorded
        integer :: glued !! 1: forces of interfaces are not among them
    end type push_layout_t
end module brz_push_layout
