! SPDX-License-Identifier: MIT
!> Sums over a body: mass, momentum, energy, all in real64 and in a fixed order.
module brz_solid_totals
    use brz_kinds, only: dp
    use brz_solid_state, only: solid_t, worth_threads
    use brz_solid_step, only: velocity_at_step
    implicit none
    private
    public :: solid_totals, solid_totals_t

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
        real(dp) :: damage = 0 !! mean over the mass
    end type solid_totals_t

    integer, parameter :: n_sum = 14

contains

    !> Totals of body b, or of all bodies with b = 0.
    subroutine solid_totals(solid, b, totals)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: b
        type(solid_totals_t), intent(out) :: totals
        real(dp) :: part(n_sum, size(solid%block, 2)), sums(n_sum)
        integer :: k

        !$omp parallel do if(solid%n >= worth_threads) schedule(static)
        do k = 1, size(solid%block, 2)
            part(:, k) = 0
            if (b == 0 .or. solid%block(1, k) == b) &
                call sum_block(solid, solid%block(2, k), solid%block(3, k), part(:, k))
        end do
        sums = sum(part, dim=2)
        totals%mass = sums(1)
        totals%centre = sums(2:4)/max(sums(1), tiny(1.0_dp))
        totals%momentum = sums(5:7)
        totals%angular = sums(8:10)
        totals%kinetic = sums(11)
        totals%internal = sums(12)
        totals%outside = sums(14)
        totals%damage = sums(13)/max(sums(1), tiny(1.0_dp))
        do k = 1, size(solid%bodies) ! the turning of the particles of rigid bodies
            if (b /= 0 .and. b /= k) cycle
            associate (r => solid%bodies(k)%rigid)
                totals%angular = totals%angular + r%cell_inertia*r%omega
                totals%kinetic = totals%kinetic &
                                 + r%cell_inertia/2*dot_product(r%omega, r%omega)
            end associate
        end do
        if (b == 0) then
            totals%hourglass = sum(solid%bodies%ledger%hourglass)
            totals%artificial = sum(solid%bodies%ledger%artificial)
            totals%contact = sum(solid%bodies%ledger%contact)
        else
            totals%hourglass = solid%bodies(b)%ledger%hourglass
            totals%artificial = solid%bodies(b)%ledger%artificial
            totals%contact = solid%bodies(b)%ledger%contact
        end if
    end subroutine solid_totals

    subroutine sum_block(solid, first, last, part)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: first, last
        real(dp), intent(out) :: part(n_sum)
        real(dp) :: x(3), v(3), m
        integer :: i

        part = 0
        do i = first, last
            m = solid%mass(i)
            x = solid%x(:, i)
            v = velocity_at_step(solid, i)
            part(1) = part(1) + m
            part(2:4) = part(2:4) + m*x
            part(5:7) = part(5:7) + m*v
            part(8) = part(8) + m*(x(2)*v(3) - x(3)*v(2))
            part(9) = part(9) + m*(x(3)*v(1) - x(1)*v(3))
            part(10) = part(10) + m*(x(1)*v(2) - x(2)*v(1))
            part(11) = part(11) + m*dot_product(v, v)/2
            part(12) = part(12) + m*solid%energy(i)
            part(13) = part(13) + m*solid%damage(i)
            if (any(x < solid%region(:, 1) .or. x > solid%region(:, 2))) part(14) = part(14) + m
        end do
    end subroutine sum_block
end module brz_solid_totals
