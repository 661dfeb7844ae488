! SPDX-License-Identifier: MIT
!> Bodies: their material, their shape, and where they lie.
module brz_check_bodies
    use brz_case, only: body_case_t, case_t, means
    use brz_check_aspect, only: check_aspect
    use brz_check_lattice, only: check_lattice
    use brz_check_methods, only: check_methods
    use brz_check_plies, only: check_plies
    use brz_check_air, only: box_text, check_corners
    use brz_deck, only: add_warning, complain, deck_t, find_group, group_label
    use brz_get, only: is_given, is_usable, need_file
    use brz_kinds, only: dp
    use brz_body_geometry, only: has_key, needs_key, body_geometry_t
    use brz_body_geometries, only: body_box, keys_of_shapes, geometry_of
    use brz_text, only: nearest, to_text
    implicit none
    private
    public :: check_bodies, miss_body, reference_hint, warn_cut, moves_across

    character(*), parameter :: moves_across = 'moves away from it or through it'

    character(*), parameter :: axes = 'xyz'

    real(dp), parameter :: slack = 1e-9_dp !! relative rounding of positions in the deck

contains

    !> Check all bodies, find their materials, and cut boxes at the planes of symmetry.
    subroutine check_bodies(deck, case)
        type(deck_t), intent(inout) :: deck
        type(case_t), intent(inout) :: case
        integer :: g, i, k

        k = 0
        do g = 1, deck%n
            if (deck%groups(g)%name /= 'body') cycle
            k = k + 1
            call find_material(deck, g, case, case%bodies(k))
            call check_shape(deck, g, case%bodies(k))
            call check_width(deck, g, case%bodies(k))
            call check_start(deck, g, case%bodies(k))
            if (deck%groups(g)%bad) cycle
            call check_aspect(deck, g, case, case%bodies(k))
            call check_methods(deck, g, case%bodies(k))
            call check_lattice(deck, g, case, case%bodies(k))
            call check_gaps(deck, g, case, case%bodies(k))
            call check_cover(deck, g, case, case%bodies(k))
            do i = 1, case%bodies(k)%n_rollers
                if (index('xyz', case%bodies(k)%roller_axis(i)) > case%run%dimension) &
                    call complain(deck, g, 'roller_axis', 'the scene has no direction '// &
                        case%bodies(k)%roller_axis(i)//'; take that roller out')
            end do
            if (case%bodies(k)%file /= '') then
                call check_file(deck, g, case%run%dimension, case%bodies(k))
                call check_cuts(deck, g, case, k)
                cycle
            end if
            call check_size(deck, g, case%run%dimension, case%bodies(k))
            call check_plies(deck, g, case, case%bodies(k))
            call check_round(deck, g, case%run%dimension, case%bodies(k))
            if (.not. deck%groups(g)%bad) call cut_body(deck, g, case, case%bodies(k))
            if (.not. deck%groups(g)%bad) call check_in_air(deck, g, case, case%bodies(k))
            if (.not. deck%groups(g)%bad) call check_bars(deck, g, case%run%dimension, &
                                                          case%bodies(k))
            if (.not. deck%groups(g)%bad) call check_cuts(deck, g, case, k)
        end do
    end subroutine check_bodies

    subroutine find_material(deck, g, case, body)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(body_case_t), intent(inout) :: body
        integer :: i

        if (.not. is_usable(deck%groups(g), 'material')) return
        do i = 1, size(case%materials)
            if (case%materials(i)%id == body%material) body%material_index = i
            if (body%material_index > 0) return
        end do
        call complain(deck, g, 'material', "there is no &material with id='"// &
                      trim(body%material)//"'"// &
                      reference_hint(trim(body%material), case%materials%id))
    end subroutine find_material

    !> Complain that a key names a body that is not there.
    subroutine miss_body(deck, g, case, key, id)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        character(*), intent(in) :: key, id

        call complain(deck, g, key, "there is no &body with id='"//trim(id)//"'"// &
                      reference_hint(trim(id), case%bodies%id))
    end subroutine miss_body

    !> '; did you mean ...' or the ids that exist.
    pure function reference_hint(id, ids) result(text)
        character(*), intent(in) :: id
        character(*), intent(in) :: ids(:)
        character(:), allocatable :: text
        integer :: i

        i = nearest(id, ids)
        if (i > 0) then
            text = "; did you mean '"//trim(ids(i))//"'?"
            return
        end if
        text = '; there is none'
        if (size(ids) > 0) text = '; there are:'
        do i = 1, min(size(ids), 10)
            text = text//" '"//trim(ids(i))//"'"
        end do
    end function reference_hint

    !> Keys that the shape needs, and keys that belong to another shape.
    subroutine check_shape(deck, g, body)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(body_case_t), intent(in) :: body
        type(body_geometry_t) :: geometry
        character(24), allocatable :: keys(:)
        character(:), allocatable :: key, text
        integer :: i

        if (.not. is_usable(deck%groups(g), 'shape')) return
        geometry = geometry_of(body)
        keys = keys_of_shapes()
        do i = 1, size(keys)
            key = trim(keys(i))
            if (has_key(geometry, key)) then
                if (needs_key(geometry, key) .and. .not. is_usable(deck%groups(g), key)) &
                    call need_key(deck, g, body, key)
            else if (is_given(deck%groups(g), key)) then
                call complain(deck, g, key, "key '"//key//"' has no place with shape='"// &
                              trim(body%shape)//"'; take it out or change the shape")
            end if
        end do
        if (needs_key(geometry, 'box')) call check_corners(deck, g, body%lo, body%hi)
        if (deck%groups(g)%bad .or. .not. associated(geometry%fault)) return
        call geometry%fault(body, key, text)
        if (key /= '') call complain(deck, g, key, text)
    end subroutine check_shape

    !> A depth that is held needs a face, and a layer of particles within it.
    subroutine check_width(deck, g, body)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(body_case_t), intent(in) :: body

        if (.not. body%fix_width > 0) return
        if (is_given(deck%groups(g), 'fix_layers')) call complain(deck, g, 'fix_width', &
            'fix_width and fix_layers both say how deep a face is fixed; keep one')
        if (all(body%fix == '')) call complain(deck, g, 'fix_width', &
            "fix_width needs the faces that are fixed: add fix='sides'")
        if (body%fix_width < 0.5_dp*body%spacing) call complain(deck, g, 'fix_width', &
            'fix_width '//to_text(body%fix_width)//' m holds no particle: the first ones lie '// &
            'half a spacing of '//to_text(body%spacing)//' m deep')
    end subroutine check_width

    !> A file of the start must be there, and bounds of the smoothing length in order.
    subroutine check_start(deck, g, body)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(body_case_t), intent(in) :: body

        call need_file(deck, g, 'start_file', body%start_file)
        if (body%h_range(1) > body%h_range(2)) call complain(deck, g, 'h_range', &
            'h_range ends before it begins; the lower bound comes first')
    end subroutine check_start

    !> A key that is missing for this shape; one that is there but wrong has its message already.
    subroutine need_key(deck, g, body, key)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(body_case_t), intent(in) :: body
        character(*), intent(in) :: key

        if (is_given(deck%groups(g), key)) return
        call complain(deck, g, key, "key '"//key//"' is missing: shape='"//trim(body%shape)// &
                      "' needs it")
    end subroutine need_key

    !> At least one particle across, and no more particles than can be counted.
    subroutine check_size(deck, g, dimension, body)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g, dimension
        type(body_case_t), intent(in) :: body
        real(dp) :: lo(3), hi(3), n(3)

        call body_box(body, lo, hi)
        n = 1
        n(:dimension) = (hi(:dimension) - lo(:dimension)) &
                        /(body%spacing*body%aspect(:dimension))
        if (any(n < 1 - slack)) then
            call complain(deck, g, 'spacing', 'spacing '//to_text(body%spacing)// &
                          ' m is larger than the body, which is '// &
                          box_text(lo, hi)//'; two particles across stretch right, three bend '// &
                          'right too')
        else if (product(n) > real(huge(1), dp)) then
            call complain(deck, g, 'spacing', 'about '//to_text(anint(product(n)))// &
                          ' particles are more than '//to_text(huge(1))//'; use a larger spacing')
        end if
    end subroutine check_size

    !> A sphere is no sphere where the scene lacks a direction.
    subroutine check_round(deck, g, dimension, body)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g, dimension
        type(body_case_t), intent(in) :: body
        character(32), parameter :: are(2) = [character(32) :: 'a slab of 1 m2 across x', &
                                              'a round bar of 1 m along z']

        if (body%shape /= 'sphere' .or. dimension > 2) return
        call add_warning(deck, deck%groups(g)%line, group_label(deck%groups(g))// &
                         'with dimension='//to_text(dimension)//' a sphere is '// &
                         trim(are(dimension))//'; a ball needs dimension=3, as a quarter with '// &
                         'symmetry')
    end subroutine check_round

    !> Planes of symmetry: a box is cut, and nothing may lie wholly behind one.
    subroutine cut_body(deck, g, case, body)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(body_case_t), intent(inout) :: body
        real(dp) :: lo(3), hi(3), tolerance
        integer :: i

        call body_box(body, lo, hi)
        do i = 1, 3
            if (.not. case%run%symmetry(i)) cycle
            tolerance = slack*(hi(i) - lo(i))
            if (hi(i) <= tolerance) then
                call complain(deck, g, 'id', 'the body lies behind the plane of symmetry '// &
                              axes(i:i)//'=0; '// &
                              'only the positive side is modelled')
            else if (lo(i) < tolerance) then
                if (body%shape == 'box') then ! bars keep their row
                    body%below(i) = max(-body%lo(i), 0.0_dp)
                    body%lo(i) = 0
                end if
                if (lo(i) < -tolerance .and. abs(lo(i) + hi(i)) > tolerance) &
                    call warn_cut(deck, g, i, 'the body', &
                                  'is not symmetric about it, but its mirror image is')
                if (abs(body%velocity(i)) > 0) &
                    call warn_cut(deck, g, i, 'the body', moves_across)
            end if
        end do
    end subroutine cut_body

    !> Warn of what the plane of symmetry normal to axis i cuts.
    subroutine warn_cut(deck, g, i, part, what)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g, i
        character(*), intent(in) :: part !! that is cut
        character(*), intent(in) :: what !! it does: moves_across, ...

        call add_warning(deck, deck%groups(g)%line, group_label(deck%groups(g))// &
                         'the plane of symmetry '// &
                         axes(i:i)//'=0 cuts '//part//', which '//what)
    end subroutine warn_cut

    subroutine check_in_air(deck, g, case, body)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(body_case_t), intent(in) :: body
        real(dp) :: lo(3), hi(3), tolerance(3)
        integer :: d

        if (.not. case%air%present) return
        if (deck%groups(find_group(deck, 'air'))%bad) return
        call body_box(body, lo, hi)
        where (case%run%symmetry) lo = max(lo, 0.0_dp)
        tolerance = slack*(case%air%hi - case%air%lo)
        d = case%run%dimension
        if (any(hi(:d) <= case%air%lo(:d) .or. lo(:d) >= case%air%hi(:d))) then
            call complain(deck, g, 'id', 'the body, '//box_text(lo, hi)// &
                          ', lies outside the air, which is '// &
                          box_text(case%air%lo, case%air%hi))
        else if (any(lo(:d) < case%air%lo(:d) - tolerance(:d) .or. &
                     hi(:d) > case%air%hi(:d) + tolerance(:d))) then
            call add_warning(deck, deck%groups(g)%line, group_label(deck%groups(g))// &
                             'part of the body lies outside the air grid: no air load there')
        end if
    end subroutine check_in_air

    !> Particles as far apart as the cells of air leave cells in a body empty where it stretches.
    subroutine check_gaps(deck, g, case, body)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(body_case_t), intent(in) :: body
        real(dp), parameter :: wide = 0.9_dp !! of a cell
        real(dp) :: cell
        integer :: d

        if (.not. case%air%present .or. body%shape == 'bars') return
        if (deck%groups(find_group(deck, 'air'))%bad) return
        d = case%run%dimension
        cell = minval((case%air%hi(:d) - case%air%lo(:d))/case%air%cells(:d))
        if (body%spacing <= cell*merge(1 + slack, wide, body%formulation == 'rigid')) return
        call add_warning(deck, deck%groups(g)%line, group_label(deck%groups(g))// &
                         'its particles, '//to_text(body%spacing)//' m apart, leave gaps for '// &
                         'cells of air of '//to_text(cell)//' m: gas appears inside it, and '// &
                         'energy with it; use at most 0.9 of a cell, better half of one')
    end subroutine check_gaps

    !> A cell that holds a particle is solid as a whole: to the gas, what is smaller is as large.
    !> What is thin along one axis alone has the right face.
    subroutine check_cover(deck, g, case, body)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(body_case_t), intent(in) :: body
        real(dp) :: lo(3), hi(3), cell(3), low(3), high(3)
        integer :: d, k

        d = case%run%dimension
        if (.not. case%air%present .or. body%shape == 'bars' .or. body%file /= '') return
        if (d == 1 .or. deck%groups(find_group(deck, 'air'))%bad) return
        call body_box(body, lo, hi)
        where (case%run%symmetry .and. lo <= 0) lo = -hi
        cell = (case%air%hi - case%air%lo)/case%air%cells
        if (count(hi(:d) - lo(:d) < (1 - slack)*cell(:d)) < 2) return
        do k = 1, size(case%bodies) ! what lies in another one meets no gas
            if (case%bodies(k)%id == body%id) cycle
            call body_box(case%bodies(k), low, high)
            if (all(lo(:d) >= low(:d) .and. hi(:d) <= high(:d))) return
        end do
        call add_warning(deck, deck%groups(g)%line, group_label(deck%groups(g))// &
                         'it is smaller than a cell of the air, '//to_text(maxval(cell(:d)))// &
                         ' m: the gas sees and pushes whole cells, a body as large as these; '// &
                         'use cells of a third of the body at most')
    end subroutine check_cover

    !> The file must be there. What it holds is not known yet: its box is all of space.
    subroutine check_file(deck, g, dimension, body)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g, dimension
        type(body_case_t), intent(inout) :: body

        body%lo = -huge(1.0_dp)
        body%hi = huge(1.0_dp)
        call need_file(deck, g, 'file', body%file)
        if (dimension < 3) call complain(deck, g, 'shape', "shape='"//trim(body%shape)// &
                                         "' needs dimension=3")
        if (body%shape == 'particles' .and. any(body%cuts /= '')) call complain(deck, g, 'cuts', &
            "shape='particles' has no surface and can cut nothing")
    end subroutine check_file

    !> The bodies that a body cuts must exist, and not cut it in turn.
    subroutine check_cuts(deck, g, case, k)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g, k
        type(case_t), intent(in) :: case
        integer :: c, i

        do c = 1, size(case%bodies(k)%cuts)
            associate (id => case%bodies(k)%cuts(c))
                if (id == '') exit
                i = findloc(means(id, case%bodies%id), .true., 1)
                if (i == 0) then
                    call miss_body(deck, g, case, 'cuts', id)
                else if (means(id, case%bodies(k)%id) .or. &
                         any(means(case%bodies(i)%cuts, case%bodies(k)%id))) then
                    call complain(deck, g, 'cuts', "the bodies '"//trim(case%bodies(k)%id)// &
                                  "' and '"//trim(id)//"' cut each other; one must give way")
                end if
            end associate
        end do
    end subroutine check_cuts

    !> Bars are three-dimensional and have room in their box.
    subroutine check_bars(deck, g, dimension, body)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g, dimension
        type(body_case_t), intent(in) :: body
        integer :: a, i
        real(dp) :: side

        if (body%shape /= 'bars') return
        if (dimension < 3) then
            call complain(deck, g, 'shape', "shape='bars' needs dimension=3")
            return
        end if
        do i = 1, 2
            a = modulo(index(axes, body%axis) + i - 1, 3) + 1
            side = (body%hi(a) - body%lo(a))*(1 + slack)
            if (side < body%bars(i)*body%diameter) call complain(deck, g, 'box', &
                to_text(body%bars(i))//' bars of '//to_text(body%diameter)//' m do not fit '// &
                'between '//axes(a:a)//'='//to_text(body%lo(a))//' and '//to_text(body%hi(a)))
        end do
        if (body%diameter < 0.5_dp*body%spacing) call complain(deck, g, 'diameter', 'bars of '// &
            to_text(body%diameter)//' m are thinner than half a spacing of '// &
            to_text(body%spacing)//' m')
    end subroutine check_bars
end module brz_check_bodies
