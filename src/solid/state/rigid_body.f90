! SPDX-License-Identifier: MIT
!> A rigid body: its mass and inertia, and its motion.
module brz_rigid_body
    use brz_kinds, only: dp
    implicit none
    private
    public :: rigid_t

    !> Levels of time: see brz_rigid.
    type :: rigid_t
        real(dp) :: mass = 0 !! [kg]
        real(dp) :: centre_ref(3) = 0 !! centre of mass of the unloaded body [m]
        real(dp) :: compliance(3, 3) = 0 !! inverse inertia in the unloaded attitude [1/(kg m2)]
        real(dp) :: reach = 0 !! farthest from centre_ref that its cells go [m]
        real(dp) :: steps(2) = huge(1.0_dp) !! time steps that bonds and contact bear [s]
        real(dp) :: cell_inertia = 0 !! inertia of the cells of the particles themselves [kg m2]
        real(dp) :: x(3) = 0 !! centre of mass [m]
        real(dp) :: q(4) = [1, 0, 0, 0] !! attitude, unit quaternion, scalar first
        real(dp) :: p(3) = 0, l(3) = 0 !! momentum, angular momentum about x, half a step before
        real(dp) :: force(3) = 0, torque(3) = 0 !! of contact, at the step
        real(dp) :: load(6) = 0 !! force and torque of the air over its step, of another body
                                !! that is driven the force on its fixed particles [N, N m]
        real(dp) :: omega(3) = 0 !! angular velocity at the step [1/s]
        real(dp) :: spin(3) = 0 !! angular velocity half a step before [1/s]
        real(dp) :: moves(3) = 1, turns(3) = 1 !! 0: component is kept at zero
    end type rigid_t
end module brz_rigid_body
