! SPDX-License-Identifier: MIT
!> What the host asks of its GPU and of other processes, part by part of a run: calls, bytes, and
!> how long the host was in them. Kernels run on beside it; a part whose host waits in reads and
!> waits is one of the GPU, one that waits in messages is one of another process.
module brz_host_calls
    use brz_kinds, only: dp, int64
    use brz_ranks, only: ranks_t, sum_of_all, traffic, traffic_t
    use brz_timer, only: wall_seconds
    implicit none
    private
    public :: counting, calls_so_far, count_calls, enter_part, record_call, print_calls
    public :: to_launch, to_copy, to_read, to_wait, to_reserve

    ! kinds of calls
    integer, parameter :: to_launch = 1
    integer, parameter :: to_copy = 2 !! to or on the GPU; fills
    integer, parameter :: to_read = 3 !! to the host, which waits
    integer, parameter :: to_wait = 4 !! for the GPU
    integer, parameter :: to_reserve = 5 !! memory, or to give it back
    integer, parameter :: to_tell = 6 !! other processes: all-reduces, counts, messages, greetings
    integer, parameter :: n_kinds = 6

    type :: share_t
        character(20) :: name = ''
        integer(int64) :: entered = 0
        integer(int64) :: calls(n_kinds) = 0, bytes(n_kinds) = 0
        real(dp) :: seconds = 0, inside(n_kinds) = 0 !! of it all, in each kind of call
    end type share_t

    integer, parameter :: most_parts = 24
    logical, protected :: counting = .false.
    type(share_t) :: parts(0:most_parts) !! the last one: what goes beyond the table
    integer :: now = 0, n = 0
    real(dp) :: since = 0 !! wall clock when this part was entered [s]
    type(traffic_t) :: said !! when this part was entered

contains

    !> Count from now on.
    subroutine count_calls()
        counting = .true.
        since = wall_seconds()
        call enter_part('start')
    end subroutine count_calls

    !> What follows belongs to a part of the run, entered once more unless it only goes on.
    subroutine enter_part(name, go_on)
        character(*), intent(in) :: name
        logical, intent(in), optional :: go_on
        integer :: k

        if (.not. counting) return
        associate (part => parts(now), messages => (traffic%reductions + traffic%fetches) &
                   - (said%reductions + said%fetches))
            part%seconds = part%seconds + (wall_seconds() - since)
            part%calls(to_tell) = part%calls(to_tell) + messages
            part%inside(to_tell) = part%inside(to_tell) + (traffic%seconds - said%seconds)
        end associate
        said = traffic
        since = wall_seconds()
        do k = 1, n
            if (parts(k)%name == name) exit
        end do
        now = min(k, most_parts)
        n = max(n, now)
        parts(now)%name = name
        if (.not. present(go_on)) parts(now)%entered = parts(now)%entered + 1
    end subroutine enter_part

    !> One call that began at some time.
    subroutine record_call(kind, bytes, began)
        integer, intent(in) :: kind
        integer(int64), intent(in) :: bytes
        real(dp), intent(in) :: began !! wall clock [s]

        if (.not. counting) return
        associate (part => parts(now))
            part%calls(kind) = part%calls(kind) + 1
            part%bytes(kind) = part%bytes(kind) + bytes
            part%inside(kind) = part%inside(kind) + (wall_seconds() - began)
        end associate
    end subroutine record_call

    !> Calls of a kind since they are counted.
    pure integer(int64) function calls_so_far(kind)
        integer, intent(in) :: kind

        calls_so_far = sum(parts%calls(kind))
    end function calls_so_far

    !> A table for each process; all must call, with the same parts.
    subroutine print_calls(unit, ranks)
        integer, intent(in) :: unit
        type(ranks_t), intent(in) :: ranks
        integer(int64) :: row(2*n_kinds + 4)
        integer :: k, r

        call enter_part('end')
        do r = 0, ranks%n - 1
            write (unit, '(a, i0, a)') 'host of process ', r + 1, &
                ': calls each time, and the milliseconds that it spends in them'
            write (unit, '(2a)') 'part                  times       ms       launches         '// &
                'copies          reads          waits         memory       messages   kB read'// &
                ' kB copied'
            do k = 1, n
                associate (part => parts(k))
                    row = 0
                    if (r == ranks%rank) row = [part%entered, nint(1e9_dp*part%seconds, int64), &
                        part%calls, nint(1e9_dp*part%inside, int64), part%bytes(to_read), &
                        part%bytes(to_copy)]
                    call sum_of_all(ranks, row)
                    call print_part(unit, part%name, row)
                end associate
            end do
        end do
    end subroutine print_calls

    subroutine print_part(unit, name, row)
        integer, intent(in) :: unit
        character(*), intent(in) :: name
        integer(int64), intent(in) :: row(:) !! times, ns, calls, ns in them, bytes read and copied
        real(dp) :: each
        integer :: k

        each = 1/real(max(row(1), 1_int64), dp)
        write (unit, '(a, i7, f9.3, 6(f7.1, f8.3), 2f10.1)') name, row(1), 1e-6_dp*row(2)*each, &
            (row(2 + k)*each, 1e-6_dp*row(2 + n_kinds + k)*each, k=1, n_kinds), &
            1e-3_dp*row(2*n_kinds + 3:)*each
    end subroutine print_part
end module brz_host_calls
