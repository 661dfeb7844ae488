! SPDX-License-Identifier: MIT
!> Totals of bodies from sums over their particles.
module brz_solid_sums
    use brz_force_loop_bodies, only: n_sum
    use brz_kinds, only: dp, rk
    use brz_particles, only: particles_t
    use brz_bodies, only: bodies_t
    implicit none
    private
    public :: totals_of_sums, solid_totals_t, n_sum, velocity_at_step

    !> Of what is modelled (a half or a quarter where symmetry planes cut), at the time of the step.
    type :: solid_totals_t
        real(dp) :: mass = 0 !! [kg]
        real(dp) :: centre(3) = 0 !! mass centre [m]
        real(dp) :: momentum(3) = 0 !! [N s]
        real(dp) :: angular(3) = 0 !! angular momentum about the origin [N m s]
        real(dp) :: kinetic = 0, internal = 0 !! [J]
        real(dp) :: hourglass = 0 !! energy held by the stiff hourglass force [J]
        real(dp) :: artificial = 0 !! energy held by the artificial stress [J]
        real(dp) :: contact = 0 !! energy held by the springs of contact [J]
        real(dp) :: outside = 0 !! mass that has left the region [kg]
        real(dp) :: removed(2) = 0 !! mass and energy of what has been taken out [kg, J]
        real(dp) :: damage = 0 !! mean over the mass
    end type solid_totals_t

contains

    !> Totals of body b, or of all bodies with b = 0.
    subroutine totals_of_sums(solid, b, sums, totals)
        class(bodies_t), intent(in) :: solid
        integer, intent(in) :: b
        real(dp), intent(in) :: sums(n_sum, size(solid%bodies)) !! see sum_state
        type(solid_totals_t), intent(out) :: totals
        real(dp) :: all(n_sum)
        integer :: k

        if (b == 0) all = sum(sums, 2) ! body by body
        if (b > 0) all = sums(:, b)
        totals%mass = all(1)
        totals%centre = all(2:4)/max(all(1), tiny(1.0_dp))
        totals%momentum = all(5:7)
        totals%angular = all(8:10)
        totals%kinetic = all(11)
        totals%internal = all(12)
        totals%outside = all(14)
        totals%removed = all(15:16)
        totals%damage = all(13)/max(all(1), tiny(1.0_dp))
        do k = 1, size(solid%bodies) ! the turning of the particles of rigid bodies
            if (b /= 0 .and. b /= k) cycle
            associate (r => solid%bodies(k)%rigid)
                totals%angular = totals%angular + r%cell_inertia*r%omega
                totals%kinetic = totals%kinetic &
                                 + r%cell_inertia/2*dot_product(r%omega, r%omega)
            end associate
        end do
        if (b == 0) then
            totals%hourglass = sum(solid%bodies%account%hourglass)
            totals%artificial = sum(solid%bodies%account%artificial)
            totals%contact = sum(solid%bodies%account%contact)
            totals%internal = totals%internal - sum(solid%bodies%account%early)
        else
            totals%hourglass = solid%bodies(b)%account%hourglass
            totals%artificial = solid%bodies(b)%account%artificial
            totals%contact = solid%bodies(b)%account%contact
            totals%internal = totals%internal - solid%bodies(b)%account%early
        end if
    end subroutine totals_of_sums

    !> Velocity of a particle at the step itself [m/s].
    pure function velocity_at_step(solid, i) result(v)
        class(particles_t), intent(in) :: solid
        integer, intent(in) :: i
        real(rk) :: v(3)

        v = solid%v(:, i) + real(solid%dt_last/2, rk)*solid%a(:, i)
    end function velocity_at_step
end module brz_solid_sums
