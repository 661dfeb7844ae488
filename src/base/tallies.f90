! SPDX-License-Identifier: MIT
!> Block partial sums, called tallies, how a GPU adds up numbers of all loop bodies: each of a fixed
!> number of threads adds those of every tally_threads-th loop body to a number of its own.
module brz_tallies
    use brz_kinds, only: dp
    implicit none
    private
    public :: pick_chunk, tally_threads, tally_exactly

    integer, parameter :: tally_threads = 4096
    integer, parameter :: pick_chunk = 32 !! marks that a thread looks at

contains

    !> Note the terms of exact sums: in pass 0 the largest of each, in pass 1 what is added to the
    !> limbs of each, see brz_exact_sum. A largest term that is no number stays.
    !@cuf attributes(host,device) &
    pure subroutine tally_exactly(pass, sums, up, term, tally)
        integer, intent(in) :: pass, sums
        real(dp), intent(in) :: up(2, sums) !! both make a term smaller than 2^31
        real(dp), intent(in) :: term(sums)
        real(dp), intent(inout) :: tally(*) !! (sums), or three limbs of each
        real(dp) :: rest, whole
        integer :: k, r

        do r = 1, sums
            if (pass == 0) then
                if (tally(r) <= huge(rest) .and. .not. abs(term(r)) <= tally(r)) &
                    tally(r) = abs(term(r))
                cycle
            end if
            rest = term(r)*up(1, r)*up(2, r)
            if (.not. abs(rest) > 0) cycle ! factors of sums without a number are 0
            do k = 1, 3
                whole = aint(rest)
                tally(3*(r - 1) + k) = tally(3*(r - 1) + k) + whole
                rest = (rest - whole)*2.0_dp**31
            end do
        end do
    end subroutine tally_exactly
end module brz_tallies
