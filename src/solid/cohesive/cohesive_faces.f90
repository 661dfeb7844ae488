! SPDX-License-Identifier: MIT
!> Where two bodies face each other: the faces of lattice cells that have a cell of the other body
!> across.
module brz_cohesive_faces
    use brz_cell_grid, only: cell_span, fill_cells, lay_grid, number_of_cell
    use brz_kinds, only: dp
    use brz_listed_bodies, only: listed_bodies_t
    implicit none
    private
    public :: faces_t, find_faces, drop_faces

    real(dp), parameter :: nearest = 0.5_dp, farthest = 1.5_dp !! distance over that of two cells
    real(dp), parameter :: edge = 1e-6_dp !! by which a neighbour may lie beside its cell

    !> Faces of the particles of one body, one column each.
    type :: faces_t
        integer :: n = 0
        integer, allocatable :: own(:), other(:) !! particles on this side and across
        integer, allocatable :: axis(:) !! normal, outwards: +-1, +-2, +-3
        real(dp), allocatable :: at(:, :) !! (3, n) middle of the gap [m]
        real(dp), allocatable :: area(:) !! [m2]
    end type faces_t

contains

    !> Faces of body a, whose lattice is the finer one, towards body b; particles by number.
    subroutine find_faces(solid, a, b, layers, faces)
        class(listed_bodies_t), intent(inout) :: solid !! its search tables are overwritten
        integer, intent(in) :: a, b
        real(dp), intent(in) :: layers(3, 2) !! distance of the layers of both [m]
        type(faces_t), intent(out) :: faces
        integer :: axis, i, j, n, pass, side
        real(dp) :: far

        call lay_grid(solid%search, solid%x_ref, solid%fixed, solid%bodies(b), &
                      2*maxval(layers(:solid%dimension, :)))
        call fill_cells(solid%search, solid%x_ref, solid%fixed, solid%bodies(b))
        do pass = 1, 2
            n = 0
            do i = solid%bodies(a)%first, solid%bodies(a)%last
                do axis = 1, solid%dimension
                    do side = -1, 1, 2
                        call look_across(solid, i, axis, side, layers, j, far)
                        if (j == 0) cycle
                        n = n + 1
                        if (pass == 1) cycle
                        faces%own(n) = i
                        faces%other(n) = j
                        faces%axis(n) = side*axis
                        faces%at(:, n) = solid%x_ref(:, i)
                        faces%at(axis, n) = faces%at(axis, n) &
                            + side*(layers(axis, 1)/2 + far - layers(axis, 2)/2)/2
                        faces%area(n) = product(layers(:solid%dimension, 1))/layers(axis, 1) &
                                        *solid%depth
                    end do
                end do
            end do
            if (pass == 1) allocate (faces%own(n), faces%other(n), faces%axis(n), &
                                     faces%at(3, n), faces%area(n))
        end do
        faces%n = n
    end subroutine find_faces

    !> Leave out the faces in a box.
    subroutine drop_faces(faces, box, dimension)
        type(faces_t), intent(inout) :: faces
        real(dp), intent(in) :: box(6) !! x0, x1, y0, y1, z0, z1 [m]
        integer, intent(in) :: dimension
        integer, allocatable :: keep(:)
        integer :: f

        keep = pack([(f, f=1, faces%n)], &
                    [(.not. (all(faces%at(:dimension, f) >= box(1:2*dimension:2)) .and. &
                             all(faces%at(:dimension, f) <= box(2:2*dimension:2))), &
                      f=1, faces%n)])
        faces%own = faces%own(keep)
        faces%other = faces%other(keep)
        faces%axis = faces%axis(keep)
        faces%at = faces%at(:, keep)
        faces%area = faces%area(keep)
        faces%n = size(keep)
    end subroutine drop_faces

    !> Particle of the body in the cells that lies across a face of particle i, and how far; or 0.
    subroutine look_across(solid, i, axis, side, layers, j, far)
        class(listed_bodies_t), intent(in) :: solid
        integer, intent(in) :: i, axis, side
        real(dp), intent(in) :: layers(3, 2)
        integer, intent(out) :: j
        real(dp), intent(out) :: far !! [m]
        real(dp) :: at(3), d(3), gap, beside, least
        integer :: c, c1, c2, c3, k, lo(3), hi(3)

        j = 0
        far = 0
        gap = sum(layers(axis, :))/2
        at = solid%x_ref(:, i)
        at(axis) = at(axis) + side*gap
        least = huge(least)
        call cell_span(solid%search, at, maxval(layers(:solid%dimension, 2)), lo, hi)
        do c3 = lo(3), hi(3)
            do c2 = lo(2), hi(2)
                do c1 = lo(1), hi(1)
                    c = number_of_cell(solid%search, c1, c2, c3)
                    do k = solid%search%start(c), solid%search%start(c + 1) - 1
                        d = solid%x_ref(:, solid%search%order(k)) - solid%x_ref(:, i)
                        if (side*d(axis) < nearest*gap .or. side*d(axis) > farthest*gap) cycle
                        d(axis) = 0
                        if (any(abs(d) > (0.5_dp + edge)*layers(:, 2))) cycle
                        beside = norm2(d)
                        if (beside >= least) cycle
                        least = beside
                        j = solid%search%order(k)
                    end do
                end do
            end do
        end do
        if (j > 0) far = abs(solid%x_ref(axis, j) - solid%x_ref(axis, i))
    end subroutine look_across
end module brz_cohesive_faces
