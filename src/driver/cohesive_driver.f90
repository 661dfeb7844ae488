! SPDX-License-Identifier: MIT
!> Cohesive interfaces at the present places: the loops over points and nodes.
module brz_cohesive_driver
    use brz_cohesive_loops, only: for_each_gather_node, for_each_join_node, for_each_mark_glued, &
        for_each_open_point, for_each_own_node, for_each_place_node, for_each_see_point
    use brz_cohesive_part, only: share_points, tell_owners
    use brz_device_data, only: update_device, update_host
    use brz_errors, only: error_t
    use brz_gpu_cohesive_part, only: fetch_gpu_points, put_points
    use brz_lists, only: clear_list
    use brz_ranks, only: several
    use brz_solid_backend, only: refresh_joined
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: cohesive_pass, mark_glue, note_owners, place_nodes

contains

    !> Where the particles of the nodes lie, after a sort or a restart.
    subroutine place_nodes(solid, err)
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        integer :: b

        if (.not. solid%cohesive%present) return
        associate (cohesive => solid%cohesive)
            if (several(solid%ranks)) call clear_list(solid%on_gpu, cohesive%nodes, &
                cohesive%place, err)
        end associate
        do b = 1, size(solid%bodies)
            associate (cohesive => solid%cohesive, there => solid%bodies(b))
                call for_each_place_node(solid%on_gpu, there%rim - there%first + 1, there%first, &
                    solid%id, cohesive%row, cohesive%place, err)
            end associate
        end do
        if (.not. solid%on_gpu) solid%links%joined = 0
        call join_nodes(solid, err)
    end subroutine place_nodes

    !> Particles may have changed processes: tell all who has which now, and the state of points
    !> that others have computed.
    subroutine note_owners(solid, err)
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        integer :: b

        if (.not. (solid%cohesive%present .and. several(solid%ranks))) return
        if (solid%on_gpu) call fetch_gpu_points(solid%device, .false., solid%cohesive, err)
        call share_points(solid)
        if (solid%on_gpu) call put_points(solid%device, solid%cohesive, err)
        associate (cohesive => solid%cohesive)
            call clear_list(solid%on_gpu, cohesive%nodes, cohesive%owner, err)
        end associate
        do b = 1, size(solid%bodies)
            associate (cohesive => solid%cohesive, there => solid%bodies(b))
                call for_each_own_node(solid%on_gpu, there%last - there%first + 1, there%first, &
                                   solid%ranks%rank + 1, solid%id, cohesive%row, cohesive%owner, &
                                   err)
            end associate
        end do
        if (solid%on_gpu) call update_host(solid%cohesive%owner, err)
        call tell_owners(solid)
        if (solid%on_gpu) call update_device(solid%cohesive%owner, err)
        associate (cohesive => solid%cohesive)
            call for_each_see_point(solid%on_gpu, cohesive%n, solid%ranks%rank + 1, &
                                cohesive%first, cohesive%entry, cohesive%owner, cohesive%seen_by, &
                                cohesive%mine, err)
        end associate
    end subroutine note_owners

    !> Mark the particles of body b that others need for the points that they compute.
    subroutine mark_glue(solid, b, err)
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: b
        type(error_t), intent(inout) :: err
        integer :: r

        if (.not. solid%cohesive%present) return
        associate (cohesive => solid%cohesive, there => solid%bodies(b), part => solid%part)
            do r = 0, solid%ranks%n - 1
                if (r == solid%ranks%rank) cycle
                call for_each_mark_glued(solid%on_gpu, there%last - there%first + 1, there%first, &
                    solid%n, r, solid%id, cohesive%row, cohesive%back_first, cohesive%back, &
                    cohesive%seen_by, part%sent, part%mark, err)
            end do
        end associate
    end subroutine mark_glue

    !> Which interfaces still hold each particle; of ghosts their own process knows.
    subroutine join_nodes(solid, err)
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        associate (cohesive => solid%cohesive, links => solid%links)
            call for_each_join_node(solid%on_gpu, cohesive%nodes, cohesive%bit, cohesive%of, &
                                cohesive%back_first, cohesive%back, cohesive%damage, &
                                cohesive%place, links%joined, err)
        end associate
        call refresh_joined(solid, err)
    end subroutine join_nodes

    !> State and forces of all points, and what time step they bear.
    subroutine cohesive_pass(solid, err)
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        if (.not. solid%cohesive%present) return
        associate (cohesive => solid%cohesive, links => solid%links)
            call for_each_open_point(solid%on_gpu, cohesive%n, solid%wide, cohesive%mine, &
                cohesive%law, cohesive%bit, cohesive%of, cohesive%first, cohesive%entry, &
                cohesive%weight, cohesive%area, cohesive%gap, cohesive%rest, cohesive%place, &
                solid%x, solid%fixed, links%joined, cohesive%damage, cohesive%spent, &
                cohesive%held, cohesive%pull, err)
            call join_nodes(solid, err)
            call for_each_gather_node(solid%on_gpu, cohesive%nodes, cohesive%place, &
                                  cohesive%back_first, cohesive%back, cohesive%entry, &
                                  cohesive%weight, cohesive%pull, cohesive%push(:, 1:), err)
        end associate
        solid%dt_limit = min(solid%dt_limit, solid%cohesive%dt_limit)
    end subroutine cohesive_pass
end module brz_cohesive_driver
