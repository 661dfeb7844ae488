! SPDX-License-Identifier: MIT
!> In which directions a particle is held.
module brz_support
    use brz_kinds, only: int32
    use brz_solid_state, only: is_held
    implicit none
    private
    public :: is_kept

contains

    !> True where a particle does not move by itself along axis d.
    !@cuf attributes(host,device) &
    pure function is_kept(fixed, d) result(yes)
        integer(int32), intent(in) :: fixed
        integer, intent(in) :: d
        logical :: yes

        yes = fixed == is_held .or. btest(fixed, d + 1)
    end function is_kept
end module brz_support
