! SPDX-License-Identifier: MIT
!> Gas that comes in through open faces of the box: its state as a history.
!>
!> An open boundary answers the gas inside by a Riemann problem with the gas outside (brz_outflow).
!> Here that gas changes with time. So what comes faster than sound is given as a whole, what comes
!> slower meets the waves from inside, and these leave.
!>
!> A wave of a given overpressure into the undisturbed air: what rises is a shock (Rankine and
!> Hugoniot), what falls expands along the isentrope and the characteristic of the highest pressure
!> so far, u - 2c/(gamma - 1) as it was there. Exact for a step, and for a fall until its waves
!> reach the shock; a rise without a shock errs in the third order of its strength.
module brz_inflow
    use brz_case, only: inflow_case_t
    use brz_inflow_history, only: inflow_t
    use brz_kinds, only: dp, rk
    use brz_gas, only: to_conserved
    use brz_scheme, only: max_var
    use brz_time_table, only: mean_over, value_at
    implicit none
    private
    public :: make_inflow, state_over, gas_over, fastest_over, wave_state

contains

    !> From the deck.
    pure subroutine make_inflow(input, gamma, density, pressure, inflow)
        type(inflow_case_t), intent(in) :: input
        real(rk), intent(in) :: gamma, density, pressure !! of the undisturbed air
        type(inflow_t), intent(out) :: inflow

        inflow%axis = input%axis
        inflow%side = input%side
        inflow%gamma = gamma
        inflow%rest = real([density, pressure], dp)
        inflow%wave = input%wave
        inflow%time = input%time
        inflow%state = input%state
        inflow%overpressure = input%overpressure
    end subroutine make_inflow

    !> Mean density, velocity along x, y, z and pressure over a step.
    pure function state_over(inflow, from, dt) result(w)
        type(inflow_t), intent(in) :: inflow
        real(dp), intent(in) :: from, dt !! start of the step, its length [s]
        real(dp) :: w(5)
        integer :: c

        if (inflow%wave) then
            w = wave_at(inflow, mean_over(inflow%time, inflow%overpressure, from, dt, .false.), &
                        from + dt)
            return
        end if
        do c = 1, 5
            w(c) = mean_over(inflow%time, inflow%state(:, c), from, dt, .true.)
        end do
    end function state_over

    !> Conserved variables of this state.
    pure function gas_over(inflow, from, dt) result(q)
        type(inflow_t), intent(in) :: inflow
        real(dp), intent(in) :: from, dt !! [s]
        real(rk) :: q(max_var)

        q = 0
        call to_conserved(real(inflow%gamma, rk), real(state_over(inflow, from, dt), rk), q)
    end function gas_over

    !> Sum over the directions of the fastest waves that come in within a time, in cells per time.
    pure real(dp) function fastest_over(inflow, dx, from, dt) result(fastest)
        type(inflow_t), intent(in) :: inflow
        real(dp), intent(in) :: dx(3) !! cell sides, huge in directions that are not modelled [m]
        real(dp), intent(in) :: from, dt !! [s]
        integer :: i

        fastest = max(speed_at(from), speed_at(from + dt))
        do i = 1, size(inflow%time)
            if (inflow%time(i) > from .and. inflow%time(i) < from + dt) &
                fastest = max(fastest, speed_at(inflow%time(i)))
        end do

    contains

        pure real(dp) function speed_at(at)
            real(dp), intent(in) :: at !! [s]
            real(dp) :: w(5)
            integer :: c

            if (inflow%wave) then
                w = wave_at(inflow, value_at(inflow%time, inflow%overpressure, at, .false.), at)
            else
                do c = 1, 5
                    w(c) = value_at(inflow%time, inflow%state(:, c), at, .true.)
                end do
            end if
            speed_at = sum((abs(w(2:4)) + sqrt(inflow%gamma*w(5)/w(1)))/dx)
        end function speed_at
    end function fastest_over

    !> State of a wave of an overpressure, which has been as high as the history was until a time.
    pure function wave_at(inflow, overpressure, until) result(w)
        type(inflow_t), intent(in) :: inflow
        real(dp), intent(in) :: overpressure, until !! [Pa], [s]
        real(dp) :: w(5), state(3), highest
        integer :: i

        highest = max(0.0_dp, overpressure, &
                      value_at(inflow%time, inflow%overpressure, until, .false.))
        do i = 1, size(inflow%time)
            if (inflow%time(i) <= until) highest = max(highest, inflow%overpressure(i))
        end do
        state = wave_state(inflow%gamma, inflow%rest, overpressure, highest)
        w = 0
        w([1, 1 + inflow%axis, 5]) = state
        if (inflow%side == 2) w(1 + inflow%axis) = -state(2)
    end function wave_at

    !> Density, velocity and pressure behind a wave that runs into gas at rest.
    pure function wave_state(gamma, rest, overpressure, highest) result(state)
        real(dp), intent(in) :: gamma !! ratio of specific heats [-]
        real(dp), intent(in) :: rest(2) !! density and pressure of that gas
        real(dp), intent(in) :: overpressure !! now [Pa]
        real(dp), intent(in) :: highest !! overpressure that came before, or now [Pa]
        real(dp) :: state(3), ratio, g, c_shock, c

        ratio = 1 + highest/rest(2)
        g = (gamma - 1)/(gamma + 1)
        state(1) = rest(1)*(ratio + g)/(g*ratio + 1)
        state(2) = highest/sqrt(rest(1)*(gamma*rest(2) + (gamma + 1)/2*highest))
        state(3) = rest(2) + highest
        if (overpressure >= highest) return
        c_shock = sqrt(gamma*state(3)/state(1))
        state(1) = state(1)*((rest(2) + overpressure)/state(3))**(1/gamma)
        state(3) = rest(2) + overpressure
        c = sqrt(gamma*state(3)/state(1))
        state(2) = state(2) - 2/(gamma - 1)*(c_shock - c)
    end function wave_state
end module brz_inflow
