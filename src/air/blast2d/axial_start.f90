! SPDX-License-Identifier: MIT
!> From a charge of the deck to the blast in the plane through its axis: where the plane lies in the
!> scene, and what the blast would meet that is not round about the axis.
module brz_axial_start
    use brz_axial_state, only: axial_input_t, axial_t, top_of, w_p, w_r, w_rho, w_z
    use brz_blast_start, only: charge_constants
    use brz_case, only: case_t, label
    use brz_charge_shape, only: make_shape, charge_shape_t
    use brz_body_geometries, only: body_box
    use brz_errors, only: error_t, exit_deck, raise
    use brz_kinds, only: dp
    use brz_text, only: to_text
    implicit none
    private
    public :: frame_t, obstacle_t, make_frame, axial_input, axial_at
    public :: find_obstacles, free_gap, charge_gap

    real(dp), parameter :: on_plane = 1e-6_dp !! how exactly a plane must pass the centre, in cells

    !> Where the plane (r, z) lies: z counts from the centre of the charge, away from the floor.
    type :: frame_t
        integer :: axis = 3, across(2) = [1, 2]
        real(dp) :: sense = 1 !! of z along the axis
        real(dp) :: centre(3) = 0 !! of the charge [m]
        real(dp) :: floor = huge(1.0_dp) !! its distance below the centre [m]
        logical :: mirrored(3) = .false. !! a plane of symmetry through the centre
    end type frame_t

    !> What lies in r >= radius, low <= z <= high of the plane, at some angle.
    type :: obstacle_t
        real(dp) :: radius = 0, low = 0, high = 0 !! [m]
    end type obstacle_t

contains

    !> Where the plane lies: a wall or plane of symmetry across the axis is its floor, of two the
    !> nearer one.
    pure function make_frame(case) result(frame)
        type(case_t), intent(in) :: case
        type(frame_t) :: frame
        real(dp) :: depth, dx
        integer :: d, s

        associate (charge => case%charges(1), air => case%air)
            frame%axis = index('xyz', charge%axis)
            frame%across = modulo(frame%axis + [0, 1], 3) + 1
            frame%centre = charge%at
            if (air%geometry /= 'cartesian') then
                if (air%floor > -huge(1.0_dp)) frame%floor = charge%at(frame%axis) - air%floor
                return
            end if
            do d = 1, 3
                dx = (air%hi(d) - air%lo(d))/air%cells(d)
                do s = 1, 2
                    depth = merge(charge%at(d) - air%lo(d), air%hi(d) - charge%at(d), s == 1)
                    if (abs(depth) <= on_plane*dx) depth = 0
                    if (.not. depth > 0) frame%mirrored(d) = air%bc(s, d) == 'symmetry' .or. &
                        (d == frame%axis .and. air%bc(s, d) == 'wall') .or. frame%mirrored(d)
                    if (d /= frame%axis .or. all(air%bc(s, d) /= ['wall    ', 'symmetry'])) cycle
                    if (.not. depth < frame%floor) cycle
                    frame%floor = depth
                    frame%sense = merge(1, -1, s == 1)
                end do
            end do
        end associate
    end function make_frame

    !> What the blast starts from.
    subroutine axial_input(case, frame, input, err)
        type(case_t), intent(in) :: case
        type(frame_t), intent(in) :: frame
        type(axial_input_t), intent(out) :: input
        type(error_t), intent(inout) :: err
        type(charge_shape_t) :: shape

        call make_shape(case%charges(1), spread(.true., 1, 3), 1.0_dp, shape, err)
        associate (charge => case%charges(1), air => case%air)
            input%ball = charge%shape == 'sphere'
            input%half = shape%half(frame%axis)
            input%radius = shape%half(frame%across(1))
            call charge_constants(case, input%eos, input%velocity)
            input%ignition = frame%sense*(charge%ignition(frame%axis) - charge%at(frame%axis))
            input%density = air%density
            input%pressure = air%pressure
            input%gamma = air%gamma
            input%floor = frame%floor
            input%n = charge%plane_cells
            if (abs(input%ignition) > input%half) call raise(err, exit_deck, label('charge', &
                charge%id, charge%place)//'ignition lies outside of the charge, whose half '// &
                'length is '//to_text(input%half)//' m')
            if (input%floor > 0 .and. input%floor < input%half) call raise(err, exit_deck, &
                label('charge', charge%id, charge%place)//'it reaches through the floor, which '// &
                'is '//to_text(input%floor)//' m from its centre; move it by its half length, '// &
                to_text(input%half)//' m, or halve it by a plane of symmetry')
            if (input%floor < 0) call raise(err, exit_deck, label('charge', charge%id, &
                charge%place)//'its centre lies below the floor')
        end associate
    end subroutine axial_input

    !> All that is not round about the axis: bodies and boxes of gas by their bounding boxes, the
    !> sides of the box of air but for its floor and planes of symmetry through the axis. Open sides
    !> count where there is nothing else: a blast is gone behind them.
    subroutine find_obstacles(case, frame, obstacles)
        type(case_t), intent(in) :: case
        type(frame_t), intent(in) :: frame
        type(obstacle_t), allocatable, intent(out) :: obstacles(:)
        type(obstacle_t), allocatable :: open (:)
        real(dp) :: lo(3), hi(3), far
        integer :: b, d, s

        allocate (obstacles(0), open (0))
        far = sum(case%air%hi - case%air%lo)
        do b = 1, size(case%bodies)
            call body_box(case%bodies(b), lo, hi)
            obstacles = [obstacles, swept(frame, lo, hi)]
        end do
        do b = 1, size(case%gas)
            obstacles = [obstacles, swept(frame, case%gas(b)%lo, case%gas(b)%hi)]
        end do
        do d = 1, 3
            do s = 1, 2
                lo = case%air%lo - far
                hi = case%air%hi + far
                if (s == 1) hi(d) = case%air%lo(d)
                if (s == 2) lo(d) = case%air%hi(d)
                if (d == frame%axis .and. s == merge(1, 2, frame%sense > 0) .and. &
                    frame%floor < far) cycle
                if (d /= frame%axis .and. case%air%bc(s, d) == 'symmetry' .and. &
                    frame%mirrored(d) .and. is_near(case, frame, d, s)) cycle
                if (case%air%bc(s, d) == 'outflow') then
                    open = [open, swept(frame, lo, hi)]
                else
                    obstacles = [obstacles, swept(frame, lo, hi)]
                end if
            end do
        end do
        if (size(obstacles) == 0) obstacles = open
    end subroutine find_obstacles

    !> True for the side of the box that is nearer to the axis.
    pure logical function is_near(case, frame, d, s)
        type(case_t), intent(in) :: case
        type(frame_t), intent(in) :: frame
        integer, intent(in) :: d, s

        is_near = (s == 1) .eqv. frame%centre(d) - case%air%lo(d) < case%air%hi(d) - frame%centre(d)
    end function is_near

    !> What a box covers of the plane when it is turned about the axis.
    pure function swept(frame, lo, hi) result(obstacle)
        type(frame_t), intent(in) :: frame
        real(dp), intent(in) :: lo(3), hi(3) !! corners [m]
        type(obstacle_t) :: obstacle
        real(dp) :: away(3), ends(2)

        away = max(lo - frame%centre, frame%centre - hi, 0.0_dp)
        ends = frame%sense*([lo(frame%axis), hi(frame%axis)] - frame%centre(frame%axis))
        obstacle = obstacle_t(norm2(away(frame%across)), minval(ends), maxval(ends))
    end function swept

    !> Least distance from the front to an obstacle [m].
    pure real(dp) function free_gap(blast, obstacles) result(gap)
        type(axial_t), intent(in) :: blast
        type(obstacle_t), intent(in) :: obstacles(:)
        integer :: j

        gap = huge(gap)
        do j = blast%first, blast%last
            if (blast%reached(j) == 0) cycle
            gap = min(gap, distance(obstacles, blast%reached(j)*blast%dr, top_of(blast, j - 1), &
                top_of(blast, j)))
        end do
    end function free_gap

    !> Least distance from the charge to an obstacle; a ball counts with the cylinder around it [m].
    pure real(dp) function charge_gap(input, obstacles) result(gap)
        type(axial_input_t), intent(in) :: input
        type(obstacle_t), intent(in) :: obstacles(:)

        gap = distance(obstacles, input%radius, -input%half, input%half)
    end function charge_gap

    !> Least distance from what lies in r <= radius, low <= z <= high to an obstacle [m].
    pure real(dp) function distance(obstacles, radius, low, high)
        type(obstacle_t), intent(in) :: obstacles(:)
        real(dp), intent(in) :: radius, low, high !! [m]
        integer :: b

        distance = huge(distance)
        do b = 1, size(obstacles)
            associate (o => obstacles(b))
                distance = min(distance, norm2([max(o%radius - radius, 0.0_dp), &
                    max(o%low - high, low - o%high, 0.0_dp)]))
            end associate
        end do
    end function distance

    !> Density, velocity and pressure of the blast at a place of the scene.
    pure function axial_at(blast, frame, at) result(seen)
        type(axial_t), intent(in) :: blast !! prepared
        type(frame_t), intent(in) :: frame
        real(dp), intent(in) :: at(3) !! [m]
        real(dp) :: seen(5)
        real(dp) :: arm(3), r, part(2), mean(7)
        integer :: i, j, a, b

        arm = at - frame%centre
        r = norm2(arm(frame%across))
        part = [r/blast%dr, (frame%sense*arm(frame%axis) - blast%rise)/blast%dz] + 0.5_dp
        i = min(floor(part(1)), blast%n)
        j = max(min(floor(part(2)), blast%n - 1), blast%low - 1)
        part = min(max(part - [i, j], 0.0_dp), 1.0_dp)
        mean = 0
        do b = 0, 1 ! between the centres of four cells
            do a = 0, 1
                mean = mean + merge(part(1), 1 - part(1), a == 1) &
                    *merge(part(2), 1 - part(2), b == 1)*blast%w(i + a, :, j + b)
            end do
        end do
        seen([1, 5]) = mean([w_rho, w_p])
        seen(1 + frame%across) = mean(w_r)*arm(frame%across)/max(r, tiny(r))
        seen(1 + frame%axis) = frame%sense*mean(w_z)
    end function axial_at
end module brz_axial_start
