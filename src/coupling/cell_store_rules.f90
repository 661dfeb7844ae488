! SPDX-License-Identifier: MIT
!> What happens to the gas of one cell when the solid comes or goes: in place of cut cells the
!> immersed boundary has whole ones, and no small cell shortens the step. Point physics: compiled
!> for the CPU and for the GPU.
!>
!> Conserved variables are density, momentum x, y, z, total energy and products per volume, as in
!> air_t; the last is zero where no products are carried.
module brz_cell_store_rules
    use brz_gas, only: to_conserved
    use brz_kinds, only: rk
    use brz_positivity, only: is_kept, margin
    implicit none
    private
    public :: gas_of_cleared, stored_ratio, stored_excess, release_deferred

    real(rk), parameter :: thinnest = 1e-3_rk !! least density of a fresh cell over that around it
    real(rk), parameter :: middle = 0.5_rk !! of a cell store, in units of the gas beside it
    real(rk), parameter :: half_band = 1.5_rk !! it may lie so far off: in -1..2
    real(rk), parameter :: pace = 0.05_rk !! part of a deferred source released per step
    real(rk), parameter :: jolt = 0.02_rk !! largest change of internal energy by it
    real(rk), parameter :: density_jolt = 0.999_rk*jolt
    !! largest change of density: less, so that rounding does not decide where both are the same
    real(rk), parameter :: trifle = 1e-3_rk !! mass over that of the gas that is deferred as it
                                            !! comes
    !> A deferred source this small, over the gas, is released at once: a twentieth of it may be
    !> lost to rounding
    real(rk), parameter :: crumb = max(1e-10_rk, 40*epsilon(1.0_rk))

contains

    !> Fill a cell that the solid has left.
    !>
    !> It gets the state of its surroundings, so that the flow sees no step. Where the solid leaves
    !> so fast that less than half of that gas could follow, and less than half has come in through
    !> the walls, the cell is thinner, by an isentropic expansion, but not below the floors; nor may
    !> its internal energy be lost in rounding beside the kinetic one. What is left over, of any
    !> sign, is returned for the cell stores nearby.
    !@cuf attributes(host,device) &
    pure subroutine gas_of_cleared(floors, gamma, w, follows, u, rest)
        real(rk), intent(in) :: floors(3) !! see floors_of
        real(rk), intent(in) :: gamma !! ratio of specific heats [-]
        real(rk), intent(in) :: w(6) !! surroundings: density, velocity, pressure, products' share
        real(rk), intent(in) :: follows !! part of the gas that follows the solid, 0..1
        real(rk), intent(inout) :: u(6) !! the cell store; on return the gas
        real(rk), intent(out) :: rest(6) !! cell store less gas
        real(rk) :: q, v(5)
        integer :: i

        do i = 1, 5
            rest(i) = u(i)
            v(i) = w(i)
        end do
        rest(6) = u(6)
        if (u(1) < w(1)/2 .and. follows < 0.5_rk) then
            q = max(u(1)/w(1), follows, thinnest, min(1.0_rk, floors(2)/w(1)))
            v(1) = w(1)*q
            v(5) = w(5)*q**gamma
        end if
        v(5) = max(v(5), 2*(gamma - 1)*max(floors(3), &
                                           margin*v(1)*(v(2)*v(2) + v(3)*v(3) + v(4)*v(4))))
        call to_conserved(gamma, v, u)
        u(6) = u(1)*w(6)
        do i = 1, 6
            rest(i) = rest(i) - u(i)
        end do
    end subroutine gas_of_cleared

    !> A cell store in units of the gas beside it, density or energy, whichever is farther out.
    !@cuf attributes(host,device) &
    pure function stored_ratio(u, rho, energy) result(r)
        real(rk), intent(in) :: u(5) !! the cell store
        real(rk), intent(in) :: rho, energy !! of the gas: density [kg/m3], total energy [J/m3]
        real(rk) :: r, e

        r = u(1)/rho
        e = u(5)/energy
        if (abs(e - middle) > abs(r - middle)) r = e
    end function stored_ratio

    !> Part of a cell store that must go so that its ratio comes back to the edge of the band, 0..1.
    !@cuf attributes(host,device) &
    pure function stored_excess(ratio) result(part)
        real(rk), intent(in) :: ratio !! from stored_ratio
        real(rk) :: part

        part = 0
        if (abs(ratio - middle) > half_band) part = (abs(ratio - middle) - half_band)/abs(ratio)
    end function stored_excess

    !> Hand part of a deferred source to the gas of its cell: a twentieth, or less where that would
    !> be a jolt.
    !>
    !> The gas stays gas: what would leave less than the floors waits. A cell with a sink of mass
    !> gives gas as it is, and the rest of the deferred source waits: mass without its energy, a
    !> little each step, would leave next to nothing at the same pressure, and a step of the air to
    !> match.
    !@cuf attributes(host,device) &
    pure subroutine release_deferred(floors, u, deferred)
        real(rk), intent(in) :: floors(3) !! see floors_of
        real(rk), intent(inout) :: u(6) !! gas
        real(rk), intent(inout) :: deferred(6)
        real(rk) :: part, inner, changed, v(6), d(6)
        integer :: i, halvings
        logical :: released, alike

        part = pace
        if (abs(deferred(1))*part > density_jolt*u(1)) part = density_jolt*u(1)/abs(deferred(1))
        inner = u(5) - (u(2)*u(2) + u(3)*u(3) + u(4)*u(4))/(2*u(1))
        if (abs(deferred(1)) <= crumb*u(1) .and. abs(deferred(5)) <= crumb*inner) part = 1
        alike = deferred(1) < -trifle*u(1)
        do halvings = 1, 60
            do i = 1, 6
                d(i) = part*deferred(i)
                if (alike) d(i) = part*deferred(1)*(u(i)/u(1))
                v(i) = u(i) + d(i)
            end do
            if (v(1) > 0) then
                changed = v(5) - (v(2)*v(2) + v(3)*v(3) + v(4)*v(4))/(2*v(1)) - inner
                if (abs(changed) < jolt*inner .and. is_kept(floors, u, v)) exit
            end if
            part = part/2
        end do
        if (halvings > 60) return
        ! products only as far as their share stays within 0..1
        released = part == 1 .and. v(6) >= 0 .and. v(6) <= v(1)
        v(6) = max(0.0_rk, min(v(1), v(6)))
        ! the deferred source loses exactly what the gas gains
        do i = 1, 6
            d(i) = v(i) - u(i)
            deferred(i) = deferred(i) - d(i)
            u(i) = v(i)
            if (released .or. (part == 1 .and. i < 6)) deferred(i) = 0
        end do
    end subroutine release_deferred
end module brz_cell_store_rules
