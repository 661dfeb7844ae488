! SPDX-License-Identifier: MIT
!> Writing while the run goes on: a copy of the process, whose memory stays as it was, writes a file
!> and ends. Several may write at once; they are heard in the order in which they began.
!>
!> Worth it where the host has nothing else to do: compression of a dump takes one core some hundred
!> times as long as a step takes the GPU.
module brz_writer
    use, intrinsic :: iso_fortran_env, only: error_unit
    use brz_errors, only: error_t, exit_io, failed, raise
    use brz_kinds, only: dp
    use brz_memory, only: free_memory, held_memory
    use brz_process, only: copy_process, has_ended, leave_process
    use brz_timer, only: wall_seconds
    use omp_lib, only: omp_get_num_procs
    implicit none
    private
    public :: writer_t, writers_t, has_room, begin_writing, end_writing, hear_writer

    integer, parameter :: most_writers = 16
    integer, parameter :: at_once = 4 !! writers that share the cores: about as many work together
    integer, parameter, public :: no_dump = -1

    type :: writer_t
        integer :: copy = 0 !! the process that writes; 0: this one
        character(:), allocatable :: what
        integer :: dump = no_dump !! its number, where it writes one
        integer :: step = 0 !! of the checkpoint, where it writes one
        real(dp) :: time = 0 !! of the dump [s]
        real(dp) :: begin = 0 !! wall-clock time [s]
        real(dp) :: seconds = 0 !! that it took
    end type writer_t

    type :: writers_t
        integer :: n = 0 !! that write, or have written and were not heard
        type(writer_t) :: of(most_writers) !! in the order in which they began
    end type writers_t

contains

    !> May one more copy of the process write now? One always may. More take a core each, this
    !> process keeping one; and memory: as much as the process holds, if all of it changes.
    logical function has_room(writers)
        type(writers_t), intent(in) :: writers

        has_room = writers%n < min(most_writers, max(1, omp_get_num_procs() - 1))
        if (has_room .and. writers%n > 0) has_room = free_memory() > 2*held_memory()
    end function has_room

    !> Decide who writes: a copy of this process, or where that is not wanted or not possible this
    !> one. A copy is put in the list, which must have room. Who finds `here` true writes, and calls
    !> end_writing.
    subroutine begin_writing(writers, writer, apart, here, last)
        type(writers_t), intent(inout) :: writers
        type(writer_t), intent(inout) :: writer !! with what it writes, for messages
        logical, intent(in) :: apart !! by a copy of the process
        logical, intent(out) :: here
        logical, intent(in), optional :: last !! nothing else goes on: the copy may use all cores
        integer :: cores

        writer%begin = wall_seconds()
        writer%copy = 0
        flush (error_unit) ! or the copy would say again what waits there
        cores = (omp_get_num_procs() - 1)/at_once
        if (present(last)) cores = merge(omp_get_num_procs(), cores, last)
        if (apart) writer%copy = copy_process(max(1, cores))
        here = writer%copy <= 0
        if (here) return
        writers%n = writers%n + 1
        writers%of(writers%n) = writer
    end subroutine begin_writing

    !> After writing: a copy tells its error and is gone.
    subroutine end_writing(writer, apart, err)
        type(writer_t), intent(inout) :: writer
        logical, intent(in) :: apart !! as in begin_writing
        type(error_t), intent(in) :: err

        writer%seconds = wall_seconds() - writer%begin
        if (.not. apart .or. writer%copy < 0) return
        if (failed(err)) write (error_unit, '(a)') err%text
        flush (error_unit)
        call leave_process(err%code)
    end subroutine end_writing

    !> Has the writer that began first ended well? Then it is taken from the list; so is one that
    !> has failed, and its failure is one of the run.
    subroutine hear_writer(writers, wait, writer, ended, err)
        type(writers_t), intent(inout) :: writers
        logical, intent(in) :: wait !! until it has
        type(writer_t), intent(out) :: writer
        logical, intent(out) :: ended !! well, in this call
        type(error_t), intent(inout) :: err
        integer :: code, m

        ended = .false.
        if (writers%n == 0) return
        if (.not. has_ended(writers%of(1)%copy, wait, code)) return
        writer = writers%of(1)
        writer%seconds = wall_seconds() - writer%begin
        do m = 2, writers%n
            writers%of(m - 1) = writers%of(m)
        end do
        writers%n = writers%n - 1
        ended = code == 0
        if (.not. ended) call raise(err, exit_io, writer%what//' could not be written')
    end subroutine hear_writer
end module brz_writer
