! SPDX-License-Identifier: MIT
!> The loaded segments that carry the loads of a deck, from the unloaded bodies.
module brz_load_setup
    use brz_body, only: body_t
    use brz_body_shape, only: shape_t
    use brz_case, only: case_t, load_case_t, label
    use brz_edge_shares, only: edge_shares, n_edge, share_of
    use brz_errors, only: error_t, exit_deck, failed, raise
    use brz_face_load, only: arrival_of, find_places, lay_out
    use brz_interaction, only: law_bonded
    use brz_kinds, only: dp, int32, real32, rk
    use brz_kingery_bulmash, only: blast_t, farthest, free_air_blast, friedlander_decay, nearest, &
                                   nearest_ground, oblique_shares, surface_blast
    use brz_loads, only: loaded_segments_t
    use brz_patch, only: is_under
    use brz_particles, only: particles_t
    use brz_bodies, only: bodies_t
    use brz_listed_bodies, only: listed_bodies_t
    use brz_stl, only: mesh_t, read_stl
    use brz_text, only: to_text
    use brz_loaded_wall, only: find_loaded_wall
    use brz_wide_lattice, only: unloaded_place
    implicit none
    private
    public :: set_up_loads

    real(dp), parameter :: fine = 0.01_dp !! step over the length of a load
    real(dp), parameter :: most_stretch = 2 !! of a loaded segment that still carries more load

contains

    !> Loaded segments of all loads, and room for forces.
    subroutine set_up_loads(case, shapes, solid, err)
        type(case_t), intent(in) :: case
        type(shape_t), intent(in) :: shapes(:) !! of the bodies
        class(listed_bodies_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        type(loaded_segments_t), allocatable :: segments(:)
        integer :: k

        if (.not. allocated(case%loads)) return
        if (size(case%loads) == 0) return
        if (.not. allocated(solid%load)) allocate (solid%load(3, solid%n), source=0.0_rk)
        if (.not. all(case%loads%on_all)) allocate (solid%face_stress(6, solid%n), source=0.0_rk)
        allocate (solid%loads%of(size(case%loads)), solid%loads%place(solid%n), &
                  segments(size(case%loads)))
        call find_places(solid%loads, solid%id)
        do k = 1, size(case%loads)
            associate (load => case%loads(k), history => solid%loads%of(k))
                history%blast = load%mass > 0
                history%time = load%time
                history%pressure = load%pressure
                if (size(load%time) > 1) solid%loads%step = min(solid%loads%step, fine* &
                                                     (load%time(size(load%time)) - load%time(1)))
                call lay_out(segments(k), 0)
                if (load%on_all) then
                    history%body = load%body
                    history%push = push_of(load, solid)
                    cycle
                end if
                if (case%bodies(load%body)%layered) then
                    call find_loaded_wall(case%bodies(load%body), shapes(load%body), &
                                          load%faces(7:8), most_stretch, solid, &
                                          solid%bodies(load%body), segments(k))
                else
                    call find_loaded_segments(load, shapes(load%body), solid, &
                                     solid%bodies(load%body), segments(k), err)
                    if (failed(err)) return
                    call weigh_edges(load, shapes(load%body), solid, solid%bodies(load%body), &
                                     segments(k))
                end if
                segments(k)%load = k
                if (segments(k)%n == 0) call raise(err, exit_deck, label('load', load%id, &
                    load%place)//'no particle of the body lies on these faces'// &
                    trim(merge(' under the patch', '                ', load%patch /= ''))// &
                    '; name others')
                if (.not. history%blast) cycle
                call find_waves(load, solid, segments(k), err)
                solid%loads%step = min(solid%loads%step, minval(segments(k)%wave(2, :))*fine)
            end associate
        end do
        call join(segments, solid%loads%segments)
        call judge_arrivals(case, solid)
    end subroutine set_up_loads

    !> A load that begins after the end of the run does nothing.
    subroutine judge_arrivals(case, solid)
        type(case_t), intent(in) :: case
        class(bodies_t), intent(inout) :: solid
        character(:), allocatable :: remedy
        real(dp) :: arrival
        integer :: k

        do k = 1, size(case%loads)
            arrival = arrival_of(solid%loads, k)
            if (arrival < case%run%t_end .or. arrival > huge(arrival)/2) cycle
            remedy = '; make t_end of &run longer'
            if (solid%loads%of(k)%blast) remedy = remedy//', or let detonation_time be '// &
                'negative: the run then begins when the wave is near'
            solid%notes = solid%notes//label('load', case%loads(k)%id, case%loads(k)%place)// &
                'warning: it arrives at '//to_text(real(arrival, real32))//' s, after the end '// &
                'of the run at '//to_text(real(case%run%t_end, real32))//' s'//remedy//new_line('a')
        end do
    end subroutine judge_arrivals

    !> The acceleration of a whole body [m/s2].
    pure function push_of(load, solid) result(push)
        type(load_case_t), intent(in) :: load
        class(bodies_t), intent(in) :: solid
        real(dp) :: push(3)

        associate (body => solid%bodies(load%body))
            push = load%acceleration &
                   + load%force/sum(real(solid%mass(body%first:body%last), dp))
        end associate
    end function push_of

    !> The loaded segments of all loads in one list, those of a particle one after the other.
    subroutine join(parts, all)
        type(loaded_segments_t), intent(in) :: parts(:)
        type(loaded_segments_t), intent(out) :: all
        integer, allocatable :: start(:)
        integer :: at, i, k, most

        call lay_out(all, sum(parts%n))
        most = 0
        do k = 1, size(parts)
            if (parts(k)%n > 0) most = max(most, maxval(parts(k)%id))
        end do
        allocate (start(most + 1), source=0)
        do k = 1, size(parts)
            do i = 1, parts(k)%n
                start(parts(k)%id(i) + 1) = start(parts(k)%id(i) + 1) + 1
            end do
        end do
        all%carriers = count(start > 0)
        allocate (all%first(all%carriers + 1))
        allocate (all%owner(all%carriers), source=0_int32)
        all%first(all%carriers + 1) = all%n + 1
        at = 0
        do i = 1, most ! from numbers of loaded segments to the places before those of a particle
            if (start(i + 1) > 0) then
                at = at + 1
                all%first(at) = start(i) + 1
            end if
            start(i + 1) = start(i) + start(i + 1)
        end do
        do k = 1, size(parts)
            do i = 1, parts(k)%n
                start(parts(k)%id(i)) = start(parts(k)%id(i)) + 1
                call copy_loaded_segment(parts(k), i, all, start(parts(k)%id(i)))
            end do
        end do
    end subroutine join

    subroutine copy_loaded_segment(from, i, to, k)
        type(loaded_segments_t), intent(in) :: from
        integer, intent(in) :: i, k
        type(loaded_segments_t), intent(inout) :: to

        to%id(k) = from%id(i)
        to%load(k) = from%load(i)
        to%side(k) = from%side(i)
        to%beside(:, k) = from%beside(:, i)
        to%mirror(:, k) = from%mirror(:, i)
        to%width(:, k) = from%width(:, i)
        to%most(:, k) = from%most(:, i)
        to%wave(:, k) = from%wave(:, i)
    end subroutine copy_loaded_segment

    !> Particles with no neighbour on the lattice across a face, and their neighbours in the layer.
    subroutine find_loaded_segments(load, shape, solid, body, segments, err)
        type(load_case_t), intent(in) :: load
        type(shape_t), intent(in) :: shape
        class(particles_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        type(loaded_segments_t), intent(out) :: segments
        type(error_t), intent(inout) :: err
        type(mesh_t) :: mesh
        integer, allocatable :: cell(:, :, :)
        integer :: at(3), axis, i, low(3), high(3), n, pass, side, steps(3)

        if (load%patch /= '') call read_stl(trim(load%patch), mesh, err, is_patch=.true.)
        if (failed(err)) return
        call fill_lattice(solid, body, shape%spacing*body%stretch, cell, low, high)
        do pass = 1, 2
            n = 0
            do axis = 1, solid%dimension
                do side = -1, 1, 2
                    if (.not. load%faces(merge(2*axis - 1, 2*axis, side < 0))) cycle
                    steps = 0
                    steps(axis) = side
                    do i = body%first, body%last
                        at = place_of(solid, i, body%first, shape%spacing*body%stretch)
                        if (number_at(cell, low, high, at + steps) /= 0) cycle
                        if (load%patch /= '') then
                            if (.not. is_under(mesh, solid%x_ref(:, i)/body%stretch, axis, &
                                               2*shape%spacing(axis))) cycle
                        end if
                        if (side < 0 .and. solid%mirror(axis) .and. &
                            solid%x_ref(axis, i) < shape%spacing(axis)*body%stretch(axis)) cycle
                        n = n + 1
                        if (pass == 2) call lay_loaded_segment(i, axis, side, n)
                    end do
                end do
            end do
            if (pass == 1) call lay_out(segments, n)
        end do

    contains

        !> Loaded segment k: that of particle i. A neighbour beyond a plane of symmetry is its own
        !> image; at an edge of the face the span is that to the one other neighbour.
        subroutine lay_loaded_segment(i, axis, side, k)
            integer, intent(in) :: i, axis, side, k
            integer :: a, j, m, step(3), tangent, up

            segments%id(k) = solid%id(i)
            segments%side(k) = side*axis
            do tangent = 1, 2
                a = mod(axis + tangent - 1, 3) + 1
                segments%width(tangent, k) = 0
                segments%most(tangent, k) = most_stretch*shape%spacing(a)
                do up = 0, 1
                    m = 2*tangent - 1 + up
                    segments%beside(m, k) = 0
                    segments%mirror(m, k) = 0
                    if (a > solid%dimension) cycle
                    step = 0
                    step(a) = 1 - 2*up
                    j = number_at(cell, low, high, &
                                  place_of(solid, i, body%first, shape%spacing*body%stretch) + step)
                    if (j > 0) then
                        segments%beside(m, k) = solid%id(j)
                    else if (up == 1 .and. solid%mirror(a) .and. &
                             solid%x_ref(a, i) < shape%spacing(a)*body%stretch(a)) then
                        segments%mirror(m, k) = a
                    else
                        cycle
                    end if
                    segments%width(tangent, k) = segments%width(tangent, k) + 1
                end do
                if (segments%width(tangent, k) > 0) &
                    segments%width(tangent, k) = 1/segments%width(tangent, k)
            end do
        end subroutine lay_loaded_segment
    end subroutine find_loaded_segments

    !> Give loaded segments near the edges of faces the shares of the load that their columns bear.
    subroutine weigh_edges(load, shape, solid, body, segments)
        type(load_case_t), intent(in) :: load
        type(shape_t), intent(in) :: shape
        class(listed_bodies_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        type(loaded_segments_t), intent(inout) :: segments
        real(dp) :: apart(3), share, shares(n_edge)
        integer, allocatable :: cell(:, :, :)
        integer :: a, i, k, low(3), high(3), tangent

        if (.not. has_edges(load, shape, solid, body)) return
        apart = shape%spacing*body%stretch
        call fill_lattice(solid, body, apart, cell, low, high)
        shares = edge_shares(solid%dimension, real(body%h/body%spacing, dp))
        do k = 1, segments%n
            i = solid%loads%place(segments%id(k))
            do tangent = 1, 2
                a = mod(abs(segments%side(k)) + tangent - 1, 3) + 1
                if (a > solid%dimension) cycle
                share = share_of(shares, columns_to_edge(i, a, -1), columns_to_edge(i, a, 1))
                segments%width(tangent, k) = share*segments%width(tangent, k)
                segments%most(tangent, k) = share*segments%most(tangent, k)
            end do
        end do

    contains

        !> Columns from particle i to the free edge of its layer on one side, itself the first; at
        !> most one more than those that an edge changes. Beyond a plane of symmetry the layer goes
        !> on as its image.
        integer function columns_to_edge(i, a, side) result(columns)
            integer, intent(in) :: i, a, side !! axis, -1 or 1
            integer :: at(3), from_plane, there(3)

            at = place_of(solid, i, body%first, apart)
            from_plane = n_edge + 1
            if (side < 0 .and. solid%mirror(a)) &
                from_plane = nint(solid%x_ref(a, i)/apart(a) + 0.5_dp)
            do columns = 1, n_edge
                there = at
                there(a) = at(a) + columns*side
                if (columns >= from_plane) there(a) = at(a) + columns - 2*from_plane + 1
                if (number_at(cell, low, high, there) == 0) return
            end do
        end function columns_to_edge
    end subroutine weigh_edges

    !> True for loads on whole faces of a box beyond whose edges no bonded body goes on.
    pure logical function has_edges(load, shape, solid, body) result(yes)
        type(load_case_t), intent(in) :: load
        type(shape_t), intent(in) :: shape
        class(listed_bodies_t), intent(in) :: solid
        type(body_t), intent(in) :: body

        yes = load%patch == '' .and. body%face_share > 0 .and. &
              body%last - body%first + 1 == product(shape%n(:solid%dimension))
        if (allocated(solid%links%table)) &
            yes = yes .and. .not. any(solid%links%table(:, load%body)%law == law_bonded)
    end function has_edges

    !> Numbers of the particles of a body on its lattice.
    subroutine fill_lattice(solid, body, spacing, cell, low, high)
        class(particles_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        real(dp), intent(in) :: spacing(3)
        integer, allocatable, intent(out) :: cell(:, :, :)
        integer, intent(out) :: low(3), high(3)
        integer :: at(3), i

        low = huge(low)
        high = -huge(high)
        do i = body%first, body%last
            at = place_of(solid, i, body%first, spacing)
            low = min(low, at)
            high = max(high, at)
        end do
        allocate (cell(low(1):high(1), low(2):high(2), low(3):high(3)), source=0)
        do i = body%first, body%last
            at = place_of(solid, i, body%first, spacing)
            cell(at(1), at(2), at(3)) = i
        end do
    end subroutine fill_lattice

    !> Layers of a particle, from those of the first of its body; 0 where nothing is modelled.
    pure function place_of(solid, i, first, spacing) result(at)
        class(particles_t), intent(in) :: solid
        integer, intent(in) :: i, first
        real(dp), intent(in) :: spacing(3)
        integer :: at(3)

        at = 0
        associate (n => solid%dimension)
            at(:n) = nint((solid%x_ref(:n, i) - solid%x_ref(:n, first))/spacing(:n))
        end associate
    end function place_of

    pure integer function number_at(cell, low, high, at) result(i)
        integer, intent(in) :: low(3), high(3), at(3)
        integer, intent(in) :: cell(low(1):high(1), low(2):high(2), low(3):high(3))

        i = 0
        if (all(at >= low) .and. all(at <= high)) i = cell(at(1), at(2), at(3))
    end function number_at

    !> Waves of a blast on the loaded segments of the unloaded body: reflected and incident part by
    !> the angle of incidence.
    subroutine find_waves(load, solid, segments, err)
        type(load_case_t), intent(in) :: load
        class(bodies_t), intent(in) :: solid
        type(loaded_segments_t), intent(inout) :: segments
        type(error_t), intent(inout) :: err
        type(blast_t) :: blast
        real(dp) :: arm(3), outward(3), share(2), distance, near, far, least
        integer :: i, k

        near = huge(near)
        least = merge(nearest_ground, nearest, load%on_ground)
        far = 0
        do k = 1, segments%n
            i = solid%loads%place(segments%id(k))
            arm = load%at - unloaded_place(solid, load%body, i)
            arm(solid%dimension + 1:) = 0
            distance = norm2(arm)
            near = min(near, distance/load%mass**(1/3.0_dp))
            far = max(far, distance/load%mass**(1/3.0_dp))
            if (near < least .or. far > farthest) cycle
            if (load%on_ground) then
                blast = surface_blast(load%mass, distance)
            else
                blast = free_air_blast(load%mass, distance)
            end if
            outward = 0
            outward(abs(segments%side(k))) = sign(1, segments%side(k))
            associate (round => solid%bodies(load%body)%round)
                if (load%faces(8)) outward = unloaded_place(solid, load%body, i) - round%centre
                if (load%faces(8)) outward(round%axis) = 0
            end associate
            share = oblique_shares(dot_product(arm, outward)/(distance*norm2(outward)))
            segments%wave(:, k) = [load%start + blast%arrival, blast%duration, &
                share(1)*blast%reflected, share(2)*blast%peak, &
                friedlander_decay(blast%reflected, blast%duration, blast%reflected_impulse), &
                friedlander_decay(blast%peak, blast%duration, blast%impulse)]
        end do
        if (near < least .or. far > farthest) call raise(err, exit_deck, &
            label('load', load%id, load%place)//'scaled distances from '//to_text(near)//' to '// &
            to_text(far)//' m/kg^(1/3) leave the range of the Kingery-Bulmash curves, '// &
            to_text(least)//' to '//to_text(farthest)//'; move the charge, or compute the air')
    end subroutine find_waves
end module brz_load_setup
