! SPDX-License-Identifier: MIT
!> Laminates that may delaminate: one body of the deck as sublaminates of its plies.
!>
!> `&body delamination='cohesive'` becomes bodies 'id.1', 'id.2', ... from the low to the high side,
!> each with its plies and its part of the box, and an &interaction between neighbours. What names
!> the laminate means all of them. The echo is the deck as it is computed.
module brz_laminates
    use brz_case, only: max_plies, name_len
    use brz_deck, only: add_group, add_warning, complain, deck_t, entry_t, find_entry, find_group, &
                        group_label, group_t, move_group
    use brz_gauge_quantities, only: find_quantity, quantities
    use brz_get, only: get, is_given, is_usable
    use brz_group_values, only: set_numbers, set_text, take_entry
    use brz_key, only: key_t
    use brz_kinds, only: dp
    use brz_laminate_interfaces, only: glue_plies, keep_plies_whole
    use brz_layup, only: parse_layup
    use brz_text, only: digits_only, string_t, to_text
    implicit none
    private
    public :: expand_laminates

    !> How a laminate is parted.
    type :: parting_t
        integer :: n = 0 !! sublaminates
        integer :: axis = 3 !! normal of the plies
        integer :: plies = 0
        real(dp) :: angle(max_plies) = 0 !! [deg]
        integer :: last(0:max_plies) = 0 !! ply on the high side of each sublaminate; 0
        real(dp) :: box(6) = 0 !! of the whole [m]
    end type parting_t

contains

    !> Lay all laminates of a deck whose groups are converted and complete.
    subroutine expand_laminates(deck, keys, defaults, mirror)
        type(deck_t), intent(inout) :: deck
        type(key_t), intent(in) :: keys(:)
        type(entry_t), intent(in) :: defaults(:)
        logical, intent(in) :: mirror(3) !! planes of symmetry through the origin
        character(name_len) :: word
        type(string_t) :: laminates(deck%n)
        integer :: g, n

        n = 0
        do g = deck%n, 1, -1
            if (deck%groups(g)%name /= 'body' .or. deck%groups(g)%bad) cycle
            word = 'none'
            call get(deck%groups(g), 'delamination', word)
            if (word == 'cohesive') then
                n = n + 1
                laminates(n)%s = deck%groups(g)%id
                call expand(deck, keys, defaults, mirror, laminates(n)%s)
            else if (is_given(deck%groups(g), 'interfaces')) then
                call complain(deck, g, 'interfaces', "interfaces needs delamination='cohesive'")
            end if
        end do
        if (n > 0) call keep_plies_whole(deck, keys, defaults, laminates(:n))
    end subroutine expand_laminates

    !> Replace one laminate by its parts, where it is made of a material that is there.
    subroutine expand(deck, keys, defaults, mirror, id)
        type(deck_t), intent(inout) :: deck
        type(key_t), intent(in) :: keys(:)
        type(entry_t), intent(in) :: defaults(:)
        logical, intent(in) :: mirror(3)
        character(*), intent(in) :: id
        type(parting_t) :: parting
        character(name_len) :: material
        integer :: g

        g = find_group(deck, 'body', id)
        material = ''
        call get(deck%groups(g), 'material', material)
        if (find_group(deck, 'material', trim(material)) == 0) return ! told by check_bodies
        call read_laminate(deck, g, parting)
        if (.not. deck%groups(g)%bad) call find_interfaces(deck, g, parting)
        if (.not. deck%groups(g)%bad) call leave_out_below(deck, g, mirror, parting)
        if (.not. deck%groups(g)%bad) call check_parts(deck, g, parting)
        if (.not. deck%groups(g)%bad) call glue_plies(deck, keys, defaults, g)
        if (deck%groups(g)%bad) return
        call rename_laminate(deck, id, parting)
        call lay_parts(deck, keys, defaults, g, parting)
    end subroutine expand

    !> Plies and box; what a laminate with interfaces cannot be.
    subroutine read_laminate(deck, g, parting)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(parting_t), intent(inout) :: parting
        character(name_len) :: word, faces(8)
        character(2048) :: layup
        character(:), allocatable :: message
        integer :: dimension, n

        layup = ''
        call get(deck%groups(g), 'plies', layup)
        call parse_layup(trim(layup), parting%angle, parting%plies, message)
        if (parting%plies < 2) call complain(deck, g, 'delamination', "delamination='cohesive' "// &
            "needs a laminate of at least two plies; write them as plies='0/90'")
        word = 'z'
        call get(deck%groups(g), 'ply_axis', word)
        parting%axis = index('xyz', trim(word))
        dimension = 3
        call get(deck%groups(find_group(deck, 'run')), 'dimension', dimension)
        if (parting%axis > dimension) call complain(deck, g, 'ply_axis', &
            "delamination='cohesive' needs plies that lie one above the other in what is "// &
            'modelled; change ply_axis')
        word = 'box'
        call get(deck%groups(g), 'shape', word)
        if (word /= 'box' .or. .not. is_usable(deck%groups(g), 'box')) call complain(deck, g, &
            'delamination', "delamination='cohesive' is for shape='box'; lay other shapes as "// &
            "bodies of their own with &interaction law='cohesive'")
        call get(deck%groups(g), 'box', parting%box)
        word = ''
        call get(deck%groups(g), 'formulation', word)
        if (word == 'rigid') call complain(deck, g, 'delamination', &
            "delamination='cohesive' has no place with formulation='rigid'")
        faces = ''
        call get(deck%groups(g), 'fix', faces, n)
        call check_faces(deck, g, parting, dimension, faces)
    end subroutine read_laminate

    !> Faces that are held must be edges of the plies.
    subroutine check_faces(deck, g, parting, dimension, faces)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g, dimension
        type(parting_t), intent(in) :: parting
        character(name_len), intent(in) :: faces(:)
        character(1) :: axis
        real(dp) :: side(3)

        axis = 'xyz' (parting%axis:parting%axis)
        side = parting%box(2:6:2) - parting%box(1:5:2)
        if (any(faces == axis//'-' .or. faces == axis//'+') .or. &
            (any(faces == 'sides') .and. side(parting%axis) > minval(side(:dimension)))) &
            call complain(deck, g, 'fix', 'fix holds a face of an outer ply, and with '// &
            "delamination='cohesive' only edges of the plies can be held so; use fix_box")
    end subroutine check_faces

    !> Between which plies the laminate may open.
    subroutine find_interfaces(deck, g, parting)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(parting_t), intent(inout) :: parting
        character(name_len) :: word(max_plies)
        logical :: parted(max_plies)
        integer :: i, n, number

        associate (a => parting%angle, last => parting%plies - 1)
            parted = .false.
            word = ''
            call get(deck%groups(g), 'interfaces', word, n)
            do i = 1, n
                number = 0
                if (len_trim(word(i)) < 9 .and. digits_only(trim(word(i)))) read (word(i), *) number
                if (word(i) == 'all') then
                    parted(:last) = .true.
                else if (word(i) == 'angles') then
                    parted(:last) = abs(modulo(a(2:last + 1) - a(:last) + 90, 180.0_dp) - 90) &
                                  > 1e-6_dp
                else if (number >= 1 .and. number <= last) then
                    parted(number) = .true.
                else
                    call complain(deck, g, 'interfaces', "interfaces: '"//trim(word(i))// &
                        "' is not 'all', 'angles' or a number from 1 (above the lowest ply) to "// &
                        to_text(last))
                    return
                end if
            end do
            if (.not. any(parted)) call complain(deck, g, 'interfaces', 'interfaces: all plies '// &
                "have the same angle, so none is left to open; take 'all' or numbers")
            parting%n = count(parted) + 1
            parting%last(1:parting%n) = [pack([(i, i=1, last)], parted(:last)), parting%plies]
        end associate
    end subroutine find_interfaces

    !> Plies below a plane of symmetry are made by it.
    subroutine leave_out_below(deck, g, mirror, parting)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        logical, intent(in) :: mirror(3)
        type(parting_t), intent(inout) :: parting
        real(dp) :: lo, hi, ply
        integer :: below

        associate (a => parting%axis)
            lo = parting%box(2*a - 1)
            hi = parting%box(2*a)
            ply = (hi - lo)/parting%plies
            if (.not. mirror(a) .or. hi <= 0) return
            below = 0
            do while (lo + parting%last(below + 1)*ply <= 1e-9_dp*(hi - lo))
                below = below + 1
            end do
            if (below == 0) return
            associate (gone => parting%last(below))
                parting%box(2*a - 1) = lo + gone*ply
                parting%angle(:parting%plies - gone) = parting%angle(gone + 1:parting%plies)
                parting%n = parting%n - below
                parting%plies = parting%plies - gone
                parting%last(1:parting%n) = parting%last(below + 1:below + parting%n) - gone
            end associate
            if (abs(parting%box(2*a - 1)) <= 1e-9_dp*(hi - lo)) call add_warning(deck, &
                deck%groups(g)%line, group_label(deck%groups(g))//'its interface in a plane '// &
                'of symmetry cannot open: there it is one with its mirror image')
        end associate
    end subroutine leave_out_below

    !> Ids that are free and short enough, and a layer of particles at least in each part.
    subroutine check_parts(deck, g, parting)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(parting_t), intent(in) :: parting
        character(:), allocatable :: id
        real(dp) :: spacing, thinnest
        integer :: p

        do p = 1, parting%n
            id = part_id(deck%groups(g)%id, p)
            if (len(id) > name_len) call complain(deck, g, 'id', "the id is too long for its "// &
                "parts, '"//id//"'; at most "//to_text(name_len)//' characters')
            if (find_group(deck, 'body', id) > 0) call complain(deck, g, 'id', "its part '"// &
                id//"' has the id of another body; choose another")
            if (deck%groups(g)%bad) return
        end do
        spacing = 0
        call get(deck%groups(g), 'spacing', spacing)
        thinnest = huge(thinnest)
        do p = 1, parting%n
            thinnest = min(thinnest, height(parting, p) - height(parting, p - 1))
        end do
        if (spacing > (1 + 1e-6_dp)*thinnest) call complain(deck, g, 'spacing', 'spacing '// &
            to_text(spacing)//' m is larger than the thinnest sublaminate, '//to_text(thinnest)// &
            ' m; take a smaller one, or fewer interfaces')
    end subroutine check_parts

    !> Height of the high side of a sublaminate, 0: of the lowest one's low side [m].
    pure real(dp) function height(parting, p)
        type(parting_t), intent(in) :: parting
        integer, intent(in) :: p

        associate (lo => parting%box(2*parting%axis - 1), hi => parting%box(2*parting%axis))
            height = lo + (hi - lo)*parting%last(p)/parting%plies
            if (p == parting%n) height = hi
        end associate
    end function height

    pure function part_id(id, p) result(text)
        character(*), intent(in) :: id
        integer, intent(in) :: p
        character(:), allocatable :: text

        text = id//'.'//to_text(p)
    end function part_id

    !> What names the laminate names all its parts; a gauge the one in which it lies.
    subroutine rename_laminate(deck, id, parting)
        type(deck_t), intent(inout) :: deck
        character(*), intent(in) :: id
        type(parting_t), intent(in) :: parting
        real(dp) :: at(3)
        integer :: e, i, k, p

        do k = 1, deck%n
            e = 0
            if (deck%groups(k)%name == 'interaction') e = find_entry(deck%groups(k), 'bodies')
            if (deck%groups(k)%name == 'body') e = find_entry(deck%groups(k), 'cuts')
            if (is_of_a_point(deck%groups(k))) e = find_entry(deck%groups(k), 'body')
            if (e == 0) cycle
            associate (entry => deck%groups(k)%entries(e))
                do i = 1, size(entry%word)
                    if (entry%word(i)%s /= id) cycle
                    entry%word(i)%s = id//'.*'
                    if (deck%groups(k)%name /= 'gauge') cycle
                    at = 0
                    call get(deck%groups(k), 'at', at)
                    p = 1
                    do while (p < parting%n .and. at(parting%axis) >= height(parting, p))
                        p = p + 1
                    end do
                    entry%word(i)%s = part_id(id, p)
                end do
            end associate
        end do
    end subroutine rename_laminate

    !> True for a gauge that measures at a point.
    logical function is_of_a_point(group) result(yes)
        type(group_t), intent(in) :: group
        character(name_len) :: quantity
        integer :: row

        yes = group%name == 'gauge'
        if (.not. yes) return
        quantity = ''
        call get(group, 'quantity', quantity)
        row = find_quantity(trim(quantity))
        if (row > 0) yes = quantities(row)%whole == 0
    end function is_of_a_point

    !> Replace the laminate by its sublaminates.
    subroutine lay_parts(deck, keys, defaults, g, parting)
        type(deck_t), intent(inout) :: deck
        type(key_t), intent(in) :: keys(:)
        type(entry_t), intent(in) :: defaults(:)
        integer, intent(in) :: g
        type(parting_t), intent(in) :: parting
        type(group_t) :: whole
        integer :: k, p

        whole = deck%groups(g)
        do p = 2, parting%n
            call add_group(deck, 'body', deck%groups(g)%line)
        end do
        do k = deck%n, g + parting%n, -1
            call move_group(deck%groups(k - parting%n + 1), deck%groups(k))
        end do
        do p = parting%n, 1, -1
            deck%groups(g + p - 1) = whole
            associate (group => deck%groups(g + p - 1))
                group%id = part_id(whole%id, p)
                call set_text(group, 'id', group%id)
                call set_text(group, 'plies', layup_text(parting, p))
                call set_numbers(group, 'box', box_of(parting, p))
                if (is_given(group, 'spin') .and. .not. is_given(group, 'spin_centre')) &
                    call set_numbers(group, 'velocity', velocity_of(group, parting, p))
                call take_entry(group, keys, defaults, 'delamination')
                call take_entry(group, keys, defaults, 'interfaces')
            end associate
        end do
    end subroutine lay_parts

    pure function box_of(parting, p) result(box)
        type(parting_t), intent(in) :: parting
        integer, intent(in) :: p
        real(dp) :: box(6)

        box = parting%box
        box(2*parting%axis - 1) = height(parting, p - 1)
        box(2*parting%axis) = height(parting, p)
    end function box_of

    !> Velocity of a part of a body that spins about the centre of the whole [m/s].
    function velocity_of(group, parting, p) result(v)
        type(group_t), intent(in) :: group
        type(parting_t), intent(in) :: parting
        integer, intent(in) :: p
        real(dp) :: v(3), w(3), r(3)

        v = 0
        w = 0
        call get(group, 'velocity', v)
        call get(group, 'spin', w)
        r = 0
        r(parting%axis) = (height(parting, p - 1) + height(parting, p) &
                           - height(parting, 0) - height(parting, parting%n))/2
        v = v + [w(2)*r(3) - w(3)*r(2), w(3)*r(1) - w(1)*r(3), w(1)*r(2) - w(2)*r(1)]
    end function velocity_of

    pure function layup_text(parting, p) result(text)
        type(parting_t), intent(in) :: parting
        integer, intent(in) :: p
        character(:), allocatable :: text
        integer :: i

        text = to_text(parting%angle(parting%last(p - 1) + 1))
        do i = parting%last(p - 1) + 2, parting%last(p)
            text = text//'/'//to_text(parting%angle(i))
        end do
    end function layup_text
end module brz_laminates
