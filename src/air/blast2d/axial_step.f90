! SPDX-License-Identifier: MIT
!> One time step of a blast in the plane through an axis: finite volumes of two stages.
!>
!> Rings of cells with their true faces and volumes; the pressure stands in differences to that of
!> the cell, so that a uniform one moves nothing. Limited slopes of density, velocity, pressure,
!> internal energy and mass fraction, HLLC, Heun's method. Only the rows and columns that the blast
!> can have reached are computed.
module brz_axial_step
    use brz_axial_flux, only: limited_slopes, riemann_row
    use brz_axial_products, only: gas_state
    use brz_axial_state, only: axial_t, margin_cells, v_energy, v_products, v_r, v_rho, v_z, &
        w_energy, w_p, w_part, w_r, w_rho, w_sound, w_z
    use brz_axial_window, only: find_front, follow_front, axial_window_t
    use brz_kinds, only: dp
    implicit none
    private
    public :: advance_axial

    integer, parameter :: most_attempts = 14 !! of a step
    integer, parameter :: smooth_attempts = 4 !! of these with the whole step
    integer, parameter :: most_steps = 1000000
    integer, parameter :: ramp = 20 !! first steps, over which the time step grows from a tenth
    real(dp), parameter :: burn_width = 2 !! of the front of the detonation, in cells
    real(dp), parameter :: least = 1e-6_dp !! pressure over that of the undisturbed air

contains

    !> One step, no longer than `longest`. Fails (ok = .false.) where a state is lost at any step.
    subroutine advance_axial(blast, longest, ok)
        type(axial_t), intent(inout) :: blast
        real(dp), intent(in) :: longest !! [s]
        logical, intent(out) :: ok
        type(axial_window_t) :: window
        real(dp) :: dt
        integer :: attempt, lost

        call follow_front(blast, window)
        call prepare_axial(blast, blast%time, window)
        dt = min(stable_step(blast, window), longest)
        associate (w => window)
            blast%u_start(:w%columns, :, w%low:w%high) = blast%u(:w%columns, :, w%low:w%high)
            do attempt = 1, most_attempts
                call stage(blast, window, 0.0_dp, dt, lost)
                if (lost == 0) then
                    call prepare_axial(blast, blast%time + dt, window)
                    call stage(blast, window, 0.5_dp, dt, lost)
                end if
                ok = lost == 0
                if (ok) exit
                if (attempt >= smooth_attempts) dt = dt/2
                blast%u(:w%columns, :, w%low:w%high) = blast%u_start(:w%columns, :, w%low:w%high)
                call prepare_axial(blast, blast%time, window)
            end do
            if (attempt > 1) blast%smooth = 1
        end associate
        blast%time = blast%time + dt
        blast%cycle = blast%cycle + 1
        ok = ok .and. blast%cycle < most_steps
        if (blast%burning) blast%burning = maxval(blast%lit_at) &
            + burn_width*max(blast%dr, blast%dz)/blast%input%velocity > blast%time
        call prepare_axial(blast, blast%time, window)
        call find_front(blast, window)
    end subroutine advance_axial

    !> Courant's limit on the sum over both directions, shorter in the first steps.
    real(dp) function stable_step(blast, window) result(dt)
        type(axial_t), intent(in) :: blast
        type(axial_window_t), intent(in) :: window
        real(dp) :: fastest
        integer :: i, j

        fastest = 0
        !$omp parallel do private(i) reduction(max: fastest) if(window%wide)
        do j = window%low, window%high
            do i = 1, window%columns
                associate (w => blast%w(i, :, j))
                    fastest = max(fastest, (abs(w(w_r)) + w(w_sound))/blast%dr &
                        + (abs(w(w_z)) + w(w_sound))/blast%dz)
                end associate
            end do
        end do
        !$omp end parallel do
        if (blast%burning) fastest = max(fastest, &
            blast%input%velocity*(1/blast%dr + 1/blast%dz))
        dt = blast%input%cfl/fastest
        if (blast%cycle < ramp) dt = dt*(0.1_dp + 0.9_dp*blast%cycle/ramp)
    end function stable_step

    !> Derive states and their ghosts from the conserved sums.
    subroutine prepare_axial(blast, time, window)
        type(axial_t), intent(inout) :: blast
        real(dp), intent(in) :: time !! of the stage, for the detonation [s]
        type(axial_window_t), intent(in) :: window
        integer :: j

        !$omp parallel do if(window%wide)
        do j = window%low, window%high
            call prepare_row(blast, time, window%columns, j, blast%w(:, :, j))
        end do
        !$omp end parallel do
        call fill_outside(blast, window)
    end subroutine prepare_axial

    !> States of one row, mirrored at the axis.
    pure subroutine prepare_row(blast, time, n, j, w)
        type(axial_t), intent(in) :: blast
        real(dp), intent(in) :: time !! [s]
        integer, intent(in) :: n, j
        real(dp), intent(inout) :: w(-1:, :) !! (-1:n+2, 7)
        real(dp) :: burnt, width
        integer :: i, c

        width = burn_width*max(blast%dr, blast%dz)/blast%input%velocity
        burnt = 1
        associate (u => blast%u(:, :, j))
            do i = 1, n
                w(i, w_rho) = u(i, v_rho)
                w(i, w_r) = u(i, v_r)/u(i, v_rho)
                w(i, w_z) = u(i, v_z)/u(i, v_rho)
                w(i, w_part) = min(max(u(i, v_products)/u(i, v_rho), 0.0_dp), 1.0_dp)
                w(i, w_energy) = u(i, v_energy) - 0.5_dp*(u(i, v_r)*w(i, w_r) + u(i, v_z)*w(i, w_z))
                if (blast%burning) &
                    burnt = min(max((time - blast%lit_at(i, j))/width, 0.0_dp), 1.0_dp)
                call gas_state(blast%gas, u(i, v_rho), u(i, v_products), w(i, w_energy), burnt, &
                    least*blast%input%pressure, w(i, w_p), w(i, w_sound))
            end do
            do c = 1, 7
                w(0, c) = w(1, c)
                w(-1, c) = w(2, c)
            end do
            w(-1:0, w_r) = -w(-1:0, w_r)
        end associate
    end subroutine prepare_row

    !> Ghosts around the window: undisturbed air at the edge of the plane, the mirror image below
    !> a floor; between window and edge the states are those of rest since the last merging.
    subroutine fill_outside(blast, window)
        type(axial_t), intent(inout) :: blast
        type(axial_window_t), intent(in) :: window
        integer :: k

        if (.not. (blast%below >= 0 .and. window%low == blast%low)) return
        do k = 1, 2
            blast%w(:, :, blast%low - k) = blast%w(:, :, blast%low + k - 1)
            blast%w(:, w_z, blast%low - k) = -blast%w(:, w_z, blast%low - k)
        end do
    end subroutine fill_outside

    !> From the present state over dt, mixed with a part of that at the start of the step. Cells
    !> that are lost, and their neighbours, do without slopes from now on.
    subroutine stage(blast, window, part, dt, lost)
        type(axial_t), intent(inout) :: blast !! prepared
        type(axial_window_t), intent(in) :: window
        real(dp), intent(in) :: part
        real(dp), intent(in) :: dt !! [s]
        integer, intent(out) :: lost !! cells
        integer :: j

        associate (n => window%columns, low => window%low, high => window%high)
            !$omp parallel do if(window%wide)
            do j = low - 1, high + 1
                call slopes_along(blast, n, j)
                if (j >= low .and. j <= high) &
                    call fluxes_outwards(blast, n, j, blast%w(:, :, j), blast%flux_r(:, :, j))
            end do
            !$omp end parallel do
            !$omp parallel do if(window%wide)
            do j = low - 1, high
                call fluxes_along(blast, n, j)
            end do
            !$omp end parallel do
            !$omp parallel do if(window%wide)
            do j = low, high
                call update_row(blast, part, dt, blast%w(1:n, w_p, j), blast%flux_r(:, :, j), &
                    blast%flux_z(:, :, j - 1:j), blast%u_start(:, :, j), blast%u(:, :, j))
            end do
            !$omp end parallel do
            lost = 0
            do j = low, high
                call flatten(blast, n, j, lost)
            end do
        end associate
    end subroutine stage

    !> Half the limited differences along z.
    subroutine slopes_along(blast, n, j)
        type(axial_t), intent(inout) :: blast
        integer, intent(in) :: n, j
        real(dp) :: one(n)
        integer :: c

        one = 1
        associate (w => blast%w, smooth => blast%smooth(1:n, j))
            do c = 1, 6
                call limited_slopes(n, w(1:n, c, j - 1), w(1:n, c, j), w(1:n, c, j + 1), one, one, &
                    0.5_dp*smooth, blast%slope(1:n, c, j))
            end do
        end associate
    end subroutine slopes_along

    !> Fluxes through the faces along r of one row.
    pure subroutine fluxes_outwards(blast, n, j, w, flux)
        type(axial_t), intent(in) :: blast
        integer, intent(in) :: n, j
        real(dp), intent(in) :: w(-1:, :) !! (-1:n+2, 7)
        real(dp), intent(inout) :: flux(0:, :) !! (0:n, 6)
        real(dp) :: l(0:n, 7), r(0:n, 7), slope(0:n + 1), over(-1:n + 1)
        integer :: c, i

        associate (x => blast%x)
            over = 1/(x(0:n + 2) - x(-1:n + 1))
            do c = 1, 6
                call limited_slopes(n + 2, w(-1:n, c), w(0:n + 1, c), w(1:n + 2, c), over(-1:n), &
                    over(0:n + 1), blast%smooth(0:n + 1, j), slope)
                do i = 0, n
                    l(i, c) = w(i, c) + (i - x(i))*slope(i)
                    r(i, c) = w(i + 1, c) + (i - x(i + 1))*slope(i + 1)
                end do
            end do
            l(:, 7) = w(0:n, 7)
            r(:, 7) = w(1:n + 1, 7)
            call riemann_row(n + 1, w_r, l, r, flux(0:n, :))
        end associate
    end subroutine fluxes_outwards

    !> Fluxes through the upper faces of one row.
    subroutine fluxes_along(blast, n, j)
        type(axial_t), intent(inout) :: blast
        integer, intent(in) :: n, j
        real(dp) :: l(n, 7), r(n, 7)
        integer :: c

        do c = 1, 6
            l(:, c) = blast%w(1:n, c, j) + blast%slope(1:n, c, j)
            r(:, c) = blast%w(1:n, c, j + 1) - blast%slope(1:n, c, j + 1)
        end do
        l(:, 7) = blast%w(1:n, 7, j)
        r(:, 7) = blast%w(1:n, 7, j + 1)
        call riemann_row(n, w_z, l, r, blast%flux_z(1:n, :, j))
    end subroutine fluxes_along

    !> Change the sums of one row by what the fluxes bring over dt.
    pure subroutine update_row(blast, part, dt, p, f, along, start, u)
        type(axial_t), intent(in) :: blast
        real(dp), intent(in) :: part !! of the state at the start of the step
        real(dp), intent(in) :: dt !! [s]
        real(dp), intent(in) :: p(:) !! (columns) pressures
        real(dp), intent(in) :: f(0:, :) !! (0:n, 6) fluxes along r
        real(dp), intent(in) :: along(0:, :, :) !! (0:n, 6, 2) fluxes along z, below and above
        real(dp), intent(in) :: start(:, :) !! sums at the start of the step
        real(dp), intent(inout) :: u(:, :) !! sums
        integer, parameter :: row(5) = [1, 3, 2, 4, 5] !! of the fluxes along z
        real(dp), dimension(size(p)) :: rate, inner, outer, held
        integer :: c, i, n

        n = size(p)
        do i = 1, n ! faces over the volume of their ring
            inner(i) = (i - 1)/((i - 0.5_dp)*blast%dr)
            outer(i) = i/((i - 0.5_dp)*blast%dr)
        end do
        held = p
        held(1) = f(0, 6) ! on the axis what flows in must come to rest
        do c = 1, 5
            do i = 1, n
                rate(i) = (inner(i)*f(i - 1, c) - outer(i)*f(i, c)) &
                    + (along(i, row(c), 1) - along(i, row(c), 2))/blast%dz
            end do
            if (c == v_z) rate = rate + (along(1:n, 6, 1) - along(1:n, 6, 2))/blast%dz
            if (c == v_r) rate = rate + (inner*(f(0:n - 1, 6) - held) - outer*(f(1:n, 6) - held))
            u(1:n, c) = part*start(1:n, c) + (1 - part)*(u(1:n, c) + dt*rate)
        end do
    end subroutine update_row

    !> Take the slopes out of cells that are lost, and out of their neighbours.
    subroutine flatten(blast, n, j, lost)
        type(axial_t), intent(inout) :: blast
        integer, intent(in) :: n, j
        integer, intent(inout) :: lost !! cells
        integer :: i

        do i = 1, n
            associate (u => blast%u(i, :, j))
                if (u(v_rho) > 0 .and. u(v_energy)*u(v_rho) > 0.5_dp*(u(v_r)**2 + u(v_z)**2)) cycle
            end associate
            lost = lost + 1
            blast%smooth(i - 1:i + 1, j - 1:j + 1) = 0
        end do
    end subroutine flatten
end module brz_axial_step
