! SPDX-License-Identifier: MIT
!> What every material update does with the velocity gradient: volume, stretch and rotation.
!>
!> Point physics: compiled for the CPU and for the GPU.
module brz_kinematics
    use brz_kinds, only: rk
    use brz_algebra, only: multiply3, rotation_exp
    implicit none
    private
    public :: volume_step, turn_axes, transposed, exp_minus_1, polar_rotation

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

        if (abs(x) < 0.125_rk) then
            y = x*(1 + x/2*(1 + x/3*(1 + x/4*(1 + x/5*(1 + x/6*(1 + x/7*(1 + x/8*(1 + x/9* &
                (1 + x/10)))))))))
        else
            y = exp(x) - 1
        end if
    end function exp_minus_1

    !> Turn the axes of a material over one step.
    !>
    !> f is the deformation gradient times the rotation to the axes of the unloaded material; its
    !> polar rotation is that of the axes now. f_new = exp(w dt/2) exp(d dt) exp(w dt/2) f: exact
    !> for a pure rotation and for a pure stretch, and reversible. `only_spin`: f forgets the
    !> stretch, the axes turn with w.
    !@cuf attributes(host,device) &
    pure subroutine turn_axes(only_spin, l, dt, f, middle, last, ok)
        logical, intent(in) :: only_spin
        real(rk), intent(in) :: l(3, 3) !! velocity gradient at mid-step [1/s]
        real(rk), intent(in) :: dt !! [s]
        real(rk), intent(inout) :: f(3, 3)
        real(rk), intent(out) :: middle(3, 3) !! axes at mid-step
        real(rk), intent(out) :: last(3, 3) !! axes at the end of the step
        logical, intent(out) :: ok
        real(rk) :: q(3, 3), e(3, 3), t(3, 3), r(3, 3)
        logical :: fine

        call rotation_exp(l, dt/2, q)
        call multiply3(q, f, t)
        if (only_spin) then
            call polar_rotation(t, middle, ok)
            call multiply3(q, middle, last)
            call multiply3(q, middle, f)
        else
            call exp_symmetric(l, dt/2, e)
            call multiply3(e, t, r)
            call polar_rotation(r, middle, fine)
            call multiply3(e, r, t)
            call polar_rotation(t, r, ok)
            ok = ok .and. fine
            call multiply3(q, r, last)
            call multiply3(q, t, f)
        end if
    end subroutine turn_axes

    !> b = a^T for 3x3 matrices.
    !@cuf attributes(host,device) &
    pure subroutine transposed(a, b)
        real(rk), intent(in) :: a(3, 3)
        real(rk), intent(out) :: b(3, 3)
        integer :: i, j

        do j = 1, 3
            do i = 1, 3
                b(i, j) = a(j, i)
            end do
        end do
    end subroutine transposed

    !> exp(s t) of the symmetric part s of l, to the fourth order in |s| t.
    !@cuf attributes(host,device) &
    pure subroutine exp_symmetric(l, t, e)
        real(rk), intent(in) :: l(3, 3) !! velocity gradient [1/s]
        real(rk), intent(in) :: t !! time [s]
        real(rk), intent(out) :: e(3, 3)
        real(rk) :: s(3, 3), s2(3, 3), tail(3, 3)
        integer :: i, j

        do j = 1, 3
            do i = 1, 3
                s(i, j) = (l(i, j) + l(j, i))*t/2
            end do
        end do
        call multiply3(s, s, s2)
        do j = 1, 3
            do i = 1, 3
                e(i, j) = s2(i, j)/12 + s(i, j)/3
            end do
            e(j, j) = e(j, j) + 1
        end do
        call multiply3(s2, e, tail)
        do j = 1, 3
            do i = 1, 3
                e(i, j) = s(i, j) + tail(i, j)/2
            end do
            e(j, j) = e(j, j) + 1
        end do
    end subroutine exp_symmetric

    !> Rotation of the polar decomposition f = r u, by Newton's iteration r <- (r + r^-T)/2.
    !>
    !> Quadratic: three iterations at a strain of 1e-3, five at 0.5. `ok` is false for det f <= 0
    !> or where the iteration did not end.
    !@cuf attributes(host,device) &
    pure subroutine polar_rotation(f, r, ok)
        real(rk), intent(in) :: f(3, 3)
        real(rk), intent(out) :: r(3, 3)
        logical, intent(out) :: ok
        real(rk), parameter :: enough = 1e-8_rk + 30*epsilon(1.0_rk) !! its square is below rounding
        integer, parameter :: most = 20
        real(rk) :: c(3, 3), d, change
        integer :: i, j, n

        do j = 1, 3
            do i = 1, 3
                r(i, j) = f(i, j)
            end do
        end do
        ok = .false.
        do n = 1, most
            call cofactors(r, c)
            d = r(1, 1)*c(1, 1) + r(2, 1)*c(2, 1) + r(3, 1)*c(3, 1)
            if (.not. d > tiny(d)) return
            d = 1/d
            change = 0
            do j = 1, 3
                do i = 1, 3
                    c(i, j) = (c(i, j)*d - r(i, j))/2
                    r(i, j) = r(i, j) + c(i, j)
                    change = change + abs(c(i, j))
                end do
            end do
            if (change <= enough) exit
        end do
        ok = change <= enough
    end subroutine polar_rotation

    !> Matrix of cofactors of a 3x3 matrix: det(a) a^-T.
    !@cuf attributes(host,device) &
    pure subroutine cofactors(a, c)
        real(rk), intent(in) :: a(3, 3)
        real(rk), intent(out) :: c(3, 3)

        c(1, 1) = a(2, 2)*a(3, 3) - a(2, 3)*a(3, 2)
        c(2, 1) = a(1, 3)*a(3, 2) - a(1, 2)*a(3, 3)
        c(3, 1) = a(1, 2)*a(2, 3) - a(1, 3)*a(2, 2)
        c(1, 2) = a(2, 3)*a(3, 1) - a(2, 1)*a(3, 3)
        c(2, 2) = a(1, 1)*a(3, 3) - a(1, 3)*a(3, 1)
        c(3, 2) = a(1, 3)*a(2, 1) - a(1, 1)*a(2, 3)
        c(1, 3) = a(2, 1)*a(3, 2) - a(2, 2)*a(3, 1)
        c(2, 3) = a(1, 2)*a(3, 1) - a(1, 1)*a(3, 2)
        c(3, 3) = a(1, 1)*a(2, 2) - a(1, 2)*a(2, 1)
    end subroutine cofactors
end module brz_kinematics
