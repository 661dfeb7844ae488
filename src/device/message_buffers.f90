! SPDX-License-Identifier: MIT
!> Message buffers: rows of listed particles, cells or faces from some arrays into
!> those of other processes, in one message to each.
module brz_message_buffers
    use, intrinsic :: iso_c_binding, only: c_f_pointer, c_loc
    use brz_errors, only: error_t
    use brz_gpu_message_buffers, only: gpu_message_buffers_t
    use brz_kinds, only: int32, int64, int8
    use brz_message_exchange, only: message_exchange_t, make_room, post
    use brz_message_files, only: post_by_files
    use brz_places, only: message_buffers_t
    use brz_ranks, only: ranks_t
    use brz_rows, only: rows_t
    implicit none
    private
    public :: send_rows, courier_t

    integer, parameter :: worth_threads = 10000 !! rows

    !> Who sends, and the messages; what a process has for itself goes the same way.
    type :: courier_t
        type(ranks_t) :: ranks
        type(message_exchange_t) :: exchange
        type(gpu_message_buffers_t) :: device !! who does the same between GPUs
        logical :: on_gpu = .false. !! there
    contains
        procedure :: send, send_apart, announce, aim
    end type courier_t

contains

    !> Get ready to send a list: on GPUs all processes hear how many go from each to each.
    subroutine announce(self, list, err)
        class(courier_t), intent(inout) :: self
        type(message_buffers_t), intent(inout) :: list
        type(error_t), intent(inout) :: err

        if (self%on_gpu) call self%device%announce(list, err)
    end subroutine announce

    !> The same where all know already.
    subroutine aim(self, number, list, err)
        class(courier_t), intent(inout) :: self
        integer(int64), intent(in) :: number(:, :) !! (to processes, from processes)
        type(message_buffers_t), intent(inout) :: list
        type(error_t), intent(inout) :: err

        if (self%on_gpu) call self%device%aim(number, list, err)
    end subroutine aim

    !> Send the rows of listed particles to others, and put those that come where a list says, in
    !> arrays with as much of each. See send_rows.
    subroutine send(self, out, in, from, to, err)
        class(courier_t), intent(inout) :: self
        type(message_buffers_t), intent(inout) :: out, in !! all processes have announced or aimed
                                                          !! `out`
        type(rows_t), intent(in) :: from(:), to(:)
        type(error_t), intent(inout) :: err

        if (self%on_gpu) then
            call self%device%send(out, in, from, to, err)
        else
            call send_rows(self%ranks, out, in, from, to, self%exchange)
        end if
    end subroutine send

    !> The same, where what the process has for itself goes to the places of its message in another
    !> list, in other arrays.
    subroutine send_apart(self, out, in, from, to, own_in, own_to, err)
        class(courier_t), intent(inout) :: self
        type(message_buffers_t), intent(inout) :: out, in
        type(message_buffers_t), intent(in) :: own_in
        type(rows_t), intent(in) :: from(:), to(:), own_to(:)
        type(error_t), intent(inout) :: err

        if (self%on_gpu) then
            call self%device%send_apart(out, in, from, to, own_in, own_to, err)
        else
            call send_rows(self%ranks, out, in, from, to, self%exchange, own_in, own_to)
        end if
    end subroutine send_apart

    !> Send the rows of listed particles, and put those that come where a list says, in arrays with
    !> as many bytes in a row. In copies of the processes, by files: see message_exchange_t.
    subroutine send_rows(ranks, out, in, from, to, exchange, own_in, own_to)
        type(ranks_t), intent(in) :: ranks
        type(message_buffers_t), intent(in) :: out, in
        type(rows_t), intent(in) :: from(:), to(:)
        type(message_exchange_t), intent(inout) :: exchange
        type(message_buffers_t), intent(in), optional :: own_in !! see send_apart
        type(rows_t), intent(in), optional :: own_to(:)
        integer(int64) :: long(0:ranks%n - 1, 2)
        integer :: r

        do r = 0, ranks%n - 1
            long(r, 1) = sum(length(from, out%first(r + 1) - out%first(r)))
            long(r, 2) = sum(length(to, in%first(r + 1) - in%first(r)))
        end do
        if (present(own_to)) long(ranks%rank, 2) = long(ranks%rank, 1)
        call make_room(ranks, long(:, 1), long(:, 2), exchange)
        do r = 0, ranks%n - 1
            call pack_message(from, out, r, exchange)
        end do
        if (allocated(exchange%path)) then
            call post_by_files(ranks, exchange, exchange%path, exchange%fault)
        else
            call post(ranks, exchange)
        end if
        do r = 0, ranks%n - 1
            if (present(own_to) .and. r == ranks%rank) then
                call unpack_message(own_to, own_in, r, exchange)
            else
                call unpack_message(to, in, r, exchange)
            end if
        end do
    end subroutine send_rows

    !> Fill the message to process r.
    subroutine pack_message(from, list, r, exchange)
        type(rows_t), intent(in) :: from(:)
        type(message_buffers_t), intent(in) :: list
        integer, intent(in) :: r
        type(message_exchange_t), intent(inout) :: exchange
        integer(int64) :: at
        integer :: k

        at = exchange%out_first(r)
        associate (place => list%place(list%first(r):list%first(r + 1) - 1))
            do k = 1, merge(size(from), 0, size(place) > 0)
                call pack_rows(from(k), place, exchange%out(at:))
                at = at + length(from(k), size(place))
            end do
        end associate
    end subroutine pack_message

    !> Put the message from process r where a list says.
    subroutine unpack_message(to, list, r, exchange)
        type(rows_t), intent(in) :: to(:)
        type(message_buffers_t), intent(in) :: list
        integer, intent(in) :: r
        type(message_exchange_t), intent(in) :: exchange
        integer(int64) :: at
        integer :: k

        at = exchange%in_first(r)
        associate (place => list%place(list%first(r):list%first(r + 1) - 1))
            do k = 1, merge(size(to), 0, size(place) > 0)
                call unpack_rows(to(k), place, exchange%in(at:))
                at = at + length(to(k), size(place))
            end do
        end associate
    end subroutine unpack_message

    !> Bytes of n rows in a message: whole numbers of eight.
    elemental integer(int64) function length(rows, n)
        type(rows_t), intent(in) :: rows
        integer, intent(in) :: n

        length = (int(rows%bytes, int64)*n + 7)/8*8
    end function length

    !> Copy the rows of some places to a message.
    subroutine pack_rows(rows, place, message)
        type(rows_t), intent(in) :: rows
        integer(int32), intent(in) :: place(:)
        integer(int8), intent(inout), target, contiguous :: message(:)
        integer(int32), pointer, contiguous :: words(:, :), there(:, :)
        integer(int8), pointer, contiguous :: bytes(:, :), here(:, :)
        integer :: k

        associate (wide => rows%bytes, n => size(place))
            if (modulo(wide, 4) == 0) then
                call c_f_pointer(rows%host, words, [wide/4, maxval(place)])
                call c_f_pointer(c_loc(message), there, [wide/4, n])
                !$omp parallel do if(n >= worth_threads) schedule(static)
                do k = 1, n
                    there(:, k) = words(:, place(k))
                end do
            else
                call c_f_pointer(rows%host, bytes, [wide, maxval(place)])
                call c_f_pointer(c_loc(message), here, [wide, n])
                !$omp parallel do if(n >= worth_threads) schedule(static)
                do k = 1, n
                    here(:, k) = bytes(:, place(k))
                end do
            end if
        end associate
    end subroutine pack_rows

    !> The way back.
    subroutine unpack_rows(rows, place, message)
        type(rows_t), intent(in) :: rows
        integer(int32), intent(in) :: place(:)
        integer(int8), intent(in), target, contiguous :: message(:)
        integer(int32), pointer, contiguous :: words(:, :), there(:, :)
        integer(int8), pointer, contiguous :: bytes(:, :), here(:, :)
        integer :: k

        associate (wide => rows%bytes, n => size(place))
            if (modulo(wide, 4) == 0) then
                call c_f_pointer(rows%host, words, [wide/4, maxval(place)])
                call c_f_pointer(c_loc(message), there, [wide/4, n])
                !$omp parallel do if(n >= worth_threads) schedule(static)
                do k = 1, n
                    words(:, place(k)) = there(:, k)
                end do
            else
                call c_f_pointer(rows%host, bytes, [wide, maxval(place)])
                call c_f_pointer(c_loc(message), here, [wide, n])
                !$omp parallel do if(n >= worth_threads) schedule(static)
                do k = 1, n
                    bytes(:, place(k)) = here(:, k)
                end do
            end if
        end associate
    end subroutine unpack_rows
end module brz_message_buffers
