! SPDX-License-Identifier: MIT
!> Checkpoints: the whole state of a run in one HDF5 file, sealed, two of them kept.
!>
!> Written at the end of a step, under a temporary name, and renamed when it is on the disk: a
!> checkpoint that has its name is complete. The number in the name is that of the step. Before
!> HDF5 sees one it is compared with its seal: HDF5 does not survive every damage.
module brz_checkpoint
    use brz_air_parts, only: check_parts, is_in_parts, read_air_boxes, remove_parts, rename_parts, &
                             write_air_box, write_boxes
    use brz_air_state, only: air_t
    use brz_byte_file, only: sync_file
    use brz_case, only: case_t
    use brz_checkpoint_check, only: check_state
    use brz_branch_match, only: branch_fault
    use brz_checkpoint_match, only: first_difference, quoted
    use brz_checkpoint_state, only: carry_air, carry_clock, carry_coupling, carry_solid
    use brz_clock, only: clock_t
    use brz_core_keys, only: core_keys
    use brz_coupling_gather, only: begin_sharing, keep_before, share_coupling
    use brz_coupling_state, only: coupling_t
    use brz_errors, only: error_t, failed, raise, exit_deck, exit_io
    use brz_carry, only: carry
    use brz_files, only: list_folder, name_len, remove_file, rename_file
    use brz_hdf5_attribute, only: h5_get
    use brz_hdf5_file, only: h5_close, h5_create, h5_open, h5_plain, h5_t
    use brz_key, only: key_t
    use brz_kinds, only: dp
    use brz_meta, only: describe_run, meta_t, write_meta
    use brz_output_folder, only: checkpoint_begin, checkpoint_end, checkpoint_name
    use brz_ranks, only: reduce_errors, ranks_t, several, share_text
    use brz_seal, only: check_seal
    use brz_solid_diagnostics, only: keep_diagnostics_of_first
    use brz_solid_owner, only: hold_all, share_out
    use brz_interacting_bodies, only: interacting_bodies_t
    use brz_solid_state, only: solid_t
    use brz_together, only: end_bodies, together_t
    use brz_version, only: precision
    implicit none
    private
    public :: write_checkpoint, name_checkpoint, read_checkpoint, find_checkpoint
    public :: drop_later_checkpoints, remove_checkpoint

    integer, parameter :: kept = 2 !! checkpoints in a folder
    character(*), parameter :: about = 'brisance'
    character(*), parameter :: title = 'Brisance checkpoint, layout 7' !! another number with
                                                                       !! whatever it holds

contains

    !> Write a checkpoint, which `name_checkpoint` then names. Histories must be flushed before. Of
    !> several processes each writes the air of its box, and the first what all have in common and
    !> the bodies, after begin_bodies and begin_state.
    subroutine write_checkpoint(together, case, clock, air, coupling, solid, sums, err)
        type(together_t), intent(inout) :: together
        type(case_t), intent(in) :: case
        type(clock_t), intent(inout) :: clock
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: coupling
        class(interacting_bodies_t), intent(inout) :: solid
        real(dp), intent(inout) :: sums(:) !! what the step remembers besides
        type(error_t), intent(inout) :: err
        type(h5_t) :: file
        type(meta_t) :: meta
        character(:), allocatable :: path
        logical :: in_parts, shared

        path = together%folder//'/'//checkpoint_name(clock%cycle)
        in_parts = air%present .and. several(air%part%ranks)
        shared = solid%present .and. several(solid%ranks)
        if (in_parts) call write_air_box(path, title, air, err)
        if (shared) call end_bodies(together, solid, path, .true., err)
        if (in_parts .and. air%part%ranks%rank > 0 .or. shared .and. solid%ranks%rank > 0) return
        if (failed(err)) return
        call describe_run(case, clock, meta)
        call h5_create(file, path, h5_plain, err, title)
        file%unnamed = .true.
        call write_meta(file, meta, err)
        if (in_parts) then
            call write_boxes(file, air, together%diagnostics, err)
        else if (air%present) then
            call carry_air(file, air, err)
        end if
        if (shared) then
            if (coupling%present) call keep_before(together%whole, together%all)
            call carry_rest(file, clock, together%all, together%whole, sums, err)
        else
            call carry_rest(file, clock, coupling, solid, sums, err)
        end if
        call h5_close(file, err)
    end subroutine write_checkpoint

    !> Remove a checkpoint that could not be written.
    subroutine remove_checkpoint(folder, step)
        character(*), intent(in) :: folder
        integer, intent(in) :: step

        call remove_file(folder//'/'//checkpoint_name(step)//'.tmp')
        call remove_parts(folder, checkpoint_name(step))
    end subroutine remove_checkpoint

    !> Give a checkpoint that is on the disk its name, and remove all but the last two. Of several
    !> processes one does it.
    subroutine name_checkpoint(folder, step, err)
        character(*), intent(in) :: folder
        integer, intent(in) :: step
        type(error_t), intent(inout) :: err
        character(:), allocatable :: path

        if (failed(err)) return
        path = folder//'/'//checkpoint_name(step)
        call rename_file(path//'.tmp', path, err)
        call sync_file(folder, err) ! the name is on the disk too
        if (failed(err)) call remove_parts(folder, checkpoint_name(step))
        if (.not. failed(err)) call remove_old(folder, step)
    end subroutine name_checkpoint

    !> Read a checkpoint into a scene that has been set up from the same deck, or from one that may
    !> branch off it. Afterwards the solid and the coupling must derive what is not in it
    !> (`resume_solid`, `restart_coupling`).
    subroutine read_checkpoint(path, branch, case, clock, air, coupling, solid, sums, err)
        character(*), intent(in) :: path !! as `find_checkpoint` gives it
        logical, intent(in) :: branch
        type(case_t), intent(in) :: case
        type(clock_t), intent(inout) :: clock
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: coupling
        type(solid_t), intent(inout) :: solid
        real(dp), intent(inout) :: sums(:)
        type(error_t), intent(inout) :: err
        type(coupling_t), allocatable :: all
        type(h5_t) :: file

        call h5_open(file, path, err)
        call check_origin(file, branch, case, err)
        if (solid%present) call hold_all(solid)
        if (is_in_parts(file) .or. several(air%part%ranks)) then
            call read_air_boxes(file, air, err)
        else if (air%present) then
            call carry_air(file, air, err)
        end if
        if (several(air%part%ranks)) then
            allocate (all)
            call begin_sharing(coupling, solid, all)
            call carry_rest(file, clock, all, solid, sums, err)
            call check_state(path, clock, air, all, solid, err)
        else
            call carry_rest(file, clock, coupling, solid, sums, err)
            call check_state(path, clock, air, coupling, solid, err)
        end if
        call h5_close(file, err)
        if (.not. several(solid%ranks)) return
        call reduce_errors(solid%ranks, err)
        if (failed(err)) return
        if (coupling%present) call share_coupling(all, solid, coupling)
        call keep_diagnostics_of_first(solid)
        call share_out(solid)
    end subroutine read_checkpoint

    !> What a checkpoint holds besides the air.
    subroutine carry_rest(file, clock, coupling, solid, sums, err)
        type(h5_t), intent(in) :: file
        type(clock_t), intent(inout) :: clock
        type(coupling_t), intent(inout) :: coupling
        class(interacting_bodies_t), intent(inout) :: solid
        real(dp), intent(inout) :: sums(:)
        type(error_t), intent(inout) :: err

        if (solid%present) call carry_solid(file, solid, err)
        if (coupling%present) call carry_coupling(file, coupling, err)
        call carry(file, 'sums', sums, err)
        if (.not. failed(err)) call carry_clock(file, clock, err)
    end subroutine carry_rest

    !> Refuse a checkpoint of another deck or precision.
    subroutine check_origin(file, branch, case, err)
        type(h5_t), intent(in) :: file
        logical, intent(in) :: branch
        type(case_t), intent(in) :: case
        type(error_t), intent(inout) :: err
        character(:), allocatable :: made_with, deck, theirs, ours, fault
        type(key_t), allocatable :: keys(:)
        real(dp) :: time(1)
        logical :: differ

        call h5_get(file, about, 'precision', made_with, err)
        call h5_get(file, about, 'deck', deck, err)
        if (failed(err)) return
        call core_keys(keys)
        if (made_with /= precision) then
            call raise(err, exit_io, file%path//': was written with PRECISION='//made_with// &
                       ', this program has '//precision)
            return
        else if (branch) then
            call h5_get(file, about, 'time', time, err)
            call branch_fault(keys, deck, case%echo, time(1), fault)
            if (fault /= '') call raise(err, exit_deck, file%path//': '//fault)
            return
        end if
        call first_difference(keys, deck, case%echo, differ, theirs, ours)
        if (differ) then
            call raise(err, exit_io, file%path//': belongs to another deck: there '// &
                       quoted(theirs)//', here '//quoted(ours)// &
                       '; only &output and t_end, max_steps, dt_min, energy_band, title and '// &
                       'backend of &run may change; --branch takes other histories of loads too')
        end if
    end subroutine check_origin

    !> The checkpoint that a run shall go on from, one whose seal is right.
    !> Of several processes the first looks for all.
    subroutine find_checkpoint(request, folder, path, note, err, ranks)
        character(*), intent(in) :: request !! a file, or 'latest'
        character(*), intent(in) :: folder !! where 'latest' looks
        character(:), allocatable, intent(out) :: path
        character(:), allocatable, intent(out) :: note !! damaged files that were passed over, or ''
        type(error_t), intent(inout) :: err
        type(ranks_t), intent(in), optional :: ranks
        logical :: leads

        note = ''
        path = request
        leads = .true.
        if (present(ranks)) leads = ranks%rank == 0
        if (leads .and. request == 'latest') then
            call find_latest(folder, path, note, err)
        else if (leads) then
            call check_seal(path, title, err)
            if (.not. failed(err)) call check_parts(path, title, err)
        end if
        if (.not. present(ranks)) return
        call reduce_errors(ranks, err)
        call share_text(ranks, 0, path)
    end subroutine find_checkpoint

    !> The newest checkpoint in a folder that is whole.
    subroutine find_latest(folder, path, note, err)
        character(*), intent(in) :: folder
        character(:), allocatable, intent(inout) :: path
        character(:), allocatable, intent(inout) :: note !! damaged files that were passed over
        type(error_t), intent(inout) :: err
        type(error_t) :: damage
        integer, allocatable :: steps(:)
        integer :: i

        call list_checkpoints(folder, steps)
        do i = 1, size(steps)
            path = folder//'/'//checkpoint_name(steps(i))
            damage = error_t()
            call check_seal(path, title, damage)
            if (.not. failed(damage)) call check_parts(path, title, damage)
            if (damage%code /= exit_io) then
                err = damage
                return
            end if
            note = note//'passed over '//damage%text//new_line('a')
        end do
        call raise(err, exit_io, folder//': no checkpoint that can be read'//new_line('a')//note)
    end subroutine find_latest

    !> Step numbers of the checkpoints in a folder, the newest first.
    subroutine list_checkpoints(folder, steps)
        character(*), intent(in) :: folder
        integer, allocatable, intent(out) :: steps(:)
        character(name_len), allocatable :: names(:)
        integer :: i, n, io, number

        call list_folder(folder, checkpoint_begin, checkpoint_end, names)
        allocate (steps(0))
        do i = 1, size(names)
            n = len_trim(names(i)) - len(checkpoint_end)
            read (names(i) (len(checkpoint_begin) + 1:n), *, iostat=io) number
            if (io == 0) steps = [pack(steps, steps > number), number, &
                                   pack(steps, steps < number)]
        end do
    end subroutine list_checkpoints

    !> Keep the newest checkpoint, of step `step`, and the one before it. Later ones are left over
    !> from a run that was taken up again further back.
    subroutine remove_old(folder, step)
        character(*), intent(in) :: folder
        integer, intent(in) :: step
        integer, allocatable :: steps(:)
        integer :: i

        call list_checkpoints(folder, steps)
        do i = 1, size(steps)
            if (steps(i) <= step .and. count(steps > steps(i) .and. steps <= step) < kept) &
                cycle
            call remove_file(folder//'/'//checkpoint_name(steps(i)))
            call remove_parts(folder, checkpoint_name(steps(i)))
        end do
    end subroutine remove_old

    !> After going on from step `step`: later checkpoints do not belong to this run any more, as
    !> its histories are cut back. They are renamed, so that 'latest' does not find them.
    subroutine drop_later_checkpoints(folder, step, err)
        character(*), intent(in) :: folder
        integer, intent(in) :: step
        type(error_t), intent(inout) :: err
        integer, allocatable :: steps(:)
        integer :: i

        call list_checkpoints(folder, steps)
        do i = 1, size(steps)
            if (steps(i) <= step .or. failed(err)) cycle
            call rename_file(folder//'/'//checkpoint_name(steps(i)), &
                             folder//'/dropped_'//checkpoint_name(steps(i)), err)
            call rename_parts(folder, checkpoint_name(steps(i)), &
                              'dropped_'//checkpoint_name(steps(i)), err)
        end do
    end subroutine drop_later_checkpoints
end module brz_checkpoint
