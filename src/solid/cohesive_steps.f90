! SPDX-License-Identifier: MIT
!> Cohesive interfaces at the present places: the loops over points and nodes. scripts/steps.py
!> writes the same for the GPU.
module brz_cohesive_steps
    use brz_cohesive_loops, only: each_gather_node, each_join_node, each_open_point, &
        each_place_node
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: cohesive_pass, place_nodes

contains

    !> Where the particles of the nodes lie, after a sort or a restart.
    subroutine place_nodes(solid)
        type(solid_t), intent(inout) :: solid

        if (.not. solid%cohesive%present) return
        associate (glue => solid%cohesive)
            call each_place_node(solid%n, solid%id, glue%row, glue%place)
        end associate
        solid%links%joined = 0 !@cpu
        call join_nodes(solid)
    end subroutine place_nodes

    !> Which interfaces still hold each particle.
    subroutine join_nodes(solid)
        type(solid_t), intent(inout) :: solid

        associate (glue => solid%cohesive, links => solid%links)
            call each_join_node(glue%nodes, glue%bit, glue%of, glue%back_first, glue%back, &
                                glue%damage, glue%place, links%joined)
        end associate
    end subroutine join_nodes

    !> State and forces of all points, and what time step they bear.
    subroutine cohesive_pass(solid)
        type(solid_t), intent(inout) :: solid

        if (.not. solid%cohesive%present) return
        associate (glue => solid%cohesive, links => solid%links)
            call each_open_point(glue%n, solid%wide, glue%law, glue%bit, glue%of, glue%first, &
                glue%entry, glue%weight, glue%area, glue%gap, glue%rest, glue%place, solid%x, &
                solid%fixed, links%joined, glue%damage, glue%spent, glue%held, glue%pull)
            call join_nodes(solid)
            call each_gather_node(glue%nodes, glue%back_first, glue%back, glue%entry, &
                                  glue%weight, glue%pull, glue%push(:, 1:))
        end associate
        solid%dt_limit = min(solid%dt_limit, solid%cohesive%dt_limit)
    end subroutine cohesive_pass
end module brz_cohesive_steps
