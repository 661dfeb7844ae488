! SPDX-License-Identifier: MIT
!> Kinds of numbers.
!>
!> Positions, times and every sum are real64 (`dp`); rates, stresses and the gas use the working
!> real (`rk`), which `make PRECISION=mixed` turns into real32.
module brz_kinds
    use, intrinsic :: iso_fortran_env, only: int8, int16, int32, int64, real32, real64
    implicit none
    private
    public :: int8, int16, int32, int64, real32, real64, dp, rk

    integer, parameter :: dp = real64 !! positions, time, sums
#ifdef BRZ_MIXED
    integer, parameter :: rk = real32 !! working real
#else
    integer, parameter :: rk = real64 !! working real
#endif
end module brz_kinds
