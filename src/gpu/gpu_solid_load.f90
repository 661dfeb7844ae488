! SPDX-License-Identifier: MIT
!> Pressures on faces of bodies on the GPU: memory, and what brz_load_steps leaves to each backend.
module brz_gpu_solid_load
    use brz_device, only: allocate_buffer, clear_buffer
    use brz_errors, only: error_t
    use brz_face_load, only: loads_t
    use brz_facet_launches, only: facet_kernels
    use brz_gpu_face_load, only: put_facets
    use brz_gpu_solid_state, only: gpu_solid_t
    use brz_kinds, only: dp, int64
    use brz_tallies, only: tally_threads
    implicit none
    private
    public :: open_gpu_loads, see_carriers

contains

    !> Reserve memory and copy the facets.
    subroutine open_gpu_loads(loads, gpu, err)
        type(loads_t), intent(inout) :: loads
        type(gpu_solid_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err

        if (.not. allocated(loads%of)) return
        loads%rebuilds = -1 ! the GPU has no places yet
        call put_facets(loads%facets, gpu%loads%facets, err)
        call allocate_buffer(gpu%loads%mean, 8_int64*size(loads%of), err)
        call allocate_buffer(gpu%loads%place, 4_int64*size(loads%place), err)
    end subroutine open_gpu_loads

    !> Number of a particle whose facets reach out of sight, else 0.
    subroutine see_carriers(gpu, lost, err)
        type(gpu_solid_t), intent(inout) :: gpu
        real(dp), intent(inout) :: lost
        type(error_t), intent(inout) :: err

        call clear_buffer(gpu%sums_of_forces, err)
        associate (f => gpu%loads%facets)
            call facet_kernels%see_carrier(f%carriers, f%first, f%id, f%beside, &
                gpu%loads%place, gpu%fixed, gpu%sums_of_forces, err)
        end associate
        lost = gpu%common%largest(gpu%sums_of_forces, tally_threads, err)
    end subroutine see_carriers
end module brz_gpu_solid_load
