! SPDX-License-Identifier: MIT
!> Cohesive interfaces at the present places: the loops over points and nodes.
module brz_solid_cohesive
    use brz_cohesive_loops, only: each_gather_node, each_join_node, each_open_point, &
        each_place_node
    use brz_kinds, only: dp
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: cohesive_pass, place_nodes, cohesive_push

contains

    !> Where the particles of the nodes lie, after a sort or a restart.
    subroutine place_nodes(solid)
        type(solid_t), intent(inout) :: solid

        if (.not. solid%cohesive%present) return
        call each_place_node(solid%n, solid%id, solid%cohesive%row, solid%cohesive%place)
        solid%links%joined = 0
        call join_nodes(solid)
    end subroutine place_nodes

    !> Which interfaces still hold each particle.
    subroutine join_nodes(solid)
        type(solid_t), intent(inout) :: solid

        associate (glue => solid%cohesive)
            call each_join_node(glue%nodes, 1, glue%bit, glue%of, glue%back_first, glue%back, &
                                glue%damage, glue%place, solid%links%joined)
        end associate
    end subroutine join_nodes

    !> State and forces of all points, and what time step they bear.
    subroutine cohesive_pass(solid)
        type(solid_t), intent(inout) :: solid

        if (.not. solid%cohesive%present) return
        associate (glue => solid%cohesive)
            call each_open_point(glue%n, 3, 1, glue%law, glue%bit, glue%of, glue%first, &
                                 glue%entry, glue%weight, glue%area, glue%gap, glue%rest, &
                                 glue%place, solid%x, solid%fixed, solid%links%joined, &
                                 glue%damage, glue%spent, glue%held, glue%pull)
            call join_nodes(solid)
            call each_gather_node(glue%nodes, glue%back_first, glue%back, glue%entry, &
                                  glue%weight, glue%pull, glue%push(:, 1:))
            solid%dt_limit = min(solid%dt_limit, glue%dt_limit)
        end associate
    end subroutine cohesive_pass

    !> Force of all interfaces on particle i [N].
    pure function cohesive_push(solid, i) result(f)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: i
        real(dp) :: f(3)

        f = solid%cohesive%push(:, solid%cohesive%row(solid%id(i)))
    end function cohesive_push
end module brz_solid_cohesive
