! SPDX-License-Identifier: MIT
!> Supports: in which directions a particle is held (single-point constraints).
module brz_support
    use brz_kinds, only: int32, rk
    use brz_particle_marks, only: is_fixed
    implicit none
    private
    public :: fixed_share, is_kept, kept_along, driven_by, is_driven

contains

    !> True where a particle does not move by itself along axis d.
    !@cuf attributes(host,device) &
    pure function is_kept(fixed, d) result(yes)
        integer(int32), intent(in) :: fixed
        integer, intent(in) :: d
        logical :: yes

        yes = fixed == is_fixed .or. iand(fixed, kept_along(d)) /= 0
    end function is_kept

    !> For each direction 1 where a particle is held, else 0.
    pure function fixed_share(fixed) result(held)
        integer(int32), intent(in) :: fixed
        real(rk) :: held(3)
        integer :: d

        do d = 1, 3
            held(d) = merge(1, 0, is_kept(fixed, d))
        end do
    end function fixed_share

    !> The mark of a particle that is held along axis d alone; marks add up.
    !@cuf attributes(host,device) &
    pure function kept_along(d) result(mark)
        integer, intent(in) :: d
        integer(int32) :: mark

        mark = ishft(2_int32, d)
    end function kept_along

    !> The mark of a particle that motion m of its body moves; added to those of the axes.
    !@cuf attributes(host,device) &
    pure function driven_by(m) result(mark)
        integer, intent(in) :: m
        integer(int32) :: mark

        mark = 32*m
    end function driven_by

    !> True for a particle that motion m of its body moves; 0: that of all that is held.
    !@cuf attributes(host,device) &
    pure function is_driven(fixed, m) result(yes)
        integer(int32), intent(in) :: fixed
        integer, intent(in) :: m
        logical :: yes

        yes = fixed/driven_by(1) == m
        if (m == 0) yes = fixed == is_fixed
    end function is_driven
end module brz_support
