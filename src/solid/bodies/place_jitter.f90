! SPDX-License-Identifier: MIT
!> Particles a little off their places, to see what chance does to a body that breaks.
!>
!> The shifts are numbers of a small generator that starts from seed and body: the same on any
!> machine, for any number of threads and processes.
module brz_place_jitter
    use brz_kinds, only: dp
    implicit none
    private
    public :: jitter_places

    ! the generator of Lehmer with the multiplier of Park and Miller, Comm. ACM 31 (1988) 1192
    integer, parameter :: wide = selected_int_kind(18)
    integer(wide), parameter :: multiplier = 48271_wide, modulus = 2147483647_wide
    integer, parameter :: first_thrown = 8 !! numbers that lie too near to the seed

contains

    !> Shift the particles of a body by up to `reach` along each axis that is modelled.
    pure subroutine jitter_places(reach, seed, number, dimension, x)
        real(dp), intent(in) :: reach !! [m]
        integer, intent(in) :: seed !! from 0
        integer, intent(in) :: number !! of the body
        integer, intent(in) :: dimension
        real(dp), intent(inout) :: x(:, :) !! (3, n) [m]
        integer(wide) :: state
        integer :: a, i

        if (.not. reach > 0) return
        state = 1 + modulo(7919_wide*seed + 104729_wide*number, modulus - 1)
        do i = 1, first_thrown
            state = modulo(multiplier*state, modulus)
        end do
        do i = 1, size(x, 2)
            do a = 1, dimension
                state = modulo(multiplier*state, modulus)
                x(a, i) = x(a, i) + reach*(2*real(state, dp)/real(modulus, dp) - 1)
            end do
        end do
    end subroutine jitter_places

end module brz_place_jitter
