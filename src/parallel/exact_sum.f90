! SPDX-License-Identifier: MIT
!> Reproducible summation: sums that do not depend on order, threads or processes, in fixed-point
!> accumulators.
!>
!> All processes agree on the largest exponent of the terms. Each term is cut below it into limbs of
!> 31 bits; limbs are added as whole numbers, which is exact in any order. There is room for 2^32
!> terms. What lies 93 bits below the largest term is cut off, the same way everywhere.
!>
!> Terms are seen twice: by `widen`, and once `open_sums` has agreed on their size by `add_terms`.
module brz_exact_sum
    use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_positive_inf, ieee_quiet_nan, &
                                             ieee_value
    use brz_kinds, only: dp, int64
    use brz_ranks, only: most_of_all, ranks_t, several, sum_of_all
    implicit none
    private
    public :: exact_sums, exact_sum
    public :: limbs, bits, scale_t, widen, open_sums, add_terms, close_sums, carry_limbs

    integer, parameter :: bits = 31, limbs = 3
    integer(int64), parameter :: nothing = -5000 !! exponent where all terms are zero
    integer(int64), parameter :: no_number = 5000 !! and where one is no number

    !> Size of the terms of a sum.
    type :: scale_t
        integer(int64) :: top = nothing !! exponent of the largest, nothing, no_number
        real(dp) :: up(2) = 0 !! both together make a term smaller than 2^bits
    end type scale_t

contains

    !> Look at one term of each of several sums: the largest of each so far, no number is infinite.
    pure subroutine widen(x, largest)
        real(dp), intent(in) :: x(:) !! (sums)
        real(dp), intent(inout) :: largest(:) !! (sums) 0 at first
        integer :: r

        do r = 1, size(x)
            if (abs(x(r)) <= largest(r)) cycle
            largest(r) = abs(x(r))
            if (.not. ieee_is_finite(x(r))) largest(r) = ieee_value(x(r), ieee_positive_inf)
        end do
    end subroutine widen

    !> Agree on the size of the terms.
    subroutine open_sums(ranks, largest, scales)
        type(ranks_t), intent(in) :: ranks
        real(dp), intent(in) :: largest(:) !! (sums) what `widen` has found
        type(scale_t), intent(out) :: scales(:) !! (sums)
        integer(int64) :: top(size(largest))
        integer :: r

        top = nothing
        do r = 1, size(largest)
            if (largest(r) > 0) top(r) = exponent(largest(r))
            if (.not. ieee_is_finite(largest(r))) top(r) = no_number
        end do
        call most_of_all(ranks, top)
        do r = 1, size(largest)
            scales(r)%top = top(r)
            if (top(r) == nothing .or. top(r) == no_number) cycle
            associate (power => bits - int(top(r)))
                scales(r)%up = [scale(1.0_dp, power/2), scale(1.0_dp, power - power/2)]
            end associate
        end do
    end subroutine open_sums

    !> Add one term to each of several sums.
    pure subroutine add_terms(scales, x, limb)
        type(scale_t), intent(in) :: scales(:) !! (sums)
        real(dp), intent(in) :: x(:) !! (sums)
        integer(int64), intent(inout) :: limb(:, :) !! (limbs, sums) 0 at first
        real(dp) :: rest, whole
        integer :: k, r

        do r = 1, size(x)
            rest = x(r)*scales(r)%up(1)*scales(r)%up(2)
            if (.not. abs(rest) > 0) cycle ! scales of sums without a number are 0
            do k = 1, limbs
                whole = aint(rest)
                limb(k, r) = limb(k, r) + int(whole, int64)
                rest = (rest - whole)*2.0_dp**bits
            end do
        end do
    end subroutine add_terms

    !> The sums over all processes. No number gives no number.
    subroutine close_sums(ranks, scales, limb, total)
        type(ranks_t), intent(in) :: ranks
        type(scale_t), intent(in) :: scales(:) !! (sums)
        integer(int64), intent(in) :: limb(:, :) !! (limbs, sums)
        real(dp), intent(out) :: total(:) !! (sums)
        integer(int64) :: all(limbs*size(total))
        integer :: r

        all = reshape(limb, [size(all)])
        call sum_of_all(ranks, all)
        do r = 1, size(total)
            total(r) = 0
            if (scales(r)%top == no_number) then
                total(r) = ieee_value(total(r), ieee_quiet_nan)
            else if (scales(r)%top /= nothing) then
                total(r) = number_of(all(limbs*(r - 1) + 1:limbs*r), int(scales(r)%top))
            end if
        end do
    end subroutine close_sums

    !> Sums of several rows of terms, over all terms of all processes. No number gives no number.
    subroutine exact_sums(ranks, x, total)
        type(ranks_t), intent(in) :: ranks
        real(dp), intent(in) :: x(:, :) !! (rows, terms)
        real(dp), intent(out) :: total(:) !! (rows)
        type(scale_t) :: scales(size(x, 1))
        integer(int64) :: limb(limbs, size(x, 1))
        real(dp) :: largest(size(x, 1))
        integer :: i

        if (size(x, 2) == 1 .and. .not. several(ranks)) then ! one term is exact as it is
            total = x(:, 1)
            where (.not. abs(total) <= huge(total)) total = ieee_value(total, ieee_quiet_nan)
            return
        end if
        largest = 0
        do i = 1, size(x, 2)
            call widen(x(:, i), largest)
        end do
        call open_sums(ranks, largest, scales)
        limb = 0
        do i = 1, size(x, 2)
            call add_terms(scales, x(:, i), limb)
        end do
        call close_sums(ranks, scales, limb, total)
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
        integer(int64) :: limb(limbs)
        integer :: k

        limb = sums
        call carry_limbs(limb)
        total = 0
        do k = limbs, 1, -1
            total = total + scaled(real(limb(k), dp), top - bits*k)
        end do
    end function number_of

    !> Bring limbs into the one way to write a number: from 0 to 2^31 - 1, but for the first.
    pure subroutine carry_limbs(limb)
        integer(int64), intent(inout) :: limb(:)
        integer(int64) :: carry
        integer :: k

        do k = size(limb), 2, -1
            carry = shifta(limb(k), bits)
            limb(k) = limb(k) - shiftl(carry, bits)
            limb(k - 1) = limb(k - 1) + carry
        end do
    end subroutine carry_limbs
end module brz_exact_sum
