! SPDX-License-Identifier: MIT
!> Cores of the machine for this process.
module brz_cores
    use, intrinsic :: iso_c_binding, only: c_int, c_long
    use omp_lib, only: omp_get_num_procs
    implicit none
    private
    public :: cores_for

    integer(c_int), parameter :: online = 84 ! _SC_NPROCESSORS_ONLN of Linux

    interface
        integer(c_long) function c_sysconf(name) bind(c, name='sysconf')
            import :: c_int, c_long
            integer(c_int), value :: name
        end function c_sysconf
    end interface

contains

    !> Those that this process is bound to; where several processes of a program are bound to the
    !> same ones, its share of the machine.
    integer function cores_for(processes) result(cores)
        integer, intent(in) :: processes !! on this machine

        cores = max(1, min(omp_get_num_procs(), int(c_sysconf(online))/processes))
    end function cores_for
end module brz_cores
