! SPDX-License-Identifier: MIT
!> One time step of a blast in one dimension: two stages of a finite-volume method on moving cells.
!>
!> Second order: limited slopes of density, velocity, pressure and internal energy (van Leer), the
!> exact solution of the jump at the contact, HLLC at all other faces, Heun's method in time. What a
!> face sweeps is counted in r**(power+1), so that moving the faces alone changes no state, and the
!> pressure stands in differences, so that a uniform one moves nothing.
module brz_blast1d_step
    use brz_blast1d_mesh, only: follow_front, refine_air
    use brz_blast1d_reconstruct, only: face_state, prepare
    use brz_blast1d_state, only: area_at, blast1d_t, burn_width, place_faces
    use brz_kinds, only: dp
    use brz_moving_flux, only: moving_flux
    implicit none
    private
    public :: advance_blast1d

    integer, parameter :: most_attempts = 4 !! to find the cells that must do without slopes
    integer, parameter :: most_halvings = 12 !! of a time step
    integer, parameter :: most_steps = 1000000 !! of a blast; more of them lead nowhere
    integer, parameter :: ramp = 20 !! first steps, over which the time step grows from a tenth

contains

    !> One step, no longer than `longest`. Fails (ok = .false.) where a state is lost at any step.
    subroutine advance_blast1d(blast, longest, ok)
        type(blast1d_t), intent(inout) :: blast
        real(dp), intent(in) :: longest !! [s]
        logical, intent(out) :: ok
        real(dp) :: dt, outer
        integer :: attempt

        call refine_air(blast)
        call prepare(blast, blast%time)
        call follow_front(blast, outer)
        dt = min(stable_step(blast, outer), longest)
        blast%r_start = blast%r
        blast%xi_start = blast%xi
        blast%q_start = blast%q
        do attempt = 1, most_halvings ! a shock that collapses on the centre may ask for more steps
            call both_stages(blast, outer, dt, ok)
            if (ok) exit
            dt = dt/2
            blast%r = blast%r_start
            blast%xi = blast%xi_start
            blast%q = blast%q_start
            call prepare(blast, blast%time)
        end do
        call burn_on(blast, dt)
        blast%time = blast%time + dt
        blast%cycle = blast%cycle + 1
        ok = ok .and. blast%cycle < most_steps
        if (blast%burning) blast%burning = blast%time*blast%input%velocity <= &
            blast%input%radius*(1 + burn_width/blast%n_in)
    end subroutine advance_blast1d

    !> What the products set free by burning with the air in one step.
    subroutine burn_on(blast, dt)
        type(blast1d_t), intent(inout) :: blast
        real(dp), intent(in) :: dt !! [s]
        real(dp) :: energy

        associate (in => blast%input)
            if (.not. (in%afterburn > 0 .and. blast%time < in%afterburn_time)) return
            energy = in%afterburn*min(dt, in%afterburn_time - blast%time)/in%afterburn_time
        end associate
        blast%q(3, :blast%n_in) = blast%q(3, :blast%n_in) + energy*blast%q(1, :blast%n_in)
        blast%burnt_on = blast%burnt_on + energy
    end subroutine burn_on

    !> Heun's method: the second stage goes from the mean of both states over half the step.
    subroutine both_stages(blast, outer, dt, ok)
        type(blast1d_t), intent(inout) :: blast !! prepared
        real(dp), intent(in) :: outer !! velocity of the last face [m/s]
        real(dp), intent(in) :: dt !! [s]
        logical, intent(out) :: ok !! every cell kept its mass and internal energy
        integer :: ends(2)

        ends = [blast%n_in, blast%n]
        blast%xi_old = blast%xi
        blast%q_old = blast%q
        call stage(blast, blast%xi_old(ends) + dt*ends_swept(blast, outer), dt, ok)
        if (.not. ok) return
        call prepare(blast, blast%time + dt)
        blast%xi_old = (blast%xi_start + blast%xi)/2
        blast%q_old = (blast%q_start + blast%q)/2
        call stage(blast, blast%xi_old(ends) + dt/2*ends_swept(blast, outer), dt/2, ok)
    end subroutine both_stages

    !> What the contact and the last face sweep per time.
    pure function ends_swept(blast, outer) result(swept)
        type(blast1d_t), intent(in) :: blast
        real(dp), intent(in) :: outer !! velocity of the last face [m/s]
        real(dp) :: swept(2)

        swept = area_at(blast%input%power, blast%r([blast%n_in, blast%n]))*[blast%contact, outer]
    end function ends_swept

    !> Courant's limit on the moving cells, shorter in the first steps.
    pure real(dp) function stable_step(blast, outer) result(dt)
        type(blast1d_t), intent(in) :: blast
        real(dp), intent(in) :: outer !! velocity of the last face [m/s]
        real(dp) :: fastest, inside, w(2), part
        integer :: i

        fastest = 0
        inside = blast%r(blast%n_in)
        do i = 1, blast%n
            if (i <= blast%n_in) then
                w = blast%contact*blast%r(i - 1:i)/inside
            else
                part = 1/(blast%r(blast%n) - inside)
                w = blast%contact + (outer - blast%contact)*part*(blast%r(i - 1:i) - inside)
            end if
            associate (u => blast%state(2, i), c => blast%state(5, i))
                fastest = max(fastest, (max(abs(u - w(1)), abs(u - w(2))) + c) &
                    /(blast%r(i) - blast%r(i - 1)))
            end associate
        end do
        dt = blast%input%cfl/fastest
        if (blast%cycle < ramp) dt = dt*(0.1_dp + 0.9_dp*blast%cycle/ramp)
    end function stable_step

    !> From xi_old and q_old over dt, with the rates of the present state, to new faces. Where a
    !> cell would lose its mass or its internal energy, it and its neighbours do without slopes.
    subroutine stage(blast, ends, dt, ok)
        type(blast1d_t), intent(inout) :: blast
        real(dp), intent(in) :: ends(2) !! xi of the contact and of the last face afterwards
        real(dp), intent(in) :: dt !! [s]
        logical, intent(out) :: ok !! no cell is lost
        real(dp) :: radius(2)
        integer :: attempt, lost

        associate (n => blast%n, power => blast%input%power)
            ok = .false.
            if (.not. (ends(1) > 0 .and. ends(2) > ends(1))) return
            radius = ((power + 1)*ends)**(1.0_dp/(power + 1))
            call place_faces(blast, radius(1), radius(2))
            blast%swept(:n) = (blast%r_new(:n)**(power + 1)/(power + 1) - blast%xi_old(:n))/dt
            do attempt = 1, most_attempts
                call fluxes(blast)
                call add_fluxes(blast, dt)
                call flatten(blast, lost)
                ok = lost == 0
                if (ok) exit
            end do
            blast%r(:n) = blast%r_new(:n)
            blast%xi(:n) = blast%r(:n)**(power + 1)/(power + 1)
        end associate
    end subroutine stage

    !> Change the conserved sums by what the fluxes bring over dt.
    subroutine add_fluxes(blast, dt)
        type(blast1d_t), intent(inout) :: blast
        real(dp), intent(in) :: dt !! [s]
        real(dp) :: area(2), p
        integer :: i

        do i = 1, blast%n
            area = area_at(blast%input%power, blast%r(i - 1:i))
            p = blast%state(3, i)
            if (i == 1) p = blast%flux(4, 0) ! at the centre what flows in must come to rest
            associate (f => blast%flux(:, i - 1:i))
                blast%q(:, i) = blast%q_old(:, i) + dt*(f(:3, 1) - f(:3, 2))
                blast%q(2, i) = blast%q(2, i) + dt*(area(1)*(f(4, 1) - p) - area(2)*(f(4, 2) - p))
            end associate
        end do
    end subroutine add_fluxes

    !> Take the slopes out of cells that are lost, and out of their neighbours.
    subroutine flatten(blast, lost)
        type(blast1d_t), intent(inout) :: blast
        integer, intent(out) :: lost !! cells
        integer :: i

        lost = 0
        do i = 1, blast%n
            associate (q => blast%q(:, i))
                if (q(1) > 0 .and. q(3)*q(1) > q(2)**2/2) cycle
            end associate
            lost = lost + 1
            blast%slope(:, max(i - 1, 1):min(i + 1, blast%n)) = 0
        end do
    end subroutine flatten

    !> Fluxes through all faces, times their area. Nothing crosses the centre and the contact.
    subroutine fluxes(blast)
        type(blast1d_t), intent(inout) :: blast
        real(dp) :: below(5), above(5), area, f(3), p
        integer :: i

        call face_state(blast, 1, 0, above)
        below = above*[1, -1, 1, 1, 1]
        call moving_flux(below, above, 0.0_dp, f, p)
        blast%flux(:, 0) = [0.0_dp, 0.0_dp, 0.0_dp, p]
        do i = 1, blast%n
            if (i == blast%n_in) then
                p = blast%contact_pressure
                blast%flux(:, i) = [0.0_dp, 0.0_dp, p*blast%swept(i), p]
                cycle
            end if
            area = area_at(blast%input%power, blast%r(i))
            call face_state(blast, i, i, below)
            call face_state(blast, i + 1, i, above)
            call moving_flux(below, above, blast%swept(i)/area, f, p)
            blast%flux(:3, i) = f*area
            blast%flux(4, i) = p
        end do
    end subroutine fluxes
end module brz_blast1d_step
