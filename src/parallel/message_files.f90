! SPDX-License-Identifier: MIT
!> Messages for the first process by way of files: copies of the processes, which write beside the
!> run, cannot send messages. Each leaves its message in a file beside what is to be written, and
!> the copy of the first waits for those of all others. A file without bytes says that one has
!> failed.
module brz_message_files
    use, intrinsic :: iso_c_binding, only: c_loc
    use brz_byte_file, only: add_from, byte_file_t, close_bytes, open_bytes, read_into, to_make, &
                             to_read
    use brz_errors, only: error_t, exit_io, failed, raise
    use brz_files, only: file_exists, remove_file, rename_file
    use brz_kinds, only: int64
    use brz_message_exchange, only: message_exchange_t
    use brz_process, only: is_orphan, rest
    use brz_ranks, only: ranks_t
    use brz_text, only: to_text
    implicit none
    private
    public :: post_by_files, give_up_message, forget_message

contains

    !> Name of the message of a process.
    pure function message_name(path, rank) result(name)
        character(*), intent(in) :: path !! of what is to be written
        integer, intent(in) :: rank
        character(:), allocatable :: name
        character(12) :: digits

        write (digits, '(i0.3)') rank + 1
        name = path//'.'//trim(digits)//'.parcel'
    end function message_name

    !> Hand all messages for the first process over; others must be empty. Raises exit_io where a
    !> file cannot be written or read, or a process has given up or ended.
    subroutine post_by_files(ranks, exchange, path, err)
        type(ranks_t), intent(in) :: ranks
        type(message_exchange_t), intent(inout), target :: exchange
        character(*), intent(in) :: path !! of what is to be written
        type(error_t), intent(inout) :: err
        type(byte_file_t) :: file
        integer :: r

        associate (first => exchange%out_first(0), bytes => exchange%out_first(1) - &
            exchange%out_first(0))
            if (ranks%rank == 0) then
                exchange%in(exchange%in_first(0):exchange%in_first(1) - 1) = &
                    exchange%out(first:first + bytes - 1)
            else if (bytes > 0) then
                call open_bytes(file, message_name(path, ranks%rank)//'.tmp', to_make, err)
                call add_from(file, c_loc(exchange%out(first)), bytes, err)
                call close_bytes(file, err)
                if (.not. failed(err)) call rename_file(file%path, &
                    message_name(path, ranks%rank), err)
            end if
        end associate
        if (ranks%rank > 0) return
        do r = 1, ranks%n - 1
            if (exchange%in_first(r + 1) > exchange%in_first(r)) &
                call take_message(exchange, r, path, err)
        end do
    end subroutine post_by_files

    !> Wait for the message of a process, read it, and remove its file.
    subroutine take_message(exchange, r, path, err)
        type(message_exchange_t), intent(inout), target :: exchange
        integer, intent(in) :: r
        character(*), intent(in) :: path
        type(error_t), intent(inout) :: err
        type(byte_file_t) :: file
        character(:), allocatable :: name
        integer(int64) :: n

        name = message_name(path, r)
        associate (first => exchange%in_first(r), &
                   bytes => exchange%in_first(r + 1) - exchange%in_first(r))
            do while (.not. (file_exists(name) .or. failed(err)))
                call rest()
                if (is_orphan()) call raise(err, exit_io, path//': the run has ended')
            end do
            call open_bytes(file, name, to_read, err)
            n = 0
            if (.not. failed(err)) call read_into(file, c_loc(exchange%in(first)), bytes, n, err)
            call close_bytes(file, err)
            if (n < bytes) call raise(err, exit_io, path//': the particles of process '// &
                                      to_text(r + 1)//' have not come')
            call remove_file(name)
        end associate
    end subroutine take_message

    !> The message of this process does not come: whoever waits for it need not.
    subroutine give_up_message(ranks, path)
        type(ranks_t), intent(in) :: ranks
        character(*), intent(in) :: path !! of what was to be written
        type(byte_file_t) :: file
        type(error_t) :: err

        if (ranks%rank == 0) return
        call forget_message(ranks, path)
        call open_bytes(file, message_name(path, ranks%rank), to_make, err)
        call close_bytes(file, err)
    end subroutine give_up_message

    !> Remove what is left of a message of this process.
    subroutine forget_message(ranks, path)
        type(ranks_t), intent(in) :: ranks
        character(*), intent(in) :: path

        call remove_file(message_name(path, ranks%rank))
        call remove_file(message_name(path, ranks%rank)//'.tmp')
    end subroutine forget_message
end module brz_message_files
