! SPDX-License-Identifier: MIT
!> What particles need of those of other processes, between GPUs: as brz_gpu_fetch, for lists of
!> places that change whenever neighbours are looked for anew.
module brz_gpu_message_buffers
    use brz_buffers, only: integers_t, part_from => from
    use brz_device, only: copy_within
    use brz_errors, only: error_t, exit_device, raise
    use brz_gpu_peers, only: peers_t
    use brz_places, only: message_buffers_t
    use brz_present_table, only: on_device
    use brz_kinds, only: int32, int64
    use brz_lists, only: put_list
    use brz_message_exchange, only: tell_all
    use brz_place_launches, only: place_kernels
    use brz_ranks, only: ranks_t, several
    use brz_record_rules, only: add_array, most_arrays, record_t
    use brz_rows, only: rows_t
    implicit none
    private
    public :: gpu_message_buffers_t, carry_rows

    type :: gpu_message_buffers_t
        type(ranks_t) :: ranks
        integer :: most = 0 !! words of a particle in a message
        type(message_buffers_t) :: out, in !! particles, and their ghosts
        type(message_buffers_t) :: gone, come !! who changes the process
        type(peers_t) :: peers
        type(integers_t) :: row !! where the messages of an exchange lie
    contains
        procedure :: open, refresh, aim, announce, send, send_apart, offer, take
    end type gpu_message_buffers_t

contains

    !> Get ready for the ghosts of now.
    subroutine open (self, ranks, out, in, most, err)
        class(gpu_message_buffers_t), intent(inout) :: self
        type(ranks_t), intent(in) :: ranks
        type(message_buffers_t), intent(in) :: out, in !! ghosts of now
        integer, intent(in) :: most !! words of 4 B of a particle in a message
        type(error_t), intent(inout) :: err

        self%ranks = ranks
        if (.not. several(ranks)) return
        self%out%first = out%first
        self%in%first = in%first
        self%most = (most + 1)/2*2
        call put_list(.true., out%place, self%out%place, err)
        call put_list(.true., in%place, self%in%place, err)
        call self%peers%open(ranks, 0_int64, err)
        call self%announce(self%out, err)
    end subroutine open

    !> Get ready to send a list: all processes hear how many go from each to each.
    subroutine announce(self, list, err)
        class(gpu_message_buffers_t), intent(inout) :: self
        type(message_buffers_t), intent(inout) :: list
        type(error_t), intent(inout) :: err
        integer(int64) :: all(1, self%ranks%n, self%ranks%n), number(1, self%ranks%n)

        number(1, :) = list%first(1:) - list%first(:self%ranks%n - 1)
        call tell_all(self%ranks, number, all)
        call self%aim(all(1, :, :), list, err)
    end subroutine announce

    !> Bring the rows of ghosts in some arrays up to date.
    subroutine refresh(self, arrays, err)
        class(gpu_message_buffers_t), intent(inout) :: self
        type(rows_t), intent(in) :: arrays(:)
        type(error_t), intent(inout) :: err

        if (several(self%ranks)) call self%send(self%out, self%in, arrays, arrays, err)
    end subroutine refresh

    !> Get ready to send a list of which all processes know how many go from each to each.
    subroutine aim(self, number, list, err)
        class(gpu_message_buffers_t), intent(inout) :: self
        integer(int64), intent(in) :: number(:, :) !! (to processes, from processes)
        type(message_buffers_t), intent(inout) :: list
        type(error_t), intent(inout) :: err

        call self%peers%aim(number, 4*self%most, list, err)
    end subroutine aim

    !> Send the rows of listed particles to others, and put those that come where a list says, in
    !> arrays with as many words of each.
    subroutine send(self, out, in, from, to, err)
        class(gpu_message_buffers_t), intent(inout) :: self
        type(message_buffers_t), intent(inout) :: out, in !! all processes have aimed `out`
        type(rows_t), intent(in) :: from(:), to(:)
        type(error_t), intent(inout) :: err

        call self%offer(out, in, from, err)
        call carry(self, out, in, from, to, err)
        call self%take(in, to, .false., err)
    end subroutine send

    !> The same, where what the process has for itself goes to the places of its message in another
    !> list, in other arrays: while all meet.
    subroutine send_apart(self, out, in, from, to, own_in, own_to, err)
        class(gpu_message_buffers_t), intent(inout) :: self
        type(message_buffers_t), intent(inout) :: out, in
        type(rows_t), intent(in) :: from(:), to(:), own_to(:)
        type(message_buffers_t), intent(in) :: own_in
        type(error_t), intent(inout) :: err

        call self%offer(out, in, from, err)
        call carry(self, out, own_in, from, own_to, err)
        call self%take(in, to, .false., err)
    end subroutine send_apart

    !> The first half of it: others get their rows. It may be repeated.
    subroutine offer(self, out, in, from, err)
        class(gpu_message_buffers_t), intent(inout) :: self
        type(message_buffers_t), intent(inout) :: out, in
        type(rows_t), intent(in) :: from(:)
        type(error_t), intent(inout) :: err
        integer :: wide
        type(integers_t) :: a(most_arrays)
        type(record_t) :: record

        wide = words_of(from)
        if (wide > self%most) call raise(err, exit_device, 'a message of particles is '// &
            'longer than what was reserved for it: this is an error of the program')
        call self%peers%begin(out, in, 4*wide, self%row, err)
        call make_record(from, record, a)
        if (out%tiled > 0) call place_kernels%pick_record(wide*out%tiled, wide, record, &
            out%messages, at(out%place), a(1), a(2), a(3), a(4), a(5), a(6), a(7), a(8), self%row, &
            err)
        call self%peers%finish(err)
    end subroutine offer

    !> The second half.
    subroutine take(self, in, to, met, err)
        class(gpu_message_buffers_t), intent(inout) :: self
        type(message_buffers_t), intent(inout) :: in
        type(rows_t), intent(in) :: to(:)
        logical, intent(in) :: met !! see swap
        type(error_t), intent(inout) :: err
        type(integers_t) :: a(most_arrays)
        type(record_t) :: record

        call self%peers%swap(met, err)
        call make_record(to, record, a)
        if (in%tiled > 0) call place_kernels%put_record(words_of(to)*in%tiled, words_of(to), &
            record, in%messages, at(in%place), self%row, a(1), a(2), a(3), a(4), a(5), a(6), a(7), &
            a(8), err)
    end subroutine take

    !> Words of a particle in a message.
    pure integer function words_of(rows) result(wide)
        type(rows_t), intent(in) :: rows(:)

        wide = (sum(rows%words*rows%columns) + 1)/2*2
    end function words_of

    !> The places of message r and those behind it.
    type(integers_t) function from_place(list, r) result(place)
        type(message_buffers_t), intent(in) :: list
        integer, intent(in) :: r

        place = integers_t(address=on_device(list%place(list%first(r):)))
    end function from_place

    !> What a process has for itself: from array to array, in runs where both lists say so.
    subroutine carry(self, out, in, from, to, err)
        class(gpu_message_buffers_t), intent(in) :: self
        type(message_buffers_t), intent(in) :: out, in
        type(rows_t), intent(in) :: from(:), to(:)
        type(error_t), intent(inout) :: err
        integer :: k
        logical :: runs

        runs = allocated(out%run) .and. allocated(in%run)
        associate (me => self%ranks%rank)
            do k = 1, size(from)
                if (runs .and. from(k)%columns == to(k)%columns .and. &
                    from(k)%pitch == to(k)%pitch) then
                    call copy_runs(from(k), out%run, to(k), in%run, err)
                    cycle
                end if
                call carry_rows(out%first(me + 1) - out%first(me), from(k), from_place(out, me), &
                                to(k), from_place(in, me), err)
            end do
        end associate
    end subroutine carry

    !> The rows of n listed particles of an array, to places in an array of such rows.
    subroutine carry_rows(n, from, from_place, to, to_place, err)
        integer, intent(in) :: n
        type(rows_t), intent(in) :: from, to
        type(integers_t), intent(in) :: from_place, to_place
        type(error_t), intent(inout) :: err

        associate (wide => from%words*from%columns)
            if (n > 0) call place_kernels%carry_words(n*wide, wide, from%words, from%pitch, &
                from%stride, from_place, from%of, to%words, to%pitch, to%stride, to_place, &
                to%of, err)
        end associate
    end subroutine carry_rows

    !> The whole rows of runs of particles, column by column.
    subroutine copy_runs(from, out, to, in, err)
        type(rows_t), intent(in) :: from, to
        integer, intent(in) :: out(:, :), in(:, :) !! (2, runs) first place, number
        type(error_t), intent(inout) :: err
        integer(int64) :: word
        integer :: c, r

        word = from%pitch
        do c = 0, from%columns - 1
            do r = 1, size(out, 2)
                call copy_within(part_from(from%of, c*from%stride + (out(1, r) - 1)*word + 1), &
                                 part_from(to%of, c*to%stride + (in(1, r) - 1)*word + 1), &
                                 4*word*out(2, r), err)
            end do
        end do
    end subroutine copy_runs

    !> The copy of a list.
    type(integers_t) function at(list)
        integer(int32), intent(in), target :: list(:)

        at = integers_t(address=on_device(list))
    end function at

    !> How records are made of some arrays, most_arrays at most.
    pure subroutine make_record(arrays, record, array)
        type(rows_t), intent(in) :: arrays(:)
        type(record_t), intent(out) :: record
        type(integers_t), intent(out) :: array(most_arrays)
        integer :: k

        do k = 1, size(arrays)
            call add_array(arrays(k)%words, arrays(k)%pitch, arrays(k)%columns, &
                           arrays(k)%stride, record)
            array(k) = arrays(k)%of
        end do
    end subroutine make_record
end module brz_gpu_message_buffers
