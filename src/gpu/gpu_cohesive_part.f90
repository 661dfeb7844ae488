! SPDX-License-Identifier: MIT
!> Points of cohesive interfaces between a GPU and its host.
module brz_gpu_cohesive_part
    use brz_cohesive_state, only: cohesive_t
    use brz_device, only: copy_in, copy_out
    use brz_errors, only: error_t, failed
    use brz_gpu_solid_state, only: gpu_solid_t
    use brz_kinds, only: int64
    implicit none
    private
    public :: fetch_gpu_points, fetch_owners, put_owners, put_points

contains

    !> Bring damage and energies of the points to the host, if the GPU has moved on, and with
    !> `places` where their particles lie.
    subroutine fetch_gpu_points(gpu, places, glue, err)
        type(gpu_solid_t), intent(inout) :: gpu
        logical, intent(in) :: places
        type(cohesive_t), intent(inout) :: glue
        type(error_t), intent(inout) :: err

        if (.not. glue%present) return
        associate (there => gpu%cohesive)
            if (places) call copy_out(there%place, glue%place, 4_int64*glue%nodes, err)
            if (gpu%points_fetched) return
            call copy_out(there%damage, glue%damage, 8_int64*glue%n, err)
            call copy_out(there%spent, glue%spent, 8_int64*glue%n, err)
            call copy_out(there%held, glue%held, 8_int64*glue%n, err)
            gpu%points_fetched = .not. failed(err)
        end associate
    end subroutine fetch_gpu_points

    !> The state of all points, as all processes know it together.
    subroutine put_points(gpu, glue, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(cohesive_t), intent(in) :: glue
        type(error_t), intent(inout) :: err

        associate (there => gpu%cohesive)
            call copy_in(glue%damage, there%damage, 8_int64*glue%n, err)
            call copy_in(glue%spent, there%spent, 8_int64*glue%n, err)
            call copy_in(glue%held, there%held, 8_int64*glue%n, err)
        end associate
        gpu%points_fetched = .false. ! the step that has begun goes on
    end subroutine put_points

    !> Which process has the particle of each node, as far as this one knows.
    subroutine fetch_owners(gpu, glue, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(cohesive_t), intent(inout) :: glue
        type(error_t), intent(inout) :: err

        call copy_out(gpu%cohesive%owner, glue%owner, 4_int64*glue%nodes, err)
    end subroutine fetch_owners

    !> The same, as all know.
    subroutine put_owners(gpu, glue, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(cohesive_t), intent(in) :: glue
        type(error_t), intent(inout) :: err

        call copy_in(glue%owner, gpu%cohesive%owner, 4_int64*glue%nodes, err)
    end subroutine put_owners
end module brz_gpu_cohesive_part
