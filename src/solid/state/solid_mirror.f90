! SPDX-License-Identifier: MIT
!> Particles as their images in planes of symmetry have them: signs, symmetric tensors. Rows: see
!> brz_pair_rows.
module brz_solid_mirror
    use brz_kinds, only: real32, rk
    implicit none
    private
    public :: signs, mirrored

contains

    !> Signs of the components that a mask mirrors.
    pure function signs(mask) result(s)
        integer, intent(in) :: mask !! bits 0..2
        real(rk) :: s(3)
        integer :: a

        do a = 1, 3
            s(a) = merge(-1, 1, btest(mask, a - 1))
        end do
    end function signs

    !> A symmetric tensor seen in the mirror planes with s = -1.
    pure function mirrored(s, k) result(m)
        real(rk), intent(in) :: s(3)
        real(real32), intent(in) :: k(6)
        real(rk) :: m(6)

        m(1:3) = k(1:3)
        m(4:6) = k(4:6)*[s(1)*s(2), s(2)*s(3), s(1)*s(3)]
    end function mirrored
end module brz_solid_mirror
