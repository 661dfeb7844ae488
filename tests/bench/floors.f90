! SPDX-License-Identifier: MIT
!> What the machine can do: the floors that the benchmarks compare with, measured in the same run.
module brz_bench_floors
    use, intrinsic :: iso_fortran_env, only: output_unit
    use brz_kinds, only: dp, rk
    use omp_lib, only: omp_get_max_threads
    implicit none
    private
    public :: argument, floors_t, measure_floors, core_time

    !> What the machine can do.
    type :: floors_t
        real(dp) :: bytes = 0, flops = 0, divisions = 0 !! per second of core time
    end type floors_t

    !> A number of the command line.
    interface argument
        module procedure whole_argument, real_argument
    end interface argument

contains

    integer function whole_argument(k, default)
        integer, intent(in) :: k, default

        whole_argument = nint(real_argument(k, real(default, dp)))
    end function whole_argument

    real(dp) function real_argument(k, default)
        integer, intent(in) :: k
        real(dp), intent(in) :: default
        character(20) :: text

        real_argument = default
        call get_command_argument(k, text)
        if (len_trim(text) > 0) read (text, *) real_argument
    end function real_argument

    !> Bandwidth, multiply-adds and divisions per second of core time, with all threads at it.
    subroutine measure_floors(floors)
        type(floors_t), intent(out) :: floors
        integer, parameter :: large = 6000000, small = 1024, rounds = 4000
        real(rk), allocatable :: a(:), b(:), c(:)
        real(rk) :: x(small)
        integer :: i, k, pass

        allocate (a(large), b(large), c(large), source=1.0_rk)
        do pass = 1, 4
            floors%bytes = -core_time()
            !$omp parallel do schedule(static)
            do i = 1, large
                a(i) = b(i) + 0.5_rk*c(i)
            end do
            floors%bytes = 3.0_dp*storage_size(1.0_rk)/8*large/(floors%bytes + core_time())
            c(pass) = a(pass)
        end do
        floors%flops = -core_time()
        !$omp parallel private(x, i, k)
        x = 1.0_rk
        do k = 1, rounds
            do i = 1, small
                x(i) = polynomial(x(i))
            end do
        end do
        if (sum(x) < 0) write (output_unit, *) x
        !$omp end parallel
        floors%flops = 32.0_dp*rounds*small*omp_get_max_threads()/(floors%flops + core_time())
        floors%divisions = -core_time()
        !$omp parallel private(x, i, k)
        x = 1.0_rk
        do k = 1, rounds
            do i = 1, small
                x(i) = 2/(x(i) + 1)
            end do
        end do
        if (sum(x) < 0) write (output_unit, *) x
        !$omp end parallel
        floors%divisions = 1.0_dp*rounds*small*omp_get_max_threads() &
            /(floors%divisions + core_time())
    end subroutine measure_floors

    !> Time that the cores have worked for this program so far [s].
    real(dp) function core_time()
        call cpu_time(core_time)
    end function core_time

    !> Sixteen multiply-adds.
    pure real(rk) function polynomial(x) result(p)
        real(rk), intent(in) :: x
        integer :: i

        p = x
        do i = 1, 16
            p = 0.5_rk - 0.25_rk*p
        end do
    end function polynomial
end module brz_bench_floors
