! SPDX-License-Identifier: MIT
!> Deviatoric stress over one step: exact rotation, elastic trial, radial return.
!>
!> S_new = Q keep (Q S Q^T + 2 G de) Q^T with Q the rotation of half a step and de the increment of
!> the deviatoric strain. Source: Wilkins 1964 (radial return).
!> Point physics: compiled for the CPU and for the GPU.
module brz_deviator
    use brz_algebra, only: double_dot, rotate_voigt, rotation_exp, to_voigt
    use brz_kinds, only: rk
    implicit none
    private
    public :: trial_deviator, return_deviator, mises_stress, third_invariant

contains

    !> The elastic trial, in the axes of mid-step.
    !@cuf attributes(host,device) &
    pure subroutine trial_deviator(g, dt, l, s, q, de, trial)
        real(rk), intent(in) :: g !! shear modulus [Pa]
        real(rk), intent(in) :: dt !! [s]
        real(rk), intent(in) :: l(3, 3) !! velocity gradient at mid-step [1/s]
        real(rk), intent(inout) :: s(6) !! deviator, at the start in, turned to mid-step out [Pa]
        real(rk), intent(out) :: q(3, 3) !! rotation of half a step
        real(rk), intent(out) :: de(6) !! increment of the deviatoric strain (tensor shears)
        real(rk), intent(out) :: trial(6) !! [Pa]
        real(rk) :: mean
        integer :: i

        call rotation_exp(l, dt/2, q)
        call to_voigt(l, de)
        mean = (de(1) + de(2) + de(3))/3
        do i = 1, 3
            de(i) = (de(i) - mean)*dt
            de(i + 3) = de(i + 3)*dt
        end do
        call rotate_voigt(q, s)
        do i = 1, 6
            trial(i) = s(i) + 2*g*de(i)
        end do
    end subroutine trial_deviator

    !> Keep a part of the trial, turn it to the end of the step, and account for the work.
    !>
    !> Plastic work is never negative: elastic energy that a fall of the strength lets go, and the
    !> work of the flow at the stress of the end, which is less than nothing where strain is taken
    !> back while the strength falls. (With the mean stress of the step, as in `work`, flow that
    !> starts or turns round within a step would count half of it or less than nothing.)
    !@cuf attributes(host,device) &
    pure subroutine return_deviator(g, keep, de, trial, q, s, work, plastic)
        real(rk), intent(in) :: g !! shear modulus [Pa]
        real(rk), intent(in) :: keep !! yield stress over trial stress; 1: elastic
        real(rk), intent(in) :: de(6), trial(6), q(3, 3) !! of trial_deviator
        real(rk), intent(inout) :: s(6) !! deviator, at mid-step in, at the end out [Pa]
        real(rk), intent(out) :: work !! done by it, per volume, stress after the return [J/m3]
        real(rk), intent(out) :: plastic !! plastic work [J/m3]
        real(rk) :: start, last, fall
        integer :: i

        plastic = 0
        if (g > 0 .and. keep < 1) then
            start = double_dot(s, s)
            last = keep**2*double_dot(trial, trial)
            fall = 0
            if (start > last) fall = 1 - sqrt(last/start)
            plastic = (keep*(1 - keep)*double_dot(trial, trial) &
                       - keep*fall*double_dot(trial, s))/(2*g)
            plastic = max(plastic + max(start - last, 0.0_rk)/(4*g), 0.0_rk)
        end if
        do i = 1, 6
            s(i) = (s(i) + keep*trial(i))/2
        end do
        work = double_dot(s, de)
        do i = 1, 6
            s(i) = keep*trial(i)
        end do
        call rotate_voigt(q, s)
    end subroutine return_deviator

    !> Equivalent stress of von Mises of a deviator.
    !@cuf attributes(host,device) &
    pure function mises_stress(s) result(mises)
        real(rk), intent(in) :: s(6)
        real(rk) :: mises

        mises = sqrt(1.5_rk*double_dot(s, s))
    end function mises_stress

    !> Product of the principal values of a deviator.
    !@cuf attributes(host,device) &
    pure function third_invariant(s) result(product)
        real(rk), intent(in) :: s(6) !! xx, yy, zz, xy, yz, xz
        real(rk) :: product

        product = s(1)*(s(2)*s(3) - s(5)**2) - s(4)*(s(4)*s(3) - s(5)*s(6)) &
                  + s(6)*(s(4)*s(5) - s(2)*s(6))
    end function third_invariant
end module brz_deviator
