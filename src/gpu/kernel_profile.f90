! SPDX-License-Identifier: MIT
!> Time by kernel: every launch is waited for and booked under the name of its kernel. That makes a
!> run slower, by some 20 us a launch, and nothing runs beside anything else.
module brz_kernel_profile
    use brz_kinds, only: dp, int64
    implicit none
    private
    public :: profiling, start_profile, book_launch, print_profile

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

    !> Book the launches from now on.
    subroutine start_profile()
        profiling = .true.
        n = 0
        table = launches_t()
    end subroutine start_profile

    !> One launch; kernels beyond the table are left out.
    subroutine book_launch(name, seconds)
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
    end subroutine book_launch

    !> The kernels that took at least a thousandth of the time, the longest first, and their sum.
    subroutine print_profile(unit)
        integer, intent(in) :: unit
        real(dp) :: total
        logical :: left(most_kernels)
        integer :: i, k

        total = max(sum(table(:n)%seconds), tiny(1.0_dp))
        left = .true.
        write (unit, '(a)') 'kernel                             launches   seconds   us each  share'
        do i = 1, n
            k = maxloc(table(:n)%seconds, 1, left(:n))
            left(k) = .false.
            if (table(k)%seconds < 1e-3_dp*total) exit
            call print_row(unit, table(k), total)
        end do
        call print_row(unit, launches_t('all', sum(table(:n)%launches), sum(table(:n)%seconds)), &
            total)
    end subroutine print_profile

    subroutine print_row(unit, entry, total)
        integer, intent(in) :: unit
        type(launches_t), intent(in) :: entry
        real(dp), intent(in) :: total !! [s]

        write (unit, '(a, i11, f10.3, f10.1, f6.1, a)') entry%name, entry%launches, &
            entry%seconds, 1e6_dp*entry%seconds/max(entry%launches, 1_int64), &
            100*entry%seconds/total, ' %'
    end subroutine print_row
end module brz_kernel_profile
