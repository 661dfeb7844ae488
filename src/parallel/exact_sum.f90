! SPDX-License-Identifier: MIT
!> Sums that do not depend on order, threads or processes.
!>
!> All processes agree on the largest exponent of the terms. Each term is cut below it into limbs of
!> 31 bits; limbs are added as whole numbers, which is exact in any order. There is room for 2^32
!> terms. What lies 93 bits below the largest term is cut off, the same way everywhere.
module brz_exact_sum
    use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_quiet_nan, ieee_value
    use brz_kinds, only: dp, int64
    use brz_ranks, only: most_of_all, ranks_t, sum_of_all
    implicit none
    private
    public :: exact_sums, exact_sum

    integer, parameter :: bits = 31, limbs = 3
    integer(int64), parameter :: nothing = -5000 !! exponent where all terms are zero
    integer(int64), parameter :: no_number = 5000 !! and where one is no number

contains

    !> Sums of several rows of terms, over all terms of all processes. No number gives no number.
    subroutine exact_sums(ranks, x, total)
        type(ranks_t), intent(in) :: ranks
        real(dp), intent(in) :: x(:, :) !! (rows, terms)
        real(dp), intent(out) :: total(:) !! (rows)
        integer(int64) :: top(size(x, 1)), limb(limbs*size(x, 1))
        integer :: i, k, r
        real(dp) :: rest, whole

        top = nothing
        do i = 1, size(x, 2)
            do r = 1, size(x, 1)
                if (.not. ieee_is_finite(x(r, i))) then
                    top(r) = no_number
                else if (abs(x(r, i)) > 0) then
                    top(r) = max(top(r), int(exponent(x(r, i)), int64))
                end if
            end do
        end do
        call most_of_all(ranks, top)
        limb = 0
        do i = 1, size(x, 2)
            do r = 1, size(x, 1)
                if (top(r) == nothing .or. top(r) == no_number) cycle
                rest = scaled(x(r, i), bits - int(top(r))) ! |rest| < 2^bits
                do k = 1, limbs
                    whole = aint(rest)
                    limb(limbs*(r - 1) + k) = limb(limbs*(r - 1) + k) + int(whole, int64)
                    rest = (rest - whole)*2.0_dp**bits
                end do
            end do
        end do
        call sum_of_all(ranks, limb)
        do r = 1, size(x, 1)
            total(r) = 0
            if (top(r) == no_number) total(r) = ieee_value(total(r), ieee_quiet_nan)
            if (top(r) /= nothing .and. top(r) /= no_number) &
                total(r) = number_of(limb(limbs*(r - 1) + 1:limbs*r), int(top(r)))
        end do
    end subroutine exact_sums

    !> Sum of one row of terms over all processes.
    real(dp) function exact_sum(ranks, x) result(total)
        type(ranks_t), intent(in) :: ranks
        real(dp), intent(in) :: x(:)
        real(dp) :: sums(1)

        call exact_sums(ranks, reshape(x, [1, size(x)]), sums)
        total = sums(1)
    end function exact_sum

    !> x 2^power for a result that is no larger than 2^31, in two steps where one would overflow.
    elemental real(dp) function scaled(x, power)
        real(dp), intent(in) :: x
        integer, intent(in) :: power

        scaled = scale(scale(x, power/2), power - power/2)
    end function scaled

    !> The number that limbs stand for, rounded once but for the last place.
    pure real(dp) function number_of(sums, top) result(total)
        integer(int64), intent(in) :: sums(limbs)
        integer, intent(in) :: top !! exponent of the largest term
        integer(int64) :: limb(limbs), carry
        integer :: k

        limb = sums
        do k = limbs, 2, -1 ! one way only to write the number: limbs from 0 to 2^31 - 1
            carry = shifta(limb(k), bits)
            limb(k) = limb(k) - shiftl(carry, bits)
            limb(k - 1) = limb(k - 1) + carry
        end do
        total = 0
        do k = limbs, 1, -1
            total = total + scaled(real(limb(k), dp), top - bits*k)
        end do
    end function number_of
end module brz_exact_sum
