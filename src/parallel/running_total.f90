! SPDX-License-Identifier: MIT
!> Totals that grow over a whole run and depend on no order: what many processes and threads have
!> added in any order is the same number. As brz_exact_sum, with a largest exponent that is fixed
!> when the run begins, and one limb more.
module brz_running_total
    use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
    use brz_exact_sum, only: bits, carry_limbs
    use brz_kinds, only: dp, int64
    use brz_ranks, only: ranks_t, sum_of_all
    use brz_total_state, only: limbs, room, running_total_t, total_numbers
    implicit none
    private
    public :: running_total_t, begin_total, add_to_total, value_of, values_of_all, total_numbers

contains

    !> Start from a number, with the size that the total is expected to have.
    pure subroutine begin_total(total, size, start)
        type(running_total_t), intent(inout) :: total
        real(dp), intent(in) :: size
        real(dp), intent(in) :: start

        total%top = room
        if (abs(size) > 0) total%top = exponent(size) + room
        total%limb = 0
        call add_to_total(total, start)
    end subroutine begin_total

    !> Add a term.
    pure subroutine add_to_total(total, x)
        type(running_total_t), intent(inout) :: total
        real(dp), intent(in) :: x
        real(dp) :: rest, whole
        integer :: k

        if (.not. abs(x) < scale(1.0_dp, total%top)) then
            total%limb(0) = total%limb(0) + 1
            return
        end if
        rest = scale(x, bits - total%top)
        do k = 1, limbs
            whole = aint(rest)
            total%limb(k) = total%limb(k) + int(whole, int64)
            rest = (rest - whole)*2.0_dp**bits
        end do
        call carry_limbs(total%limb(1:))
    end subroutine add_to_total

    !> The total as a number; no number if a term was none.
    real(dp) function value_of(total)
        type(running_total_t), intent(in) :: total
        integer(int64) :: limb(0:limbs)
        integer :: k

        limb = total%limb
        call carry_limbs(limb(1:))
        value_of = 0
        do k = limbs, 1, -1
            value_of = value_of + scale(real(limb(k), dp), total%top - bits*k)
        end do
        if (limb(0) > 0) value_of = ieee_value(value_of, ieee_quiet_nan)
    end function value_of

    !> Several totals of all processes, in one message.
    subroutine values_of_all(ranks, totals, values)
        type(ranks_t), intent(in) :: ranks
        type(running_total_t), intent(in) :: totals(:)
        real(dp), intent(out) :: values(:)
        type(running_total_t) :: one
        integer(int64) :: limb((limbs + 1)*size(totals))
        integer :: k

        limb = [(totals(k)%limb, k=1, size(totals))]
        call sum_of_all(ranks, limb)
        do k = 1, size(totals)
            one = totals(k)
            one%limb = limb((limbs + 1)*(k - 1) + 1:(limbs + 1)*k)
            values(k) = value_of(one)
        end do
    end subroutine values_of_all
end module brz_running_total
