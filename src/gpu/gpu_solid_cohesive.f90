! SPDX-License-Identifier: MIT
!> Cohesive interfaces on the GPU: memory, launches, what results need of them.
module brz_gpu_solid_cohesive
    use brz_cohesive_law, only: has_damage, has_held, has_spent
    use brz_cohesive_state, only: cohesive_t
    use brz_buffers, only: from
    use brz_device, only: allocate_buffer, copy_out, device_t, put_buffer
    use brz_errors, only: error_t, failed
    use brz_gpu_solid_layout, only: tag_fixed, tag_id, tag_joined
    use brz_gpu_solid_state, only: gpu_solid_t, tags_of
    use brz_kinds, only: dp, int64
    implicit none
    private
    public :: open_gpu_cohesive, place_gpu_nodes, open_gpu_points, gather_gpu_points, &
        fetch_gpu_points

contains

    !> Reserve memory and copy points, entries, nodes and state.
    subroutine open_gpu_cohesive(device, glue, gpu, err)
        type(device_t), intent(in) :: device
        type(cohesive_t), intent(in) :: glue
        type(gpu_solid_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err

        gpu%glue%present = glue%present
        if (.not. glue%present) return
        associate (there => gpu%glue)
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
            call put_buffer(glue%place, there%place_of, 4_int64*glue%nodes, err)
            call put_buffer(state_of(glue), there%state, 24_int64*glue%n, err)
            call allocate_buffer(there%pull, 72_int64*glue%n, err)
            call allocate_buffer(there%push, 24_int64*glue%nodes, err)
            call there%kernels%open(device, err)
        end associate
    end subroutine open_gpu_cohesive

    !> Damage and energies of all points, as the kernels have them.
    pure function state_of(glue) result(state)
        type(cohesive_t), intent(in) :: glue
        real(dp) :: state(3, glue%n)

        state(has_damage, :) = glue%damage
        state(has_spent, :) = glue%spent
        state(has_held, :) = glue%held
    end function state_of

    !> Where the particles of the nodes lie, after a sort.
    subroutine place_gpu_nodes(gpu, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(error_t), intent(inout) :: err

        if (gpu%glue%present) call gpu%glue%kernels%place_node(gpu%n, tags_of(gpu, tag_id), &
            gpu%glue%row, gpu%glue%place_of, err)
    end subroutine place_gpu_nodes

    !> State and forces of all points, and which interfaces still hold their particles.
    subroutine open_gpu_points(gpu, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(error_t), intent(inout) :: err

        if (.not. gpu%glue%present) return
        associate (glue => gpu%glue, damage => from(gpu%glue%state, int(has_damage, int64)))
            call glue%kernels%open_point(glue%n, 4, 3, glue%law, glue%bit, glue%of, glue%first, &
                glue%entry, glue%weight, glue%area, glue%gap, glue%rest, glue%place_of, &
                gpu%place, tags_of(gpu, tag_fixed), tags_of(gpu, tag_joined), damage, &
                from(glue%state, int(has_spent, int64)), from(glue%state, int(has_held, int64)), &
                glue%pull, err)
            call glue%kernels%join_node(glue%nodes, 3, glue%bit, glue%of, glue%back_first, &
                glue%back, damage, glue%place_of, tags_of(gpu, tag_joined), err)
        end associate
    end subroutine open_gpu_points

    !> Add the forces of the points to `extra`, after those of contact, which begin it anew.
    subroutine gather_gpu_points(gpu, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(error_t), intent(inout) :: err

        if (.not. gpu%glue%present) return
        associate (glue => gpu%glue)
            call glue%kernels%gather_node(glue%nodes, glue%back_first, glue%back, glue%entry, &
                                          glue%weight, glue%pull, glue%push, err)
            call glue%kernels%add_pull(glue%nodes, gpu%n, glue%place_of, glue%push, gpu%extra, err)
        end associate
    end subroutine gather_gpu_points

    !> Bring damage and energies of the points to the host, if the GPU has moved on, and with
    !> `places` where their particles lie.
    subroutine fetch_gpu_points(gpu, places, glue, err)
        type(gpu_solid_t), intent(inout) :: gpu
        logical, intent(in) :: places
        type(cohesive_t), intent(inout) :: glue
        type(error_t), intent(inout) :: err
        real(dp), allocatable :: state(:, :)

        if (.not. gpu%glue%present .or. failed(err)) return
        if (places) call copy_out(gpu%glue%place_of, glue%place, 4_int64*glue%nodes, err)
        if (gpu%glue%fetched) return
        allocate (state(3, glue%n))
        call copy_out(gpu%glue%state, state, 24_int64*glue%n, err)
        if (failed(err)) return
        glue%damage = state(has_damage, :)
        glue%spent = state(has_spent, :)
        glue%held = state(has_held, :)
        gpu%glue%fetched = .true.
    end subroutine fetch_gpu_points
end module brz_gpu_solid_cohesive
