! SPDX-License-Identifier: MIT
!> Hand the solids to a GPU, where they are computed from then on.
module brz_solid_to_gpu
    use brz_device, only: device_t
    use brz_errors, only: error_t, failed
    use brz_gpu_solid_copy, only: open_gpu_solid
    use brz_solid_list_driver, only: build_neighbours
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: move_solid_to_gpu

contains

    !> Reserve memory, copy the solids and build their lists for the places that these have.
    subroutine move_solid_to_gpu(device, solid, in_air, err)
        type(device_t), intent(in) :: device
        type(solid_t), intent(inout) :: solid !! its search tables are overwritten
        logical, intent(in) :: in_air !! the air loads the bodies
        type(error_t), intent(inout) :: err !! exit_device where a GPU fails

        call open_gpu_solid(device, solid, in_air, err)
        if (failed(err)) return
        call build_neighbours(solid, .false., err, spread(.true., 1, size(solid%bodies)))
    end subroutine move_solid_to_gpu
end module brz_solid_to_gpu
