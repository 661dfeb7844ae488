! SPDX-License-Identifier: MIT
!> Velocities of particles a step ago, from which walls are carried to the middle of the next.
module brz_velocity_loop_bodies
    use brz_kinds, only: int32, rk
    implicit none
    private
    public :: keep_velocity

contains

    !> Keep the velocities for the forces of the next step.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine keep_velocity(p, wide, stride_d, stride_p, v, id, v_before)
        integer, intent(in) :: p !! particles
        integer, intent(in) :: wide !! rows of v
        integer, intent(in) :: stride_d, stride_p !! distances of directions and particles in
                                                  !! v_before
        real(rk), intent(in) :: v(wide, *)
        integer(int32), intent(in) :: id(*)
        real(rk), intent(inout) :: v_before(*)
        integer :: d

        do d = 1, 3
            v_before(1 + (id(p) - 1)*stride_p + (d - 1)*stride_d) = v(d, p)
        end do
    end subroutine keep_velocity
end module brz_velocity_loop_bodies
