! SPDX-License-Identifier: MIT
!> Cohesive interfaces on the GPU: memory, launches, what results need of them.
module brz_gpu_solid_cohesive
    use brz_cohesive_law, only: has_damage, has_held, has_spent
    use brz_cohesive_state, only: cohesive_t
    use brz_device, only: allocate_buffer, arguments_t, copy_out, device_t, find_kernel, launch, &
        put_buffer
    use brz_errors, only: error_t, failed
    use brz_gpu_solid_layout, only: mask_unit
    use brz_gpu_solid_state, only: gpu_solid_t
    use brz_kinds, only: dp, int32, int64
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
            call put_buffer(glue%node + int(glue%mask, int32)*mask_unit, there%entry, &
                            4_int64*size(glue%node), err)
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
            call find_kernel(device, 'cohesive_place', there%place, err)
            call find_kernel(device, 'cohesive_open', there%open, err)
            call find_kernel(device, 'cohesive_join', there%join, err)
            call find_kernel(device, 'cohesive_gather', there%gather, err)
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
        type(arguments_t) :: arguments

        if (.not. gpu%glue%present) return
        call arguments%add(gpu%n)
        call arguments%add([gpu%tag, gpu%glue%row, gpu%glue%place_of])
        call launch(gpu%glue%place, [gpu%n, 1, 1], arguments, err)
    end subroutine place_gpu_nodes

    !> State and forces of all points, and which interfaces still hold their particles.
    subroutine open_gpu_points(gpu, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments

        if (.not. gpu%glue%present) return
        associate (glue => gpu%glue)
            call arguments%add(glue%n)
            call arguments%add(gpu%n)
            call arguments%add([glue%law, glue%bit, glue%of, glue%first, glue%entry, glue%weight, &
                                glue%area, glue%gap, glue%rest, glue%place_of, gpu%place, &
                                gpu%tag, glue%state, glue%pull])
            call launch(glue%open, [glue%n, 1, 1], arguments, err)
            arguments%n = 0
            call arguments%add(glue%nodes)
            call arguments%add(gpu%n)
            call arguments%add([glue%bit, glue%of, glue%back_first, glue%back, glue%state, &
                                glue%place_of, gpu%tag])
            call launch(glue%join, [glue%nodes, 1, 1], arguments, err)
        end associate
    end subroutine open_gpu_points

    !> Add the forces of the points to `extra`, after those of contact, which begin it anew.
    subroutine gather_gpu_points(gpu, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments

        if (.not. gpu%glue%present) return
        associate (glue => gpu%glue)
            call arguments%add(glue%nodes)
            call arguments%add(gpu%n)
            call arguments%add([glue%back_first, glue%back, glue%entry, glue%weight, glue%pull, &
                                glue%place_of, gpu%extra])
            call launch(glue%gather, [glue%nodes, 1, 1], arguments, err)
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
