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
    subroutine enter_cohesive(cohesive, err)
        type(cohesive_t), intent(inout) :: cohesive
        type(error_t), intent(inout) :: err

        call enter_bytes(cohesive%law, size(cohesive%law)*(storage_size(cohesive%law)/8_int64), err)
        call enter_data(cohesive%bit, err)
        call enter_data(cohesive%of, err)
        call enter_data(cohesive%first, err)
        call enter_data(cohesive%area, err)
        call enter_data(cohesive%gap, err)
        call enter_data(cohesive%rest, err)
        call enter_data(cohesive%entry, err)
        call enter_data(cohesive%weight, err)
        call enter_data(cohesive%back_first, err)
        call enter_data(cohesive%back, err)
        call enter_data(cohesive%row, err)
        call enter_data(cohesive%place, err)
        call enter_data(cohesive%owner, err)
        call enter_data(cohesive%seen_by, err)
        call enter_data(cohesive%mine, err)
        call enter_data(cohesive%damage, err)
        call enter_data(cohesive%spent, err)
        call enter_data(cohesive%held, err)
        call enter_data(cohesive%pull, err)
        call enter_data(cohesive%push, err)
    end subroutine enter_cohesive

    !> Bring damage and energies of the points to the host, if the GPU has moved on, and with
    !> `places` where their particles lie.
    subroutine fetch_gpu_points(gpu, places, cohesive, err)
        type(solid_device_t), intent(inout) :: gpu
        logical, intent(in) :: places
        type(cohesive_t), intent(inout) :: cohesive
        type(error_t), intent(inout) :: err

        if (.not. cohesive%present) return
        if (places) call update_host(cohesive%place, err)
        if (gpu%points_fetched) return
        call update_host(cohesive%damage, err)
        call update_host(cohesive%spent, err)
        call update_host(cohesive%held, err)
        gpu%points_fetched = .not. failed(err)
    end subroutine fetch_gpu_points

    !> The state of all points, as all processes know it together.
    subroutine put_points(gpu, cohesive, err)
        type(solid_device_t), intent(inout) :: gpu
        type(cohesive_t), intent(in) :: cohesive
        type(error_t), intent(inout) :: err

        call update_device(cohesive%damage, err)
        call update_device(cohesive%spent, err)
        call update_device(cohesive%held, err)
        gpu%points_fetched = .false. ! the step that has begun goes on
    end subroutine put_points
end module brz_gpu_cohesive_part
