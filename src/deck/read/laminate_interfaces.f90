! SPDX-License-Identifier: MIT
!> The interfaces of a laminate: their strengths and energies, from the deck or from the plies.
module brz_laminate_interfaces
    use brz_case, only: name_len
    use brz_complete, only: complete_group
    use brz_deck, only: add_group, complain, deck_t, drop_group, entry_t, find_group, group_t, &
                        move_group
    use brz_get, only: get, is_given
    use brz_group_values, only: set_numbers, set_text, set_texts, take_entry
    use brz_key, only: key_t
    use brz_kinds, only: dp
    use brz_text, only: string_t
    implicit none
    private
    public :: glue_plies, keep_plies_whole

    character(16), parameter :: glue_keys(4) = [character(16) :: 'tensile_strength', &
        'shear_strength', 'gi', 'gii']
    character(3), parameter :: ply_keys(4) = ['zt ', 's13', 's23', 'gdl']

contains

    !> See that an interaction glues the parts of laminate g to each other, with all its numbers.
    !>
    !> It is that of the deck between the laminate and itself; without one it is added behind all
    !> others, but before those that name two of the parts. These get what they lack as well.
    subroutine glue_plies(deck, keys, defaults, g)
        type(deck_t), intent(inout) :: deck
        type(key_t), intent(in) :: keys(:)
        type(entry_t), intent(in) :: defaults(:)
        integer, intent(inout) :: g !! the laminate, which may move
        integer :: k, place
        logical :: whole

        whole = .false.
        place = deck%n + 1
        do k = deck%n, 1, -1
            if (deck%groups(k)%name /= 'interaction') cycle
            if (names(deck%groups(k), deck%groups(g)%id, .false.)) then
                whole = .true.
                call fill(deck, g, k)
            else if (names(deck%groups(k), deck%groups(g)%id//'.', .true.)) then
                place = k
                call fill(deck, g, k)
            end if
        end do
        if (whole .or. deck%groups(g)%bad) return
        call insert_interaction(deck, place, deck%groups(g)%line)
        if (place <= g) g = g + 1
        associate (id => deck%groups(g)%id)
            call set_texts(deck%groups(place), 'bodies', [id, id])
        end associate
        call set_text(deck%groups(place), 'law', 'cohesive')
        call fill(deck, g, place)
        if (deck%groups(g)%bad) then
            call drop_group(deck, place) ! so that nothing is said of what no deck has
            if (place < g) g = g - 1
        else
            call complete_group(deck, keys, defaults, place)
        end if
    end subroutine glue_plies

    !> True if both bodies of a cohesive interaction are the one named, or begin like it.
    logical function names(group, id, begins)
        type(group_t), intent(in) :: group
        character(*), intent(in) :: id
        logical, intent(in) :: begins

        character(name_len) :: word(2), law
        integer :: n

        law = ''
        word = ''
        call get(group, 'law', law)
        call get(group, 'bodies', word, n)
        names = law == 'cohesive'
        if (begins) then
            names = names .and. all(index(word, id) == 1)
        else
            names = names .and. all(word == id)
        end if
    end function names

    !> Give an interaction between plies of laminate g the numbers that it lacks.
    subroutine fill(deck, g, k)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g, k
        character(name_len) :: material
        character(:), allocatable :: lacking
        real(dp) :: value(4), shear(2)
        integer :: i, m

        material = ''
        call get(deck%groups(g), 'material', material)
        m = find_group(deck, 'material', trim(material))
        value = 0
        shear = huge(1.0_dp)
        call get(deck%groups(m), 'zt', value(1))
        call get(deck%groups(m), 's13', shear(1))
        call get(deck%groups(m), 's23', shear(2))
        if (any(shear < huge(1.0_dp))) value(2) = minval(shear)
        call get(deck%groups(m), 'gdl', value(3))
        value(4) = value(3)
        lacking = ''
        do i = 1, 4
            if (is_given(deck%groups(k), trim(glue_keys(i)))) cycle
            if (value(i) > 0) then
                call set_numbers(deck%groups(k), trim(glue_keys(i)), value(i:i))
            else
                lacking = lacking//' '//trim(glue_keys(i))
            end if
        end do
        if (lacking /= '') call complain(deck, g, 'delamination', "delamination='cohesive' "// &
            "knows nothing of"//lacking//": give zt, s13 or s23, gdl in &material id='"// &
            trim(material)//"', or the missing keys in &interaction bodies='"// &
            deck%groups(g)%id//"','"//deck%groups(g)%id//"', law='cohesive'")
    end subroutine fill

    !> Make room for an interaction at a place.
    subroutine insert_interaction(deck, place, line)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: place, line
        type(group_t) :: added
        integer :: k

        call add_group(deck, 'interaction', line)
        call move_group(deck%groups(deck%n), added)
        do k = deck%n, place + 1, -1
            call move_group(deck%groups(k - 1), deck%groups(k))
        end do
        call move_group(added, deck%groups(place))
    end subroutine insert_interaction

    !> Plies between interfaces do not delaminate by the law of the material as well: the strengths
    !> and the energy of that mode are taken out of it, or of a copy where other bodies need it.
    subroutine keep_plies_whole(deck, keys, defaults, laminates)
        type(deck_t), intent(inout) :: deck
        type(key_t), intent(in) :: keys(:)
        type(entry_t), intent(in) :: defaults(:)
        type(string_t), intent(in) :: laminates(:) !! their ids
        integer :: i, m

        m = 0
        do while (m < deck%n)
            m = m + 1
            if (deck%groups(m)%name /= 'material') cycle
            if (.not. any(made_of(deck, m, laminates, .true.))) cycle
            if (any(made_of(deck, m, laminates, .false.))) then
                call copy_material(deck, m, laminates) ! comes later in this loop
            else
                do i = 1, size(ply_keys)
                    call take_entry(deck%groups(m), keys, defaults, trim(ply_keys(i)))
                end do
            end if
        end do
    end subroutine keep_plies_whole

    !> For each group: is it a body of material m, and a part of a laminate or not?
    function made_of(deck, m, laminates, part) result(yes)
        type(deck_t), intent(in) :: deck
        integer, intent(in) :: m
        type(string_t), intent(in) :: laminates(:)
        logical, intent(in) :: part
        logical :: yes(deck%n)
        character(name_len) :: material
        logical :: is_part
        integer :: g, i

        yes = .false.
        do g = 1, deck%n
            if (deck%groups(g)%name /= 'body') cycle
            material = ''
            call get(deck%groups(g), 'material', material)
            if (material == '' .or. material /= deck%groups(m)%id) cycle
            is_part = .false.
            do i = 1, size(laminates)
                is_part = is_part .or. index(deck%groups(g)%id, laminates(i)%s//'.') == 1
            end do
            yes(g) = is_part .eqv. part
        end do
    end function made_of

    !> A copy of a material, at the end, for the parts of laminates.
    subroutine copy_material(deck, m, laminates)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: m
        type(string_t), intent(in) :: laminates(:)
        character(:), allocatable :: id
        logical :: parts(deck%n)
        integer :: g

        id = deck%groups(m)%id//'.plies'
        if (find_group(deck, 'material', id) > 0 .or. len(id) > name_len) then
            call complain(deck, m, 'id', "plies that delaminate need a material '"//id// &
                "' of their own besides that of other bodies; choose another id")
            return
        end if
        parts = made_of(deck, m, laminates, .true.)
        call add_group(deck, 'material', deck%groups(m)%line)
        deck%groups(deck%n) = deck%groups(m)
        deck%groups(deck%n)%id = id
        call set_text(deck%groups(deck%n), 'id', id)
        do g = 1, size(parts)
            if (parts(g)) call set_text(deck%groups(g), 'material', id)
        end do
    end subroutine copy_material
end module brz_laminate_interfaces
