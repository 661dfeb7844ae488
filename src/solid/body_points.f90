! SPDX-License-Identifier: MIT
!> Where the particles of each body are, and what volume each one has.
!>
!> A body that cuts another takes the places of that body's particles. The volume of a particle is
!> that of its shape over the number of particles, so that every mass is exact.
module brz_body_points
    use brz_body_shape, only: exact_volume, inside, lay_shape, point_of, shape_t, take_lattice
    use brz_case, only: body_case_t, case_t
    use brz_errors, only: error_t, exit_deck, failed, raise
    use brz_kinds, only: dp
    use brz_text, only: to_text
    implicit none
    private
    public :: points_t, place_points

    real(dp), parameter :: same_spacing = 0.02_dp !! relative difference that lattices may have

    !> The particles of one body.
    type :: points_t
        type(shape_t) :: shape
        real(dp), allocatable :: x(:, :) !! (3, n) [m]
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
        real(dp) :: volume
        integer :: b, c

        do b = 1, size(points)
            call lay_shape(case%bodies(b), case%run%dimension, mirror, depth, middle, &
                           points(b)%shape)
        end do
        do b = 1, size(points)
            c = lender(case%bodies, b)
            if (c > 0) call take_lattice(points(c)%shape, points(b)%shape)
            call fill_lattice(case%bodies(b), points(b))
        end do
        do b = 1, size(points)
            volume = exact_volume(case%bodies(b), points(b)%shape)
            do c = 1, size(points)
                if (cuts(case%bodies(c), case%bodies(b))) &
                    call cut_out(case%bodies, points, b, c, volume)
            end do
            if (size(points(b)%x, 2) == 0) call raise(err, exit_deck, label(case%bodies(b))// &
                'holds no particle: it lies beyond a symmetry plane, or is smaller than its '// &
                'spacing, or another body cuts all of it away')
            points(b)%volume = volume/max(1, size(points(b)%x, 2))
            points(b)%scale = points(b)%volume/cell_volume(points(b)%shape)
        end do
        do b = 1, size(points)
            do c = 1, size(points)
                if (.not. failed(err)) call refuse_overlap(case%bodies, points, b, c, err)
            end do
        end do
    end subroutine place_points

    !> 'line 7: &body id='b': ', as messages begin.
    pure function label(body) result(text)
        type(body_case_t), intent(in) :: body
        character(:), allocatable :: text

        text = "&body id='"//trim(body%id)//"': "
        if (body%line > 0) text = 'line '//to_text(body%line)//': '//text
    end function label

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
            if (bodies(b)%shape == 'box' .and. all(s%lo(:d) >= t%lo(:d) - 1e-6_dp*t%spacing(:d) &
                .and. s%hi(:d) <= t%hi(:d) + 1e-6_dp*t%spacing(:d))) then
                volume = volume - exact_volume(bodies(c), s)
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
            call raise(err, exit_deck, label(bodies(b))//"it overlaps the body '"// &
                       trim(bodies(c)%id)//"'; move one of them, or say with cuts='...' which "// &
                       'one makes room for the other')
            return
        end do
    end subroutine refuse_overlap
end module brz_body_points
