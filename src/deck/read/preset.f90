! SPDX-License-Identifier: MIT
!> Presets: named sets of keys with their sources, built in from inputs/presets/NAME.nml.
!>
!> A group that gives `preset` takes the keys of that file which it does not give itself. The group
!> is then complete: nothing downstream, the echo included, knows of the preset.
module brz_preset
    use brz_deck, only: add_entry, add_error, complain, deck_t, find_entry, group_label, group_t
    use brz_entries, only: read_entries
    use brz_key, only: key_t, required
    use brz_key_text, only: find_row
    use brz_preset_files, only: n_presets, preset_names, preset_text
    use brz_reader, only: find_group_start, open_text, reader_t
    use brz_text, only: nearest, printable
    implicit none
    private
    public :: expand_preset, describe_presets, is_preset, leave_failure_out, take_back

    character(*), parameter :: lf = new_line('a')

contains

    !> Replace the key `preset` of a group by the keys that it stands for.
    subroutine expand_preset(deck, keys, g)
        type(deck_t), intent(inout) :: deck
        type(key_t), intent(in) :: keys(:)
        integer, intent(in) :: g
        type(group_t) :: preset
        integer :: e, i

        e = find_entry(deck%groups(g), 'preset')
        if (e == 0 .or. find_row(keys, trim(deck%groups(g)%name), 'preset', '') == 0) return
        call choose_preset(deck, g, e, i)
        if (i > 0) call read_preset(i, preset)
        if (i > 0) call check_model(deck, g, e, preset, i)
        if (i == 0) then
            deck%groups(g)%broken = .true. ! its keys are lost
            return
        end if
        call take_keys(preset, keys, e, deck%groups(g))
        call remove_entry(deck%groups(g), find_entry(deck%groups(g), 'preset'))
    end subroutine expand_preset

    !> Place of the preset that an entry names; 0, and an error, where there is none.
    subroutine choose_preset(deck, g, e, i)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g, e
        integer, intent(out) :: i
        character(:), allocatable :: name, hint
        integer :: k

        i = 0
        associate (entry => deck%groups(g)%entries(e))
            if (entry%n /= 1) return ! told where values are converted
            if (.not. entry%raw(1)%quoted) return
            name = entry%raw(1)%text
            do i = 1, n_presets
                if (preset_names(i) == name .and. name /= '') return
            end do
            i = 0
            entry%bad = .true.
            k = nearest(name, preset_names)
            hint = ''
            if (k > 0) hint = "; did you mean '"//trim(preset_names(k))//"'?"
            call add_error(deck, entry%line, group_label(deck%groups(g))//"unknown preset '"// &
                           printable(name, 40)//"'"//hint//' Presets: '//list_names()// &
                           " (explained by brisance --describe presets)", entry%set)
        end associate
    end subroutine choose_preset

    !> A preset belongs to one group and to one model.
    subroutine check_model(deck, g, e, preset, i)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g, e
        type(group_t), intent(in) :: preset
        integer, intent(inout) :: i !! place of the preset, becomes 0 where it does not fit
        character(:), allocatable :: fault, name
        integer :: mine, its

        fault = ''
        name = "preset '"//trim(preset_names(i))//"' "
        mine = find_entry(deck%groups(g), 'model')
        its = find_entry(preset, 'model')
        if (preset%name /= deck%groups(g)%name) then
            fault = name//'is one of &'//trim(preset%name)
        else if (mine > 0 .and. its > 0) then
            if (raw_text(deck%groups(g), mine) /= raw_text(preset, its)) fault = name// &
                "is one of model '"//raw_text(preset, its)//"'; take the key 'model' away"
        end if
        if (fault == '') return
        i = 0
        deck%groups(g)%entries(e)%bad = .true.
        call add_error(deck, deck%groups(g)%entries(e)%line, group_label(deck%groups(g))//fault, &
                       deck%groups(g)%entries(e)%set)
    end subroutine check_model

    !> The first value of a key, as written.
    pure function raw_text(group, e) result(text)
        type(group_t), intent(in) :: group
        integer, intent(in) :: e
        character(:), allocatable :: text

        text = ''
        if (group%entries(e)%n > 0) text = trim(group%entries(e)%raw(1)%text)
    end function raw_text

    !> Parse the one group of a preset file.
    subroutine read_preset(i, group)
        integer, intent(in) :: i
        type(group_t), intent(out) :: group
        type(deck_t) :: scratch
        type(reader_t) :: reader
        character(:), allocatable :: text
        character(32) :: name
        integer :: line
        logical :: found, opens

        scratch%file = ''
        allocate (scratch%groups(1))
        scratch%n = 1
        scratch%groups(1)%id = ''
        allocate (scratch%groups(1)%entries(8))
        call preset_text(i, text)
        call open_text(reader, text)
        do
            call find_group_start(reader, name, line, found, opens)
            if (opens .or. .not. found) exit
        end do
        scratch%groups(1)%name = name(:16)
        if (found) call read_entries(reader, scratch, 1)
        group = scratch%groups(1)
        call mark_unconfirmed(text, group)
    end subroutine read_preset

    !> A number is unconfirmed where the comment behind it has that word.
    subroutine mark_unconfirmed(text, group)
        character(*), intent(in) :: text !! of the preset
        type(group_t), intent(inout) :: group
        integer :: e, first, line, length

        first = 1
        line = 0
        do while (first <= len(text))
            line = line + 1
            length = index(text(first:)//lf, lf)
            do e = 1, group%n
                if (group%entries(e)%line == line) group%entries(e)%unconfirmed = &
                    index(text(first:first + length - 2), 'unconfirmed') > 0
            end do
            first = first + length
        end do
    end subroutine mark_unconfirmed

    !> Append the keys that the group does not give; they stand at the line of `preset`. A key of
    !> the preset that the group gives as `none` is taken back.
    subroutine take_keys(preset, keys, named, group)
        type(group_t), intent(in) :: preset
        type(key_t), intent(in) :: keys(:)
        integer, intent(in) :: named !! entry of the group that names the preset
        type(group_t), intent(inout) :: group
        integer :: e, line, own, set

        line = group%entries(named)%line
        set = group%entries(named)%set
        own = group%n
        do e = 1, preset%n
            if (find_entry(group, trim(preset%entries(e)%key)) > 0) cycle
            call add_entry(group, trim(preset%entries(e)%key), line)
            group%entries(group%n) = preset%entries(e)
            group%entries(group%n)%line = line
            group%entries(group%n)%set = set
        end do
        do e = own, 1, -1
            if (group%entries(e)%n /= 1) cycle
            if (group%entries(e)%raw(1)%quoted .or. raw_text(group, e) /= 'none') cycle
            if (find_entry(preset, trim(group%entries(e)%key)) == 0) cycle
            call take_back(keys, raw_text(preset, find_entry(preset, 'model')), e, own + 1, group)
            own = own - 1
        end do
    end subroutine take_keys

    !> Take a key out of a group, and with it those that mean nothing without it.
    subroutine take_back(keys, owner, e, first, group)
        type(key_t), intent(in) :: keys(:)
        character(*), intent(in) :: owner !! model of the material
        integer, intent(in) :: e !! entry of the key
        integer, intent(in) :: first !! entry from which on others go with it
        type(group_t), intent(inout) :: group
        character(:), allocatable :: key
        integer :: k, row

        key = trim(group%entries(e)%key)
        do k = group%n, first, -1
            row = find_row(keys, trim(group%name), trim(group%entries(k)%key), owner)
            if (row == 0 .or. k == e) cycle
            if (keys(row)%needs == key) call remove_entry(group, k)
        end do
        call remove_entry(group, find_entry(group, key))
    end subroutine take_back

    !> Take the keys of failure out of a material with failure = 'none', its values being converted.
    subroutine leave_failure_out(deck, keys, g)
        type(deck_t), intent(inout) :: deck
        type(key_t), intent(in) :: keys(:)
        integer, intent(in) :: g
        integer :: e

        e = find_entry(deck%groups(g), 'failure')
        if (e == 0 .or. deck%groups(g)%name /= 'material') return
        if (raw_text(deck%groups(g), e) /= 'none') return
        do e = deck%groups(g)%n, 1, -1
            associate (row => deck%groups(g)%entries(e)%row)
                if (row == 0) cycle
                if (.not. keys(row)%failure) cycle
                if (keys(row)%default /= required) then
                    call remove_entry(deck%groups(g), e)
                    cycle
                end if
                call complain(deck, g, 'failure', "failure = 'none' is for metals and plies: "// &
                    "the strength of model '"//trim(keys(row)%owner)//"' falls with its "// &
                    "damage; take 'linear_elastic' or 'drucker_prager' for what must not break")
            end associate
        end do
    end subroutine leave_failure_out

    subroutine remove_entry(group, e)
        type(group_t), intent(inout) :: group
        integer, intent(in) :: e
        integer :: k

        do k = e, group%n - 1
            group%entries(k) = group%entries(k + 1)
        end do
        group%n = group%n - 1
    end subroutine remove_entry

    !> All presets, separated by commas.
    function list_names() result(text)
        character(:), allocatable :: text
        integer :: i

        text = ''
        do i = 1, n_presets
            if (i > 1) text = text//', '
            text = text//trim(preset_names(i))
        end do
    end function list_names

    pure logical function is_preset(name)
        character(*), intent(in) :: name

        is_preset = any(preset_names == name) .and. name /= ''
    end function is_preset

    !> One line for each preset; or the whole file of one, with the sources of its numbers.
    subroutine describe_presets(name, text)
        character(*), intent(in) :: name !! of a preset; any other: all of them
        character(:), allocatable, intent(out) :: text
        character(:), allocatable :: whole
        integer :: i

        text = ''
        do i = 1, n_presets
            call preset_text(i, whole)
            if (preset_names(i) == name) then
                text = whole
                return
            end if
            text = text//preset_names(i) (:18)//' '//whole(:index(whole, lf))
        end do
    end subroutine describe_presets
end module brz_preset
