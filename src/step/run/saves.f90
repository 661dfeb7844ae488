! SPDX-License-Identifier: MIT
!> Dumps and checkpoints: written by this process, or where a GPU computes by copies of it beside
!> the run, and named in the order in which they began.
module brz_saves
    use brz_backend_fetch, only: fetch_exchange, fetch_order, fetch_state, fetch_sums, &
        take_snapshot
    use brz_checkpoint, only: name_checkpoint, remove_checkpoint, write_checkpoint
    use brz_dumps, only: bodies_path, dumps_t, name_dump, write_dump_files
    use brz_errors, only: error_t, failed
    use brz_kinds, only: dp
    use brz_output_folder, only: checkpoint_name
    use brz_message_files, only: forget_message, give_up_message
    use brz_ranks, only: reduce_errors, several
    use brz_simulation, only: simulation_t
    use brz_snapshots, only: snapshot_t, use_snapshot
    use brz_text, only: to_text
    use brz_timer, only: lap, wall_seconds
    use brz_together, only: begin_bodies, begin_state, together_t
    use brz_writer, only: begin_writing, end_writing, has_room, hear_writer, no_dump, writer_t, &
                          writers_t
    implicit none
    private
    public :: saves_t, hear_writers, on_gpu, save_dump, save_state

    type :: saves_t
        type(dumps_t) :: dumps
        type(writers_t) :: writers !! of dumps and checkpoints, beside the run
        type(together_t) :: together !! of several processes, while they write
        real(dp) :: reserve = 0 !! wall-clock time that a checkpoint has taken at most [s]
        real(dp) :: fetching = 0 !! time that the run has lost: the state brought to the host [s]
        real(dp) :: copying = 0 !! copies of the process begun [s]
        real(dp) :: writing = 0 !! files written, or awaited [s]
        integer :: saved_cycle = -1 !! cycle of the last checkpoint
    end type saves_t

contains

    !> Hear what has become of the dumps and the checkpoint that are written beside the run; those
    !> that are written are named, in their order.
    subroutine hear_writers(sim, saves, most, err)
        type(simulation_t), intent(in) :: sim
        type(saves_t), intent(inout) :: saves
        integer, intent(in) :: most !! wait until no more than that are at work
        type(error_t), intent(inout) :: err
        type(writer_t) :: writer
        logical :: ended

        do
            call hear_writer(saves%writers, sim%ranks, saves%writers%n > most, writer, ended, err)
            if (.not. ended) then
                if (allocated(writer%what)) call see_to_failure(sim, saves, writer, failed(err))
                exit
            end if
            call written(sim, saves, writer, err)
            call reduce_errors(sim%ranks, err) ! names are given by the first
        end do
    end subroutine hear_writers

    !> Where this process has failed to write, the others learn that its particles do not come; once
    !> all have ended, what is left of it is removed.
    subroutine see_to_failure(sim, saves, writer, all_ended)
        type(simulation_t), intent(in) :: sim
        type(saves_t), intent(in) :: saves
        type(writer_t), intent(in) :: writer !! its files
        logical, intent(in) :: all_ended

        if (all_ended) then
            call forget_message(sim%ranks, path_of(saves, writer))
            if (writer%dump == no_dump .and. saves%dumps%leads) &
                call remove_checkpoint(saves%dumps%folder, writer%step)
        else if (writer%ended .and. writer%code /= 0) then
            call give_up_message(sim%ranks, path_of(saves, writer))
        end if
    end subroutine see_to_failure

    !> Wait until one more copy of the process may write.
    subroutine make_room(sim, saves, err)
        type(simulation_t), intent(in) :: sim
        type(saves_t), intent(inout) :: saves
        type(error_t), intent(inout) :: err

        do while (.not. (has_room(saves%writers, sim%ranks) .or. failed(err)))
            call hear_writers(sim, saves, saves%writers%n - 1, err)
        end do
    end subroutine make_room

    !> A dump or a checkpoint is on the disk: name it. Keep in mind what a checkpoint took.
    subroutine written(sim, saves, writer, err)
        type(simulation_t), intent(in) :: sim
        type(saves_t), intent(inout) :: saves
        type(writer_t), intent(in) :: writer
        type(error_t), intent(inout) :: err
        type(error_t) :: naming ! a file that is good gets its name after an error too

        if (writer%dump == no_dump) then
            if (saves%dumps%leads) call name_checkpoint(saves%dumps%folder, writer%step, naming)
            saves%reserve = max(saves%reserve, 2*writer%seconds)
        else
            call name_dump(saves%dumps, writer%dump, writer%time, sim%air%present, &
                           sim%solid%present, naming)
        end if
        if (failed(naming) .and. .not. failed(err)) err = naming
    end subroutine written

    !> True if a GPU computes, so that the host has time to write.
    pure logical function on_gpu(sim)
        type(simulation_t), intent(in) :: sim

        on_gpu = sim%backend%on_gpu .or. sim%backend%bodies_on_gpu
    end function on_gpu

    !> The file that holds the particles.
    pure function path_of(saves, writer) result(path)
        type(saves_t), intent(in) :: saves
        type(writer_t), intent(in) :: writer
        character(:), allocatable :: path

        path = bodies_path(saves%dumps%folder, writer%dump)
        if (writer%dump == no_dump) path = saves%dumps%folder//'/'//checkpoint_name(writer%step)
    end function path_of

    !> Decide who writes, and bring the state to the host there. A copy of this process has it from
    !> a snapshot: what this one has on its host stays as it is, and no page is copied for it.
    subroutine begin(sim, saves, writer, here, err, last)
        type(simulation_t), intent(inout) :: sim
        type(saves_t), intent(inout) :: saves
        type(writer_t), intent(inout) :: writer
        logical, intent(out) :: here !! this process writes, or it is the copy that does
        type(error_t), intent(inout) :: err
        logical, intent(in), optional :: last !! see begin_writing
        type(snapshot_t) :: snapshot
        real(dp) :: mark

        here = .false.
        mark = wall_seconds()
        call fetch_sums(sim%backend, sim%air, sim%solid, err)
        if (several(sim%ranks)) then
            call fetch_order(sim%backend, sim%solid, err)
            call begin_bodies(saves%together, sim%solid)
            if (writer%dump == no_dump) then
                call fetch_exchange(sim%coupling, err)
                call begin_state(saves%together, sim%air, sim%coupling)
            end if
            saves%together%by_files = writer%apart
            call forget_message(sim%ranks, path_of(saves, writer))
        end if
        if (writer%apart .and. .not. failed(err)) &
            call take_snapshot(sim%backend, sim%air, sim%solid, sim%coupling, snapshot)
        if (snapshot%room == 0) &
            call fetch_state(sim%backend, sim%air, sim%solid, sim%coupling, err)
        call reduce_errors(sim%ranks, err)
        call lap(mark, saves%fetching)
        if (failed(err)) return
        call begin_writing(saves%writers, sim%ranks, writer, here, last)
        call lap(mark, saves%copying)
        if (snapshot%room == 0 .or. .not. here) return
        if (writer%copy == 0) call use_snapshot(snapshot) ! else no copy could be made
        call fetch_state(sim%backend, sim%air, sim%solid, sim%coupling, err)
        call snapshot%give_back()
        call use_snapshot(snapshot)
    end subroutine begin

    !> Write a dump; where a GPU computes, beside the run, and the last one beside the checkpoint
    !> that follows.
    subroutine save_dump(sim, saves, last, err)
        type(simulation_t), intent(inout) :: sim
        type(saves_t), intent(inout) :: saves
        logical, intent(in) :: last !! the run ends here
        type(error_t), intent(inout) :: err
        type(writer_t) :: writer
        real(dp) :: mark
        logical :: here

        mark = wall_seconds()
        call make_room(sim, saves, err)
        call lap(mark, saves%writing)
        writer%apart = on_gpu(sim)
        writer%what = 'the dump of t = '//to_text(sim%clock%time)//' s'
        writer%dump = sim%clock%dump_number
        writer%time = sim%clock%time
        call begin(sim, saves, writer, here, err, last)
        mark = wall_seconds()
        if (here) then
            call write_dump_files(saves%together, sim%case, sim%clock, sim%air, &
                                  sim%coupling%wall, sim%solid, err)
            call end_writing(saves%writers, writer, err)
            if (allocated(saves%together%whole)) deallocate (saves%together%whole)
            ! those that began before have their names first
            if (.not. writer%listed) call hear_writers(sim, saves, 0, err)
        end if
        call reduce_errors(sim%ranks, err)
        call lap(mark, saves%writing)
        if (failed(err)) return
        sim%clock%dump_number = sim%clock%dump_number + 1
        sim%clock%dump_time = sim%clock%time
        if (here .and. .not. writer%listed) call written(sim, saves, writer, err)
        call reduce_errors(sim%ranks, err)
    end subroutine save_dump

    !> Write a checkpoint; the histories up to it must be on the disk.
    subroutine save_state(sim, saves, apart, err)
        type(simulation_t), intent(inout) :: sim
        type(saves_t), intent(inout) :: saves
        logical, intent(in) :: apart !! beside the run; else it is on the disk on return
        type(error_t), intent(inout) :: err
        real(dp) :: sums(9)
        type(writer_t) :: writer
        real(dp) :: mark
        logical :: here

        mark = wall_seconds()
        if (apart) then
            call make_room(sim, saves, err)
        else
            call hear_writers(sim, saves, 0, err)
        end if
        call lap(mark, saves%writing)
        if (saves%saved_cycle == sim%clock%cycle .or. failed(err)) return
        sums = [sim%start%total, sim%start%mass, sim%start%momentum, sim%start%energy, &
                sim%start%work, sim%start%supply, sim%start%available]
        writer%what = 'the checkpoint of t = '//to_text(sim%clock%time)//' s'
        writer%step = sim%clock%cycle
        writer%apart = apart
        call begin(sim, saves, writer, here, err)
        mark = wall_seconds()
        if (here) then
            if (writer%copy < 0 .and. .not. writer%listed) &
                call hear_writers(sim, saves, 0, err) ! those before it first
            call write_checkpoint(saves%together, sim%case, sim%clock, sim%air, sim%coupling, &
                                  sim%solid, sums, err)
            if (.not. apart) call reduce_errors(sim%ranks, err)
            if (failed(err) .and. saves%dumps%leads) &
                call remove_checkpoint(saves%dumps%folder, writer%step)
            call end_writing(saves%writers, writer, err)
            if (allocated(saves%together%whole)) deallocate (saves%together%whole)
            if (.not. (failed(err) .or. writer%listed)) call written(sim, saves, writer, err)
            call reduce_errors(sim%ranks, err)
        end if
        call lap(mark, saves%writing)
        if (.not. failed(err)) saves%saved_cycle = sim%clock%cycle
    end subroutine save_state
end module brz_saves
