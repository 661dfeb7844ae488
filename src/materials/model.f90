! SPDX-License-Identifier: MIT
!> How a material model presents itself: its table of keys, its history, and what it derives.
!>
!> Key i of the table fills slot i of `material%par`, or that of `slots(i)`: a number as it is, a
!> logical as 0 or 1, a text as its place among the choices, 0 for a key that is absent. A model
!> names its slots.
module brz_model
    use brz_kinds, only: dp, rk
    use brz_case, only: material_case_t, label
    use brz_errors, only: error_t, raise, exit_deck
    use brz_key, only: key_t, kind_text, kind_logical, required, none
    use brz_material, only: material_t, point_t, n_hist, n_par
    use brz_text, only: string_t
    implicit none
    private
    public :: derived_t, model_t, load_parameters, material_label, real_key, text_key, &
              switch_key, usual

    !> A number that follows from the keys of a material, for `--check`.
    type :: derived_t
        character(12) :: name = ''
        character(8) :: unit = ''
        real(dp) :: value = 0
    end type derived_t

    type :: model_t
        integer :: code = 0 !! what `material%model` holds
        integer :: class = 0 !! what the material does when it is strained far, see brz_material
        character(24) :: name = '' !! what the deck calls it
        type(key_t), allocatable :: keys(:)
        integer, allocatable :: slots(:) !! of `par` that the keys fill; absent: 1, 2, ...
        integer :: n_hist = 0 !! history in use
        character(32) :: history(n_hist) = '' !! names of the slots worth a dump, '' for the others
        character(12) :: history_unit(n_hist) = '-'
        procedure(derive_i), pointer, nopass :: derive => null()
        procedure(report_i), pointer, nopass :: report => null() !! null: nothing to tell
        procedure(remark_i), pointer, nopass :: remark => null() !! null: nothing to say
        procedure(start_i), pointer, nopass :: start => null() !! null: all zero
        procedure(rest_i), pointer, nopass :: rest => null() !! the same without a direction
    end type model_t

    abstract interface
        !> Fill density, moduli, wave speed and the derived slots; say what is wrong in `fault`.
        subroutine derive_i(material, given, fault)
            import :: material_t
            type(material_t), intent(inout) :: material
            logical, intent(in) :: given(:) !! the key of slot i stands in the deck
            character(:), allocatable, intent(out) :: fault !! unallocated if all is well
        end subroutine derive_i

        !> Numbers that a user should know and has not given.
        subroutine report_i(material, list)
            import :: material_t, derived_t
            type(material_t), intent(in) :: material
            type(derived_t), allocatable, intent(out) :: list(:)
        end subroutine report_i

        !> What a user should know beside numbers, and what is to be warned of.
        subroutine remark_i(material, lines, warning)
            import :: material_t, string_t
            type(material_t), intent(in) :: material
            type(string_t), allocatable, intent(out) :: lines(:)
            character(:), allocatable, intent(out) :: warning !! empty where all is well
        end subroutine remark_i

        !> History of an unloaded point.
        subroutine start_i(material, angle, axis, point)
            import :: material_t, point_t, rk
            type(material_t), intent(in) :: material
            real(rk), intent(in) :: angle !! of the ply about its normal [rad]
            character(1), intent(in) :: axis !! normal of the ply: 'x', 'y', 'z'
            type(point_t), intent(inout) :: point
        end subroutine start_i

        !> State of a point at t = 0.
        subroutine rest_i(material, point)
            import :: material_t, point_t
            type(material_t), intent(in) :: material
            type(point_t), intent(inout) :: point
        end subroutine rest_i
    end interface

contains

    !> Row of a number.
    pure function real_key(model, key, unit, default, meaning, lower, upper, open_lower) result(row)
        character(*), intent(in) :: model, key, unit, default, meaning
        real(dp), intent(in), optional :: lower, upper
        logical, intent(in), optional :: open_lower
        type(key_t) :: row

        row%group = 'material'
        row%owner = model
        row%key = key
        row%unit = unit
        row%default = default
        row%meaning = meaning
        if (present(lower)) row%lower = lower
        if (present(upper)) row%upper = upper
        if (present(open_lower)) row%open_lower = open_lower
    end function real_key

    !> The same row, with the range beyond which a warning is given.
    pure function usual(row, low, high) result(known)
        type(key_t), intent(in) :: row
        real(dp), intent(in) :: low, high
        type(key_t) :: known

        known = row
        known%likely = [low, high]
    end function usual

    !> Row of a text with a list of choices.
    pure function text_key(model, key, default, choices, meaning) result(row)
        character(*), intent(in) :: model, key, default, choices, meaning
        type(key_t) :: row

        row = real_key(model, key, '-', default, meaning)
        row%kind = kind_text
        row%choices = choices
    end function text_key

    !> Row of a logical.
    pure function switch_key(model, key, default, meaning) result(row)
        character(*), intent(in) :: model, key, default, meaning
        type(key_t) :: row

        row = real_key(model, key, '-', default, meaning)
        row%kind = kind_logical
    end function switch_key

    !> Numbers of a material from the deck, checked against the table, and what follows from them.
    subroutine load_parameters(model, input, material, err)
        type(model_t), intent(in) :: model
        type(material_case_t), intent(in) :: input
        type(material_t), intent(inout) :: material
        type(error_t), intent(inout) :: err
        character(:), allocatable :: fault
        logical :: given(n_par)
        integer :: i, j, slot

        material%model = model%code
        material%class = model%class
        material%n_hist = model%n_hist
        material%yields = 0
        given = .false.
        do i = 1, size(model%keys)
            j = place_of(model%keys(i)%key, input)
            slot = i
            if (allocated(model%slots)) slot = model%slots(i)
            call load_one(model%keys(i), input, j, material%par(slot), given(slot), fault)
            if (allocated(fault)) exit
        end do
        if (.not. allocated(fault)) call model%derive(material, given, fault)
        if (allocated(fault)) call raise(err, exit_deck, material_label(input)//fault)
    end subroutine load_parameters

    !> One number of a material; the default where the deck does not give the key.
    subroutine load_one(row, input, j, number, given, fault)
        type(key_t), intent(in) :: row
        type(material_case_t), intent(in) :: input
        integer, intent(in) :: j !! place of the key in the input, 0: absent
        real(rk), intent(out) :: number
        logical, intent(out) :: given
        character(:), allocatable, intent(inout) :: fault
        character(len(input%word)) :: word
        real(dp) :: value

        value = 0
        word = ''
        given = j > 0
        if (given) then
            given = input%given(j)
            value = input%value(j)
            word = input%word(j)
        end if
        if (.not. given) call read_default(row, value, word, fault)
        if (row%kind == kind_text) value = choice_number(word, row%choices)
        number = real(value, rk)
        if (allocated(fault)) return
        if (row%kind == kind_text .and. value < 1) then
            fault = trim(row%key)//"='"//trim(word)//"' is none of "//trim(row%choices)
        else if (row%default /= none .or. given) then
            if (.not. in_range(row, value)) fault = trim(row%key)//' is out of its range'
        end if
    end subroutine load_one

    !> Value of a key that the deck leaves out.
    subroutine read_default(row, value, word, fault)
        type(key_t), intent(in) :: row
        real(dp), intent(out) :: value
        character(*), intent(inout) :: word
        character(:), allocatable, intent(inout) :: fault
        logical :: switch
        integer :: io

        value = 0
        io = 0
        if (row%default == required) then
            fault = trim(row%key)//' ['//trim(row%unit)//'] is missing'
        else if (row%default == none) then
            return
        else if (row%kind == kind_text) then
            word = row%default
        else if (row%kind == kind_logical) then
            read (row%default, *, iostat=io) switch
            value = merge(1.0_dp, 0.0_dp, switch)
        else
            read (row%default, *, iostat=io) value
        end if
        if (io /= 0) fault = 'the default of '//trim(row%key)//' cannot be read'
    end subroutine read_default

    pure logical function in_range(row, value)
        type(key_t), intent(in) :: row
        real(dp), intent(in) :: value

        in_range = value >= row%lower .and. value <= row%upper
        if (row%open_lower) in_range = in_range .and. value > row%lower
    end function in_range

    !> Place of a word in a list of choices that are separated by '|'; 0: not among them.
    pure integer function choice_number(word, choices)
        character(*), intent(in) :: word, choices
        integer :: first, last

        choice_number = 0
        first = 1
        do while (first <= len_trim(choices))
            choice_number = choice_number + 1
            last = index(choices(first:)//'|', '|') + first - 2
            if (choices(first:last) == word) return
            first = last + 2
        end do
        choice_number = 0
    end function choice_number

    !> Place of a key in the input; 0: absent.
    pure integer function place_of(key, input)
        character(*), intent(in) :: key
        type(material_case_t), intent(in) :: input
        integer :: j

        place_of = 0
        do j = 1, input%n
            if (input%key(j) == key) place_of = j
        end do
    end function place_of

    !> How a message on this material begins.
    pure function material_label(input) result(text)
        type(material_case_t), intent(in) :: input
        character(:), allocatable :: text

        text = label('material', input%id, input%place)
    end function material_label
end module brz_model
