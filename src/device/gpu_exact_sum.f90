! SPDX-License-Identifier: MIT
!> Exact sums on the GPU, over all processes: loop bodies whose sums are `@exact` run twice, to find
!> the largest terms and then to add up their limbs, see brz_exact_sum. Limbs are whole numbers.
module brz_gpu_exact_sum
    use, intrinsic :: ieee_arithmetic, only: ieee_positive_inf, ieee_value
    use brz_buffers, only: doubles_t
    use brz_common_launches, only: common_kernels
    use brz_device, only: allocate_buffer, copy_in, copy_out, sessions
    use brz_errors, only: error_t
    use brz_exact_sum, only: close_sums, limbs, open_sums, scale_t
    use brz_gpu_common, only: gpu_common_t
    use brz_kinds, only: dp, int64
    use brz_ranks, only: ranks_t
    use brz_tallies, only: tally_threads
    implicit none
    private
    public :: gpu_exact_t, exact_for

    integer, parameter :: most = 18 !! sums of a loop body
    integer, parameter :: rows = 32 !! largest terms of each that are left for the host

    type :: gpu_exact_t
        type(ranks_t) :: ranks
        type(doubles_t) :: sums !! (tally_threads, limbs*most) of the pass at hand
        type(doubles_t) :: up !! (2, most) both together make a term smaller than 2^31
        type(scale_t) :: scales(most)
        real(dp) :: total(most) = 0
        type(gpu_common_t) :: common
    contains
        procedure :: open, end
    end type gpu_exact_t

    type(gpu_exact_t), save, target :: one !! sums are taken one after the other
    integer, save :: session = -1 !! for which it is open

contains

    !> Where the sums of a loop body over the processes are taken, see the loops.
    function exact_for(ranks, err) result(exact)
        type(ranks_t), intent(in) :: ranks
        type(error_t), intent(inout) :: err
        type(gpu_exact_t), pointer :: exact

        exact => one
        if (session /= sessions) then
            one = gpu_exact_t()
            call one%open(ranks, err)
            session = sessions
        end if
        one%ranks = ranks
    end function exact_for

    subroutine open (self, ranks, err)
        class(gpu_exact_t), intent(inout) :: self
        type(ranks_t), intent(in) :: ranks
        type(error_t), intent(inout) :: err

        self%ranks = ranks
        call self%common%open(limbs*most, 1, err)
        call allocate_buffer(self%sums, 8_int64*tally_threads*limbs*most, err)
        call allocate_buffer(self%up, 16_int64*most, err)
    end subroutine open

    !> A pass has ended: 0 has found the largest term of each sum, 1 leaves their `total`. All
    !> processes must call.
    subroutine end(self, pass, n, err)
        class(gpu_exact_t), intent(inout) :: self
        integer, intent(in) :: pass, n
        type(error_t), intent(inout) :: err
        real(dp) :: folded(rows, n), largest(n), sums(limbs*n, 1), up(2, n)
        integer :: r

        if (pass == 1) then
            call self%common%fold(self%sums, tally_threads, limbs*n, 1, err)
            call self%common%read_sums(1, sums, err)
            call close_sums(self%ranks, self%scales(:n), &
                            reshape(nint(sums, int64), [limbs, n]), self%total(:n))
            return
        end if
        call common_kernels%largest([rows, n, 1], tally_threads, rows, self%sums, &
                                    self%common%folded, err)
        folded = 0
        call copy_out(self%common%folded, folded, 8_int64*rows*n, err)
        do r = 1, n
            largest(r) = maxval(folded(:, r))
            if (.not. all(folded(:, r) <= huge(largest))) largest(r) = &
                ieee_value(largest(r), ieee_positive_inf)
        end do
        call open_sums(self%ranks, largest, self%scales(:n))
        do r = 1, n
            up(:, r) = self%scales(r)%up
        end do
        call copy_in(up, self%up, 16_int64*n, err)
    end subroutine end
end module brz_gpu_exact_sum
