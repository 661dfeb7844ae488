! SPDX-License-Identifier: MIT
!> Time by kernel: every launch is waited for and recorded under the name of its kernel. That makes
!> a run slower, by some 20 us a launch, and nothing runs beside anything else.
module brz_kernel_profile
    use brz_kinds, only: dp, int64
    use brz_ranks, only: ranks_t, several, sum_of_all
    implicit none
    private
    public :: profiling, start_profile, record_launch, print_profile

    type :: launches_t
        character(32) :: name = '' !! of the kernel
        integer(int64) :: launches = 0
        real(dp) :: seconds = 0
    end type launches_t

    integer, parameter :: most_kernels = 512
    logical, protected :: profiling = .false.
    integer :: n = 0
    type(launches_t) :: table(most_kernels)

contains

    !> Record the launches from now on.
    subroutine start_profile()
        profiling = .true.
        n = 0
        table = launches_t()
    end subroutine start_profile

    !> One launch; kernels beyond the table are left out.
    subroutine record_launch(name, seconds)
        character(*), intent(in) :: name
        real(dp), intent(in) :: seconds !! until it was done
        integer :: k

        do k = 1, n
            if (table(k)%name == name) exit
        end do
        if (k > most_kernels) return
        n = max(n, k)
        table(k)%name = name
        table(k)%launches = table(k)%launches + 1
        table(k)%seconds = table(k)%seconds + seconds
    end subroutine record_launch

    !> The kernels of each process that took at least a thousandth of its time, the longest first,
    !> and their sum; all must call.
    subroutine print_profile(unit, ranks)
        integer, intent(in) :: unit
        type(ranks_t), intent(in) :: ranks
        type(launches_t) :: of_one(most_kernels)
        integer :: r

        do r = 0, ranks%n - 1
            if (several(ranks)) write (unit, '(a, i0)') 'kernels of process ', r + 1
            call tell_table(ranks, r, of_one)
            call print_table(unit, pack(of_one, of_one%launches > 0))
        end do
    end subroutine print_profile

    !> The table of one process, in all of them.
    subroutine tell_table(ranks, r, of_one)
        type(ranks_t), intent(in) :: ranks
        integer, intent(in) :: r !! process
        type(launches_t), intent(out) :: of_one(:)
        integer(int64) :: row(6)
        integer :: k

        of_one = table
        if (.not. several(ranks)) return
        do k = 1, size(table)
            row = 0
            if (r == ranks%rank) row = [transfer(table(k)%name, row), table(k)%launches, &
                                        nint(1e9_dp*table(k)%seconds, int64)]
            call sum_of_all(ranks, row)
            of_one(k) = launches_t(transfer(row(:4), of_one(k)%name), row(5), 1e-9_dp*row(6))
        end do
    end subroutine tell_table

    subroutine print_table(unit, rows)
        integer, intent(in) :: unit
        type(launches_t), intent(in) :: rows(:)
        real(dp) :: total
        logical :: left(size(rows))
        integer :: i, k

        total = max(sum(rows%seconds), tiny(1.0_dp))
        left = .true.
        write (unit, '(a)') 'kernel                             launches   seconds   us each  share'
        do i = 1, size(rows)
            k = maxloc(rows%seconds, 1, left)
            left(k) = .false.
            if (rows(k)%seconds < 1e-3_dp*total) exit
            call print_row(unit, rows(k), total)
        end do
        call print_row(unit, launches_t('all', sum(rows%launches), sum(rows%seconds)), total)
    end subroutine print_table

    subroutine print_row(unit, entry, total)
        integer, intent(in) :: unit
        type(launches_t), intent(in) :: entry
        real(dp), intent(in) :: total !! [s]

        write (unit, '(a, i11, f10.3, f10.1, f6.1, a)') entry%name, entry%launches, &
            entry%seconds, 1e6_dp*entry%seconds/max(entry%launches, 1_int64), &
            100*entry%seconds/total, ' %'
    end subroutine print_row
end module brz_kernel_profile
