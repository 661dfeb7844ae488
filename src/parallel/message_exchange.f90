! SPDX-License-Identifier: MIT
!> Message exchange: bytes from every process to every other one, one message for each, some of them
!> empty.
!>
!> First all tell each other how long the messages are (`tell_counts`), then both sides make room
!> (`make_room`), and `post` sends them, as often as there is something new in them.
module brz_message_exchange
    use, intrinsic :: iso_c_binding, only: c_f_pointer, c_int, c_loc, c_null_ptr, c_ptr
    use brz_errors, only: error_t
    use brz_kinds, only: dp, int64, int8
    use brz_mpi_library, only: mpi_alltoall, mpi_double, mpi_int64, mpi_irecv, mpi_isend, &
                               mpi_waitall
    use brz_ranks, only: ranks_t, traffic
    use brz_timer, only: lap, wall_seconds
    implicit none
    private
    public :: message_exchange_t, tell_counts, tell_all, make_room, post, greet, put_numbers, &
              take_numbers, outgoing, incoming

    integer, parameter :: tag = 90
    integer, parameter :: unit = 8 !! bytes: messages are sent as numbers of so many

    !> Message r is bytes first(r) to first(r + 1) - 1; messages are whole numbers of units.
    type :: message_exchange_t
        integer(int64), allocatable :: out_first(:), in_first(:) !! (0:processes)
        integer(int8), allocatable :: out(:), in(:) !! bytes
        type(c_ptr), allocatable :: requests(:)
        !> In copies of the processes: beside what file those for the first go, see
        !> brz_message_files, and what has gone wrong.
        character(:), allocatable :: path
        type(error_t) :: fault
    end type message_exchange_t

contains

    !> Tell every process some numbers, and hear what it tells.
    subroutine tell_counts(ranks, out, in)
        type(ranks_t), intent(in) :: ranks
        integer(int64), intent(in), target, contiguous :: out(:, :) !! (numbers, processes)
        integer(int64), intent(out), target, contiguous :: in(:, :) !! the same
        integer(c_int) :: status
        real(dp) :: mark

        mark = wall_seconds()
        status = mpi_alltoall(c_loc(out), size(out, 1, kind=c_int), mpi_int64, c_loc(in), &
                              size(in, 1, kind=c_int), mpi_int64, ranks%comm)
        traffic%reductions = traffic%reductions + 1
        call lap(mark, traffic%seconds)
    end subroutine tell_counts

    !> Tell every process the numbers for all of them.
    subroutine tell_all(ranks, out, all)
        type(ranks_t), intent(in) :: ranks
        integer(int64), intent(in) :: out(:, :) !! (numbers, to processes)
        integer(int64), intent(out) :: all(:, :, :) !! (numbers, to processes, from processes)
        integer(int64), dimension(size(out), ranks%n) :: told, heard

        told = spread(reshape(out, [size(out)]), 2, ranks%n)
        call tell_counts(ranks, told, heard)
        all = reshape(heard, shape(all))
    end subroutine tell_all

    !> Room for messages of so many bytes, or with `elsewhere` only where they begin.
    subroutine make_room(ranks, out, in, exchange, elsewhere)
        type(ranks_t), intent(in) :: ranks
        integer(int64), intent(in) :: out(0:), in(0:) !! (processes) bytes to and from each
        type(message_exchange_t), intent(inout) :: exchange
        logical, intent(in), optional :: elsewhere !! they do not pass through the host
        integer :: r

        if (.not. allocated(exchange%requests)) then
            allocate (exchange%requests(2*ranks%n))
            allocate (exchange%out_first(0:ranks%n), exchange%in_first(0:ranks%n))
            exchange%out_first(0) = 1
            exchange%in_first(0) = 1
        end if
        do r = 0, ranks%n - 1
            exchange%out_first(r + 1) = exchange%out_first(r) + (out(r) + unit - 1)/unit*unit
            exchange%in_first(r + 1) = exchange%in_first(r) + (in(r) + unit - 1)/unit*unit
        end do
        if (present(elsewhere)) then
            if (elsewhere) return
        end if
        call lengthen(exchange%out_first(ranks%n), exchange%out)
        call lengthen(exchange%in_first(ranks%n), exchange%in)
    end subroutine make_room

    !> Room for n bytes, with something to spare.
    subroutine lengthen(n, bytes)
        integer(int64), intent(in) :: n
        integer(int8), allocatable, intent(inout) :: bytes(:)

        if (allocated(bytes)) then
            if (size(bytes, kind=int64) >= n) return
            deallocate (bytes)
        end if
        allocate (bytes(n + n/4))
    end subroutine lengthen

    !> Fill the message to a process with numbers; there is room for them.
    subroutine put_numbers(exchange, r, x)
        type(message_exchange_t), intent(inout), target :: exchange
        integer, intent(in) :: r !! process
        real(dp), intent(in) :: x(:, :)
        real(dp), pointer :: there(:, :)

        if (size(x) == 0) return
        call c_f_pointer(c_loc(exchange%out(exchange%out_first(r))), there, shape(x))
        there = x
    end subroutine put_numbers

    !> The numbers that a message from a process holds.
    subroutine take_numbers(exchange, r, x)
        type(message_exchange_t), intent(in), target :: exchange
        integer, intent(in) :: r !! process
        real(dp), intent(out) :: x(:, :)
        real(dp), pointer :: there(:, :)

        if (size(x) == 0) return
        call c_f_pointer(c_loc(exchange%in(exchange%in_first(r))), there, shape(x))
        x = there
    end subroutine take_numbers

    !> The numbers of the message to a process, to be filled in place.
    function outgoing(exchange, r, rows) result(x)
        type(message_exchange_t), intent(in), target :: exchange
        integer, intent(in) :: r, rows !! process; numbers that go together
        real(dp), pointer, contiguous :: x(:, :) !! (rows, ...)
        integer(int64) :: numbers

        numbers = (exchange%out_first(r + 1) - exchange%out_first(r))/unit
        call c_f_pointer(c_loc(exchange%out(exchange%out_first(r))), x, [int(rows, int64), &
            numbers/rows])
    end function outgoing

    !> The numbers of the message from a process, where they have come to.
    function incoming(exchange, r, rows) result(x)
        type(message_exchange_t), intent(in), target :: exchange
        integer, intent(in) :: r, rows !! process; numbers that go together
        real(dp), pointer, contiguous :: x(:, :) !! (rows, ...)
        integer(int64) :: numbers

        numbers = (exchange%in_first(r + 1) - exchange%in_first(r))/unit
        call c_f_pointer(c_loc(exchange%in(exchange%in_first(r))), x, [int(rows, int64), &
            numbers/rows])
    end function incoming

    !> Send all messages, and wait for those of the others. One to oneself is copied.
    subroutine post(ranks, exchange)
        type(ranks_t), intent(in) :: ranks
        type(message_exchange_t), intent(inout), target :: exchange
        integer(c_int) :: status
        integer :: n, r
        real(dp) :: mark

        mark = wall_seconds()
        n = 0
        do r = 0, ranks%n - 1
            associate (from => exchange%in_first(r), bytes => exchange%in_first(r + 1) - &
                exchange%in_first(r))
                if (r == ranks%rank .or. bytes == 0) cycle
                n = n + 1
                status = mpi_irecv(c_loc(exchange%in(from)), int(bytes/unit, c_int), mpi_double, &
                                   int(r, c_int), int(tag, c_int), ranks%comm, exchange%requests(n))
            end associate
        end do
        do r = 0, ranks%n - 1
            associate (from => exchange%out_first(r), &
                       bytes => exchange%out_first(r + 1) - exchange%out_first(r))
                if (r == ranks%rank .or. bytes == 0) cycle
                n = n + 1
                status = mpi_isend(c_loc(exchange%out(from)), int(bytes/unit, c_int), mpi_double, &
                                   int(r, c_int), int(tag, c_int), ranks%comm, exchange%requests(n))
            end associate
        end do
        associate (to => exchange%in_first(ranks%rank), from => exchange%out_first(ranks%rank), &
                   bytes => exchange%in_first(ranks%rank + 1) - exchange%in_first(ranks%rank))
            exchange%in(to:to + bytes - 1) = exchange%out(from:from + bytes - 1)
        end associate
        status = mpi_waitall(int(n, c_int), exchange%requests, c_null_ptr)
        traffic%fetches = traffic%fetches + 1
        call lap(mark, traffic%seconds)
    end subroutine post

    !> An empty message to and from every process: afterwards all of them have come as far as this.
    subroutine greet(ranks)
        type(ranks_t), intent(in) :: ranks
        type(c_ptr) :: requests(2*ranks%n)
        integer(c_int) :: status
        integer :: n, r
        real(dp) :: mark

        mark = wall_seconds()
        n = 0
        do r = 0, ranks%n - 1
            if (r == ranks%rank) cycle
            status = mpi_irecv(c_null_ptr, 0_c_int, mpi_double, int(r, c_int), int(tag, c_int), &
                               ranks%comm, requests(n + 1))
            status = mpi_isend(c_null_ptr, 0_c_int, mpi_double, int(r, c_int), int(tag, c_int), &
                               ranks%comm, requests(n + 2))
            n = n + 2
        end do
        status = mpi_waitall(int(n, c_int), requests, c_null_ptr)
        traffic%fetches = traffic%fetches + 1
        call lap(mark, traffic%seconds)
    end subroutine greet
end module brz_message_exchange
