! SPDX-License-Identifier: MIT
!> Pressures on faces of bodies on the GPU.
module brz_gpu_solid_load
    use brz_device_data, only: enter_data
    use brz_errors, only: error_t
    use brz_kinds, only: dp
    use brz_loads, only: loads_t
    implicit none
    private
    public :: open_gpu_loads

contains

    !> Copy the loaded segments.
    subroutine open_gpu_loads(loads, err)
        type(loads_t), intent(inout) :: loads
        type(error_t), intent(inout) :: err

        if (.not. allocated(loads%of)) return
        loads%rebuilds = -1 ! the GPU has no places yet
        associate (segments => loads%segments)
            if (allocated(segments%first)) then
                call enter_data(segments%first, err)
                call enter_data(segments%owner, err)
                call enter_data(segments%id, err)
                call enter_data(segments%load, err)
                call enter_data(segments%beside, err)
                call enter_data(segments%mirror, err)
                call enter_data(segments%width, err)
                call enter_data(segments%most, err)
                call enter_data(segments%side, err)
                call enter_data(segments%wave, err)
            end if
        end associate
        if (.not. allocated(loads%mean)) allocate (loads%mean(size(loads%of)), source=0.0_dp)
        call enter_data(loads%mean, err)
        call enter_data(loads%place, err)
    end subroutine open_gpu_loads
end module brz_gpu_solid_load
