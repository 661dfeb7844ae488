! SPDX-License-Identifier: MIT
!> The coupling of Chen et al. as printed, to compare with: solid cells are filled with gas before
!> every stage, ordinary fluxes run through them, and the force is what they would do to that gas.
!>
!> It loses mass and lets gas through thin solids: docs/theory/coupling.md shows how much.
module brz_coupling_paper
    use brz_air_state, only: air_t, bc_symmetry
    use brz_cell_shells, only: make_shells, neighbour_or_image, shells_t
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
        type(shells_t) :: shells
        real(rk) :: u(max_var), v(3)
        integer :: c, ijk(3)

        call make_shells(air%n, shells)
        associate (filled => coupling%wall%filled)
            do c = 1, filled%n
                ijk = filled%cell(:, c)
                v = filled%v(:, c)
                u(6) = 0
                if (filled%touches(c)) then
                    call blend(air, coupling, shells, ijk, v, u)
                else
                    call to_conserved(air%scheme%gamma, [air%rho_rest, v, air%p_rest], u)
                end if
                air%u(ijk(1), ijk(2), ijk(3), :) = u(:air%n_var)
            end do
        end associate
    end subroutine fill_solid_cells

    !> State of an interface cell from the gas cells within reach.
    subroutine blend(air, coupling, shells, c, v, u)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(in) :: coupling
        type(shells_t), intent(in) :: shells
        integer, intent(in) :: c(3) !! cell
        real(rk), intent(in) :: v(3) !! of the solid in it
        real(rk), intent(out) :: u(max_var)
        real(rk) :: sums(4), q(max_var), distance
        integer :: m, to(3)
        logical :: inside, mirrors(2, 3), turned(3)

        sums = 0
        mirrors = air%outer == bc_symmetry .and. spread(air%n > 1, 1, 2)
        do m = 1, shells%first(shells%n + 1) - 1
            call neighbour_or_image(air%n, coupling%wraps, mirrors, c, shells%offset(:, m), to, &
                                    turned, inside)
            if (.not. inside) cycle
            if (coupling%wall%solid(to(1), to(2), to(3)) == 1) cycle
            q(6) = 0
            q(:air%n_var) = air%u(to(1), to(2), to(3), :)
            distance = norm2(real(shells%offset(:, m), rk))
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

        associate (filled => coupling%wall%filled, diagnostics => coupling%diagnostics)
            do c = 1, filled%n
                ijk = filled%cell(:, c)
                call paper_force(air%rate(ijk(1), ijk(2), ijk(3), 1:4), filled%v(:, c), force)
                force = real(share*product(air%dx), rk)*force
                do i = filled%ends(c) + 1, filled%ends(c + 1)
                    p = filled%binned(i)
                    solid%load(:, p) = solid%load(:, p) &
                                       + force/(filled%ends(c + 1) - filled%ends(c))
                end do
                diagnostics%impulse = diagnostics%impulse + force*dt
                diagnostics%work = diagnostics%work + dt*dot_product(force, filled%v(:, c))
            end do
        end associate
    end subroutine add_forces
end module brz_coupling_paper
