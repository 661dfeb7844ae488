! SPDX-License-Identifier: MIT
!> Writing while the run goes on: a copy of the process, whose memory stays as it was, writes a file
!> and ends. Several may write at once; they are heard in the order in which they began.
!>
!> Of several processes each has a copy that writes, and such files are there when all copies have
!> ended well: the processes reduce their errors.
!>
!> Worth it where the host has nothing else to do: compression of a dump takes one core some hundred
!> times as long as a step takes the GPU.
module brz_writer
    use, intrinsic :: iso_fortran_env, only: error_unit
    use brz_cores, only: cores_for
    use brz_errors, only: error_t, exit_io, failed, raise
    use brz_kinds, only: dp, int64
    use brz_memory, only: free_memory, held_memory
    use brz_process, only: copy_process, has_ended, leave_process
    use brz_ranks, only: reduce_errors, most_of_all, ranks_t, several
    use brz_timer, only: wall_seconds
    use omp_lib, only: omp_get_max_threads, omp_get_num_procs
    implicit none
    private
    public :: writer_t, writers_t, has_room, begin_writing, end_writing, hear_writer, &
        threads_of_copy

    integer, parameter :: most_writers = 16
    integer, parameter :: most_threads = 16 !! of a copy
    integer, parameter :: at_once = 4 !! writers that share the cores: about as many work together
    integer, parameter, public :: no_dump = -1

    type :: writer_t
        integer :: copy = -1 !! the process that writes; 0 in it, -1: none, the run does
        character(:), allocatable :: what
        integer :: dump = no_dump !! its number, where it writes one
        integer :: step = 0 !! of the checkpoint, where it writes one
        real(dp) :: time = 0 !! of the dump [s]
        real(dp) :: begin = 0 !! wall-clock time [s]
        real(dp) :: seconds = 0 !! that it took
        logical :: apart = .false. !! by a copy of the process, where that can be made
        logical :: listed = .false. !! to be heard
        logical :: ended = .false.
        integer :: code = 0 !! exit code, once it has ended
    end type writer_t

    type :: writers_t
        integer :: n = 0 !! that write, or have written and were not heard
        type(writer_t) :: of(most_writers) !! in the order in which they began
    end type writers_t

contains

    !> May one more copy of the process write now? One always may. More take a core each, this
    !> process keeping one; and memory: as much as the process holds, if all of it changes.
    logical function has_room(writers, ranks)
        type(writers_t), intent(in) :: writers
        type(ranks_t), intent(in) :: ranks
        integer(int64) :: full(1)

        has_room = writers%n < min(most_writers, max(1, omp_get_num_procs() - 1))
        if (has_room .and. writers%n > 0) has_room = free_memory() > 2*held_memory()
        full = merge(0, 1, has_room)
        call most_of_all(ranks, full)
        has_room = full(1) == 0
    end function has_room

    !> Decide who writes: a copy of this process, or where that is not wanted or not possible this
    !> one. What is written beside the run is put in the list, which must have room; so is what one
    !> of several processes writes itself, which is named in its turn. Who finds `here` true writes,
    !> and calls end_writing.
    subroutine begin_writing(writers, ranks, writer, here, last)
        type(writers_t), intent(inout) :: writers
        type(ranks_t), intent(in) :: ranks
        type(writer_t), intent(inout) :: writer !! with what it writes, for messages
        logical, intent(out) :: here
        logical, intent(in), optional :: last !! nothing else goes on: the copy has all cores
        integer :: sharing

        writer%begin = wall_seconds()
        writer%copy = -1
        flush (error_unit) ! or the copy would say again what waits there
        sharing = at_once
        if (present(last)) sharing = merge(1, at_once, last)
        if (writer%apart) writer%copy = copy_process(threads_of_copy(ranks, sharing))
        here = writer%copy <= 0
        writer%listed = writer%apart .and. (several(ranks) .or. .not. here)
        if (.not. writer%listed) return
        writers%n = writers%n + 1
        writers%of(writers%n) = writer
    end subroutine begin_writing

    !> Threads of a copy where so many writers share the threads of the run with it, or one has them
    !> alone: more than 16 only wait for memory. Of several processes the copy of the first packs
    !> what all have: it has half of the threads.
    integer function threads_of_copy(ranks, sharing) result(threads)
        type(ranks_t), intent(in) :: ranks
        integer, intent(in) :: sharing !! writers

        threads = min(cores_for(ranks%here), omp_get_max_threads()) ! of a process
        threads = (ranks%here*threads - merge(1, 0, sharing > 1))/sharing
        if (several(ranks)) threads = threads/merge(2, 2*max(ranks%here - 1, 1), ranks%rank == 0)
        threads = max(1, min(threads, omp_get_num_procs(), most_threads))
    end function threads_of_copy

    !> After writing: a copy tells its error and is gone.
    subroutine end_writing(writers, writer, err)
        type(writers_t), intent(inout) :: writers
        type(writer_t), intent(inout) :: writer
        type(error_t), intent(in) :: err

        writer%seconds = wall_seconds() - writer%begin
        if (writer%listed .and. writer%copy < 0) then
            writers%of(writers%n)%ended = .true.
            writers%of(writers%n)%code = err%code
        end if
        if (writer%copy < 0) return
        if (failed(err)) write (error_unit, '(a)') err%text
        flush (error_unit)
        call leave_process(err%code)
    end subroutine end_writing

    !> Has the writer that began first ended, in all processes? Then it is taken from the list; if
    !> one has failed, this is an error of the run.
    subroutine hear_writer(writers, ranks, wait, writer, ended, err)
        type(writers_t), intent(inout) :: writers
        type(ranks_t), intent(in) :: ranks
        logical, intent(in) :: wait !! until it has
        type(writer_t), intent(out) :: writer
        logical, intent(out) :: ended !! well, in this call
        type(error_t), intent(inout) :: err
        integer(int64) :: reductions(2)
        integer :: m

        ended = .false.
        if (writers%n == 0) return
        associate (first => writers%of(1))
            if (.not. first%ended) first%ended = has_ended(first%copy, wait, first%code)
            reductions = [merge(0, 1, first%ended), merge(first%code, 0, first%ended)]
            call most_of_all(ranks, reductions)
            writer = first
            if (reductions(1) > 0) return
        end associate
        writer%seconds = wall_seconds() - writer%begin
        do m = 2, writers%n
            writers%of(m - 1) = writers%of(m)
        end do
        writers%n = writers%n - 1
        ended = reductions(2) == 0
        if (ended) return
        if (writer%code /= 0) call raise(err, exit_io, writer%what//' could not be written')
        call reduce_errors(ranks, err)
    end subroutine hear_writer
end module brz_writer
