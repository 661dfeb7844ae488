! SPDX-License-Identifier: MIT
!> Interactions between bodies: their values, and the bodies that they name.
module brz_check_interactions
    use brz_case, only: case_t, interaction_case_t, means, name_len
    use brz_check_bodies, only: miss_body
    use brz_deck, only: add_warning, complain, deck_t, find_group, group_label, place
    use brz_get, only: get, get_boxes, is_given
    implicit none
    private
    public :: check_interactions

contains

    !> Fill and check the interactions of a case; its bodies must be there.
    subroutine check_interactions(deck, case)
        type(deck_t), intent(inout) :: deck
        type(case_t), intent(inout) :: case
        integer :: g, k

        allocate (case%interactions(count(deck%groups(:deck%n)%name == 'interaction')))
        k = 0
        do g = 1, deck%n
            if (deck%groups(g)%name /= 'interaction') cycle
            k = k + 1
            call fill(deck, g, case%interactions(k))
            call get_boxes(deck, g, 'open_box', case%interactions(k)%open_box, &
                           case%interactions(k)%n_open_boxes)
            call find_bodies(deck, g, case, case%interactions(k))
            call check_keys(deck, g, case%interactions(k))
            if (size(case%bodies) < 2 .and. .not. deck%groups(g)%bad) &
                call add_warning(deck, deck%groups(g)%line, group_label(deck%groups(g))// &
                                 'has no effect: it needs two bodies')
        end do
    end subroutine check_interactions

    subroutine fill(deck, g, i)
        type(deck_t), intent(in) :: deck
        integer, intent(in) :: g
        type(interaction_case_t), intent(inout) :: i

        associate (group => deck%groups(g))
            i%place = place(deck, group%line)
            call get(group, 'law', i%law)
            call get(group, 'friction', i%friction)
            call get(group, 'stiffness', i%stiffness)
            call get(group, 'damping', i%damping)
            call get(group, 'shared_pressure', i%shared_pressure)
            call get(group, 'tensile_strength', i%tensile_strength)
            call get(group, 'shear_strength', i%shear_strength)
            call get(group, 'bond_law', i%bond_law)
            call get(group, 'gi', i%gi)
            call get(group, 'gii', i%gii)
            call get(group, 'mixed', i%mixed)
            call get(group, 'mixed_exponent', i%mixed_exponent)
            call get(group, 'interface_stiffness', i%interface_stiffness)
        end associate
    end subroutine fill

    !> Places of the bodies that are named.
    subroutine find_bodies(deck, g, case, interaction)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(interaction_case_t), intent(inout) :: interaction
        character(name_len) :: id(2)
        integer :: i, n

        id = '*'
        call get(deck%groups(g), 'bodies', id, n)
        do i = 1, n
            if (id(i) == '*') cycle
            call find_range(case, id(i), interaction%body(i), interaction%last(i))
            if (interaction%body(i) == 0) call miss_body(deck, g, case, 'bodies', id(i))
        end do
        if (n < 2 .or. id(1) /= id(2) .or. index(id(1), '*') > 0) return
        i = find_group(deck, 'body', trim(id(1)))
        if (i > 0) then
            if (deck%groups(i)%bad) then ! perhaps a laminate that is not laid in parts
                deck%groups(g)%bad = .true.
                return
            end if
        end if
        call complain(deck, g, 'bodies', 'a body does not meet itself; name two bodies')
    end subroutine find_bodies

    !> The body of a name, or the first and the last of those that a star names; they stand side by
    !> side.
    pure subroutine find_range(case, name, first, last)
        type(case_t), intent(in) :: case
        character(*), intent(in) :: name
        integer, intent(out) :: first, last

        first = findloc(means(name, case%bodies%id), .true., 1)
        last = findloc(means(name, case%bodies%id), .true., 1, back=.true.)
        if (last == first) last = 0
        if (last > 0) then
            if (.not. all(means(name, case%bodies(first:last)%id))) first = 0
        end if
    end subroutine find_range

    !> Keys that the law does not have.
    subroutine check_keys(deck, g, interaction)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(interaction_case_t), intent(in) :: interaction
        character(19), parameter :: keys(9) = [character(19) :: &
            'bond_law', 'tensile_strength', 'shear_strength', 'gi', 'gii', 'mixed', &
            'mixed_exponent', 'interface_stiffness', 'open_box']
        integer :: first, last, i

        first = 1 ! keys first..last belong to the law
        last = 0
        if (interaction%law == 'bonded') last = 3
        if (interaction%law == 'cohesive') then
            first = 2
            last = size(keys)
        end if
        do i = 1, size(keys)
            if (i >= first .and. i <= last) cycle
            if (is_given(deck%groups(g), trim(keys(i)))) &
                call complain(deck, g, trim(keys(i)), "key '"//trim(keys(i))// &
                              "' has no place with law='"//trim(interaction%law)// &
                              "'; take it out or change the law")
        end do
        if (interaction%law /= 'cohesive') return
        do i = 2, 5 ! strengths and energies
            if (.not. is_given(deck%groups(g), trim(keys(i)))) &
                call complain(deck, g, 'law', "law='cohesive' needs the key '"//trim(keys(i))// &
                              "', a number above 0")
        end do
    end subroutine check_keys
end module brz_check_interactions
