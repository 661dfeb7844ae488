! SPDX-License-Identifier: MIT
!> Cohesive interfaces at the present places: the loops over points and nodes. scripts/steps.py
!> writes the same for the GPU.
module brz_cohesive_steps
    use brz_cohesive_loops, only: each_gather_node, each_join_node, each_mark_glued, &
        each_open_point, each_own_node, each_place_node, each_see_point
    use brz_cohesive_part, only: share_points, tell_owners
    !@gpu use brz_gpu_cohesive_part, only: fetch_owners, fetch_gpu_points, put_owners
    !@gpu use brz_gpu_cohesive_part, only: put_points
    !@gpu use brz_gpu_solid_ghosts, only: refresh_joined
    !@gpu use brz_gpu_lists, only: clear_list
    use brz_lists, only: clear_list !@cpu
    use brz_ranks, only: several
    use brz_solid_ghosts, only: refresh_joined !@cpu
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: cohesive_pass, mark_glue, note_owners, place_nodes

contains

    !> Where the particles of the nodes lie, after a sort or a restart.
    subroutine place_nodes(solid)
        type(solid_t), intent(inout) :: solid
        integer :: b

        if (.not. solid%cohesive%present) return
        associate (glue => solid%cohesive)
            if (several(solid%ranks)) call clear_list(glue%nodes, glue%place) !@cpu
            !@gpu if (several(solid%ranks)) call clear_list(glue%nodes, glue%place)
        end associate
        do b = 1, size(solid%bodies)
            associate (glue => solid%cohesive, there => solid%bodies(b))
                call each_place_node(there%rim - there%first + 1, there%first, solid%id, &
                                     glue%row, glue%place)
            end associate
        end do
        solid%links%joined = 0 !@cpu
        call join_nodes(solid)
    end subroutine place_nodes

    !> Particles may have changed processes: tell all who has which now, and the state of points
    !> that others have computed.
    subroutine note_owners(solid)
        type(solid_t), intent(inout) :: solid
        integer :: b

        if (.not. (solid%cohesive%present .and. several(solid%ranks))) return
        !@gpu call fetch_gpu_points(gpu, .false., solid%cohesive)
        call share_points(solid) !@host
        !@gpu call put_points(gpu, solid%cohesive)
        associate (glue => solid%cohesive)
            call clear_list(glue%nodes, glue%owner) !@cpu
            !@gpu call clear_list(glue%nodes, glue%owner)
        end associate
        do b = 1, size(solid%bodies)
            associate (glue => solid%cohesive, there => solid%bodies(b))
                call each_own_node(there%last - there%first + 1, there%first, &
                                   solid%ranks%rank + 1, solid%id, glue%row, glue%owner)
            end associate
        end do
        !@gpu call fetch_owners(gpu, solid%cohesive)
        call tell_owners(solid) !@host
        !@gpu call put_owners(gpu, solid%cohesive)
        associate (glue => solid%cohesive)
            call each_see_point(glue%n, solid%ranks%rank + 1, glue%first, glue%entry, glue%owner, &
                                glue%seen_by, glue%mine)
        end associate
    end subroutine note_owners

    !> Mark the particles of body b that others need for the points that they compute.
    subroutine mark_glue(solid, b)
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: b
        integer :: r

        if (.not. solid%cohesive%present) return
        associate (glue => solid%cohesive, there => solid%bodies(b), part => solid%part)
            do r = 0, solid%ranks%n - 1
                if (r == solid%ranks%rank) cycle
                call each_mark_glued(there%last - there%first + 1, there%first, solid%n, r, &
                    solid%id, glue%row, glue%back_first, glue%back, glue%seen_by, part%sent, &
                    part%mark)
            end do
        end associate
    end subroutine mark_glue

    !> Which interfaces still hold each particle; of ghosts their own process knows.
    subroutine join_nodes(solid)
        type(solid_t), intent(inout) :: solid

        associate (glue => solid%cohesive, links => solid%links)
            call each_join_node(glue%nodes, glue%bit, glue%of, glue%back_first, glue%back, &
                                glue%damage, glue%place, links%joined)
        end associate
        call refresh_joined(solid)
    end subroutine join_nodes

    !> State and forces of all points, and what time step they bear.
    subroutine cohesive_pass(solid)
        type(solid_t), intent(inout) :: solid

        if (.not. solid%cohesive%present) return
        associate (glue => solid%cohesive, links => solid%links)
            call each_open_point(glue%n, solid%wide, glue%mine, glue%law, glue%bit, glue%of, &
                glue%first, glue%entry, glue%weight, glue%area, glue%gap, glue%rest, glue%place, &
                solid%x, solid%fixed, links%joined, glue%damage, glue%spent, glue%held, glue%pull)
            call join_nodes(solid)
            call each_gather_node(glue%nodes, glue%place, glue%back_first, glue%back, glue%entry, &
                                  glue%weight, glue%pull, glue%push(:, 1:))
        end associate
        solid%dt_limit = min(solid%dt_limit, solid%cohesive%dt_limit)
    end subroutine cohesive_pass
end module brz_cohesive_steps
