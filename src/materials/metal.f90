! SPDX-License-Identifier: MIT
!> One step of a metal of von Mises, whatever its flow stress.
!>
!> Method:  elastic trial; where it exceeds the flow stress at rest, q - 3 G x = Y(eps_p + x, x/dt,
!>          T) is solved for the plastic strain x of the step; radial return; pressure and energy by
!>          the equation of state; heat from plastic work or from the energy; damage
!> Source:  Wilkins 1964 (radial return); Johnson & Cook 1985 (failure)
!> History: plastic strain; of metals that feel heat temperature, energy on the isentrope
!> Point physics: compiled for the CPU and for the GPU.
module brz_metal
    use brz_algebra, only: double_dot
    use brz_flow_list, only: feels_heat, flow_of, heat_of
    use brz_isentrope, only: isentrope_step, isentrope_temperature
    use brz_isotropic, only: begin_step, end_step, fail_step, on_surface, stride_t
    use brz_johnson_cook_failure, only: failure_strain
    use brz_kinds, only: rk
    use brz_material, only: material_t, n_par, point_t
    use brz_metal_keys, only: by_energy, by_total_rate, fails_by_strain, h_isentrope, h_strain, &
        h_temperature, m_block, m_cutoff, m_d1, m_failure, m_fails, m_fraction, m_heat, m_heating, &
        m_least, m_melt, m_rate, m_rate0, m_room, m_start
    implicit none
    private
    public :: update_metal

    integer, parameter :: most_passes = 50

contains

    !> One step of one material point; see `update_material` for the contract.
    !@cuf attributes(host,device) &
    pure subroutine update_metal(model, material, dt, l, point, status)
        integer, intent(in) :: model !! code of the metal
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: dt !! [s]
        real(rk), intent(in) :: l(3, 3) !! dv_i/dx_j at mid-step [1/s]
        type(point_t), intent(inout) :: point
        integer, intent(out) :: status
        type(stride_t) :: step
        type(point_t) :: before
        real(rk) :: keep, strain, least, hot
        logical :: failed

        call begin_step(material, dt, l, point, step)
        failed = point%damage >= 1
        hot = 0
        if (feels_heat(model)) hot = warmth(material%par, point%hist(h_temperature))
        keep = 0
        strain = 0
        least = max(material%par(m_cutoff), 0.0_rk)
        if (.not. failed .and. hot < 1) then
            call plastic_return(model, material, dt, step, point, hot, strain, keep)
            least = material%par(m_cutoff)
        end if
        before = point
        call end_step(material, material%par(m_block), least, keep, step, point, status)
        if (status > 0) return
        if (failed) call fail_step(material, material%par(m_block), before, step, point)
        point%hist(h_strain) = point%hist(h_strain) + strain
        if (feels_heat(model)) call heat(material, before%mu, step, point)
        if (material%par(m_fails) > 0 .and. strain > 0) &
            call add_damage(material%par, dt, strain, keep*step%mises, step%p, hot, point)
    end subroutine update_metal

    !> Homologous temperature T*, 0 at room temperature and 1 where it melts.
    !@cuf attributes(host,device) &
    pure function warmth(par, temperature) result(hot)
        real(rk), intent(in) :: par(n_par), temperature
        real(rk) :: hot

        hot = min(max((temperature - par(m_room))/(par(m_melt) - par(m_room)), 0.0_rk), 1.0_rk)
    end function warmth

    !> Increment of plastic strain, and the part of the trial stress that is kept.
    !>
    !> The excess of the stress falls with x, so there is one root: Newton's method in a bracket. It
    !> begins with the whole rate as plastic. A step beyond the bracket shows that the root is near
    !> zero, as at the first yield of a law that rises steeply with the rate: there a power of x is
    !> laid through the excess at zero and the excess and slope at hand.
    !@cuf attributes(host,device) &
    pure subroutine plastic_return(model, material, dt, step, point, hot, strain, keep)
        integer, intent(in) :: model
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: dt, hot !! [s], T*
        type(stride_t), intent(in) :: step
        type(point_t), intent(in) :: point !! at the start
        real(rk), intent(out) :: strain, keep
        real(rk), parameter :: least = 1e-12_rk
        real(rk) :: y, slope, by_rate, g3, warm, per_time, low, high, excess, first, fall
        integer :: pass

        g3 = 3*material%shear
        strain = 0
        keep = 1
        warm = heat_of(model, material%par, hot, point%hist(h_temperature))
        per_time = 0
        if (int(material%par(m_rate)) == by_total_rate) per_time = step%rate
        call flow_of(model, material%par, point%hist(h_strain), per_time, warm, y, slope, by_rate)
        if (.not. step%mises > y) return
        first = step%mises - y
        strain = first/g3
        if (int(material%par(m_rate)) /= by_total_rate) then
            if (dt > 0) per_time = 1/dt
            low = 0
            high = strain
            if (step%rate > 0) strain = min(high, dt*step%rate)
            do pass = 1, most_passes
                call flow_of(model, material%par, point%hist(h_strain) + strain, strain*per_time, &
                             warm, y, slope, by_rate)
                excess = step%mises - g3*strain - y
                if (abs(excess) <= on_surface*y + 4*epsilon(y)*step%mises) exit
                if (excess > 0) then
                    low = strain
                else
                    high = strain
                end if
                fall = g3 + slope + by_rate*per_time
                strain = strain + excess/fall
                if (strain > low .and. strain < high) cycle
                strain = sqrt(low*high)
                if (.not. low > 0) strain = high*max(least, (first/(first - excess)) &
                                                     **((first - excess)/(fall*high)))
            end do
        end if
        keep = max(0.0_rk, 1 - g3*strain/step%mises)
    end subroutine plastic_return

    !> Temperature at the end of the step.
    !@cuf attributes(host,device) &
    pure subroutine heat(material, mu_old, step, point)
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: mu_old !! compression at the start
        type(stride_t), intent(in) :: step
        type(point_t), intent(inout) :: point
        real(rk) :: elastic, cold

        if (int(material%par(m_heating)) /= by_energy) then
            point%hist(h_temperature) = point%hist(h_temperature) + &
                                        material%par(m_fraction)*point%work(1)/material%par(m_heat)
            return
        end if
        call isentrope_step(material%par(m_block), mu_old, step%mu, point%hist(h_isentrope))
        cold = isentrope_temperature(material%par(m_block), step%mu, material%par(m_start))
        elastic = double_dot(step%s, step%s)/(4*material%shear*material%density*(1 + step%mu))
        point%hist(h_temperature) = max(0.0_rk, cold + (point%energy - elastic - &
                                        point%hist(h_isentrope))/material%par(m_heat))
    end subroutine heat

    !> Damage D is plastic over failure strain, or grows by it; at 1 the material has failed.
    !@cuf attributes(host,device) &
    pure subroutine add_damage(par, dt, strain, mises, p, hot, point)
        real(rk), intent(in) :: par(n_par), dt, strain
        real(rk), intent(in) :: mises, p !! at the end of the step [Pa]
        real(rk), intent(in) :: hot !! T*
        type(point_t), intent(inout) :: point
        real(rk) :: triaxiality, ratio
        real(rk), parameter :: lowest = -10, highest = 1.5_rk

        if (int(par(m_fails)) == fails_by_strain) then
            point%damage = min(1.0_rk, point%hist(h_strain)/par(m_failure))
            return
        end if
        triaxiality = lowest
        if (p < -highest*mises) triaxiality = highest
        if (abs(p) < -lowest*mises) triaxiality = min(-p/mises, highest)
        ratio = 0
        if (dt > 0) ratio = strain/(par(m_rate0)*dt)
        point%damage = min(1.0_rk, point%damage + strain/ &
                           failure_strain(par(m_d1), par(m_least), triaxiality, ratio, hot))
    end subroutine add_damage
end module brz_metal
