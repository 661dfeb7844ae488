! SPDX-License-Identifier: MIT
!> What a blast in one dimension needs of its cells before each stage: states, slopes, the contact.
module brz_blast1d_reconstruct
    use brz_blast1d_state, only: blast1d_t, burn_width
    use brz_jwl, only: jwl_pressure, jwl_sound_speed
    use brz_kinds, only: dp
    use brz_products_riemann, only: products_riemann
    implicit none
    private
    public :: prepare, face_state

contains

    !> Derive states, slopes and the contact from faces and conserved sums.
    subroutine prepare(blast, time)
        type(blast1d_t), intent(inout) :: blast
        real(dp), intent(in) :: time !! of the stage, for the detonation [s]
        integer :: i

        do i = 1, blast%n
            call centre(blast, i)
            if (i <= blast%n_in) then
                call products_state(blast, i, time)
            else
                call air_state(blast, i)
            end if
        end do
        associate (in => blast%input, n => blast%n)
            blast%x(0) = -blast%x(1)
            blast%state(:, 0) = blast%state(:, 1)*[1, -1, 1, 1, 1]
            blast%x(n + 1) = 2*blast%r(n) - blast%x(n)
            blast%state(:, n + 1) = [in%density, 0.0_dp, in%pressure, &
                in%pressure/(in%gamma - 1), sqrt(in%gamma*in%pressure/in%density)]
        end associate
        call slopes(blast)
        call contact(blast)
    end subroutine prepare

    !> Centre of mass of an even cell.
    pure subroutine centre(blast, i)
        type(blast1d_t), intent(inout) :: blast
        integer, intent(in) :: i
        real(dp) :: a, b

        a = blast%r(i - 1)
        b = blast%r(i)
        select case (blast%input%power)
        case (0)
            blast%x(i) = (a + b)/2
        case (1)
            blast%x(i) = 2*(a*a + a*b + b*b)/(3*(a + b))
        case default
            blast%x(i) = 3*(a + b)*(a*a + b*b)/(4*(a*a + a*b + b*b))
        end select
    end subroutine centre

    !> State of a cell of air.
    pure subroutine air_state(blast, i)
        type(blast1d_t), intent(inout) :: blast
        integer, intent(in) :: i
        real(dp) :: rho, u, energy, p

        rho = blast%q(1, i)/(blast%xi(i) - blast%xi(i - 1))
        u = blast%q(2, i)/blast%q(1, i)
        energy = rho*max(blast%q(3, i)/blast%q(1, i) - u*u/2, 0.0_dp)
        p = (blast%input%gamma - 1)*energy
        blast%state(:, i) = [rho, u, p, energy, max(sqrt(blast%input%gamma*p/rho), least_speed(u))]
    end subroutine air_state

    !> State of a cell of products; while it burns, pressure in proportion to what has burnt.
    pure subroutine products_state(blast, i, time)
        type(blast1d_t), intent(inout) :: blast
        integer, intent(in) :: i
        real(dp), intent(in) :: time !! [s]
        real(dp) :: rho, u, e, p, c, burnt, width

        rho = blast%q(1, i)/(blast%xi(i) - blast%xi(i - 1))
        u = blast%q(2, i)/blast%q(1, i)
        e = max(blast%q(3, i)/blast%q(1, i) - u*u/2, 0.0_dp)
        p = max(jwl_pressure(blast%input%eos, rho, e), 0.0_dp)
        c = jwl_sound_speed(blast%input%eos, rho, p)
        if (blast%burning) then
            width = burn_width*blast%input%radius/blast%n_in
            burnt = min(max((blast%input%velocity*time - blast%x(i))/width, 0.0_dp), 1.0_dp)
            p = blast%input%pressure + burnt*(p - blast%input%pressure)
            c = c*sqrt(burnt)
        end if
        blast%state(:, i) = [rho, u, p, rho*e, max(c, least_speed(u))]
    end subroutine products_state

    !> A speed of sound that keeps the waves of a gas without pressure apart [m/s].
    pure real(dp) function least_speed(u)
        real(dp), intent(in) :: u !! velocity [m/s]

        least_speed = 1e-3_dp*(1 + abs(u))
    end function least_speed

    !> Slopes between the neighbours (van Leer). Across the contact velocity and pressure go on,
    !> density and energy do not.
    pure subroutine slopes(blast)
        type(blast1d_t), intent(inout) :: blast
        integer :: i, k

        do i = 1, blast%n
            associate (x => blast%x, s => blast%state)
                do k = 1, 4
                    blast%slope(k, i) = van_leer((s(k, i) - s(k, i - 1))/(x(i) - x(i - 1)), &
                        (s(k, i + 1) - s(k, i))/(x(i + 1) - x(i)))
                end do
            end associate
        end do
        blast%slope([1, 4], blast%n_in:blast%n_in + 1) = 0
    end subroutine slopes

    !> Harmonic mean of slopes of one sign, zero otherwise.
    pure elemental real(dp) function van_leer(a, b)
        real(dp), intent(in) :: a, b

        van_leer = 0
        if (a*b > 0) van_leer = 2*a*b/(a + b)
    end function van_leer

    !> State of cell i at face f: density, velocity, pressure, energy per volume, speed of sound.
    pure subroutine face_state(blast, i, f, state)
        type(blast1d_t), intent(in) :: blast
        integer, intent(in) :: i, f
        real(dp), intent(out) :: state(5)

        state = blast%state(:, i)
        if (i <= blast%n) state(:4) = state(:4) + (blast%r(f) - blast%x(i))*blast%slope(:, i)
        state(4) = state(4) + state(1)*state(2)**2/2
    end subroutine face_state

    !> Pressure and velocity at the contact.
    pure subroutine contact(blast)
        type(blast1d_t), intent(inout) :: blast
        real(dp) :: below(5), above(5), z(2)

        call face_state(blast, blast%n_in, blast%n_in, below)
        call face_state(blast, blast%n_in + 1, blast%n_in, above)
        if (blast%burning) then ! the explosive is not all gas: as sound
            z = [below(1)*below(5), above(1)*above(5)]
            blast%contact = (z(1)*below(2) + z(2)*above(2) + below(3) - above(3))/sum(z)
            blast%contact_pressure = (z(2)*below(3) + z(1)*above(3) &
                + z(1)*z(2)*(below(2) - above(2)))/sum(z)
            return
        end if
        below(4) = below(4)/below(1) - below(2)**2/2
        call products_riemann(blast%input%eos, blast%input%gamma, below(:4), above(:3), &
            blast%contact_pressure, blast%contact)
    end subroutine contact
end module brz_blast1d_reconstruct
