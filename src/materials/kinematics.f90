! SPDX-License-Identifier: MIT
!> What every material update does with the velocity gradient: the change of volume.
!>
!> Point physics: compiled for the CPU and for the GPU.
module brz_kinematics
    use brz_kinds, only: rk
    implicit none
    private
    public :: volume_step, exp_minus_1

    real(rk), parameter :: thinnest = -0.999_rk !! least mu: debris, grown a thousandfold

contains

    !> Exact volume change of one step, in a form that keeps small compressions in real32.
    !>
    !> rho_new = rho exp(-tr(d) dt), written for mu = rho/rho0 - 1.
    !@cuf attributes(host,device) &
    pure subroutine volume_step(density, l, dt, mu, dv, v_mid)
        real(rk), intent(in) :: density !! unloaded [kg/m3]
        real(rk), intent(in) :: l(3, 3) !! velocity gradient at mid-step [1/s]
        real(rk), intent(in) :: dt !! [s]
        real(rk), intent(inout) :: mu !! compression, old in, new out [-]
        real(rk), intent(out) :: dv !! change of specific volume [m3/kg]
        real(rk), intent(out) :: v_mid !! mean specific volume of the step [m3/kg]
        real(rk) :: change, ratio_old, ratio_new

        ratio_old = 1 + mu
        change = ratio_old*exp_minus_1(-(l(1, 1) + l(2, 2) + l(3, 3))*dt)
        if (mu + change < thinnest) change = thinnest - mu
        ratio_new = ratio_old + change
        mu = mu + change
        dv = -change/(density*ratio_old*ratio_new)
        v_mid = (ratio_old + ratio_new)/(2*density*ratio_old*ratio_new)
    end subroutine volume_step

    !> exp(x) - 1 without loss of digits for small x; relative error below 4 epsilon.
    !@cuf attributes(host,device) &
    pure function exp_minus_1(x) result(y)
        real(rk), intent(in) :: x
        real(rk) :: y
        real(rk), parameter :: half = 0.5_rk, third = 1/3.0_rk, fourth = 0.25_rk, &
                               fifth = 1/5.0_rk, sixth = 1/6.0_rk, seventh = 1/7.0_rk, &
                               eighth = 0.125_rk, ninth = 1/9.0_rk, tenth = 1/10.0_rk

        if (abs(x) < 0.125_rk) then
            ! the factors are reciprocals, which cost no division
            y = x*(1 + x*half*(1 + x*third*(1 + x*fourth*(1 + x*fifth*(1 + x*sixth*(1 + x*seventh* &
                (1 + x*eighth*(1 + x*ninth*(1 + x*tenth)))))))))
        else
            y = exp(x) - 1
        end if
    end function exp_minus_1
end module brz_kinematics
