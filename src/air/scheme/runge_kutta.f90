! SPDX-License-Identifier: MIT
!> Strong-stability-preserving Runge-Kutta methods of two stages (Heun) and three (Shu, Osher 1988).
!>
!> Each stage sets u := u_start + new (u - u_start + dt rate(u)).
module brz_runge_kutta
    use brz_kinds, only: dp, rk
    implicit none
    private
    public :: new_weight, passed_before, share_of, repair_passes

    real(rk), parameter :: new(3, 2:3) = reshape([1.0_rk, 0.5_rk, 0.0_rk, &
        1.0_rk, 0.25_rk, 2/3.0_rk], [3, 2])
    real(dp), parameter :: share(3, 2:3) = reshape([0.5_dp, 0.5_dp, 0.0_dp, &
        1/6.0_dp, 1/6.0_dp, 2/3.0_dp], [3, 2])
    integer, parameter :: repair_passes = 3
    !! of the fallback: a repaired cell may push its neighbour over the edge

contains

    !> Weight of the new state in a stage.
    pure real(rk) function new_weight(stage, n_stages)
        integer, intent(in) :: stage !! from 1
        integer, intent(in) :: n_stages !! 2 or 3

        new_weight = new(stage, n_stages)
    end function new_weight

    !> Part of the step that the state before a stage has made.
    pure real(rk) function passed_before(stage, n_stages) result(passed)
        integer, intent(in) :: stage !! from 1
        integer, intent(in) :: n_stages !! 2 or 3
        integer :: m

        passed = 0
        do m = 1, stage - 1
            passed = new(m, n_stages)*(passed + 1)
        end do
    end function passed_before

    !> Weight of the rates of a stage in the whole step.
    pure real(dp) function share_of(stage, n_stages)
        integer, intent(in) :: stage !! from 1
        integer, intent(in) :: n_stages !! 2 or 3

        share_of = share(stage, n_stages)
    end function share_of
end module brz_runge_kutta
