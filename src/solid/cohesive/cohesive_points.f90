! SPDX-License-Identifier: MIT
!> The points of cohesive interfaces: what each sees of the particles of both bodies.
!>
!> Each side is continued to the point by moving least squares over the particles (images in planes
!> of symmetry among them) within two spacings, in the unloaded bodies. The weights of the near side
!> count negative, so that their sum over the places is the opening. A side that is one layer thick
!> is seen in its middle; what lies between the two then turns with the normal.
module brz_cohesive_points
    use brz_cell_grid, only: cell_span, fill_cells, lay_grid, number_of_cell
    use brz_cohesive_faces, only: faces_t
    use brz_cohesive_state, only: cohesive_t
    use brz_kinds, only: dp, int32, int8
    use brz_link_layout, only: mask_unit
    use brz_linear_weights, only: linear_weights
    use brz_solid_mirror, only: signs
    use brz_listed_bodies, only: listed_bodies_t
    use brz_interacting_bodies, only: interacting_bodies_t
    implicit none
    private
    public :: begin_points, lay_points, link_nodes

    integer, parameter :: most = 128 !! particles that a point sees of one side
    real(dp), parameter :: reach_over_spacing = 2

    !> What points see of one side.
    type :: side_t
        integer :: n = 0
        integer, allocatable :: first(:) !! (points+1)
        integer(int32), allocatable :: node(:)
        integer(int8), allocatable :: mask(:)
        real(dp), allocatable :: weight(:, :) !! (3, entries) of the place; of the tangents [1/m]
    end type side_t

contains

    !> No points yet.
    subroutine begin_points(cohesive)
        type(cohesive_t), intent(inout) :: cohesive

        cohesive%n = 0
        allocate (cohesive%of(0), cohesive%area(0), cohesive%gap(0), cohesive%beside(2, 0), &
                  cohesive%rest(3, 2, 0), cohesive%node(0), cohesive%mask(0), cohesive%weight(3, 0))
        allocate (cohesive%first(1), source=1_int32)
    end subroutine begin_points

    !> Points of one interface, appended to those that are there.
    subroutine lay_points(solid, k, faces, spacing)
        class(interacting_bodies_t), intent(inout) :: solid !! its search tables are overwritten
        integer, intent(in) :: k !! interface
        type(faces_t), intent(in) :: faces !! of the near side
        real(dp), intent(in) :: spacing(2) !! of either side [m]
        type(side_t) :: sides(2)
        real(dp) :: rest(3, 2, faces%n)
        integer :: f, side

        do f = 1, faces%n
            rest(:, :, f) = tangents(faces%axis(f))
        end do
        do side = 1, 2
            call view_side(solid, solid%cohesive%body(side, k), faces, &
                           reach_over_spacing*spacing(side), sides(side))
        end do
        call append(solid%cohesive, k, faces, sides, rest)
        call settle_gaps(solid, faces%n)
    end subroutine lay_points

    !> Tangents of a face; their cross product is its normal.
    pure function tangents(axis) result(t)
        integer, intent(in) :: axis !! of the normal, +-1, ...
        real(dp) :: t(3, 2)

        t = 0
        t(modulo(abs(axis), 3) + 1, 1) = 1
        t(modulo(abs(axis) + 1, 3) + 1, 2) = sign(1, axis)
    end function tangents

    !> What all points see of one body.
    subroutine view_side(solid, b, faces, reach, view)
        class(listed_bodies_t), intent(inout) :: solid
        integer, intent(in) :: b
        type(faces_t), intent(in) :: faces
        real(dp), intent(in) :: reach !! [m]
        type(side_t), intent(out) :: view
        integer :: particle(most), mask(most), e, f, n
        real(dp) :: x(3, most), value(most), slope(3, most), t(3, 2)

        call lay_grid(solid%search, solid%x_ref, solid%fixed, solid%bodies(b), reach)
        call fill_cells(solid%search, solid%x_ref, solid%fixed, solid%bodies(b))
        allocate (view%first(faces%n + 1), view%node(0), view%mask(0), view%weight(3, 0))
        do f = 1, faces%n
            view%first(f) = view%n + 1
            call collect(solid, faces%at(:, f), reach, n, particle, mask, x)
            call linear_weights(x(:, :n), faces%at(:, f), reach, value(:n), slope(:, :n))
            if (solid%bodies(b)%layer > 0) &
                call take_particle(x(:, :n), faces%at(:, f), abs(faces%axis(f)), reach, value(:n))
            call grow(view, view%n + n)
            t = tangents(faces%axis(f))
            do e = 1, n
                view%node(view%n + e) = particle(e)
                view%mask(view%n + e) = int(mask(e), int8)
                view%weight(:, view%n + e) = [value(e), matmul(slope(:, e), t)]
            end do
            view%n = view%n + n
        end do
        view%first(faces%n + 1) = view%n + 1
    end subroutine view_side

    !> A layer is seen where its particle lies, if one lies right above or below the point: sums
    !> over its neighbours would not see how it moves against them.
    pure subroutine take_particle(x, at, axis, reach, value)
        real(dp), intent(in) :: x(:, :) !! (3, n) particles of the layer [m]
        real(dp), intent(in) :: at(3), reach !! [m]
        integer, intent(in) :: axis
        real(dp), intent(inout) :: value(:) !! (n)
        real(dp) :: beside(size(value))
        integer :: e

        beside = [(norm2(x(:, e) - at)**2 - (x(axis, e) - at(axis))**2, e=1, size(value))]
        e = minloc(beside, dim=1)
        if (beside(e) > (1e-4_dp*reach)**2) return
        value = 0
        value(e) = 1
    end subroutine take_particle

    !> Particles and images of the body in the cells within the reach of a place, in the order of
    !> their numbers.
    pure subroutine collect(solid, at, reach, n, particle, mask, x)
        class(listed_bodies_t), intent(in) :: solid
        real(dp), intent(in) :: at(3), reach !! [m]
        integer, intent(out) :: n, particle(most), mask(most)
        real(dp), intent(out) :: x(3, most) !! [m]
        real(dp) :: y(3), s(3)
        integer :: c, c1, c2, c3, i, k, m, lo(3), hi(3)

        n = 0
        do m = 0, 7
            s = signs(m)
            if (any(s < 0 .and. .not. solid%mirror)) cycle
            call cell_span(solid%search, s*at, reach, lo, hi)
            do c3 = lo(3), hi(3)
                do c2 = lo(2), hi(2)
                    do c1 = lo(1), hi(1)
                        c = number_of_cell(solid%search, c1, c2, c3)
                        do k = solid%search%start(c), solid%search%start(c + 1) - 1
                            i = solid%search%order(k)
                            y = s*solid%x_ref(:, i)
                            if (norm2(y - at) >= (1 - 1e-9_dp)*reach .or. n == most) cycle
                            n = n + 1
                            particle(n) = i
                            mask(n) = m
                            x(:, n) = y
                        end do
                    end do
                end do
            end do
        end do
        call sort_views(n, particle, mask, x)
    end subroutine collect

    !> By the mask and the number of the particle, so that no search decides on the order of sums.
    pure subroutine sort_views(n, particle, mask, x)
        integer, intent(in) :: n
        integer, intent(inout) :: particle(most), mask(most)
        real(dp), intent(inout) :: x(3, most)
        real(dp) :: y(3)
        integer :: i, j, p, m

        do i = 2, n
            p = particle(i)
            m = mask(i)
            y = x(:, i)
            j = i - 1
            do while (j >= 1)
                if (mask(j) < m .or. mask(j) == m .and. particle(j) < p) exit
                particle(j + 1) = particle(j)
                mask(j + 1) = mask(j)
                x(:, j + 1) = x(:, j)
                j = j - 1
            end do
            particle(j + 1) = p
            mask(j + 1) = m
            x(:, j + 1) = y
        end do
    end subroutine sort_views

    !> Room for n entries.
    subroutine grow(view, n)
        type(side_t), intent(inout) :: view
        integer, intent(in) :: n
        integer(int32), allocatable :: node(:)
        integer(int8), allocatable :: mask(:)
        real(dp), allocatable :: weight(:, :)

        if (n <= size(view%node)) return
        allocate (node(2*n), mask(2*n), weight(3, 2*n))
        node(:view%n) = view%node(:view%n)
        mask(:view%n) = view%mask(:view%n)
        weight(:, :view%n) = view%weight(:, :view%n)
        call move_alloc(node, view%node)
        call move_alloc(mask, view%mask)
        call move_alloc(weight, view%weight)
    end subroutine grow

    !> Append the points of an interface; the nodes are numbers of particles for the time being.
    subroutine append(cohesive, k, faces, sides, rest)
        type(cohesive_t), intent(inout) :: cohesive
        integer, intent(in) :: k
        type(faces_t), intent(in) :: faces
        type(side_t), intent(in) :: sides(2)
        real(dp), intent(in) :: rest(3, 2, faces%n) !! tangents of the unloaded faces
        integer(int32) :: first(faces%n)
        integer :: e, f, s, n, last

        n = size(cohesive%node)
        last = n + sides(1)%n + sides(2)%n
        cohesive%of = [cohesive%of, spread(int(k, int32), 1, faces%n)]
        cohesive%area = [cohesive%area, faces%area]
        cohesive%gap = [cohesive%gap, spread(0.0_dp, 1, faces%n)]
        cohesive%beside = reshape([cohesive%beside, transpose(reshape([faces%own, faces%other], &
                                                              [faces%n, 2]))], &
                              [2, cohesive%n + faces%n])
        cohesive%rest = reshape([cohesive%rest, rest], [3, 2, cohesive%n + faces%n])
        cohesive%node = [cohesive%node, spread(0_int32, 1, last - n)]
        cohesive%mask = [cohesive%mask, spread(0_int8, 1, last - n)]
        cohesive%weight = reshape([cohesive%weight, spread(0.0_dp, 1, 3*(last - n))], [3, last])
        do f = 1, faces%n
            do s = 1, 2
                do e = sides(s)%first(f), sides(s)%first(f + 1) - 1
                    n = n + 1
                    cohesive%node(n) = sides(s)%node(e)
                    cohesive%mask(n) = sides(s)%mask(e)
                    cohesive%weight(:, n) = sides(s)%weight(:, e)*[2*s - 3.0_dp, 0.5_dp, 0.5_dp]
                end do
            end do
            first(f) = n + 1
        end do
        cohesive%first = [cohesive%first, first]
        cohesive%n = cohesive%n + faces%n
    end subroutine append

    !> What the last points see as gap in the unloaded bodies, and what of their tangents no
    !> particle shows.
    subroutine settle_gaps(solid, n)
        class(interacting_bodies_t), intent(inout) :: solid
        integer, intent(in) :: n
        real(dp) :: gap(3), seen(3, 2), x(3), normal(3)
        integer :: e, p

        associate (cohesive => solid%cohesive)
            do p = cohesive%n - n + 1, cohesive%n
                gap = 0
                seen = 0
                do e = cohesive%first(p), cohesive%first(p + 1) - 1
                    x = signs(int(cohesive%mask(e)))*solid%x_ref(:, cohesive%node(e))
                    gap = gap + cohesive%weight(1, e)*x
                    seen(:, 1) = seen(:, 1) + cohesive%weight(2, e)*x
                    seen(:, 2) = seen(:, 2) + cohesive%weight(3, e)*x
                end do
                associate (t => cohesive%rest(:, :, p))
                    normal = [t(2, 1)*t(3, 2) - t(3, 1)*t(2, 2), &
                              t(3, 1)*t(1, 2) - t(1, 1)*t(3, 2), &
                              t(1, 1)*t(2, 2) - t(2, 1)*t(1, 2)]
                    t = t - seen
                    where (abs(t) < 1e-9_dp) t = 0
                end associate
                cohesive%gap(p) = dot_product(gap, normal)
                if (abs(cohesive%gap(p)) < 1e-9_dp*sqrt(cohesive%area(p))) cohesive%gap(p) = 0
            end do
        end associate
    end subroutine settle_gaps

    !> Number the particles that points see, and list the entries of each.
    subroutine link_nodes(cohesive, particles)
        type(cohesive_t), intent(inout) :: cohesive
        integer, intent(in) :: particles
        integer :: e, i, p
        integer, allocatable :: last(:)

        allocate (cohesive%row(particles), source=0_int32)
        cohesive%row(cohesive%node) = 1
        cohesive%nodes = 0
        do i = 1, particles
            if (cohesive%row(i) == 0) cycle
            cohesive%nodes = cohesive%nodes + 1
            cohesive%row(i) = cohesive%nodes
        end do
        cohesive%node = cohesive%row(cohesive%node)
        cohesive%entry = cohesive%node + int(cohesive%mask, int32)*mask_unit
        cohesive%beside = reshape(cohesive%row(reshape(cohesive%beside, [2*cohesive%n])), [2, &
            cohesive%n])
        allocate (cohesive%back_first(cohesive%nodes + 1), source=0_int32)
        do e = 1, size(cohesive%node)
            cohesive%back_first(cohesive%node(e) + 1) = cohesive%back_first(cohesive%node(e) + 1) &
                + 1
        end do
        cohesive%back_first(1) = 1
        do i = 1, cohesive%nodes
            cohesive%back_first(i + 1) = cohesive%back_first(i + 1) + cohesive%back_first(i)
        end do
        allocate (cohesive%back(2, size(cohesive%node)))
        last = cohesive%back_first(:cohesive%nodes)
        do p = 1, cohesive%n
            do e = cohesive%first(p), cohesive%first(p + 1) - 1
                cohesive%back(:, last(cohesive%node(e))) = [e, p]
                last(cohesive%node(e)) = last(cohesive%node(e)) + 1
            end do
        end do
        allocate (cohesive%place(cohesive%nodes), cohesive%owner(cohesive%nodes), &
                  cohesive%seen_by(cohesive%n), source=0_int32)
        allocate (cohesive%mine(cohesive%n), source=1_int32)
        allocate (cohesive%damage(cohesive%n), cohesive%spent(cohesive%n), &
                  cohesive%held(cohesive%n), cohesive%pull(3, 3, cohesive%n), &
                  cohesive%push(3, 0:cohesive%nodes), source=0.0_dp)
    end subroutine link_nodes
end module brz_cohesive_points
