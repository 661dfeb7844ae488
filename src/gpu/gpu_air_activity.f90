! SPDX-License-Identifier: MIT
!> Which bricks of the air on the GPU must be computed: see brz_air_activity. The maps stay there.
module brz_gpu_air_activity
    use brz_air_grid, only: layers_around, rest_t
    use brz_air_state, only: air_t, bc_periodic
    use brz_errors, only: error_t
    use brz_gpu_air_state, only: gpu_air_t
    use brz_kinds, only: rk
    use brz_scheme, only: reach_of
    implicit none
    private
    public :: find_awake_bricks

contains

    !> Bring the maps of reached and awake bricks up to date. At the start of a step.
    !>
    !> The first step is computed everywhere, so that all states and fluxes hold gas at rest.
    subroutine find_awake_bricks(gpu, air, err)
        type(gpu_air_t), intent(inout) :: gpu
        type(air_t), intent(in) :: air
        type(error_t), intent(inout) :: err
        type(rest_t) :: rest
        integer :: columns(3), layers(3)

        rest%u = air%rest
        rest%momentum = epsilon(1.0_rk)*sqrt(air%scheme%gamma*air%p_rest*air%rho_rest)
        columns = [air%n(1:2), gpu%grid%bricks(3)]
        call gpu%kernels%air_look(columns, gpu%grid, rest, gpu%u, gpu%bricks%awake, &
                                  gpu%bricks%reached, err)
        call gpu%kernels%air_settle(columns, gpu%grid, gpu%bricks%awake, gpu%bricks%reached, &
                                    gpu%u, err)
        if (air%activity .and. gpu%bricks%swept) then
            layers = layers_around(air%n, air%bc(1, :) == bc_periodic, &
                air%n_stages*reach_of(air%scheme))
            call gpu%bricks%wake%wake_near(product(gpu%grid%bricks), gpu%grid, layers(1), &
                                           layers(2), layers(3), gpu%bricks%reached, &
                                           gpu%bricks%awake, err)
        end if
        gpu%bricks%swept = .true.
    end subroutine find_awake_bricks
end module brz_gpu_air_activity
