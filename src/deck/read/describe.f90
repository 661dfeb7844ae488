! SPDX-License-Identifier: MIT
!> The key table in words: `--describe [group]` and the reference page of the manual.
module brz_describe
    use brz_complete, only: list_owners
    use brz_errors, only: error_t, exit_deck, raise
    use brz_key, only: key_t, kind_integer, kind_logical, kind_real, none, required
    use brz_key_text, only: choice_text, default_text, group_hint, group_known, &
                            group_repeats, level_name, meaning_text, range_text, &
                            same_value_count, unit_text
    use brz_preset, only: describe_presets, is_preset
    use brz_text, only: lower, printable, split, string_t, to_text
    implicit none
    private
    public :: describe, describe_markdown

    character(*), parameter :: lf = new_line('a')

contains

    !> Text about one group, or about all where `group` is empty; 'presets', or one of them.
    !> It tells the basic keys, or every key.
    subroutine describe(keys, group, every, text, err)
        type(key_t), intent(in) :: keys(:)
        character(*), intent(in) :: group !! with or without ampersand, or a preset
        logical, intent(in) :: every
        character(:), allocatable, intent(out) :: text
        type(error_t), intent(inout) :: err
        character(:), allocatable :: wanted
        integer :: i

        text = ''
        wanted = lower(trim(adjustl(group)))
        if (index(wanted, '&') == 1) wanted = wanted(2:)
        if (wanted == 'presets' .or. is_preset(wanted)) then
            call describe_presets(wanted, text)
            return
        end if
        if (wanted /= '' .and. .not. group_known(keys, wanted)) then
            call raise(err, exit_deck, "unknown group '"//printable(group, 32)//"'"// &
                       group_hint(keys, wanted))
            return
        end if
        do i = 1, size(keys)
            if (any(keys(:i - 1)%group == keys(i)%group)) cycle
            if (wanted /= '' .and. keys(i)%group /= wanted) cycle
            call describe_group(keys, trim(keys(i)%group), every, text)
        end do
    end subroutine describe

    subroutine describe_group(keys, group, every, text)
        type(key_t), intent(in) :: keys(:)
        character(*), intent(in) :: group
        logical, intent(in) :: every
        character(:), allocatable, intent(inout) :: text
        character(len(keys%owner)) :: owner
        integer :: i, more

        if (text /= '') text = text//lf
        text = text//'&'//group//'  '//group_meaning(keys, group, '')//lf
        owner = ''
        more = 0
        do i = 1, size(keys)
            if (keys(i)%group /= group) cycle
            if (keys(i)%owner /= owner) then
                owner = keys(i)%owner
                text = text//"  with model='"//trim(owner)//"'  "// &
                     group_meaning(keys, group, trim(owner))//lf
            end if
            if (keys(i)%key == '') cycle
            if (.not. every .and. level_name(keys(i)) /= 'basic') then
                more = more + 1
                cycle
            end if
            text = text//'  '//keys(i)%key//kind_name(keys(i))
            if (range_text(keys(i)) /= '') text = text//' '//range_text(keys(i))
            text = text//unit_text(keys(i))//', '//default_words(keys(i))
            if (every) text = text//', '//level_name(keys(i))
            text = text//lf
            text = text//repeat(' ', 26)//meaning_text(keys(i))//lf
            if (choices(keys, keys(i)) /= '') text = text//repeat(' ', 26)//'One of: '// &
                 choices(keys, keys(i))//lf
        end do
        if (more > 0) text = text//'  and '//to_text(more)//' more: brisance --describe '// &
                             group//' --all'//lf
    end subroutine describe_group

    !> The reference page: a table per group.
    subroutine describe_markdown(keys, text)
        type(key_t), intent(in) :: keys(:)
        character(:), allocatable, intent(out) :: text
        integer :: i

        text = '# Deck reference'//lf//lf// &
               paragraph('For whoever writes a deck or looks up one of its keys. The page is '// &
                         'written by `brisance --describe --markdown` from the key table: '// &
                         'change the table, not this page. How a deck is written: '// &
                         '[a deck](deck.md).')//lf//lf// &
               paragraph('Keys that a first deck needs are **basic**, and `--describe` shows '// &
                         'them; some decks need the *advanced* ones, and `--describe GROUP '// &
                         '--all` shows them too. Keys of *experts* choose between numerical '// &
                         'methods: their defaults are what the verification tests hold.')//lf
        do i = 1, size(keys)
            if (any(keys(:i - 1)%group == keys(i)%group)) cycle
            call markdown_group(keys, trim(keys(i)%group), text)
        end do
    end subroutine describe_markdown

    !> Rows that an earlier model has too are named behind the table, but for the basic ones.
    subroutine markdown_group(keys, group, text)
        type(key_t), intent(in) :: keys(:)
        character(*), intent(in) :: group
        character(:), allocatable, intent(inout) :: text
        character(len(keys%owner)) :: owner, like
        character(:), allocatable :: shared
        type(string_t) :: rows(size(keys))
        logical :: header
        integer :: i

        text = text//lf//'## &'//group//lf//lf//paragraph(group_meaning(keys, group, ''))//lf
        do i = 1, size(keys)
            rows(i)%s = markdown_row(keys, keys(i))
        end do
        owner = ''
        like = ''
        shared = ''
        header = .true.
        do i = 1, size(keys)
            if (keys(i)%group /= group) cycle
            if (keys(i)%owner /= owner) then
                call name_shared(like, shared, text)
                owner = keys(i)%owner
                like = model_alike(keys, rows, owner)
                header = .true.
                text = text//lf//"### model='"//trim(owner)//"'"//lf
                if (group_meaning(keys, group, trim(owner)) /= '') &
                    text = text//lf//paragraph(group_meaning(keys, group, trim(owner)))//lf
            end if
            if (keys(i)%key == '') cycle
            if (stands_before(keys, rows, i, like)) then
                shared = shared//', `'//trim(keys(i)%key)//'`'
                cycle
            end if
            if (header) text = text//lf//'| key | level | values | unit | default | '// &
                               'meaning |'//lf//'|---|---|---|---|---|---|'//lf
            header = .false.
            text = text//rows(i)%s
        end do
        call name_shared(like, shared, text)
    end subroutine markdown_group

    !> The model before `owner` that shares the most rows with it, '' for fewer than ten.
    pure function model_alike(keys, rows, owner) result(like)
        type(key_t), intent(in) :: keys(:)
        type(string_t), intent(in) :: rows(:) !! as they stand in tables
        character(*), intent(in) :: owner
        character(len(keys%owner)) :: like
        integer :: i, j, n, most

        like = ''
        most = 9
        do i = 1, size(keys)
            if (keys(i)%owner == owner) return
            if (keys(i)%owner == '' .or. any(keys(:i - 1)%owner == keys(i)%owner)) cycle
            n = count([(keys(j)%owner == owner .and. &
                        stands_before(keys, rows, j, keys(i)%owner), j=1, size(keys))])
            if (n <= most) cycle
            most = n
            like = keys(i)%owner
        end do
    end function model_alike

    !> Is row i, which no first deck needs, one of the model `like`, too?
    pure logical function stands_before(keys, rows, i, like)
        type(key_t), intent(in) :: keys(:)
        type(string_t), intent(in) :: rows(:)
        integer, intent(in) :: i
        character(*), intent(in) :: like
        integer :: j

        stands_before = .false.
        if (like == '' .or. level_name(keys(i)) == 'basic') return
        do j = 1, i - 1
            if (keys(j)%owner /= like) cycle
            stands_before = rows(j)%s == rows(i)%s
            if (stands_before) return
        end do
    end function stands_before

    !> The line that names the rows shared with `like`; begins the list anew.
    subroutine name_shared(like, shared, text)
        character(*), intent(in) :: like
        character(:), allocatable, intent(inout) :: shared, text

        if (shared == '') return
        text = text//lf//paragraph('Besides, as in `'//trim(like)//'`: '//shared(3:)//'.')//lf
        shared = ''
    end subroutine name_shared

    !> The words of a text in lines of at most 120 columns.
    pure function paragraph(text) result(lines)
        character(*), intent(in) :: text
        character(:), allocatable :: lines
        type(string_t), allocatable :: words(:)
        integer, parameter :: longest = 120
        integer :: i, column

        call split(text, ' ', words)
        lines = ''
        column = longest
        do i = 1, size(words)
            if (column + 1 + len(words(i)%s) > longest) then
                if (i > 1) lines = lines//lf
                column = 0
            else
                lines = lines//' '
                column = column + 1
            end if
            lines = lines//words(i)%s
            column = column + len(words(i)%s)
        end do
    end function paragraph

    pure function markdown_row(keys, row) result(text)
        type(key_t), intent(in) :: keys(:)
        type(key_t), intent(in) :: row
        character(:), allocatable :: text

        text = '| `'//trim(row%key)//'` | '
        if (level_name(row) == 'basic') then
            text = text//'**basic** | '//kind_name(row)
        else
            text = text//level_name(row)//' | '//kind_name(row)
        end if
        if (range_text(row) /= '') text = text//' '//range_text(row)
        text = text//' | '//trim(row%unit)//' | '
        select case (row%default)
        case (required)
            text = text//'required'
        case (none)
            text = text//''
        case default
            text = text//'`'//default_text(row)//'`'
        end select
        text = text//' | '//meaning_text(row)
        if (choices(keys, row) /= '') text = text//full_stop(row)//' One of: '// &
                                        choices(keys, row)//'.'
        text = text//' |'//lf
    end function markdown_row

    !> What the row without key says of a group or of a model.
    pure function group_meaning(keys, group, owner) result(text)
        type(key_t), intent(in) :: keys(:)
        character(*), intent(in) :: group, owner
        character(:), allocatable :: text
        integer :: i

        text = ''
        do i = 1, size(keys)
            if (keys(i)%group /= group .or. keys(i)%key /= '' .or. keys(i)%owner /= owner) cycle
            text = trim(keys(i)%meaning)
        end do
        if (owner == '' .and. group_repeats(keys, group)) text = text//' May stand many times.'
    end function group_meaning

    !> 'real', '3 integers', '1 to 6 texts'.
    pure function kind_name(row) result(text)
        type(key_t), intent(in) :: row
        character(:), allocatable :: text

        select case (row%kind)
        case (kind_integer)
            text = 'integer'
        case (kind_real)
            text = 'real'
        case (kind_logical)
            text = 'logical'
        case default
            text = 'text'
        end select
        if (row%n_max > 1) text = same_value_count(row)//' '//text//'s'
    end function kind_name

    !> '.' where the meaning does not end with one.
    pure function full_stop(row) result(text)
        type(key_t), intent(in) :: row
        character(:), allocatable :: text

        text = '.'
        if (index(trim(row%meaning), '.', back=.true.) == len_trim(row%meaning)) text = ''
    end function full_stop

    pure function default_words(row) result(text)
        type(key_t), intent(in) :: row
        character(:), allocatable :: text

        select case (row%default)
        case (required)
            text = 'required'
        case (none)
            text = 'optional'
        case default
            text = 'default '//default_text(row)
        end select
    end function default_words

    !> The words that a key can take; for a model those that the table knows.
    pure function choices(keys, row) result(text)
        type(key_t), intent(in) :: keys(:)
        type(key_t), intent(in) :: row
        character(:), allocatable :: text

        text = choice_text(row)
        if (row%key == 'model' .and. row%owner == '') text = list_owners(keys, trim(row%group))
    end function choices
end module brz_describe
