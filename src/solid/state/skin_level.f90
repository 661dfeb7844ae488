! SPDX-License-Identifier: MIT
!> The check of the Verlet skin: how far a particle has moved relative to its body since its list
!> was built, in levels. Point physics.
!>
!> Level k says that it is between k and k + 1 units, that of `skin_levels` that the list has had
!> its time, and `lost_level` that its place is no number.
module brz_skin_level
    use brz_kinds, only: dp
    implicit none
    private
    public :: skin_levels, renewed_level, joining_level, lost_level, level_of

    integer, parameter :: skin_levels = 8
    integer, parameter :: lost_level = skin_levels + 1
    integer, parameter :: renewed_level = skin_levels/2 !! from which a particle gets a new place
    integer, parameter :: joining_level = 3*skin_levels/4 !! from which a list is built with others

contains

    !> Level of a particle that has moved by so much relative to its body.
    !@cuf attributes(host,device) &
    pure function level_of(e2, unit) result(level)
        real(dp), intent(in) :: e2, unit !! e squared [m2], step of e [m]
        integer :: level

        level = 0
        if (.not. e2 <= huge(e2)) then
            level = lost_level
        else if (e2 > (skin_levels*unit)*(skin_levels*unit)) then
            level = skin_levels
        else if (e2 > 0) then
            level = min(int(sqrt(e2)/unit), skin_levels - 1)
        end if
    end function level_of
end module brz_skin_level
