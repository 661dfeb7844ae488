! SPDX-License-Identifier: MIT
!> The inter-body neighbours of a particle, called links, as lists of links_t hold them on the CPU.
module brz_link_rows
    use brz_bond_marks, only: tie_intact
    use brz_contact_loop_bodies, only: owner_of
    use brz_force_layout, only: at_drag, at_heat, at_stiff
    use brz_interaction, only: law_bonded
    use brz_kinds, only: dp, int32, int64
    use brz_link_layout, only: link_unit, mask_unit
    use brz_links, only: links_t
    use brz_push_layout, only: push_layout_t
    use brz_interacting_bodies, only: interacting_bodies_t
    implicit none
    private
    public :: first_link, last_link, link_partner, link_mask, body_of, is_bonded, joined_of
    public :: glue_of, nodes_of, layout_of_pushes

    real(dp), target :: no_glue(3, 0:0) = 0

contains

    !> Links of particle i: first..last.
    pure integer(int64) function first_link(links, i) result(k)
        type(links_t), intent(in) :: links
        integer, intent(in) :: i

        k = int(links%slice(links%row(i)), int64)*link_unit + 1
    end function first_link

    pure integer(int64) function last_link(links, i) result(k)
        type(links_t), intent(in) :: links
        integer, intent(in) :: i

        k = int(links%slice(links%row(i)), int64)*link_unit + links%count(links%row(i))
    end function last_link

    !> The other end of a link, and its mirrored axes, bits 0..2.
    pure integer function link_partner(links, k) result(j)
        type(links_t), intent(in) :: links
        integer(int64), intent(in) :: k

        j = iand(links%list(k), mask_unit - 1)
    end function link_partner

    pure integer function link_mask(links, k) result(m)
        type(links_t), intent(in) :: links
        integer(int64), intent(in) :: k

        m = links%list(k)/mask_unit
    end function link_mask

    !> True where a pair of bodies is bonded and the bond is whole at both particles.
    pure logical function is_bonded(links, i, j)
        type(links_t), intent(in) :: links
        integer, intent(in) :: i, j

        is_bonded = .false.
        if (.not. links%bonds) return
        is_bonded = links%table(body_of(links, i), body_of(links, j))%law == law_bonded .and. &
                    links%bond(i) == tie_intact .and. links%bond(j) == tie_intact
    end function is_bonded

    !> Body of a particle.
    pure integer function body_of(links, i)
        type(links_t), intent(in) :: links
        integer, intent(in) :: i

        body_of = owner_of(links%lay%bodies, links%ends, i)
    end function body_of

    !> Which interfaces still hold each particle; where there are none, marks that mean nothing.
    function joined_of(links) result(joined)
        type(links_t), intent(in), target :: links
        integer(int32), pointer, contiguous :: joined(:)

        joined => links%bond
        if (allocated(links%joined)) joined => links%joined
    end function joined_of

    !> Forces on the nodes of interfaces, and the node of each particle by its number; where there
    !> are no interfaces something that must not be read.
    function glue_of(solid) result(cohesive)
        class(interacting_bodies_t), intent(in), target :: solid
        real(dp), pointer, contiguous :: cohesive(:, :) !! [N]

        cohesive => no_glue
        if (solid%on_gpu) cohesive => solid%x ! it has a copy
        if (solid%cohesive%present) cohesive => solid%cohesive%push
    end function glue_of

    function nodes_of(solid) result(node)
        class(interacting_bodies_t), intent(in), target :: solid
        integer(int32), pointer, contiguous :: node(:)

        node => solid%id
        if (solid%cohesive%present) node => solid%cohesive%row
    end function nodes_of

    !> How links%push lies: springs, drag, torque of drag; forces of interfaces are not among them.
    pure function layout_of_pushes(solid) result(lay)
        class(interacting_bodies_t), intent(in) :: solid
        type(push_layout_t) :: lay

        lay = push_layout_t(compact=1, step_c=1, stride_p=9, drag=3, torque=6, heat=0, &
                            glued=merge(1, 0, solid%cohesive%present))
        if (solid%on_gpu) lay = push_layout_t(compact=0, step_c=solid%stride_d, stride_p=1, &
            drag=at_drag, torque=at_stiff, heat=at_heat, glued=0)
    end function layout_of_pushes
end module brz_link_rows
