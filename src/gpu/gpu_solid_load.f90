! SPDX-License-Identifier: MIT
!> Pressures on faces of bodies on the GPU: memory, and what brz_load_steps leaves to each backend.
module brz_gpu_solid_load
    use brz_device, only: allocate_buffer, copy_in, copy_out
    use brz_errors, only: error_t
    use brz_gpu_loads, only: put_facets
    use brz_gpu_solid_state, only: gpu_solid_t
    use brz_kinds, only: int64
    use brz_loads, only: facets_t, loads_t
    implicit none
    private
    public :: fetch_loaded, open_gpu_loads, put_loaded

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

    !> Which loaded particles this process has.
    subroutine fetch_loaded(gpu, facets, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(facets_t), intent(inout) :: facets
        type(error_t), intent(inout) :: err

        call copy_out(gpu%loads%facets%owner, facets%owner, 4_int64*facets%carriers, err)
    end subroutine fetch_loaded

    !> Which process has each of them.
    subroutine put_loaded(gpu, facets, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(facets_t), intent(in) :: facets
        type(error_t), intent(inout) :: err

        call copy_in(facets%owner, gpu%loads%facets%owner, 4_int64*facets%carriers, err)
    end subroutine put_loaded
end module brz_gpu_solid_load
