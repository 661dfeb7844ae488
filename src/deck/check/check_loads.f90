! SPDX-License-Identifier: MIT
!> Loads: their values, and the bodies that they name.
module brz_check_loads
    use brz_case, only: case_t, load_case_t, name_len
    use brz_check_bodies, only: miss_body
    use brz_csv_table, only: read_columns
    use brz_deck, only: add_warning, complain, deck_t, group_label, place
    use brz_errors, only: error_t, failed
    use brz_get, only: get, get_list, get_path, is_given, is_usable, need_file
    use brz_kinds, only: dp
    use brz_body_geometries, only: body_box
    use brz_text, only: to_text
    implicit none
    private
    public :: check_loads

    character(8), parameter :: names(8) = [character(8) :: 'x-', 'x+', 'y-', 'y+', 'z-', 'z+', &
                                           'inside', 'outside']

contains

    !> Fill and check the loads of a case; its bodies must be there.
    subroutine check_loads(deck, case)
        type(deck_t), intent(inout) :: deck
        type(case_t), intent(inout) :: case
        integer :: g, k

        allocate (case%loads(count(deck%groups(:deck%n)%name == 'load')))
        k = 0
        do g = 1, deck%n
            if (deck%groups(g)%name /= 'load') cycle
            k = k + 1
            call fill(deck, g, case, case%loads(k))
            call check_keys(deck, g, case%loads(k))
            call check_planes(deck, g, case, case%loads(k))
            call check_faces(deck, g, case, case%loads(k))
            call check_sight(deck, g, case, case%loads(k))
            if (case%air%present) call complain(deck, g, 'body', &
                'is for scenes without air, and this one has &air; take one of them out')
        end do
    end subroutine check_loads

    subroutine fill(deck, g, case, load)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(load_case_t), intent(inout) :: load
        character(name_len) :: body, burst, faces(6)
        integer :: i, n

        load%place = place(deck, deck%groups(g)%line)
        load%id = deck%groups(g)%id
        body = ''
        call get(deck%groups(g), 'body', body)
        load%body = findloc(case%bodies%id, body, 1)
        if (load%body == 0 .and. is_usable(deck%groups(g), 'body')) &
            call miss_body(deck, g, case, 'body', body)
        faces = ''
        call get(deck%groups(g), 'faces', faces, n)
        load%faces = [(any(faces == names(i)), i=1, size(names))]
        call get_list(deck%groups(g), 'time', load%time)
        call get_list(deck%groups(g), 'pressure', load%pressure)
        call get_path(deck, g, 'patch', load%patch)
        call need_file(deck, g, 'patch', load%patch)
        load%in_table = is_given(deck%groups(g), 'table')
        load%on_all = is_given(deck%groups(g), 'acceleration') .or. &
                      is_given(deck%groups(g), 'force')
        if (load%on_all) then
            call get_list(deck%groups(g), 'scale', load%pressure)
            if (.not. is_given(deck%groups(g), 'scale')) load%pressure = [1.0_dp]
        end if
        if (load%in_table) call fill_table(deck, g, load)
        call get(deck%groups(g), 'acceleration', load%acceleration)
        call get(deck%groups(g), 'force', load%force)
        call get(deck%groups(g), 'mass', load%mass)
        burst = 'air'
        call get(deck%groups(g), 'burst', burst)
        load%on_ground = burst == 'surface'
        call get(deck%groups(g), 'at', load%at)
        call get(deck%groups(g), 'detonation_time', load%start)
    end subroutine fill

    !> History of a load from its table.
    subroutine fill_table(deck, g, load)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(load_case_t), intent(inout) :: load
        character(512) :: path
        character(8) :: names(2)
        real(dp), allocatable :: values(:, :)
        type(error_t) :: err
        logical :: found(2)

        if (any([is_given(deck%groups(g), 'time'), is_given(deck%groups(g), 'pressure'), &
                 is_given(deck%groups(g), 'scale'), is_given(deck%groups(g), 'mass')])) then
            call complain(deck, g, 'table', 'a table has times and values of a history; '// &
                          'take time, pressure, scale and mass out')
            return
        end if
        path = ''
        call get_path(deck, g, 'table', path)
        names = [character(8) :: 'time', merge('scale   ', 'pressure', load%on_all)]
        call read_columns(trim(path), names, values, found, err)
        if (failed(err)) then
            call complain(deck, g, 'table', err%text)
        else if (.not. all(found)) then
            call complain(deck, g, 'table', trim(path)//': its first row must name the columns '// &
                          trim(names(1))//' and '//trim(names(2)))
        else
            load%time = values(1, :)
            load%pressure = values(2, :)
        end if
    end subroutine fill_table

    !> One kind of load, and all that it needs.
    subroutine check_keys(deck, g, load)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(load_case_t), intent(in) :: load
        character(12), parameter :: kinds(4) = [character(12) :: 'pressure', 'mass', &
                                                'acceleration', 'force']
        integer :: i

        if (deck%groups(g)%bad) return
        associate (group => deck%groups(g))
            if (count([(is_given(group, trim(kinds(i))), i=1, 4)]) &
                + merge(1, 0, load%in_table .and. .not. load%on_all) /= 1) then
                call complain(deck, g, 'body', 'a load is a history (time, pressure), the '// &
                    'blast of a charge (mass, at), an acceleration or a force; give one of them')
                return
            end if
            if (load%on_all .and. is_given(group, 'faces')) call complain(deck, g, 'faces', &
                'faces belong to a pressure or a charge; take them out')
            if (is_given(group, 'patch') .and. .not. is_given(group, 'faces')) call complain(deck, &
                g, 'patch', "a patch lies on faces of the body; add them, such as faces='z+'")
            if (.not. (load%on_all .or. is_given(group, 'faces'))) call complain(deck, g, &
                'body', "a pressure needs faces, such as faces='z+'")
            if (is_given(group, 'mass')) then
                if (.not. is_given(group, 'at')) call complain(deck, g, 'mass', &
                    'a charge needs its place; add at = x, y, z')
                if (is_given(group, 'time')) call complain(deck, g, 'time', &
                    "time belongs to a history of pressure; take it out")
            else
                call check_history(deck, g, load)
            end if
        end associate
    end subroutine check_keys

    !> Times and values of a load that is no charge.
    subroutine check_history(deck, g, load)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(load_case_t), intent(in) :: load
        character(15), parameter :: of_charge(3) = [character(15) :: 'at', 'burst', &
                                                    'detonation_time']
        character(:), allocatable :: values
        integer :: i

        values = 'pressure'
        if (load%on_all) values = 'scale'
        associate (group => deck%groups(g), n => size(load%pressure), m => size(load%time))
            do i = 1, size(of_charge)
                if (is_given(group, trim(of_charge(i)))) call complain(deck, g, &
                    trim(of_charge(i)), trim(of_charge(i))//' belongs to a charge (mass); take '// &
                    'it out')
            end do
            if (is_given(group, 'scale') .and. .not. load%on_all) call complain(deck, g, 'scale', &
                'scale belongs to an acceleration or a force; take it out')
            if (m /= n .and. .not. (n == 1 .and. m == 0)) call complain(deck, g, &
                values, to_text(n)//' values of '//values//' for '// &
                to_text(m)//' times; give as many of both, or one that is constant')
            if (m == n .and. n == 1) call complain(deck, g, 'time', 'a history needs two '// &
                'times; take time out for a constant one')
            if (m < 2 .and. load%in_table) call complain(deck, g, 'table', &
                'a history needs two rows')
            if (any(load%time(2:) <= load%time(:max(m - 1, 0)))) call complain(deck, g, 'time', &
                'the times must grow')
        end associate
    end subroutine check_history

    !> Layered walls are loaded inside and outside, all others along the axes.
    subroutine check_faces(deck, g, case, load)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(load_case_t), intent(in) :: load

        if (deck%groups(g)%bad .or. load%body == 0) return
        if (case%bodies(load%body)%layered) then
            if (any(load%faces(:6))) call complain(deck, g, 'faces', "a body with lattice="// &
                "'layered' carries pressure inside and outside of its wall; name these faces")
            if (load%patch /= '') call complain(deck, g, 'patch', "a body with lattice="// &
                "'layered' carries pressure on all of a face; take the patch out")
            if (load%faces(7) .and. load%mass > 0) call complain(deck, g, 'faces', 'the curves '// &
                'of a blast in free air do not hold inside a pipe; compute the air')
        else if (any(load%faces(7:))) then
            call complain(deck, g, 'faces', 'inside and outside are faces of a body with '// &
                          "lattice='layered'; name faces along the axes")
        end if
    end subroutine check_faces

    !> The blast of a charge loads faces that are turned away from it by the incident wave: most
    !> likely the others are meant. In two dimensions it lies in the plane of the scene.
    subroutine check_sight(deck, g, case, load)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(load_case_t), intent(in) :: load
        logical :: seen
        integer :: a, d

        if (deck%groups(g)%bad .or. load%body == 0 .or. .not. load%mass > 0) return
        d = case%run%dimension
        associate (body => case%bodies(load%body), at => load%at)
            if (body%shape /= 'box') return
            seen = .false.
            do a = 1, 3
                seen = seen .or. (load%faces(2*a - 1) .and. at(a) <= body%lo(a)) .or. &
                       (load%faces(2*a) .and. at(a) >= body%hi(a))
            end do
            if (.not. seen) call add_warning(deck, deck%groups(g)%line, &
                group_label(deck%groups(g))//'none of these faces sees the charge: they feel '// &
                'the incident wave, which pushes the body towards it; name those on its side')
            if (any(at(d + 1:) < body%lo(d + 1:) .or. at(d + 1:) > body%hi(d + 1:))) &
                call add_warning(deck, deck%groups(g)%line, group_label(deck%groups(g))// &
                    'the scene has no direction '//'xyz' (d + 1:)//': the charge lies in it, '// &
                    'as near as its other coordinates say')
        end associate
    end subroutine check_sight

    !> A direction that is not modelled takes no acceleration and no force, nor does that across a
    !> plane of symmetry on which the body lies.
    subroutine check_planes(deck, g, case, load)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(load_case_t), intent(in) :: load
        character, parameter :: axes(3) = ['x', 'y', 'z']
        integer :: a
        logical :: leaves

        do a = 1, 3
            if (.not. max(abs(load%acceleration(a)), abs(load%force(a))) > 0) cycle
            leaves = on_plane(case, load%body, a)
            if (leaves .or. a > case%run%dimension) &
                call complain(deck, g, 'body', 'a load along '//axes(a)//' leaves a plane of '// &
                              'symmetry or the plane of a scene in two dimensions; make that '// &
                              'component 0')
        end do
    end subroutine check_planes

    !> Does a body lie on the plane of symmetry normal to axis a? One from a file may.
    logical function on_plane(case, b, a)
        type(case_t), intent(in) :: case
        integer, intent(in) :: b !! body; 0: there is none
        integer, intent(in) :: a
        real(dp) :: lo(3), hi(3)

        on_plane = case%run%symmetry(a)
        if (.not. on_plane .or. b == 0) return
        if (case%bodies(b)%file /= '') return
        call body_box(case%bodies(b), lo, hi)
        on_plane = lo(a) < case%bodies(b)%spacing*case%bodies(b)%aspect(a)/4 ! see lay_shape
    end function on_plane
end module brz_check_loads
