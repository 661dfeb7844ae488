! SPDX-License-Identifier: MIT
!> Where the particles of each body are, and what volume each one has.
!>
!> A body that cuts another takes the places of that body's particles. The volume of a particle is
!> that of its shape over the number of particles, so that every mass is exact.
module brz_body_points
    use brz_body_shape, only: exact_volume, inside, lay_shape, modelled_share, point_of, shape_t, &
                              take_lattice
    use brz_case, only: body_case_t, case_t, label
    use brz_errors, only: error_t, exit_deck, failed, raise
    use brz_kinds, only: dp
    use brz_particle_file, only: read_particles
    use brz_stl, only: is_inside, mesh_t, read_stl
    implicit none
    private
    public :: points_t, place_points

    real(dp), parameter :: same_spacing = 0.02_dp !! relative difference that lattices may have

    !> The particles of one body.
    type :: points_t
        type(shape_t) :: shape
        real(dp), allocatable :: x(:, :) !! (3, n) [m]
        real(dp), allocatable :: volumes(:) !! (n) where the particles have their own [m3]
        type(mesh_t) :: mesh !! shape='stl'
        real(dp) :: exact = 0 !! volume of what is modelled, 0: not known [m3]
        real(dp) :: volume = 0 !! of a particle [m3]
        real(dp) :: scale = 1 !! volume of a particle over that of its cell of the lattice
    end type points_t

contains

    !> Particles of all bodies of a case.
    subroutine place_points(case, mirror, depth, middle, points, err)
        type(case_t), intent(in) :: case
        logical, intent(in) :: mirror(3) !! symmetry planes
        real(dp), intent(in) :: depth, middle(3) !! see lay_shape [m]
        type(points_t), intent(out) :: points(:)
        type(error_t), intent(inout) :: err
        integer :: b, c

        do b = 1, size(points)
            if (failed(err)) return
            select case (case%bodies(b)%shape)
            case ('stl', 'particles')
                call from_file(case%bodies(b), mirror, depth, middle, points(b), err)
            case default
                call lay_shape(case%bodies(b), case%run%dimension, mirror, depth, middle, &
                               points(b)%shape)
            end select
        end do
        if (failed(err)) return
        do b = 1, size(points)
            if (case%bodies(b)%shape == 'particles') cycle
            c = lender(case%bodies, b)
            if (c > 0) call take_lattice(points(c)%shape, points(b)%shape)
            if (case%bodies(b)%shape == 'stl') then
                call mark_lattice(points(b))
            else
                points(b)%exact = exact_volume(case%bodies(b), points(b)%shape)
            end if
            call fill_lattice(case%bodies(b), points(b))
        end do
        do b = 1, size(points)
            call settle_volume(case%bodies, points, b, err)
        end do
        do b = 1, size(points)
            do c = 1, size(points)
                if (.not. failed(err)) call refuse_overlap(case%bodies, points, b, c, err)
            end do
        end do
    end subroutine place_points

    !> Cut a body where others take its place, and give its particles their volume.
    subroutine settle_volume(bodies, points, b, err)
        type(body_case_t), intent(in) :: bodies(:)
        type(points_t), intent(inout) :: points(:)
        integer, intent(in) :: b
        type(error_t), intent(inout) :: err
        real(dp) :: cell, volume
        integer :: c

        cell = cell_volume(points(b)%shape)
        volume = points(b)%exact
        if (.not. volume > 0) volume = cell*size(points(b)%x, 2)
        do c = 1, size(points)
            if (cuts(bodies(c), bodies(b))) call cut_out(bodies, points, b, c, volume)
        end do
        if (size(points(b)%x, 2) == 0) call raise(err, exit_deck, &
            label('body', bodies(b)%id, bodies(b)%place)// &
            'holds no particle: it lies beyond a symmetry plane, or is smaller than its '// &
            'spacing, or another body cuts all of it away')
        points(b)%volume = volume/max(1, size(points(b)%x, 2))
        points(b)%scale = points(b)%volume/cell
        if (bodies(b)%shape == 'particles') points(b)%scale = 1
    end subroutine settle_volume

    !> A body from a file: its surface, or its particles themselves.
    subroutine from_file(body, mirror, depth, middle, points, err)
        type(body_case_t), intent(in) :: body
        logical, intent(in) :: mirror(3)
        real(dp), intent(in) :: depth, middle(3) !! [m]
        type(points_t), intent(inout) :: points
        type(error_t), intent(inout) :: err
        type(error_t) :: fault
        real(dp) :: box(3, 2)
        integer :: a

        if (body%shape == 'stl') then
            call read_stl(trim(body%file), points%mesh, fault)
        else
            call read_particles(trim(body%file), points%x, points%volumes, fault)
        end if
        if (failed(fault)) then
            call raise(err, fault%code, label('body', body%id, body%place)//fault%text)
            return
        end if
        if (body%shape == 'stl') then
            associate (mesh => points%mesh)
                do a = 1, 3
                    mesh%corner(a, :, :) = body%scale*mesh%corner(a, :, :) + body%move(a)
                end do
                mesh%volume = mesh%volume*body%scale**3
                box(:, 1) = body%scale*mesh%lo + body%move
                box(:, 2) = body%scale*mesh%hi + body%move
            end associate
        else
            call move_particles(body, mirror, points)
            do a = 1, 3
                box(a, 1) = minval(points%x(a, :)) - body%spacing/2
                box(a, 2) = maxval(points%x(a, :)) + body%spacing/2
            end do
        end if
        call lay_shape(body, 3, mirror, depth, middle, points%shape, box)
        if (body%shape == 'stl') points%exact = points%mesh%volume*modelled_share(points%shape)
    end subroutine from_file

    !> Scale and move particles, and leave out those behind planes of symmetry.
    subroutine move_particles(body, mirror, points)
        type(body_case_t), intent(in) :: body
        logical, intent(in) :: mirror(3)
        type(points_t), intent(inout) :: points
        logical, allocatable :: stay(:)
        integer, allocatable :: kept(:)
        integer :: a, i

        allocate (stay(size(points%x, 2)), source=.true.)
        do a = 1, 3
            points%x(a, :) = body%scale*points%x(a, :) + body%move(a)
            if (mirror(a)) stay = stay .and. points%x(a, :) > 0
        end do
        kept = pack([(i, i=1, size(stay))], stay)
        if (size(points%volumes) == 0) then
            points%volumes = spread(body%spacing**3, 1, size(kept))
        else
            points%volumes = points%volumes(kept)*body%scale**3
        end if
        points%x = points%x(:, kept)
        points%exact = sum(points%volumes)
    end subroutine move_particles

    !> Find the points of the lattice that lie within the surface.
    subroutine mark_lattice(points)
        type(points_t), intent(inout) :: points

        associate (s => points%shape)
            allocate (s%mark(s%n(1), s%n(2), s%n(3)))
            call is_inside(points%mesh, s%start, s%spacing, s%mark)
        end associate
    end subroutine mark_lattice

    !> True where body a takes the place of body b.
    pure logical function cuts(a, b)
        type(body_case_t), intent(in) :: a, b

        cuts = b%id /= '' .and. any(a%cuts == b%id)
    end function cuts

    pure real(dp) function cell_volume(s)
        type(shape_t), intent(in) :: s

        cell_volume = product(s%spacing(:s%dimension))*s%depth
    end function cell_volume

    !> The box whose lattice a body uses: the first one that it cuts, if the spacings agree.
    pure integer function lender(bodies, b)
        type(body_case_t), intent(in) :: bodies(:)
        integer, intent(in) :: b
        integer :: c

        do c = 1, size(bodies)
            lender = c
            if (cuts(bodies(b), bodies(c)) .and. bodies(c)%shape == 'box' .and. &
                abs(bodies(b)%spacing - bodies(c)%spacing) <= same_spacing*bodies(c)%spacing) return
        end do
        lender = 0
    end function lender

    !> The points of the lattice that lie in the body.
    subroutine fill_lattice(body, points)
        type(body_case_t), intent(in) :: body
        type(points_t), intent(inout) :: points
        integer :: i, j, k, n, pass

        do pass = 1, 2
            n = 0
            do k = 1, points%shape%n(3)
                do j = 1, points%shape%n(2)
                    do i = 1, points%shape%n(1)
                        if (.not. inside(body, points%shape, point_of(points%shape, [i, j, k]), &
                                         0.0_dp)) cycle
                        n = n + 1
                        if (pass == 2) points%x(:, n) = point_of(points%shape, [i, j, k])
                    end do
                end do
            end do
            if (pass == 1) allocate (points%x(3, n))
        end do
    end subroutine fill_lattice

    !> Take the particles of body b away where body c is, and so much of its volume.
    subroutine cut_out(bodies, points, b, c, volume)
        type(body_case_t), intent(in) :: bodies(:)
        type(points_t), intent(inout) :: points(:)
        integer, intent(in) :: b, c
        real(dp), intent(inout) :: volume !! of b [m3]
        real(dp), allocatable :: left(:, :)
        real(dp) :: gap(3)
        integer :: d, i, n, before

        before = size(points(b)%x, 2)
        allocate (left(3, before))
        n = 0
        do i = 1, before
            if (inside(bodies(c), points(c)%shape, points(b)%x(:, i), 0.0_dp)) cycle
            n = n + 1
            left(:, n) = points(b)%x(:, i)
        end do
        d = points(b)%shape%dimension
        associate (s => points(c)%shape, t => points(b)%shape)
            gap = 1e-6_dp*t%spacing
            if (bodies(b)%shape == 'box' .and. points(c)%exact > 0 .and. &
                all(s%lo(:d) >= t%lo(:d) - gap(:d) .and. s%hi(:d) <= t%hi(:d) + gap(:d))) then
                volume = volume - points(c)%exact
            else if (before > 0) then
                volume = volume*n/before
            end if
        end associate
        points(b)%x = left(:, :n)
    end subroutine cut_out

    !> Particles of b inside c, more than rounding: two bodies in one place.
    subroutine refuse_overlap(bodies, points, b, c, err)
        type(body_case_t), intent(in) :: bodies(:)
        type(points_t), intent(in) :: points(:)
        integer, intent(in) :: b, c
        type(error_t), intent(inout) :: err
        real(dp) :: margin
        integer :: i

        if (b == c .or. cuts(bodies(b), bodies(c)) .or. cuts(bodies(c), bodies(b))) return
        margin = 1e-3_dp*bodies(b)%spacing
        do i = 1, size(points(b)%x, 2)
            if (.not. inside(bodies(c), points(c)%shape, points(b)%x(:, i), margin)) cycle
            call raise(err, exit_deck, label('body', bodies(b)%id, bodies(b)%place)// &
                       "it overlaps the body '"//trim(bodies(c)%id)//"'; move one of them, or "// &
                       "say with cuts='...' which one makes room for the other")
            return
        end do
    end subroutine refuse_overlap
end module brz_body_points
