! SPDX-License-Identifier: MIT
!> How the particles of a body start: their velocities, and which of them are held.
module brz_body_start
    use brz_body, only: body_t
    use brz_body_shape, only: shape_t, whole_sides
    use brz_case, only: body_case_t, is_held_whole, label
    use brz_errors, only: error_t, exit_deck, raise
    use brz_kinds, only: dp, rk
    use brz_particle_marks, only: is_fixed
    use brz_particles, only: particles_t
    use brz_bodies, only: bodies_t
    use brz_support, only: is_kept, kept_along
    use brz_text, only: to_text
    use brz_threads, only: worth_threads
    implicit none
    private
    public :: held_t, hold_body, judge_held, move_body, in_box

    !> What the boxes of a &body hold: of all its parts, where a laminate is laid in parts.
    type :: held_t
        logical :: fixes(8) = .false. !! of each fix_box: a particle lies in it
        logical :: rolls(8) = .false. !! of each roller_box
        logical :: on_plane(3) = .false. !! the body is cut by a plane of symmetry
        logical :: loose = .false. !! its faces leave some particle free
    end type held_t

contains

    !> Initial velocity, and spin about a point or the centre of mass of the whole (uncut) body.
    subroutine move_body(input, shape, solid, body)
        type(body_case_t), intent(in) :: input
        type(shape_t), intent(in) :: shape
        class(particles_t), intent(inout) :: solid
        type(body_t), intent(in) :: body
        real(dp) :: centre(3), r(3), w(3), v(3)
        integer :: i

        w = input%spin
        centre = 0
        do i = body%first, body%last
            centre = centre + solid%x(:, i)/(body%last - body%first + 1)
        end do
        where (shape%on_plane) centre = 0
        if (input%about_point) centre = input%spin_centre
        !$omp parallel do if(solid%n >= worth_threads) schedule(static) private(r, v)
        do i = body%first, body%last
            r = solid%x(:, i) - centre
            v = input%velocity + [w(2)*r(3) - w(3)*r(2), w(3)*r(1) - w(1)*r(3), &
                                  w(1)*r(2) - w(2)*r(1)]
            v(solid%dimension + 1:) = 0
            solid%v(:, i) = real(v, rk)
        end do
    end subroutine move_body

    !> Hold the layers named in the deck.
    subroutine hold_body(input, shape, solid, body, found)
        type(body_case_t), intent(in) :: input
        type(shape_t), intent(in) :: shape
        class(particles_t), intent(inout) :: solid
        type(body_t), intent(in) :: body
        type(held_t), intent(inout) :: found !! added to
        logical :: fixes(8), held(2, 3), here, loose, rolls(8), whole
        integer :: a, i, f
        real(dp) :: deep(3)

        held = .false.
        fixes = .false.
        rolls = .false.
        loose = .false.
        do f = 1, size(input%fix)
            call mark_faces(trim(input%fix(f)), shape, held)
        end do
        deep = input%fix_layers*shape%spacing
        if (input%fix_width > 0) deep = input%fix_width + 1e-6_dp*shape%spacing
        whole = is_held_whole(input)
        !$omp parallel do if(solid%n >= worth_threads) schedule(static) private(a, f, here) &
        !$omp reduction(.or.: fixes, loose, rolls)
        do i = body%first, body%last
            here = whole
            do a = 1, solid%dimension
                if (held(1, a)) here = here .or. solid%x(a, i) < lowest(shape, a) + deep(a)
                if (held(2, a)) here = here .or. solid%x(a, i) > shape%full_hi(a) - deep(a)
            end do
            loose = loose .or. .not. here
            do f = 1, input%n_fix_boxes
                if (.not. in_box(solid%x(:, i), input%fix_box(:, f), solid%dimension)) cycle
                fixes(f) = .true.
                here = .true.
            end do
            if (here) solid%fixed(i) = is_fixed
            do f = 1, input%n_rollers
                a = index('xyz', input%roller_axis(f))
                if (.not. in_box(solid%x(:, i), input%roller_box(:, f), solid%dimension)) cycle
                rolls(f) = .true.
                if (solid%fixed(i) /= is_fixed) solid%fixed(i) = ior(solid%fixed(i), kept_along(a))
            end do
            do a = 1, 3
                if (is_kept(solid%fixed(i), a)) solid%v(a, i) = 0
            end do
        end do
        found%fixes = found%fixes .or. fixes
        found%rolls = found%rolls .or. rolls
        found%loose = found%loose .or. loose
        found%on_plane = found%on_plane .or. shape%on_plane
    end subroutine hold_body

    !> Boxes without a particle are a mistake, but behind a plane of symmetry they hold the image:
    !> a warning for a fix_box, an error for a roller_box. Faces that hold all of a body that is
    !> not rigid are a mistake, too: a warning.
    subroutine judge_held(input, found, solid, err)
        type(body_case_t), intent(in) :: input
        type(held_t), intent(in) :: found
        class(bodies_t), intent(inout) :: solid !! its notes
        type(error_t), intent(inout) :: err
        integer :: f

        if (.not. found%loose .and. any(input%fix /= '') .and. .not. is_held_whole(input) .and. &
            input%formulation /= 'rigid') &
            solid%notes = solid%notes//label('body', input%id, input%place)//'warning: fix '// &
                'holds every particle of it, as '//depth()//' reach through; take less, or '// &
                "fix='all' if it is to stand still"//new_line('a')
        do f = 1, input%n_fix_boxes
            if (found%fixes(f) .or. behind(input%fix_box(:, f))) cycle
            solid%notes = solid%notes//label('body', input%id, input%place)//'warning: fix_box '// &
                to_text(f)//' holds no particle; move it, or make it as thick as the spacing'// &
                new_line('a')
        end do
        do f = 1, input%n_rollers
            if (found%rolls(f) .or. behind(input%roller_box(:, f))) cycle
            call raise(err, exit_deck, label('body', input%id, input%place)//'roller_box '// &
                       to_text(f)//' holds no particle; make it as thick as the spacing')
            return
        end do

    contains

        pure logical function behind(box)
            real(dp), intent(in) :: box(6)

            behind = any(found%on_plane .and. .not. box(2:6:2) > 0)
        end function behind

        !> What of the faces is held.
        pure function depth() result(text)
            character(:), allocatable :: text

            text = to_text(input%fix_layers)//' layers'
            if (input%fix_width > 0) text = to_text(input%fix_width)//' m'
        end function depth
    end subroutine judge_held

    !> Whether a place lies in a box x0, x1, y0, y1, z0, z1, in the directions that the scene has.
    pure logical function in_box(x, box, dimension)
        real(dp), intent(in) :: x(3), box(6) !! [m]
        integer, intent(in) :: dimension

        in_box = all(x(:dimension) >= box(1:2*dimension:2) .and. &
                     x(:dimension) <= box(2:2*dimension:2))
    end function in_box

    pure real(dp) function lowest(shape, a)
        type(shape_t), intent(in) :: shape
        integer, intent(in) :: a

        lowest = shape%full_lo(a)
        if (shape%on_plane(a)) lowest = 0
    end function lowest

    !> Add the faces that a word of the key `fix` names. A face on a symmetry plane is no face.
    subroutine mark_faces(word, shape, held)
        character(*), intent(in) :: word
        type(shape_t), intent(in) :: shape
        logical, intent(inout) :: held(2, 3) !! (low/high, direction)
        real(dp) :: side(3)
        integer :: a, thin

        if (word == 'sides') then
            side = whole_sides(shape)
            thin = shape%dimension
            do a = shape%dimension, 1, -1
                if (side(a) < (1 - 1e-9_dp)*side(thin)) thin = a
            end do
            held(:, :shape%dimension) = .true.
            if (shape%dimension > 1) held(:, thin) = .false.
        else if (len(word) == 2) then
            a = index('xyz', word(1:1))
            if (a > 0) held(merge(1, 2, word(2:2) == '-'), a) = .true.
        end if
        held(1, :) = held(1, :) .and. .not. shape%on_plane
    end subroutine mark_faces
end module brz_body_start
