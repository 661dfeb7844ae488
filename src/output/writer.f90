! SPDX-License-Identifier: MIT
!> Writing while the run goes on: a copy of the process, whose memory stays as it was, writes a file
!> and ends. One at a time; what it reports is heard at the next step.
!>
!> Worth it where the host has nothing else to do: compression of a dump takes one core some hundred
!> times as long as a step takes the GPU.
module brz_writer
    use, intrinsic :: iso_fortran_env, only: error_unit
    use brz_errors, only: error_t, exit_io, failed, raise
    use brz_kinds, only: dp
    use brz_process, only: copy_process, has_ended, leave_process
    use brz_timer, only: wall_seconds
    implicit none
    private
    public :: writer_t, begin_writing, end_writing, look_at_writer

    type :: writer_t
        integer :: copy = 0 !! the process that writes; 0: none
        logical :: here = .true. !! this process is to write
        character(:), allocatable :: what
        real(dp) :: begin = 0 !! wall-clock time [s]
        real(dp) :: seconds = 0 !! that the last one took
    end type writer_t

contains

    !> Decide who writes: a copy of this process, or where that is not wanted or not possible this
    !> one. The writer before must have ended. Who finds `here` true writes, and calls end_writing.
    subroutine begin_writing(writer, apart, what)
        type(writer_t), intent(inout) :: writer
        logical, intent(in) :: apart !! by a copy of the process
        character(*), intent(in) :: what !! is written, for messages

        writer%what = what
        writer%begin = wall_seconds()
        writer%copy = 0
        flush (error_unit) ! or the copy would say again what waits there
        if (apart) writer%copy = copy_process()
        writer%here = writer%copy <= 0
    end subroutine begin_writing

    !> After writing: a copy tells its error and is gone.
    subroutine end_writing(writer, apart, err)
        type(writer_t), intent(inout) :: writer
        logical, intent(in) :: apart !! as in begin_writing
        type(error_t), intent(in) :: err

        writer%seconds = wall_seconds() - writer%begin
        if (.not. apart .or. writer%copy < 0) then
            writer%copy = 0
            return
        end if
        if (failed(err)) write (error_unit, '(a)') err%text
        flush (error_unit)
        call leave_process(err%code)
    end subroutine end_writing

    !> Has a writer just ended? Its failure is one of the run.
    subroutine look_at_writer(writer, wait, ended, err)
        type(writer_t), intent(inout) :: writer
        logical, intent(in) :: wait !! until it has
        logical, intent(out) :: ended !! well, in this call
        type(error_t), intent(inout) :: err
        integer :: code

        ended = .false.
        if (writer%copy <= 0) return
        if (.not. has_ended(writer%copy, wait, code)) return
        writer%copy = 0
        writer%seconds = wall_seconds() - writer%begin
        ended = code == 0
        if (.not. ended) call raise(err, exit_io, writer%what//' could not be written')
    end subroutine look_at_writer
end module brz_writer
