! SPDX-License-Identifier: MIT
!> The coupling of Chen et al. as printed, to compare with: solid cells are filled with gas before
!> every stage, ordinary fluxes run through them, and the force is what they would do to that gas.
!>
!> It loses mass and lets gas through thin solids: docs/theory/coupling.md shows how much.
module brz_coupling_paper
    use brz_air_state, only: air_t
    use brz_cell_shells, only: neighbour_or_image
    use brz_coupling_state, only: coupling_t
    use brz_gas, only: to_conserved
    use brz_kinds, only: dp, rk
    use brz_paper_rules, only: add_neighbour, filled_state, paper_force
    use brz_scheme, only: max_var
    use brz_particles, only: particles_t
    implicit none
    private
    public :: fill_solid_cells, add_forces

contains

    !> Fill the solid cells with gas: those that touch gas from the gas around, the others at rest.
    subroutine fill_solid_cells(air, coupling)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(in) :: coupling
        real(rk) :: u(max_var), v(3)
        integer :: c, ijk(3)

        do c = 1, coupling%wall%n_cells
            ijk = coupling%wall%cell(:, c)
            v = coupling%wall%v(:, c)
            u(6) = 0
            if (any(coupling%wall%face_of(:, c) > 0)) then
                call blend(air, coupling, ijk, v, u)
            else
                call to_conserved(air%scheme%gamma, [air%rho_rest, v, air%p_rest], u)
            end if
            air%u(ijk(1), ijk(2), ijk(3), :) = u(:air%n_var)
        end do
    end subroutine fill_solid_cells

    !> State of an interface cell from the gas cells within reach.
    subroutine blend(air, coupling, c, v, u)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(in) :: coupling
        integer, intent(in) :: c(3) !! cell
        real(rk), intent(in) :: v(3) !! of the solid in it
        real(rk), intent(out) :: u(max_var)
        real(rk) :: sums(4), q(max_var), distance
        integer :: m, to(3)
        logical :: inside, turned(3)

        sums = 0
        do m = 1, coupling%shells%first(coupling%shells%n + 1) - 1
            call neighbour_or_image(air%n, coupling%wraps, coupling%box%mirrors, c, &
                                    coupling%shells%offset(:, m), to, turned, inside)
            if (.not. inside) cycle
            if (coupling%wall%solid(to(1), to(2), to(3)) == 1) cycle
            q(6) = 0
            q(:air%n_var) = air%u(to(1), to(2), to(3), :)
            distance = norm2(real(coupling%shells%offset(:, m), rk))
            call add_neighbour(q, distance, sums)
        end do
        call filled_state(sums, v, u)
    end subroutine blend

    !> Add what one stage does to the mean force of the step, and to the sums of impulse and work.
    subroutine add_forces(air, solid, coupling, share, dt)
        type(air_t), intent(in) :: air
        class(particles_t), intent(inout) :: solid
        type(coupling_t), intent(inout) :: coupling
        real(dp), intent(in) :: share !! weight of the stage
        real(dp), intent(in) :: dt !! [s]
        real(rk) :: force(3)
        integer :: c, i, p, ijk(3)

        do c = 1, coupling%wall%n_cells
            ijk = coupling%wall%cell(:, c)
            call paper_force(air%rate(ijk(1), ijk(2), ijk(3), 1:4), coupling%wall%v(:, c), force)
            force = real(share*product(air%dx), rk)*force
            do i = coupling%ends(c) + 1, coupling%ends(c + 1)
                p = coupling%binned(i)
                solid%load(:, p) = solid%load(:, p) &
                                   + force/(coupling%ends(c + 1) - coupling%ends(c))
            end do
            coupling%diagnostics%impulse = coupling%diagnostics%impulse + force*dt
            coupling%diagnostics%work = coupling%diagnostics%work + &
                dt*dot_product(force, coupling%wall%v(:, c))
        end do
    end subroutine add_forces
end module brz_coupling_paper
