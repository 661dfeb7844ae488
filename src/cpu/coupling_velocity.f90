! SPDX-License-Identifier: MIT
!> Velocities of the walls for the next step of the air, from the particles in the solid cells.
module brz_coupling_velocity
    use brz_air_state, only: air_t
    use brz_coupling_state, only: coupling_t
    use brz_kinds, only: dp, rk
    use brz_ledger_rules, only: to_primitive
    use brz_load_rules, only: pushed_velocity
    use brz_solid_state, only: solid_t
    use brz_wall_star, only: wall_star
    implicit none
    private
    public :: set_wall_velocity

contains

    !> Mean velocity of the particles of each solid cell, by mass, carried to the middle of the step.
    subroutine set_wall_velocity(air, solid, coupling, dt)
        type(air_t), intent(in) :: air
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        real(dp), intent(in) :: dt !! of the coming step of the air [s]
        real(rk) :: free, v(3)
        integer :: c

        !$omp parallel do schedule(dynamic, 64) private(free, v)
        do c = 1, coupling%wall%n_cells
            call mean_velocity(solid, coupling, c, v, free)
            if (free > 0 .and. any(coupling%face_of(:, c) > 0)) &
                call push(air, coupling, c, free, real(dt, rk), v)
            coupling%wall%v(:, c) = v
        end do
    end subroutine set_wall_velocity

    !> Velocity of the mass in a cell at the step, and the part of the mass that can move.
    subroutine mean_velocity(solid, coupling, c, v, free)
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(in) :: coupling
        integer, intent(in) :: c !! place in the wall list
        real(rk), intent(out) :: v(3) !! [m/s]
        real(rk), intent(out) :: free !! mass [kg]; 0 where anything is held in place
        real(rk) :: m, half
        integer :: i, p
        logical :: held

        half = real(solid%dt_last/2, rk)
        held = .false.
        m = 0
        v = 0
        do i = coupling%first(c), coupling%first(c + 1) - 1
            p = coupling%binned(i)
            m = m + solid%mass(p)
            if (solid%fixed(p) == 1) then
                held = .true.
            else
                ! the load is in v already, up to the step; the internal forces lag by half a step
                v = v + solid%mass(p)*(solid%v(:, p) + half*solid%a(:, p))
            end if
        end do
        v = v/m
        free = merge(0.0_rk, m, held)
    end subroutine mean_velocity

    !> Let the gas push the wall for half a step: each direction with wall faces by itself.
    subroutine push(air, coupling, c, mass, dt, v)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(in) :: coupling
        integer, intent(in) :: c !! place in the wall list
        real(rk), intent(in) :: mass, dt
        real(rk), intent(inout) :: v(3)
        real(rk) :: area, force, impedance, p, rho, u(5), w(5)
        integer :: d, f, g(3), s, side

        do d = 1, 3
            area = real(product(air%dx)/air%dx(d), rk)
            force = 0
            impedance = 0
            do side = 2*d - 1, 2*d
                f = coupling%face_of(side, c)
                if (f == 0) cycle
                g = coupling%wall%face(1:3, f)
                s = coupling%wall%face(5, f)
                u = air%u(g(1), g(2), g(3), :)
                call to_primitive(u, air%gamma, w)
                call wall_star(w(1), w(1 + d), w(5), v(d), s, air%gamma, p, rho)
                force = force + s*(p - coupling%reference_pressure)*area
                impedance = impedance + sqrt(air%gamma*p*rho)*area
            end do
            if (impedance > 0) v(d) = pushed_velocity(v(d), force, impedance, mass, dt)
        end do
    end subroutine push
end module brz_coupling_velocity
