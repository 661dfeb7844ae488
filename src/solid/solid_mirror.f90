! SPDX-License-Identifier: MIT
!> Particles as their images in planes of symmetry have them: signs, tensors, rows of `pair`.
module brz_solid_mirror
    use brz_kinds, only: real32, rk
    use brz_solid_state, only: held_affine, n_held, n_pair, pair_affine, pair_stress
    implicit none
    private
    public :: signs, mirrored, mirrored_row, mirrored_hold

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

    !> The row of a particle seen in the mirror planes with s = -1: its tensors change.
    pure function mirrored_row(s, row) result(m)
        real(rk), intent(in) :: s(3), row(n_pair)
        real(rk) :: m(n_pair)
        integer :: t

        m = row
        do t = 1, 3
            associate (a => pair_stress + 3*t, b => pair_affine + 3*t)
                m(a - 2:a) = s(t)*s*row(a - 2:a)
                m(b - 2:b) = s(t)*s*row(b - 2:b)
            end associate
        end do
    end function mirrored_row

    !> The same for its hold.
    pure function mirrored_hold(s, row) result(m)
        real(rk), intent(in) :: s(3), row(n_held)
        real(rk) :: m(n_held)
        integer :: t

        m = row
        do t = 1, 3
            associate (a => held_affine + 3*t)
                m(a - 2:a) = s(t)*s*row(a - 2:a)
            end associate
        end do
    end function mirrored_hold
end module brz_solid_mirror
