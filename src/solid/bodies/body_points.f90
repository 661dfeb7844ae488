! SPDX-License-Identifier: MIT
!> Where the particles of each body are, and what volume each one has.
!>
!> A body that cuts another takes the places of that body's particles. The volume of a particle is
!> that of its shape over the number of particles, so that every mass is exact.
module brz_body_points
    use brz_body_shape, only: axis_of, bar_weight, exact_volume, inside, lay_shape, &
                              modelled_share, overlap, point_of, shape_t, take_lattice
    use brz_case, only: body_case_t, case_t, label, means
    use brz_errors, only: error_t, exit_deck, failed, raise
    use brz_kinds, only: dp, real32
    use brz_layered_wall, only: lay_wall
    use brz_particle_file, only: read_particles
    use brz_place_jitter, only: jitter_places
    use brz_stl, only: is_inside, mesh_t, read_stl
    use brz_text, only: to_text
    implicit none
    private
    public :: points_t, lay_shapes, place_points, cuts, cell_volume

    real(dp), parameter :: same_spacing = 0.02_dp !! relative difference that lattices may have
    real(dp), parameter :: same_place = 0.1_dp !! of layers, in spacings
    real(dp), parameter :: same_length = 0.01_dp !! relative, of a cylinder and its layers
    real(dp), parameter :: scales(2) = [0.7_dp, 1.3_dp] !! that a volume may have over its cell

    character(*), parameter :: axes = 'xyz'

    !> The particles of one body.
    type :: points_t
        type(shape_t) :: shape
        real(dp), allocatable :: x(:, :) !! (3, n) [m]
        real(dp), allocatable :: volume(:) !! (n) of each particle, relative until all are laid [m3]
        integer, allocatable :: line(:) !! (n) of the table that they come from, (0): of none
        type(mesh_t) :: mesh !! shape='stl'
        real(dp) :: exact = 0 !! volume of what is modelled, 0: not known [m3]
        real(dp) :: scale = 1 !! mean volume of a particle over that of its cell of the lattice
        character(:), allocatable :: notes !! warnings, a line each
    end type points_t

contains

    !> Shapes and lattices of all bodies of a case; no particles but those from files.
    subroutine lay_shapes(case, mirror, depth, middle, points, err)
        type(case_t), intent(in) :: case
        logical, intent(in) :: mirror(3) !! symmetry planes
        real(dp), intent(in) :: depth, middle(3) !! see lay_shape [m]
        type(points_t), intent(out) :: points(:)
        type(error_t), intent(inout) :: err
        integer :: b

        do b = 1, size(points)
            if (failed(err)) return
            points(b)%notes = ''
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
            if (.not. case%bodies(b)%layered) call share_lattice(case%bodies, points, b)
            if (case%bodies(b)%shape /= 'stl') &
                points(b)%exact = exact_volume(case%bodies(b), points(b)%shape)
        end do
    end subroutine lay_shapes

    !> Particles of all bodies of a case, whose shapes are laid.
    subroutine place_points(case, points, err)
        type(case_t), intent(in) :: case
        type(points_t), intent(inout) :: points(:)
        type(error_t), intent(inout) :: err
        integer :: b, c

        if (failed(err)) return
        do b = 1, size(points)
            if (case%bodies(b)%shape == 'particles') cycle
            if (case%bodies(b)%shape == 'stl') call mark_lattice(case%bodies(b), points(b), err)
            if (case%bodies(b)%layered) then
                call lay_wall(case%bodies(b), points(b)%shape, points(b)%x, points(b)%volume)
            else
                call fill_lattice(case%bodies(b), points(b))
            end if
            call judge_length(case%bodies(b), points(b))
        end do
        do b = 1, size(points)
            call settle_volume(case%bodies, points, b, err)
        end do
        do b = 1, size(points)
            do c = 1, size(points)
                if (.not. failed(err)) call refuse_overlap(case%bodies, points, b, c, err)
            end do
        end do
        do b = 1, size(points)
            if (case%bodies(b)%formulation /= 'rigid') call jitter_places( &
                case%solid%jitter*case%bodies(b)%spacing, case%solid%seed, b, &
                case%run%dimension, points(b)%x)
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
        associate (p => points(b))
            p%volume = volume*p%volume/max(tiny(volume), sum(p%volume))
            if (bodies(b)%shape == 'particles') return
            p%scale = volume/cell/max(1, size(p%volume))
            if (bodies(b)%layered) p%scale = 1 ! of the cells of its rings
            if (bodies(b)%shape == 'bars' .or. &
                (p%scale >= scales(1) .and. p%scale <= scales(2))) return
            call raise(err, exit_deck, label('body', bodies(b)%id, bodies(b)%place)//'its '// &
                       to_text(size(p%volume))//' particles would each have '// &
                       to_text(real(p%scale, real32))//' times the volume of a cell of their '// &
                       'lattice: the shape is not resolved; use a smaller spacing, and let it '// &
                       'cut (cuts) all bodies that it goes through')
        end associate
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
            call read_particles(trim(body%file), points%x, points%volume, points%line, fault)
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
            do a = 1, 3
                points%x(a, :) = body%scale*points%x(a, :) + body%move(a)
                box(a, 1) = minval(points%x(a, :)) - body%spacing/2 ! of all: plies count in it
                box(a, 2) = maxval(points%x(a, :)) + body%spacing/2
            end do
            call drop_images(body, mirror, points)
        end if
        call lay_shape(body, 3, mirror, depth, middle, points%shape, box)
        if (body%shape == 'stl') points%exact = points%mesh%volume*modelled_share(points%shape)
    end subroutine from_file

    !> Leave out the particles behind planes of symmetry, and scale the volume of the others.
    subroutine drop_images(body, mirror, points)
        type(body_case_t), intent(in) :: body
        logical, intent(in) :: mirror(3)
        type(points_t), intent(inout) :: points
        logical, allocatable :: stay(:)
        integer, allocatable :: kept(:)
        integer :: a, i

        allocate (stay(size(points%x, 2)), source=.true.)
        do a = 1, 3
            if (mirror(a)) stay = stay .and. points%x(a, :) > 0
        end do
        kept = pack([(i, i=1, size(stay))], stay)
        if (size(points%volume) == 0) then
            points%volume = spread(body%spacing**3, 1, size(kept))
        else
            points%volume = points%volume(kept)*body%scale**3
        end if
        points%x = points%x(:, kept)
        if (size(points%line) > 0) points%line = points%line(kept)
        points%exact = sum(points%volume)
    end subroutine drop_images

    !> Find the points of the lattice that lie within the surface.
    subroutine mark_lattice(body, points, err)
        type(body_case_t), intent(in) :: body
        type(points_t), intent(inout) :: points
        type(error_t), intent(inout) :: err
        logical :: once

        associate (s => points%shape)
            allocate (s%mark(s%n(1), s%n(2), s%n(3)))
            call is_inside(points%mesh, s%start, s%spacing, s%mark, once)
        end associate
        if (.not. once) call raise(err, exit_deck, label('body', body%id, body%place)// &
            trim(body%file)//' has parts that lie in each other or face different ways, so its '// &
            'mass is not that of its particles; join the parts, and let the surface of a '// &
            'hollow face into it')
    end subroutine mark_lattice

    !> True where body a takes the place of body b.
    pure logical function cuts(a, b)
        type(body_case_t), intent(in) :: a, b

        cuts = any(means(a%cuts, b%id))
    end function cuts

    pure real(dp) function cell_volume(s)
        type(shape_t), intent(in) :: s

        cell_volume = product(s%spacing(:s%dimension))*s%depth
    end function cell_volume

    !> Let a body use the lattice of the boxes that it cuts, where the spacings agree: of the one in
    !> which most of it lies. Their lattices should be one.
    subroutine share_lattice(bodies, points, b)
        type(body_case_t), intent(in) :: bodies(:)
        type(points_t), intent(inout) :: points(:)
        integer, intent(in) :: b
        real(dp) :: shared(size(bodies)), beside
        integer :: a, c, from

        shared = 0
        do c = 1, size(bodies)
            if (cuts(bodies(b), bodies(c)) .and. bodies(c)%shape == 'box' .and. &
                abs(bodies(b)%spacing - bodies(c)%spacing) <= same_spacing*bodies(c)%spacing) &
                shared(c) = overlap(points(c)%shape, points(b)%shape)
        end do
        from = maxloc(shared, 1)
        if (.not. maxval(shared) > 0) return
        call take_lattice(points(from)%shape, points(b)%shape)
        do c = 1, size(bodies)
            if (c == from .or. .not. shared(c) > 0) cycle
            associate (s => points(b)%shape, t => points(c)%shape)
                do a = 1, s%dimension
                    beside = (t%start(a) - s%start(a))/s%spacing(a)
                    if (abs(beside - anint(beside)) <= same_place) cycle
                    points(b)%notes = points(b)%notes//label('body', bodies(b)%id, &
                        bodies(b)%place)//"warning: it cuts '"//trim(bodies(from)%id)//"' and '"// &
                        trim(bodies(c)%id)//"', whose layers along "//axes(a:a)//' do not go '// &
                        "on in each other: its particles do not take the places of those of '"// &
                        trim(bodies(c)%id)//"'; put their sides a whole number of spacings "// &
                        'apart'//new_line('a')
                    exit
                end do
            end associate
        end do
    end subroutine share_lattice

    !> A cylinder on the lattice of a box has whole layers of it.
    subroutine judge_length(body, points)
        type(body_case_t), intent(in) :: body
        type(points_t), intent(inout) :: points
        real(dp) :: length, laid
        integer :: a

        a = axis_of(body)
        if (points%shape%geometry%fits /= 'axis' .or. body%shape == 'bars') return
        if (a > points%shape%dimension) return
        if (size(points%x, 2) == 0) return
        length = points%shape%hi(a) - points%shape%lo(a)
        laid = maxval(points%x(a, :)) - minval(points%x(a, :)) + points%shape%spacing(a)
        if (abs(laid - length) <= same_length*length) return
        points%notes = points%notes//label('body', body%id, body%place)// &
            'warning: whole layers along '//body%axis//' make it '// &
            to_text(real(laid, real32))//' m long, not '//to_text(real(length, real32))// &
            ' m (its mass is right); choose a length that is whole layers of the box that it '// &
            'cuts'//new_line('a')
    end subroutine judge_length

    !> The points of the lattice that lie in the body.
    subroutine fill_lattice(body, points)
        type(body_case_t), intent(in) :: body
        type(points_t), intent(inout) :: points
        logical, allocatable :: within(:, :)
        integer, allocatable :: before(:) !! points in the rows before a row
        real(dp) :: x(3)
        integer :: i, m, n, rows

        associate (s => points%shape)
            rows = s%n(2)*s%n(3)
            allocate (within(s%n(1), rows), before(rows + 1))
            !$omp parallel do schedule(static) private(i)
            do m = 1, rows
                do i = 1, s%n(1)
                    within(i, m) = inside(body, s, point_of(s, layers_at(s, i, m)), 0.0_dp)
                end do
            end do
            before(1) = 0
            do m = 1, rows
                before(m + 1) = before(m) + count(within(:, m))
            end do
            allocate (points%x(3, before(rows + 1)))
            !$omp parallel do schedule(static) private(i, n, x)
            do m = 1, rows
                n = before(m)
                do i = 1, s%n(1)
                    if (.not. within(i, m)) cycle
                    n = n + 1
                    x = point_of(s, layers_at(s, i, m))
                    points%x(:, n) = x
                end do
            end do
        end associate
        if (body%shape == 'bars') then
            points%volume = bar_weight(body, points%shape, points%x)
        else
            allocate (points%volume(size(points%x, 2)), source=1.0_dp)
        end if
    end subroutine fill_lattice

    !> Layers of point i of row m of a lattice; rows go along x, one after the other in y, then z.
    pure function layers_at(s, i, m) result(layers)
        type(shape_t), intent(in) :: s
        integer, intent(in) :: i, m !! from 1
        integer :: layers(3)

        layers = [i, 1 + mod(m - 1, s%n(2)), 1 + (m - 1)/s%n(2)]
    end function layers_at

    !> Take the particles of body b away where body c is, and so much of its volume.
    subroutine cut_out(bodies, points, b, c, volume)
        type(body_case_t), intent(in) :: bodies(:)
        type(points_t), intent(inout) :: points(:)
        integer, intent(in) :: b, c
        real(dp), intent(inout) :: volume !! of b [m3]
        logical, allocatable :: stay(:)
        integer, allocatable :: left(:)
        real(dp) :: gap(3)
        integer :: d, i

        associate (p => points(b), s => points(c)%shape, t => points(b)%shape)
            allocate (stay(size(p%x, 2)))
            !$omp parallel do schedule(static)
            do i = 1, size(stay)
                stay(i) = .not. inside(bodies(c), s, p%x(:, i), 0.0_dp)
            end do
            left = pack([(i, i=1, size(stay))], stay)
            d = t%dimension
            gap = 1e-6_dp*t%spacing
            if (bodies(b)%shape == 'box' .and. points(c)%exact > 0 .and. &
                all(s%lo(:d) >= t%lo(:d) - gap(:d) .and. s%hi(:d) <= t%hi(:d) + gap(:d))) then
                volume = volume - points(c)%exact
            else
                volume = volume*sum(p%volume(left))/max(tiny(volume), sum(p%volume))
            end if
            p%x = p%x(:, left)
            p%volume = p%volume(left)
            if (bodies(b)%shape /= 'particles') return
            if (size(p%line) > 0) p%line = p%line(left)
        end associate
    end subroutine cut_out

    !> Particles of b inside c, more than rounding: two bodies in one place.
    subroutine refuse_overlap(bodies, points, b, c, err)
        type(body_case_t), intent(in) :: bodies(:)
        type(points_t), intent(in) :: points(:)
        integer, intent(in) :: b, c
        type(error_t), intent(inout) :: err
        real(dp) :: margin
        logical :: meets
        integer :: i

        if (b == c .or. cuts(bodies(b), bodies(c)) .or. cuts(bodies(c), bodies(b))) return
        margin = 1e-3_dp*bodies(b)%spacing
        meets = .false.
        !$omp parallel do schedule(static) reduction(.or.: meets)
        do i = 1, size(points(b)%x, 2)
            if (.not. meets) &
                meets = inside(bodies(c), points(c)%shape, points(b)%x(:, i), margin)
        end do
        if (meets) call raise(err, exit_deck, label('body', bodies(b)%id, bodies(b)%place)// &
            "it overlaps the body '"//trim(bodies(c)%id)//"'; move one of them, or say with "// &
            "cuts='...' which one makes room for the other")
    end subroutine refuse_overlap
end module brz_body_points
