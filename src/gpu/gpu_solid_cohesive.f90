! SPDX-License-Identifier: MIT
!> Cohesive interfaces on the GPU: memory, what results need of them.
module brz_gpu_solid_cohesive
    use brz_cohesive_state, only: cohesive_t
    use brz_device, only: allocate_buffer, copy_out, put_buffer
    use brz_errors, only: error_t, failed
    use brz_gpu_solid_state, only: gpu_solid_t
    use brz_kinds, only: int64
    implicit none
    private
    public :: open_gpu_cohesive, fetch_gpu_points

contains

    !> Reserve memory and copy points, entries, nodes and state.
    subroutine open_gpu_cohesive(glue, gpu, err)
        type(cohesive_t), intent(in) :: glue
        type(gpu_solid_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err

        if (.not. glue%present) return
        associate (there => gpu%cohesive)
            there%n = glue%n
            there%nodes = glue%nodes
            call put_buffer(glue%law, there%law, &
                            size(glue%law)*(storage_size(glue%law)/8_int64), err)
            call put_buffer(glue%bit, there%bit, 4_int64*size(glue%bit), err)
            call put_buffer(glue%of, there%of, 4_int64*glue%n, err)
            call put_buffer(glue%first, there%first, 4_int64*(glue%n + 1), err)
            call put_buffer(glue%entry, there%entry, 4_int64*size(glue%entry), err)
            call put_buffer(glue%weight, there%weight, 8_int64*size(glue%weight), err)
            call put_buffer(glue%area, there%area, 8_int64*glue%n, err)
            call put_buffer(glue%gap, there%gap, 8_int64*glue%n, err)
            call put_buffer(glue%rest, there%rest, 8_int64*size(glue%rest), err)
            call put_buffer(glue%back_first, there%back_first, 4_int64*(glue%nodes + 1), err)
            call put_buffer(glue%back, there%back, 4_int64*size(glue%back), err)
            call put_buffer(glue%row, there%row, 4_int64*size(glue%row), err)
            call put_buffer(glue%place, there%place, 4_int64*glue%nodes, err)
            call put_buffer(glue%damage, there%damage, 8_int64*glue%n, err)
            call put_buffer(glue%spent, there%spent, 8_int64*glue%n, err)
            call put_buffer(glue%held, there%held, 8_int64*glue%n, err)
            call allocate_buffer(there%pull, 72_int64*glue%n, err)
            call allocate_buffer(there%push, 24_int64*glue%nodes, err)
        end associate
    end subroutine open_gpu_cohesive

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
            if (there%fetched) return
            call copy_out(there%damage, glue%damage, 8_int64*glue%n, err)
            call copy_out(there%spent, glue%spent, 8_int64*glue%n, err)
            call copy_out(there%held, glue%held, 8_int64*glue%n, err)
            there%fetched = .not. failed(err)
        end associate
    end subroutine fetch_gpu_points
end module brz_gpu_solid_cohesive
