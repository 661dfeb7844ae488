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

    !> Copy the facets.
    subroutine open_gpu_loads(loads, err)
        type(loads_t), intent(inout) :: loads
        type(error_t), intent(inout) :: err

        if (.not. allocated(loads%of)) return
        loads%rebuilds = -1 ! the GPU has no places yet
        associate (facets => loads%facets)
            if (allocated(facets%first)) then
                call enter_data(facets%first, err)
                call enter_data(facets%owner, err)
                call enter_data(facets%id, err)
                call enter_data(facets%load, err)
                call enter_data(facets%beside, err)
                call enter_data(facets%mirror, err)
                call enter_data(facets%width, err)
                call enter_data(facets%most, err)
                call enter_data(facets%side, err)
                call enter_data(facets%wave, err)
            end if
        end associate
        if (.not. allocated(loads%mean)) allocate (loads%mean(size(loads%of)), source=0.0_dp)
        call enter_data(loads%mean, err)
        call enter_data(loads%place, err)
    end subroutine open_gpu_loads
end module brz_gpu_solid_load
