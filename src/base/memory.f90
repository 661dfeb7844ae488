! SPDX-License-Identifier: MIT
!> Memory that this process can still have, as Linux tells it under /proc and /sys.
module brz_memory
    use brz_files, only: file_exists
    use brz_kinds, only: dp
    use omp_lib, only: omp_get_max_threads
    implicit none
    private
    public :: free_memory, held_memory

    real(dp), parameter :: kib = 1024
    real(dp), parameter :: thread_bytes = 8e7_dp !! addresses that a thread takes: arena and stack

contains

    !> The least of: what the machine has free, what the limits of the process (`ulimit -v`) and
    !> of its control group leave [B]. huge where nothing is known.
    real(dp) function free_memory()
        real(dp) :: known

        free_memory = huge(free_memory)
        known = number_behind('/proc/meminfo', 'MemAvailable:')
        if (known >= 0) free_memory = known*kib
        known = number_behind('/proc/self/limits', 'Max address space')
        if (known >= 0) free_memory = min(free_memory, max(0.0_dp, &
            known - kib*max(0.0_dp, number_behind('/proc/self/status', 'VmSize:')) &
            - thread_bytes*omp_get_max_threads()))
        known = number_behind('/sys/fs/cgroup/memory.max', '')
        if (known >= 0) free_memory = min(free_memory, known)
        known = number_behind('/sys/fs/cgroup/memory/memory.limit_in_bytes', '')
        if (known >= 0) free_memory = min(free_memory, known)
    end function free_memory

    !> What this process holds of the machine's memory [B]; 0 where nothing is known.
    real(dp) function held_memory()
        held_memory = kib*max(0.0_dp, number_behind('/proc/self/status', 'VmRSS:'))
    end function held_memory

    !> The number that follows a word at the start of a line of a file; -1 where there is none.
    real(dp) function number_behind(path, word) result(number)
        character(*), intent(in) :: path, word
        character(256) :: line
        integer :: status, unit

        number = -1
        if (.not. file_exists(path)) return
        open (newunit=unit, file=path, action='read', status='old', iostat=status)
        if (status /= 0) return
        do
            read (unit, '(a)', iostat=status) line
            if (status /= 0) exit
            if (index(line, word) /= 1) cycle
            read (line(len(word) + 1:), *, iostat=status) number
            if (status /= 0) number = -1
            exit
        end do
        close (unit)
    end function number_behind
end module brz_memory
