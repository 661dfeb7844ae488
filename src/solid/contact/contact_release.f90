! SPDX-License-Identifier: MIT
!> Pairs of particles that a bond or a cohesive interface keeps from contact, and how contact begins
!> where it lets go. Point physics.
!>
!> Source: docs/theory/contact.md
module brz_contact_release
    use brz_bond_marks, only: bond_breaks, tie_intact, loose_by
    use brz_contact, only: joins
    use brz_interaction, only: law_bonded, interaction_t
    use brz_kinds, only: int32, real32, rk
    implicit none
    private
    public :: is_tied, is_freed, later_touch

contains

    !> True where a pair has no contact: its sums are joined, or a cohesive interface holds both.
    !@cuf attributes(host,device) &
    pure function is_tied(m, bond_i, bond_j, joined_i, joined_j) result(yes)
        type(interaction_t), intent(in) :: m
        integer(int32), intent(in) :: bond_i, bond_j, joined_i, joined_j
        logical :: yes

        yes = joins(m, bond_i == tie_intact .and. bond_j == tie_intact)
        if (m%bit /= 0) yes = yes .or. iand(iand(joined_i, joined_j), m%bit) /= 0
    end function is_tied

    !> True where a pair had no contact until this step, and has from now on.
    !@cuf attributes(host,device) &
    pure function is_freed(m, bond_i, bond_j, joined_i, joined_j) result(yes)
        type(interaction_t), intent(in) :: m
        integer(int32), intent(in) :: bond_i, bond_j, joined_i, joined_j
        logical :: yes
        integer(int32) :: both

        yes = .false.
        if (m%law == law_bonded .and. (bond_i == bond_breaks .or. bond_j == bond_breaks)) &
            yes = (bond_i == tie_intact .or. bond_i == bond_breaks) .and. &
                  (bond_j == tie_intact .or. bond_j == bond_breaks)
        if (m%bit == 0) return
        both = iand(ior(joined_i, ishft(joined_i, -loose_by)), &
                    ior(joined_j, ishft(joined_j, -loose_by)))
        yes = yes .or. iand(both, m%bit) /= 0
    end function is_freed

    !> Sum at which contact begins from now on, so that what is freed presses no more than what the
    !> particle touched before.
    !@cuf attributes(host,device) &
    pure function later_touch(touch, others, freed) result(later)
        real(real32), intent(in) :: touch !! so far
        real(rk), intent(in) :: others, freed !! sums a step before
        real(real32) :: later

        later = max(touch, real(freed + min(others, real(touch, rk)), real32)*(1 + epsilon(touch)))
    end function later_touch
end module brz_contact_release
