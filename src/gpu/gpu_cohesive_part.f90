! SPDX-License-Identifier: MIT
!> Points of cohesive interfaces between a GPU and its host.
module brz_gpu_cohesive_part
    use brz_cohesive_state, only: cohesive_t
    use brz_device_data, only: enter_bytes, enter_data, update_device, update_host
    use brz_errors, only: error_t, failed
    use brz_solid_device, only: solid_device_t
    use brz_kinds, only: int64
    implicit none
    private
    public :: enter_cohesive, fetch_gpu_points, put_points

contains

    !> Copy the interfaces to the GPU.
    subroutine enter_cohesive(glue, err)
        type(cohesive_t), intent(inout) :: glue
        type(error_t), intent(inout) :: err

        call enter_bytes(glue%law, size(glue%law)*(storage_size(glue%law)/8_int64), err)
        call enter_data(glue%bit, err)
        call enter_data(glue%of, err)
        call enter_data(glue%first, err)
        call enter_data(glue%area, err)
        call enter_data(glue%gap, err)
        call enter_data(glue%rest, err)
        call enter_data(glue%entry, err)
        call enter_data(glue%weight, err)
        call enter_data(glue%back_first, err)
        call enter_data(glue%back, err)
        call enter_data(glue%row, err)
        call enter_data(glue%place, err)
        call enter_data(glue%owner, err)
        call enter_data(glue%seen_by, err)
        call enter_data(glue%mine, err)
        call enter_data(glue%damage, err)
        call enter_data(glue%spent, err)
        call enter_data(glue%held, err)
        call enter_data(glue%pull, err)
        call enter_data(glue%push, err)
    end subroutine enter_cohesive

    !> Bring damage and energies of the points to the host, if the GPU has moved on, and with
    !> `places` where their particles lie.
    subroutine fetch_gpu_points(gpu, places, glue, err)
        type(solid_device_t), intent(inout) :: gpu
        logical, intent(in) :: places
        type(cohesive_t), intent(inout) :: glue
        type(error_t), intent(inout) :: err

        if (.not. glue%present) return
        if (places) call update_host(glue%place, err)
        if (gpu%points_fetched) return
        call update_host(glue%damage, err)
        call update_host(glue%spent, err)
        call update_host(glue%held, err)
        gpu%points_fetched = .not. failed(err)
    end subroutine fetch_gpu_points

    !> The state of all points, as all processes know it together.
    subroutine put_points(gpu, glue, err)
        type(solid_device_t), intent(inout) :: gpu
        type(cohesive_t), intent(in) :: glue
        type(error_t), intent(inout) :: err

        call update_device(glue%damage, err)
        call update_device(glue%spent, err)
        call update_device(glue%held, err)
        gpu%points_fetched = .false. ! the step that has begun goes on
    end subroutine put_points
end module brz_gpu_cohesive_part
