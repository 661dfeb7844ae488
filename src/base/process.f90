! SPDX-License-Identifier: MIT
!> Copies of this process: to go on computing while a copy, which has the memory as it was, writes.
!>
!> POSIX fork: the two share their memory until one of them changes it. The copy must not touch the
!> GPU.
module brz_process
    use, intrinsic :: iso_c_binding, only: c_int
    use omp_lib, only: omp_pause_resource_all, omp_pause_soft, omp_set_num_threads
    implicit none
    private
    public :: copy_process, leave_process, has_ended, is_orphan, rest

    integer, parameter :: killed = 128 !! exit code of a process that a signal has ended
    integer(c_int), save :: parent = 0 !! of a copy

    interface
        integer(c_int) function c_fork() bind(c, name='fork')
            import :: c_int
        end function c_fork
        integer(c_int) function c_waitpid(pid, status, options) bind(c, name='waitpid')
            import :: c_int
            integer(c_int), value :: pid, options
            integer(c_int), intent(out) :: status
        end function c_waitpid
        integer(c_int) function c_getpid() bind(c, name='getpid')
            import :: c_int
        end function c_getpid
        integer(c_int) function c_getppid() bind(c, name='getppid')
            import :: c_int
        end function c_getppid
        integer(c_int) function c_usleep(microseconds) bind(c, name='usleep')
            import :: c_int
            integer(c_int), value :: microseconds
        end function c_usleep
        subroutine c_leave(code) bind(c, name='_exit')
            import :: c_int
            integer(c_int), value :: code
        end subroutine c_leave
    end interface

contains

    !> Copy the process: 0 in the copy, the number of the copy in the process, -1 if there is none.
    !> Threads are not copied, so all but this one end before, and each process starts its own
    !> where it needs some; where they cannot end the copy has one.
    integer function copy_process(threads) result(number)
        integer, intent(in) :: threads !! that the copy may use
        logical :: ended
        integer(c_int) :: me

        me = c_getpid()
        ended = omp_pause_resource_all(omp_pause_soft) == 0
        number = c_fork()
        if (number /= 0) return
        parent = me
        call omp_set_num_threads(merge(threads, 1, ended))
    end function copy_process

    !> In a copy: has the process ended that it was copied from?
    logical function is_orphan()
        integer(c_int) :: now

        now = c_getppid()
        is_orphan = parent > 0 .and. now /= parent
    end function is_orphan

    !> Wait a moment: 2 ms.
    subroutine rest()
        integer(c_int) :: status

        status = c_usleep(2000_c_int)
    end subroutine rest

    !> End a copy at once: files that the process had open stay as they are.
    subroutine leave_process(code)
        integer, intent(in) :: code !! exit code

        call c_leave(int(code, c_int))
    end subroutine leave_process

    !> Has a copy ended? With `wait` it has when this returns.
    logical function has_ended(number, wait, code)
        integer, intent(in) :: number !! of the copy
        logical, intent(in) :: wait
        integer, intent(out) :: code !! its exit code, once it has ended
        integer(c_int), parameter :: at_once = 1 ! WNOHANG
        integer(c_int) :: found, status

        status = 0
        found = c_waitpid(int(number, c_int), status, merge(0_c_int, at_once, wait))
        has_ended = found /= 0
        code = iand(ishft(int(status), -8), 255)
        if (iand(int(status), 127) /= 0 .or. found < 0) code = killed
    end function has_ended
end module brz_process
