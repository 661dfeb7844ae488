! SPDX-License-Identifier: MIT
!> Columns of solid cells behind wall faces, what the gas pushes there, and the loads of particles.
!>
!> A face loads the particles of its column from the outermost one inwards, and no farther than the
!> next gas cell, in proportion to mass and load_weight of their depth. All of this follows from
!> positions, which do not change while the air takes its step.
!>
!> Behind a plane of symmetry a column goes on in the image of the body. So a face may load a
!> particle of its own column twice, the second time as the image of the face: from the other side,
!> with the opposite sign.
module brz_column_loop_bodies
    use brz_cell_shells, only: index_along
    use brz_column_rules, only: direction_of, height_of, side_of, sign_of
    use brz_coupling_box, only: box_t, go_on, place_at
    use brz_face_layers, only: layers_t
    use brz_face_stress, only: load_below
    use brz_kinds, only: dp, int32, int64, int8, rk
    use brz_load_rules, only: wall_traction, gauge_force, load_weight
    use brz_scheme, only: mixture_gamma, scheme_t
    implicit none
    private
    public :: find_above, weigh_column, find_wall_pressure, add_wall_impulse, &
        load_particle
    public :: bear_load, depth_weight, force_from, look_ahead

    integer, parameter :: at_once = 8 !! particles of a bin

contains

    !> Face that begins the column of a cell on each side and is near enough to load it, or 0; one
    !> of the other side where it is an image that does.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine find_above(c, box, cell, solid, cell_of, face_of, above)
        integer, intent(in) :: c !! solid cells
        type(box_t), intent(in) :: box
        integer(int32), intent(in) :: cell(*)
        integer(int8), intent(in) :: solid(*)
        integer, intent(in) :: cell_of(*), face_of(6, *)
        integer, intent(inout) :: above(6, *)
        integer(int64) :: place
        integer :: at, d, m, number, row, s

        do row = 1, 6
            above(row, c) = 0
            d = direction_of(row)
            if (box%n(d) == 1) cycle
            s = -sign_of(row)
            number = cell(c)
            at = c
            do m = 0, box%layers
                above(row, c) = face_of(side_of(d, -s), at)
                if (above(row, c) > 0) exit
                call go_on(box, d, s, number)
                if (number == 0) exit
                place = place_at(box, number)
                if (solid(place) == 0) exit
                at = cell_of(place)
            end do
        end do
    end subroutine find_above

    !> Weight of a particle in the load of a face whose column it belongs to [kg].
    !@cuf attributes(host,device) &
    pure function depth_weight(box, row, seen, gas, surface, x, mass) result(w)
        type(box_t), intent(in) :: box
        integer, intent(in) :: row !! side of the face
        integer, intent(in) :: seen !! side of what loads the particle: the other one of an image
        integer(int32), intent(in) :: gas !! its gas cell
        real(dp), intent(in) :: surface !! of its column [m]
        real(dp), intent(in) :: x !! of the particle, along the direction [m]
        real(rk), intent(in) :: mass !! [kg]
        real(rk) :: w

        w = mass*load_weight(depth_below(box, row, seen, gas, surface, x), &
                             real(box%spread*box%dx(direction_of(row)), rk))
    end function depth_weight

    !> Depth of a particle below the outermost one of its column [m].
    !@cuf attributes(host,device) &
    pure function depth_below(box, row, seen, gas, surface, x) result(depth)
        type(box_t), intent(in) :: box
        integer, intent(in) :: row, seen !! see depth_weight
        integer(int32), intent(in) :: gas
        real(dp), intent(in) :: surface, x !! [m]
        real(rk) :: depth
        integer :: d, g

        d = direction_of(row)
        g = box%before(d) + index_along(box%n, gas, d)
        if (seen /= row) g = merge(1, 2*box%whole(d) + 1, sign_of(seen) > 0) - g
        depth = real(height_of(x, box%lo(d), box%dx(d), box%n(d), box%wraps(d), g, &
                               sign_of(seen)) - surface, rk)
    end function depth_below

    !> Force of a face, or of its image, on what it loads from a side [N].
    !@cuf attributes(host,device) &
    pure function force_from(row, seen, force) result(f)
        integer, intent(in) :: row, seen !! side of the face, and where it is seen
        real(rk), intent(in) :: force !! of the face [N]
        real(rk) :: f

        f = merge(force, -force, seen == row)
    end function force_from

    !> The next n particles of a bin, the last one again where it ends before. A thread of a GPU
    !> that looks at several, and finds the next ones meanwhile, waits for memory once for all.
    !@cuf attributes(host,device) &
    pure subroutine look_ahead(n, first, last, binned, next)
        integer, intent(in) :: n, first, last !! of the bin
        integer(int32), intent(in) :: binned(*)
        integer, intent(out) :: next(n)
        integer :: q

        do q = 1, n
            next(q) = binned(min(first + q - 1, last))
        end do
    end subroutine look_ahead

    !> Places along d and masses of the particles of a bin from one on, and those behind these.
    !@cuf attributes(host,device) &
    pure subroutine look_at_some(first, last, wide, d, binned, x, mass, next, y, m)
        integer, intent(in) :: first, last !! of the bin
        integer, intent(in) :: wide, d !! rows of x; direction
        integer(int32), intent(in) :: binned(*)
        real(dp), intent(in) :: x(wide, *)
        real(rk), intent(in) :: mass(*)
        integer, intent(inout) :: next(at_once) !! from the first on, then those behind
        real(dp), intent(out) :: y(at_once) !! [m]
        real(rk), intent(out) :: m(at_once) !! [kg]
        integer :: q

        do q = 1, at_once
            y(q) = x(d, next(q))
            m(q) = mass(next(q))
        end do
        call look_ahead(at_once, first + at_once, last, binned, next)
    end subroutine look_at_some

    !> Surface of the column behind each face, and the sum of the weights in it.
    !@loop_body if(n >= worth_threads) schedule(dynamic, 64)
    !@cuf attributes(host,device) &
    pure subroutine weigh_column(f, box, wide, gas, rows, owner, cell, solid, cell_of, ends, &
                                 binned, x, mass, surface, weight)
        integer, intent(in) :: f !! wall faces
        type(box_t), intent(in) :: box
        integer, intent(in) :: wide !! rows of x
        integer(int32), intent(in) :: gas(*), rows(*), owner(*), cell(*)
        integer(int8), intent(in) :: solid(*)
        integer, intent(in) :: cell_of(*)
        integer(int32), intent(in) :: ends(*), binned(*)
        real(dp), intent(in) :: x(wide, *)
        real(rk), intent(in) :: mass(*)
        real(dp), intent(inout) :: surface(*)
        real(rk), intent(inout) :: weight(*)
        real(dp) :: top, y(at_once)
        real(rk) :: m(at_once), total
        integer(int64) :: at
        integer :: c, d, g, i, k, next(at_once), number, q, s

        d = direction_of(rows(f))
        s = sign_of(rows(f))
        c = owner(f)
        g = box%before(d) + index_along(box%n, gas(f), d)
        top = huge(1.0_dp)
        call look_ahead(at_once, ends(c) + 1, ends(c + 1), binned, next)
        do i = ends(c) + 1, ends(c + 1), at_once
            call look_at_some(i, ends(c + 1), wide, d, binned, x, mass, next, y, m)
            do q = 1, at_once
                top = min(top, height_of(y(q), box%lo(d), box%dx(d), box%n(d), box%wraps(d), g, s))
            end do
        end do
        surface(f) = top
        number = cell(c)
        total = 0
        do k = 0, box%layers
            call look_ahead(at_once, ends(c) + 1, ends(c + 1), binned, next)
            do i = ends(c) + 1, ends(c + 1), at_once
                call look_at_some(i, ends(c + 1), wide, d, binned, x, mass, next, y, m)
                do q = 1, at_once
                    if (i + q - 1 > ends(c + 1)) exit
                    total = total + depth_weight(box, rows(f), side_of(d, s), gas(f), top, y(q), &
                                                 m(q))
                end do
            end do
            call go_on(box, d, s, number)
            if (number == 0) exit
            at = place_at(box, number)
            if (solid(at) == 0) exit
            c = cell_of(at)
        end do
        weight(f) = total
    end subroutine weigh_column

    !> Force of the gas on each face if the wall keeps its velocity, and its fall if it yields.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine find_wall_pressure(f, box, scheme, gas, rows, owner, u, v, force, impedance)
        integer, intent(in) :: f !! wall faces
        type(box_t), intent(in) :: box
        type(scheme_t), intent(in) :: scheme
        integer(int32), intent(in) :: gas(*), rows(*), owner(*)
        real(rk), intent(in) :: u(*), v(3, *)
        real(rk), intent(inout) :: force(*), impedance(*)
        real(rk) :: f_now, gamma, q(5), z
        integer(int64) :: at
        integer :: d, k

        at = place_at(box, gas(f))
        do k = 1, 5
            q(k) = u(at + (k - 1)*box%grid%apart)
        end do
        gamma = scheme%gamma
        if (scheme%mixture) gamma = mixture_gamma(scheme, u(at + 5*box%grid%apart)/q(1))
        d = direction_of(rows(f))
        call wall_traction(rows(f), gamma, q, v(d, owner(f)), box%area(d), box%reference, f_now, z)
        force(f) = f_now
        impedance(f) = z
    end subroutine find_wall_pressure

    !> Force of each face over the step, the reference pressure taken off.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine add_wall_impulse(f, box, dt, rows, impulse, force)
        integer, intent(in) :: f !! wall faces
        type(box_t), intent(in) :: box
        real(dp), intent(in) :: dt !! step of the air, over which the impulses were added up [s]
        integer(int32), intent(in) :: rows(*)
        real(rk), intent(in) :: impulse(*)
        real(rk), intent(inout) :: force(*)

        force(f) = gauge_force(sign_of(rows(f)), impulse(f), box%reference, &
                               box%area(direction_of(rows(f))), dt)
    end subroutine add_wall_impulse

    !> Load of each particle, from all faces whose columns reach its cell.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine load_particle(p, box, wide, stride_d, stride_p, home, above, gas, rows, &
                                  surface, weight, force, x, mass, load)
        integer, intent(in) :: p !! particles
        type(box_t), intent(in) :: box
        integer, intent(in) :: wide !! rows of x
        integer, intent(in) :: stride_d, stride_p !! distances in `load` of directions, of particles
        integer(int32), intent(in) :: home(*), gas(*), rows(*)
        integer, intent(in) :: above(6, *)
        real(dp), intent(in) :: surface(*)
        real(rk), intent(in) :: weight(*), force(*)
        real(dp), intent(in) :: x(wide, *)
        real(rk), intent(in) :: mass(*)
        real(rk), intent(inout) :: load(*)
        real(rk) :: share, total
        integer :: d, f, row, side

        do d = 1, 3
            total = 0
            if (home(p) > 0 .and. box%n(d) > 1) then
                do side = 0, 1
                    row = 2*d - side
                    f = above(row, home(p))
                    if (f == 0) cycle
                    share = depth_weight(box, rows(f), row, gas(f), surface(f), x(d, p), mass(p)) &
                            /weight(f)
                    total = total + force_from(rows(f), row, force(f))*share
                end do
            end if
            load(1 + (d - 1)*stride_d + (p - 1)*stride_p) = total
        end do
    end subroutine load_particle

    !> Stress that a particle of a body lacks because the load of its columns is spread over depth:
    !> the part of each pressure that acts below it. See brz_face_stress.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine bear_load(t, first, box, layers, wide, stride_d, stride_t, home, above, gas, &
                              rows, surface, weight, force, x, mass, face_stress)
        integer, intent(in) :: t !! particles of the body
        integer, intent(in) :: first !! the first of them
        type(box_t), intent(in) :: box
        type(layers_t), intent(in) :: layers !! of the body
        integer, intent(in) :: wide !! rows of x
        integer, intent(in) :: stride_d, stride_t
        !! distances in `face_stress` of components, of particles
        integer(int32), intent(in) :: home(*), gas(*), rows(*)
        integer, intent(in) :: above(6, *)
        real(dp), intent(in) :: surface(*)
        real(rk), intent(in) :: weight(*), force(*)
        real(dp), intent(in) :: x(wide, *)
        real(rk), intent(in) :: mass(*)
        real(rk), intent(inout) :: face_stress(*) !! [Pa]
        real(rk) :: depth, total
        integer :: d, f, p, row, side

        p = first - 1 + t
        do d = 1, 3
            total = 0
            if (home(p) > 0 .and. box%n(d) > 1) then
                do side = 0, 1
                    row = 2*d - side
                    f = above(row, home(p))
                    if (f == 0) cycle
                    depth = depth_below(box, rows(f), row, gas(f), surface(f), x(d, p))/ &
                            layers%apart(d)
                    total = total - sign_of(rows(f))*force(f)* &
                            load_below(layers, d, depth, weight(f)/(mass(p)*layers%across(d)))
                end do
                total = total/(real(box%area(d), rk)*layers%share)
            end if
            face_stress(1 + (d - 1)*stride_d + (p - 1)*stride_t) = total
        end do
    end subroutine bear_load
end module brz_column_loop_bodies
