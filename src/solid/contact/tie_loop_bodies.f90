! SPDX-License-Identifier: MIT
!> Links of particles that are listed anew, who has some, and which of them can have contact until
!> then, where no bond or interface lets go.
module brz_tie_loop_bodies
    use brz_contact, only: joins
    use brz_contact_loop_bodies, only: next_owner, owner_of
    use brz_contact_release, only: is_tied
    use brz_interaction, only: law_shared, interaction_t
    use brz_kinds, only: int32, int64
    use brz_link_layout, only: link_layout_t, links_of, mask_unit
    implicit none
    private
    public :: count_failed_ties, drop_links, mark_linked

contains

    !> Forget how many links a particle has whose links are listed anew.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine drop_links(i, chosen, count)
        integer, intent(in) :: i !! particles
        integer(int32), intent(in) :: chosen(*) !! 1: listed anew
        integer(int32), intent(inout) :: count(*)

        if (chosen(i) == 1) count(i) = 0
    end subroutine drop_links

    !> Mark a particle that has links with particles that it may be bonded to.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine mark_linked(p, first, lay, ends, table, row, slice, count, list, mark)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        type(link_layout_t), intent(in) :: lay
        integer(int32), intent(in) :: ends(*)
        type(interaction_t), intent(in) :: table(lay%bodies, *)
        integer(int32), intent(in) :: row(*), slice(*), count(*), list(*)
        integer(int32), intent(inout) :: mark(*) !! 1: it has
        integer :: a, b, i, k, n, r
        integer(int64) :: at

        i = first - 1 + p
        call links_of(lay, i, row, slice, count, r, n, at)
        if (r == 0) return
        a = owner_of(lay%bodies, ends, i)
        b = a
        do k = 0, n - 1
            b = next_owner(lay%bodies, ends, iand(list(at + k*lay%side), mask_unit - 1), b)
            if (joins(table(a, b), .true.)) then
                mark(i) = 1
                return
            end if
        end do
    end subroutine mark_linked

    !> Number of links of a particle, or 0 where all of them are tied: it then has no contact.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine count_failed_ties(i, lay, ends, table, bond, joined, row, slice, count, list, &
    loose)
        integer, intent(in) :: i !! particles
        type(link_layout_t), intent(in) :: lay
        integer(int32), intent(in) :: ends(*)
        type(interaction_t), intent(in) :: table(lay%bodies, *)
        integer(int32), intent(in) :: bond(*), joined(*), row(*), slice(*), count(*), list(*)
        integer(int32), intent(inout) :: loose(*) !! as `count`
        integer :: a, b, j, k, n, r
        integer(int64) :: at

        call links_of(lay, i, row, slice, count, r, n, at)
        if (r == 0) return
        loose(r) = 0
        a = owner_of(lay%bodies, ends, i)
        b = a
        do k = 0, n - 1
            j = iand(list(at + k*lay%side), mask_unit - 1)
            b = next_owner(lay%bodies, ends, j, b)
            if (table(a, b)%law == law_shared .or. .not. &
                is_tied(table(a, b), bond(i), bond(j), joined(i), joined(j))) loose(r) = n
        end do
    end subroutine count_failed_ties
end module brz_tie_loop_bodies
