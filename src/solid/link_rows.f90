! SPDX-License-Identifier: MIT
!> The links of a particle, as lists of links_t hold them on the CPU.
module brz_link_rows
    use brz_contact, only: law_bonded
    use brz_contact_items, only: owner_of
    use brz_kinds, only: int32, int64
    use brz_link_layout, only: link_unit, mask_unit
    use brz_solid_state, only: bond_whole, links_t
    implicit none
    private
    public :: first_link, last_link, link_partner, link_mask, is_bonded, joined_of

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
        is_bonded = links%table(owner_of(links%ends, i), &
                                owner_of(links%ends, j))%law == law_bonded .and. &
                    links%bond(i) == bond_whole .and. links%bond(j) == bond_whole
    end function is_bonded

    !> Which interfaces still hold each particle; where there are none, marks that mean nothing.
    function joined_of(links) result(joined)
        type(links_t), intent(in), target :: links
        integer(int32), pointer, contiguous :: joined(:)

        joined => links%bond
        if (allocated(links%joined)) joined => links%joined
    end function joined_of
end module brz_link_rows
