! SPDX-License-Identifier: MIT
!> What the pressure curve of the Holmquist-Johnson-Cook concrete must fulfil, and where it locks.
module brz_hjc_curve
    use brz_hjc_pressure, only: dense_curve, densest, loading_curve, p_k1, p_k2, p_k3, p_k_el, &
                                p_k_tran, p_mu_crush, p_mu_lock, p_mu_plock, p_p_lock, &
                                unloading_modulus
    use brz_kinds, only: rk
    use brz_material, only: n_par
    use brz_text, only: to_text
    implicit none
    private
    public :: check_dense, check_slopes, lock_compression

contains

    !> The cubic must rise over its whole range.
    subroutine check_dense(par, fault)
        real(rk), intent(in) :: par(n_par)
        character(:), allocatable, intent(inout) :: fault
        real(rk) :: x(3), p, slope
        integer :: i

        x = [0.0_rk, densest, 0.0_rk]
        if (par(p_k3) > 0) x(3) = min(max(-par(p_k2)/(3*par(p_k3)), 0.0_rk), densest)
        do i = 1, 3
            call dense_curve(par, par(p_mu_lock) + x(i)*(1 + par(p_mu_lock)), p, slope)
            if (.not. slope > 0) fault = 'k1 + 2 k2 x + 3 k3 x^2 must be positive for x from 0 '// &
                'to 1: the pressure must rise with the compression'
        end do
    end subroutine check_dense

    !> Compression at p_lock: root of the cubic, by bisection of a rising function.
    pure function lock_compression(par) result(mu)
        real(rk), intent(in) :: par(n_par)
        real(rk) :: mu, low, high, p, slope
        integer :: i

        low = par(p_mu_lock)
        high = par(p_mu_lock) + 1
        do i = 1, 200
            call dense_curve(par, high, p, slope)
            if (p > par(p_p_lock)) exit
            high = 2*high
        end do
        do i = 1, 200
            mu = (low + high)/2
            call dense_curve(par, mu, p, slope)
            if (p < par(p_p_lock)) then
                low = mu
            else
                high = mu
            end if
        end do
    end function lock_compression

    !> The way back must be steeper than the way there: else a cycle makes energy.
    subroutine check_slopes(par, fault)
        real(rk), intent(in) :: par(n_par)
        character(:), allocatable, intent(inout) :: fault
        real(rk) :: mu, p, slope
        integer :: i
        integer, parameter :: samples = 1000

        if (par(p_k_tran) >= par(p_k_el)) then
            fault = 'the slope of crushing, '//to_text(par(p_k_tran))//' Pa, is not below '// &
                    'the elastic slope p_crush/mu_crush'
            return
        else if (par(p_k_tran) >= par(p_k1)) then
            fault = 'the slope of crushing, '//to_text(par(p_k_tran))//' Pa, is not below k1'
            return
        end if
        do i = 1, samples
            mu = par(p_mu_crush) + (par(p_mu_plock) - par(p_mu_crush))*i/samples
            call loading_curve(par, mu, p, slope)
            if (unloading_modulus(par, mu) > par(p_k_tran)) cycle
            fault = 'crushed material would unload on a softer line than it was loaded on: '// &
                    'raise k1, or p_crush/mu_crush'
            return
        end do
    end subroutine check_slopes
end module brz_hjc_curve
