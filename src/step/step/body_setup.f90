! SPDX-License-Identifier: MIT
!> From the bodies of the deck to particles.
!>
!> `set_up_solid` fills all but lists and accelerations; start_solid (brz_solid_start) does that.
module brz_body_setup
    use brz_body, only: body_t
    use brz_body_pair, only: body_pair_force_t
    use brz_body_points, only: lay_shapes, place_points, points_t
    use brz_body_shape, only: axis_of, shape_t
    use brz_body_start, only: held_t, hold_body, judge_held, move_body
    use brz_body_warnings, only: judge_distance, judge_gauges, judge_planes, judge_plies, &
        judge_scatter, judge_spacing
    use brz_bond_check, only: judge_bonds
    use brz_case, only: body_case_t, case_t, label
    use brz_cohesive_setup, only: set_up_cohesive
    use brz_crack_band, only: judge_crack
    use brz_errors, only: error_t, failed
    use brz_formulation, only: settle_formulation
    use brz_gauge_quantities, only: find_quantity, from_impulse, quantities
    use brz_contact_edges, only: find_contact_edges
    use brz_interaction_setup, only: set_up_interactions
    use brz_load_setup, only: set_up_loads
    use brz_body_geometry, only: body_geometry_t
    use brz_body_geometries, only: geometry_of
    use brz_kinds, only: dp, int16, rk
    use brz_layer_setup, only: settle_layer
    use brz_material, only: material_t, point_t
    use brz_materials, only: make_material, material_remarks, start_point
    use brz_approach_speed, only: approach_speed
    use brz_plate, only: settle_plate
    use brz_region_setup, only: set_up_regions
    use brz_rigid_setup, only: set_up_rigid
    use brz_start_fields, only: move_from_dump, start_from_file
    use brz_soft_bodies, only: judge_soft
    use brz_solid_arrays, only: allocate_solid
    use brz_bodies, only: bodies_t
    use brz_listed_bodies, only: listed_bodies_t
    use brz_interacting_bodies, only: interacting_bodies_t
    use brz_text, only: string_t
    use brz_thin_bodies, only: judge_bars, judge_thin
    use brz_threads, only: worth_threads
    use brz_wide_lattice, only: settle_lattice
    implicit none
    private
    public :: geometry_of_solid, set_up_solid

contains

    !> Materials, bodies and particles of a case.
    subroutine set_up_solid(case, solid, err)
        type(case_t), intent(in) :: case
        class(interacting_bodies_t), intent(out) :: solid
        type(error_t), intent(inout) :: err
        type(points_t), allocatable :: points(:)
        type(held_t) :: found
        integer :: b

        call geometry_of_solid(case, solid, points, err)
        if (failed(err) .or. .not. solid%present) return
        call place_points(case, points, err)
        if (failed(err)) return
        call number_particles(points, solid)
        call set_up_interactions(case, solid, err)
        call allocate_solid(solid)
        if (case%air%present) allocate (solid%load(3, solid%n), source=0.0_rk)
        if (case%air%present .and. any(solid%bodies%face_share > 0)) &
            allocate (solid%face_stress(6, solid%n), source=0.0_rk)
        do b = 1, size(solid%bodies)
            call fill_body(case%bodies(b), points(b), solid, solid%bodies(b))
            if (allocated(points(b)%mesh%corner)) &
                call move_alloc(points(b)%mesh%corner, solid%bodies(b)%surface)
            if (allocated(points(b)%line)) call move_alloc(points(b)%line, solid%bodies(b)%line)
            call move_body(case%bodies(b), points(b)%shape, solid, solid%bodies(b))
            call start_from_file(case%bodies(b), case%materials(case%bodies(b)% &
                material_index)%model == 'linear_elastic', solid, solid%bodies(b), err)
            call hold_body(case%bodies(b), points(b)%shape, solid, solid%bodies(b), found)
            call set_up_regions(case%bodies(b), solid, solid%bodies(b), err)
            if (goes_on(case%bodies, b)) cycle
            call judge_held(case%bodies(b), found, solid, err)
            found = held_t()
        end do
        if (failed(err)) return
        call find_contact_edges([(is_whole_box(points(b)%shape, solid%bodies(b)), &
                                  b=1, size(points))], solid)
        call set_up_cohesive(case, reshape([(points(b)%shape%spacing, b=1, size(points))], &
                                           [3, size(points)]), solid, err)
        if (.not. failed(err)) call judge_bonds(case, solid)
        call set_up_loads(case, points%shape, solid, err)
        call set_up_watch(case, solid)
        do b = 1, size(solid%bodies)
            call move_from_dump(case%bodies(b), solid, solid%bodies(b), err)
            call set_up_rigid(case%bodies(b), points(b)%shape%on_plane, solid, solid%bodies(b), err)
        end do
    end subroutine set_up_solid

    !> True for a box of cubic particles without holes.
    pure logical function is_whole_box(shape, body)
        type(shape_t), intent(in) :: shape
        type(body_t), intent(in) :: body

        is_whole_box = body%last - body%first + 1 == product(shape%n(:shape%dimension)) .and. &
                       all(abs(body%stretch - 1) < 1e-6_dp)
    end function is_whole_box

    !> The next body is a part of the same laminate: it comes from the same group of the deck.
    pure logical function goes_on(bodies, b)
        type(body_case_t), intent(in) :: bodies(:)
        integer, intent(in) :: b

        goes_on = b < size(bodies)
        if (goes_on) goes_on = allocated(bodies(b)%place) .and. allocated(bodies(b + 1)%place)
        if (goes_on) goes_on = bodies(b)%place == bodies(b + 1)%place
    end function goes_on

    !> What gauges of whole bodies ask the steps for.
    subroutine set_up_watch(case, solid)
        type(case_t), intent(in) :: case
        class(interacting_bodies_t), intent(inout) :: solid
        integer :: g, k, pair(2)

        if (.not. allocated(case%gauges)) return
        if (any(case%gauges%with_index > 0)) allocate (solid%between(0))
        do g = 1, size(case%gauges)
            if (case%gauges(g)%with_index > 0) then
                pair = [case%gauges(g)%body_index, case%gauges(g)%with_index]
                if (any([(all(solid%between(k)%body == pair), k=1, size(solid%between))])) cycle
                solid%between = [solid%between, body_pair_force_t(pair)]
                cycle
            end if
            associate (whole => quantities(find_quantity(trim(case%gauges(g)%quantity)))%whole)
                if (whole >= from_impulse) solid%impulses = .true.
                if (whole > 0 .and. whole < from_impulse .and. &
                    .not. allocated(solid%reaction_force)) &
                    allocate (solid%reaction_force(3, solid%n), source=0.0_rk)
            end associate
        end do
    end subroutine set_up_watch

    !> Materials, settings and shapes of the bodies of a case: all but their particles.
    subroutine geometry_of_solid(case, solid, points, err)
        type(case_t), intent(in) :: case
        class(listed_bodies_t), intent(out) :: solid
        type(points_t), allocatable, intent(out) :: points(:)
        type(error_t), intent(inout) :: err
        integer :: b

        solid%notes = ''
        solid%present = case%solid%present .and. size(case%bodies) > 0
        if (.not. solid%present) return
        allocate (solid%materials(size(case%materials)))
        call make_materials(case, solid%materials, solid%notes, err)
        if (failed(err)) return
        allocate (solid%bodies(size(case%bodies)), points(size(case%bodies)))
        call lay_bodies(case, solid, points, err)
        if (failed(err)) return
        solid%n_hist = maxval([(solid%materials(solid%bodies(b)%material)%n_hist, &
                                b=1, size(solid%bodies))])
    end subroutine geometry_of_solid

    !> All materials; their faults are told together.
    subroutine make_materials(case, materials, notes, err)
        type(case_t), intent(in) :: case
        type(material_t), intent(out) :: materials(:)
        character(:), allocatable, intent(inout) :: notes !! warnings, a line each
        type(error_t), intent(inout) :: err
        type(error_t) :: one
        type(string_t), allocatable :: lines(:)
        character(:), allocatable :: warning
        integer :: m

        if (failed(err)) return
        do m = 1, size(case%materials)
            one = error_t()
            call make_material(case%materials(m), materials(m), one)
            if (.not. failed(one)) then
                call material_remarks(materials(m), lines, warning)
                if (warning /= '') notes = notes//label('material', case%materials(m)%id, &
                    case%materials(m)%place)//'warning: '//warning//new_line('a')
                cycle
            end if
            if (failed(err)) one%text = err%text//new_line('a')//one%text
            err = one
        end do
    end subroutine make_materials

    !> Lattices and settings of all bodies.
    subroutine lay_bodies(case, solid, points, err)
        type(case_t), intent(in) :: case
        class(listed_bodies_t), intent(inout) :: solid
        type(points_t), intent(out) :: points(:)
        type(error_t), intent(inout) :: err
        real(dp) :: middle(3), speed
        integer :: a, b

        solid%dimension = case%run%dimension
        solid%mirror = case%run%symmetry
        solid%mirror(solid%dimension + 1:) = .false.
        middle = 0
        if (case%air%present) middle = (case%air%lo + case%air%hi)/2
        do a = solid%dimension + 1, 3
            if (case%air%present) solid%depth = solid%depth*(case%air%hi(a) - case%air%lo(a))
        end do
        if (case%air%present) then
            solid%region(:solid%dimension, 1) = case%air%lo(:solid%dimension)
            solid%region(:solid%dimension, 2) = case%air%hi(:solid%dimension)
        end if
        if (case%solid%has_region) solid%region = case%solid%region
        where (solid%mirror) solid%region(:, 1) = -huge(1.0_dp) ! nothing leaves through a plane
        solid%remove = case%solid%leave == 'remove'
        solid%skin = case%solid%skin*minval(case%bodies%spacing)
        call lay_shapes(case, solid%mirror, solid%depth, middle, points, err)
        speed = approach_speed(case)
        do b = 1, size(points)
            if (failed(err)) return
            associate (m => case%bodies(b)%material_index)
                call settle(case%bodies(b), solid%materials(m), solid%dimension, speed, &
                            solid%bodies(b), err)
                call settle_lattice(case%bodies(b), solid%materials(m), points(b)%shape, &
                                    solid%bodies(b), err)
                call settle_plate(case%bodies(b), speed, points(b)%shape, solid%bodies(b), err)
                call settle_layer(case, b, points(b)%shape, solid%materials(m), solid%bodies(b))
            end associate
            call judge_spacing(case%bodies(b), points(b)%shape, solid%notes)
            call judge_plies(case%bodies(b), &
                             solid%materials(case%bodies(b)%material_index), solid%notes)
            call judge_distance(case%bodies(b), points(b)%shape, solid%notes)
            if (allocated(points(b)%x)) call judge_scatter(case%bodies(b), points(b)%x, &
                                                           solid%dimension, solid%notes)
            call judge_soft(case, b, solid%materials(case%bodies(b)%material_index), &
                            solid%bodies(b), solid%notes)
            call judge_crack(case%bodies(b), solid%bodies(b), &
                             solid%materials(case%bodies(b)%material_index), solid%notes, err)
            if (case%bodies(b)%shape == 'bars') call judge_bars(case, b, solid%bodies(b), err)
            call judge_thin(case, b, points(b)%shape, &
                            solid%materials(case%bodies(b)%material_index), solid%bodies(b), &
                            solid%notes, err)
        end do
        if (allocated(case%gauges)) call judge_gauges(case, points, solid%notes)
        call judge_planes(case, points, solid%notes)
    end subroutine lay_bodies

    !> Ranges of particles of all bodies.
    subroutine number_particles(points, solid)
        type(points_t), intent(in) :: points(:)
        class(bodies_t), intent(inout) :: solid
        integer :: b

        solid%n = 0
        do b = 1, size(points)
            solid%bodies(b)%first = solid%n + 1
            solid%n = solid%n + size(points(b)%x, 2)
            solid%bodies(b)%last = solid%n
            solid%bodies(b)%rim = solid%n
            solid%bodies(b)%number = [solid%bodies(b)%first, solid%n]
            solid%bodies(b)%volume_scale = points(b)%scale
            solid%notes = solid%notes//points(b)%notes
        end do
    end subroutine number_particles

    !> Copy the settings of a body from the deck.
    subroutine settle(input, material, dimension, speed, body, err)
        type(body_case_t), intent(in) :: input
        type(material_t), intent(in) :: material
        integer, intent(in) :: dimension
        real(dp), intent(in) :: speed !! [m/s]
        type(body_t), intent(inout) :: body
        type(error_t), intent(inout) :: err
        type(body_geometry_t) :: geometry

        body%id = input%id
        body%place = label('body', input%id, input%place)
        body%file = trim(input%file)
        body%material = input%material_index
        body%spacing = input%spacing
        geometry = geometry_of(input)
        if (geometry%round) then
            body%round%centre = input%centre
            body%round%radius = [input%radius, input%inner_radius]
            if (geometry%fits == 'axis') body%round%axis = axis_of(input)
        end if
        call settle_formulation(input, material, dimension, speed, body, err)
    end subroutine settle

    !> Place the particles of a body, unloaded and at rest.
    subroutine fill_body(input, points, solid, body)
        type(body_case_t), intent(in) :: input
        type(points_t), intent(in) :: points
        class(bodies_t), intent(inout) :: solid
        type(body_t), intent(in) :: body
        type(point_t) :: point
        real(dp) :: volume
        integer :: n, ply

        ply = -1 ! of `point`, in each thread
        !$omp parallel do if(solid%n >= worth_threads) schedule(static) firstprivate(ply) &
        !$omp private(point, volume)
        do n = body%first, body%last
            solid%id(n) = n
            solid%x(:, n) = points%x(:, n - body%first + 1)
            solid%x_ref(:, n) = solid%x(:, n)*body%stretch
            volume = points%volume(n - body%first + 1)
            solid%volume(n) = real(volume, rk)
            solid%mass(n) = real(volume*solid%materials(body%material)%density, rk)
            solid%ply(n) = ply_of(input, points%shape, solid%x(:, n))
            if (solid%ply(n) /= ply) then
                ply = solid%ply(n)
                call start_point(solid%materials(body%material), ply_angle(input, ply), &
                                 input%ply_axis, point)
            end if
            solid%mu(n) = point%mu
            solid%energy(n) = point%energy
            solid%stress(:, n) = point%stress
            solid%hist(:, n) = point%hist(:solid%n_hist)
            solid%damage(n) = point%damage
        end do
    end subroutine fill_body

    !> Ply of a particle, by its centroid; 0 without plies.
    pure integer(int16) function ply_of(input, shape, x) result(ply)
        type(body_case_t), intent(in) :: input
        type(shape_t), intent(in) :: shape
        real(dp), intent(in) :: x(3)
        real(dp) :: lowest
        integer :: a, p

        ply = 0
        if (input%n_plies < 1) return
        a = max(1, index('xyz', input%ply_axis))
        lowest = shape%full_lo(a) - input%below(a) ! of the whole body
        p = 1 + int(input%n_plies*(x(a) - lowest)/(shape%full_hi(a) - lowest))
        ply = int(max(1, min(p, input%n_plies)), int16)
    end function ply_of

    pure real(rk) function ply_angle(input, ply)
        type(body_case_t), intent(in) :: input
        integer, intent(in) :: ply

        ply_angle = 0
        if (ply > 0) ply_angle = real(input%ply_angle(ply)*acos(-1.0_dp)/180, rk)
    end function ply_angle
end module brz_body_setup
