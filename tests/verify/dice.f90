! SPDX-License-Identifier: MIT
!> Random numbers that a seed alone decides.
module dice
    use brz_kinds, only: dp, int64
    implicit none
    private
    public :: dice_t

    type :: dice_t
        integer(int64), private :: state = 1
    contains
        procedure :: seed, draw, pick
    end type dice_t

contains

    subroutine seed(self, number)
        class(dice_t), intent(inout) :: self
        integer, intent(in) :: number
        integer :: m
        real(dp) :: not_used

        self%state = 7919*int(number, int64) + 12345
        do m = 1, 8 ! the first are alike for neighbouring seeds
            not_used = self%draw()
        end do
    end subroutine seed

    !> A number between 0 and 1 (xorshift of 64 bits, Marsaglia 2003).
    real(dp) function draw(self)
        class(dice_t), intent(inout) :: self

        self%state = ieor(self%state, ishft(self%state, 13))
        self%state = ieor(self%state, ishft(self%state, -7))
        self%state = ieor(self%state, ishft(self%state, 17))
        draw = real(ishft(self%state, -11), dp)/2.0_dp**53
    end function draw

    !> One of some numbers.
    integer function pick(self, from)
        class(dice_t), intent(inout) :: self
        integer, intent(in) :: from(:)

        pick = from(1 + min(size(from) - 1, int(size(from)*self%draw())))
    end function pick
end module dice
