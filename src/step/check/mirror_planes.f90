! SPDX-License-Identifier: MIT
!> Planes through the origin in which a scene is its own mirror image: with `symmetry` it can then
!> be run as a half, a quarter or an eighth.
!>
!> Asked is the deck: every box of gas and charge must be its own image, every body its own or that
!> of another, with velocity, spin, plies, what is held and what presses on it. Where a shape is in
!> a file, or a boundary is periodic, nothing is said.
module brz_mirror_planes
    use brz_case, only: body_case_t, case_t, is_from_file, region_case_t
    use brz_kinds, only: dp
    use brz_body_geometry, only: body_geometry_t
    use brz_body_geometries, only: geometry_of
    implicit none
    private
    public :: mirror_planes

    real(dp), parameter :: near = 1e-9_dp !! of lengths and speeds that should agree

contains

    !> For x, y, z: is the scene its own image, and not yet run as a part?
    function mirror_planes(case) result(plane)
        type(case_t), intent(in) :: case
        logical :: plane(3)
        integer :: a

        plane = .false.
        if (size(case%bodies) == 0 .and. .not. case%air%present) return
        if (case%air%present .and. case%air%geometry /= 'cartesian') return
        do a = 1, case%run%dimension
            plane(a) = .not. case%run%symmetry(a)
            if (plane(a)) plane(a) = air_is_even(case, a)
            if (plane(a)) plane(a) = bodies_are_even(case, a)
            if (plane(a)) plane(a) = loads_are_even(case, a)
        end do
    end function mirror_planes

    !> Box, boundaries, gas and charges of the air.
    pure logical function air_is_even(case, a) result(even)
        type(case_t), intent(in) :: case
        integer, intent(in) :: a
        integer :: m

        even = .true.
        if (case%solid%has_region) &
            even = opposite(case%solid%region(a, 1), case%solid%region(a, 2))
        associate (air => case%air)
            if (.not. air%present) return
            even = even .and. opposite(air%lo(a), air%hi(a)) .and. &
                   air%bc(1, a) == air%bc(2, a) .and. air%bc(1, a) /= 'periodic'
        end associate
        do m = 1, size(case%gas)
            even = even .and. case%gas(m)%file == '' &
                   .and. opposite(case%gas(m)%lo(a), case%gas(m)%hi(a)) &
                   .and. .not. abs(case%gas(m)%velocity(a)) > 0
        end do
        do m = 1, size(case%inflows)
            even = even .and. case%inflows(m)%axis /= a .and. (case%inflows(m)%wave &
                   .or. .not. any(abs(case%inflows(m)%state(:, 1 + a)) > 0))
        end do
        do m = 1, size(case%charges)
            even = even .and. .not. abs(case%charges(m)%at(a)) > 0
        end do
    end function air_is_even

    !> Every body has an image, itself or another.
    logical function bodies_are_even(case, a) result(even)
        type(case_t), intent(in) :: case
        integer, intent(in) :: a
        integer :: b, c, m

        even = .true.
        do b = 1, size(case%bodies)
            even = .false.
            do c = 1, size(case%bodies)
                even = is_image(case%bodies(b), case%bodies(c), a)
                if (even) exit
            end do
            if (.not. even) return
        end do
        do m = 1, size(case%interactions)
            associate (rule => case%interactions(m))
                even = even .and. &
                       boxes_agree(rule%open_box(:, :rule%n_open_boxes), &
                                   rule%open_box(:, :rule%n_open_boxes), a)
            end associate
        end do
    end function bodies_are_even

    !> Is body p the image of q?
    logical function is_image(p, q, a) result(image)
        type(body_case_t), intent(in) :: p, q
        integer, intent(in) :: a
        type(body_geometry_t) :: outline

        outline = geometry_of(p)
        image = p%shape == q%shape .and. outline%even .and. .not. is_from_file(p) .and. &
                p%file == '' .and. p%start_file == '' .and. p%material == q%material .and. &
                p%axis == q%axis .and. p%formulation == q%formulation .and. &
                (p%variable_h .eqv. q%variable_h) .and. (p%layered .eqv. q%layered)
        if (.not. image) return
        image = all(same([p%spacing, p%radius, p%length, p%inner_radius, p%diameter], &
                         [q%spacing, q%radius, q%length, q%inner_radius, q%diameter])) &
                .and. all(same(p%own, q%own)) .and. all(p%bars == q%bars) &
                .and. places_agree(p, q, a) .and. motions_agree(p, q, a) &
                .and. plies_agree(p, q, a) .and. fixes_agree(p, q, a) .and. regions_agree(p, q, a)
    end function is_image

    pure logical function places_agree(p, q, a) result(reduce_errors)
        type(body_case_t), intent(in) :: p, q
        integer, intent(in) :: a
        integer :: b

        reduce_errors = .true.
        do b = 1, 3
            if (b == a) then
                reduce_errors = reduce_errors .and. opposite(p%lo(b), q%hi(b)) .and. &
                        opposite(p%hi(b), q%lo(b)) .and. opposite(p%centre(b), q%centre(b))
            else
                reduce_errors = reduce_errors .and. same(p%lo(b), q%lo(b)) .and. &
                        same(p%hi(b), q%hi(b)) .and. same(p%centre(b), q%centre(b))
            end if
        end do
    end function places_agree

    !> Velocity and prescribed motion turn round along the axis, a spin along the other two.
    pure logical function motions_agree(p, q, a) result(reduce_errors)
        type(body_case_t), intent(in) :: p, q
        integer, intent(in) :: a
        real(dp) :: turn(3)
        integer :: m

        turn = 1
        turn(a) = -1
        reduce_errors = all(same(p%velocity, turn*q%velocity)) .and. &
                all(same(p%spin, -turn*q%spin)) .and. (p%about_point .eqv. q%about_point) &
                .and. all(same(p%spin_centre, turn*q%spin_centre)) .and. p%n_motion == q%n_motion
        if (.not. reduce_errors) return
        do m = 1, p%n_motion
            reduce_errors = reduce_errors .and. same(p%motion_time(m), q%motion_time(m)) .and. &
                    all(same(p%motion_velocity(:, m), turn*q%motion_velocity(:, m)))
        end do
    end function motions_agree

    !> Each region that a motion moves has an image that moves as its image does.
    pure logical function regions_agree(p, q, a) result(reduce_errors)
        type(body_case_t), intent(in) :: p, q
        integer, intent(in) :: a
        integer :: i, j

        reduce_errors = allocated(p%regions) .eqv. allocated(q%regions)
        if (.not. (reduce_errors .and. allocated(p%regions))) return
        reduce_errors = size(p%regions) == size(q%regions)
        do i = 1, size(p%regions)
            if (.not. reduce_errors) return
            reduce_errors = .false.
            do j = 1, size(q%regions)
                reduce_errors = reduce_errors .or. region_agrees(p%regions(i), q%regions(j), a)
            end do
        end do
    end function regions_agree

    pure logical function region_agrees(p, q, a) result(agrees)
        type(region_case_t), intent(in) :: p, q
        integer, intent(in) :: a
        real(dp) :: turn(3)
        integer :: m

        agrees = boxes_agree(p%box(:, :p%n_boxes), q%box(:, :q%n_boxes), a) .and. &
                 all(p%along .eqv. q%along) .and. size(p%time) == size(q%time)
        if (.not. agrees) return
        turn = 1
        turn(a) = -1
        do m = 1, size(p%time)
            agrees = agrees .and. same(p%time(m), q%time(m)) .and. &
                     all(same(p%velocity(:, m), turn*q%velocity(:, m)))
        end do
    end function region_agrees

    !> Across the plies their order turns round; in their plane only 0 and 90 degrees are even.
    pure logical function plies_agree(p, q, a) result(reduce_errors)
        type(body_case_t), intent(in) :: p, q
        integer, intent(in) :: a
        integer :: n

        n = p%n_plies
        reduce_errors = n == q%n_plies .and. p%ply_axis == q%ply_axis
        if (.not. reduce_errors .or. n == 0) return
        if (index('xyz', p%ply_axis) == a) then
            reduce_errors = all(same(p%ply_angle(:n), q%ply_angle(n:1:-1)))
        else
            reduce_errors = all(same(p%ply_angle(:n), q%ply_angle(:n))) .and. &
                    all(same(modulo(p%ply_angle(:n) + 1, 90.0_dp), 1.0_dp))
        end if
    end function plies_agree

    !> Faces and regions that are held.
    pure logical function fixes_agree(p, q, a) result(reduce_errors)
        type(body_case_t), intent(in) :: p, q
        integer, intent(in) :: a
        character(1) :: axis
        integer :: k

        reduce_errors = same(p%fix_width, q%fix_width) .and. p%fix_layers == q%fix_layers
        axis = 'xyz' (a:a)
        do k = 1, size(p%fix)
            if (p%fix(k) == axis//'-') then
                reduce_errors = reduce_errors .and. any(q%fix == axis//'+')
            else if (p%fix(k) == axis//'+') then
                reduce_errors = reduce_errors .and. any(q%fix == axis//'-')
            else
                reduce_errors = reduce_errors .and. any(q%fix == p%fix(k))
            end if
        end do
        reduce_errors = reduce_errors .and. boxes_agree(p%fix_box(:, :p%n_fix_boxes), &
                                        q%fix_box(:, :q%n_fix_boxes), a)
        do k = 1, 3
            reduce_errors = reduce_errors .and. boxes_agree(rollers_of(p, k), rollers_of(q, k), a)
        end do
    end function fixes_agree

    !> The regions that are held along axis k.
    pure function rollers_of(body, k) result(boxes)
        type(body_case_t), intent(in) :: body
        integer, intent(in) :: k
        real(dp), allocatable :: boxes(:, :)
        integer :: m

        allocate (boxes(6, 0))
        do m = 1, body%n_rollers
            if (index('xyz', body%roller_axis(m)) == k) &
                boxes = reshape([boxes, body%roller_box(:, m)], [6, size(boxes, 2) + 1])
        end do
    end function rollers_of

    !> Is every box of one list the image of one of the other? Corners x0, x1, y0, y1, z0, z1.
    pure logical function boxes_agree(p, q, a) result(reduce_errors)
        real(dp), intent(in) :: p(:, :), q(:, :) !! (6, boxes)
        integer, intent(in) :: a
        real(dp) :: image(6)
        integer :: i, j

        reduce_errors = size(p, 2) == size(q, 2)
        do i = 1, size(p, 2)
            if (.not. reduce_errors) return
            image = p(:, i)
            image(2*a - 1:2*a) = -p([2*a, 2*a - 1], i)
            reduce_errors = .false.
            do j = 1, size(q, 2)
                reduce_errors = reduce_errors .or. all(same(image, q(:, j)))
            end do
        end do
    end function boxes_agree

    !> What presses on a body presses on both sides alike.
    logical function loads_are_even(case, a) result(even)
        type(case_t), intent(in) :: case
        integer, intent(in) :: a
        integer :: m

        even = .true.
        do m = 1, size(case%loads)
            associate (load => case%loads(m))
                even = even .and. load%patch == '' .and. &
                       (load%faces(2*a - 1) .eqv. load%faces(2*a)) .and. &
                       is_image(case%bodies(load%body), case%bodies(load%body), a) .and. &
                       .not. (load%mass > 0 .and. abs(load%at(a)) > 0) .and. &
                       .not. max(abs(load%acceleration(a)), abs(load%force(a))) > 0
            end associate
        end do
    end function loads_are_even

    elemental logical function same(x, y)
        real(dp), intent(in) :: x, y

        same = abs(x - y) <= near*(1 + max(abs(x), abs(y)))
    end function same

    elemental logical function opposite(x, y)
        real(dp), intent(in) :: x, y

        opposite = same(x, -y)
    end function opposite
end module brz_mirror_planes
