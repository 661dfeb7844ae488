! SPDX-License-Identifier: MIT
!> How a body drifts as a whole, for its list of neighbours: see brz_list_drift.
module brz_drift_items
    use brz_kinds, only: dp, rk
    implicit none
    private
    public :: sum_drift, drift_of

    real(dp), parameter :: fine = 2.0_dp**17 !! parts of a mass, and of 1 m/s, that are counted
    real(dp), parameter :: fastest = 2.0_dp**17 !! what is faster does not count [m/s]

contains

    !> Add mass and momentum of a particle at the step, over the mass of one on its lattice, in
    !> whole parts: so the sums are the same in any order, by any number of threads and processes,
    !> as long as the particles of a process times their speed stay below 2^36 m/s.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine sum_drift(p, first, wide, step_d, half, per_mass, mass, v, accel, total)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: wide !! rows of v
        integer, intent(in) :: step_d !! distance of directions in accel
        real(rk), intent(in) :: half !! half of the last time step [s]
        real(dp), intent(in) :: per_mass !! 1/mass of a particle on the lattice [1/kg]
        real(rk), intent(in) :: mass(*)
        real(rk), intent(in) :: v(wide, *) !! half a step before [m/s]
        real(rk), intent(in) :: accel(*) !! [m/s2]
        real(dp), intent(inout) :: total(4) !@sum mass, momentum
        real(dp) :: share, u(3)
        integer :: c, i

        i = first - 1 + p
        share = fine*per_mass*mass(i)
        do c = 1, 3
            u(c) = v(c, i) + half*accel(i + (c - 1)*step_d)
            if (.not. abs(u(c)) < fastest) u(c) = 0
        end do
        total(1) = total(1) + anint(share)
        total(2) = total(2) + anint(share*u(1))
        total(3) = total(3) + anint(share*u(2))
        total(4) = total(4) + anint(share*u(3))
    end subroutine sum_drift

    !> Mean velocity of what was added up [m/s].
    pure function drift_of(total) result(v)
        real(dp), intent(in) :: total(4)
        real(dp) :: v(3)

        v = total(2:4)/max(total(1), 1.0_dp)
    end function drift_of
end module brz_drift_items
