! SPDX-License-Identifier: MIT
!> What a stage of the time integration needs to know.
module brz_air_stage
    use brz_air_grid, only: stage_t
    use brz_air_state, only: air_t, bc_periodic
    use brz_kinds, only: dp, rk
    use brz_positivity, only: floors_of
    use brz_runge_kutta, only: new_weight, passed_before, share_of
    implicit none
    private
    public :: stage_of

contains

    !> Stage m of a step of dt.
    pure function stage_of(air, dt, m) result(stage)
        type(air_t), intent(in) :: air
        real(dp), intent(in) :: dt !! time step [s]
        integer, intent(in) :: m !! stage
        type(stage_t) :: stage
        real(rk) :: share

        stage%dt = real(dt, rk)
        stage%weight = new_weight(m, air%n_stages)
        stage%passed = passed_before(m, air%n_stages)
        stage%first = merge(1, 0, m == 1)
        stage%floors = floors_of(air%fallback, air%scheme%gamma, air%rho_rest, air%p_rest)
        share = real(share_of(m, air%n_stages), rk)*stage%dt
        stage%leaves = share*(product(air%dx)/air%dx)
        stage%push = share*real(product(air%dx)/air%dx, rk)
        where (air%bc(1, :) == bc_periodic) stage%leaves = 0
    end function stage_of
end module brz_air_stage
