! SPDX-License-Identifier: MIT
!> Warnings of the set-up about bodies and what lies in them.
module brz_body_warnings
    use brz_body_points, only: points_t
    use brz_body_shape, only: inside, shape_t
    use brz_case, only: body_case_t, case_t, label
    use brz_kinds, only: dp, int64, real32, rk
    use brz_material, only: material_t
    use brz_stl, only: is_inside
    use brz_text, only: to_text
    implicit none
    private
    public :: judge_gauges, judge_planes, judge_plies, judge_scatter, judge_spacing
    public :: judge_distance

    real(dp), parameter :: anisotropy = 0.02_dp !! larger differences of the spacings are reported
    real(dp), parameter :: scattered = 0.02_dp !! scatter of distances that is reported
    integer, parameter :: sample = 200 !! particles whose distances are measured
    ! In mixed precision a GPU reads places to 2.4e-10 of themselves: 5e-6 of this many spacings.
    real(dp), parameter :: far = 2e4_dp
    real(dp), parameter :: off_plane = 10 !! widths of the largest body

contains

    !> A gauge of the air within a body measures nothing of its own.
    subroutine judge_gauges(case, points, notes)
        type(case_t), intent(in) :: case
        type(points_t), intent(in) :: points(:)
        character(:), allocatable, intent(inout) :: notes
        integer :: b, g

        do g = 1, size(case%gauges)
            if (case%gauges(g)%body_index > 0) cycle
            do b = 1, size(points)
                associate (body => case%bodies(b), gauge => case%gauges(g))
                    if (.not. holds(body, points(b), gauge%at)) cycle
                    notes = notes//label('gauge', gauge%id, gauge%place)//"warning: it lies "// &
                        "in the body '"//trim(body%id)//"' and shows the nearest gas, if there "// &
                        'is any; move it out of the body, by half a cell of the air or more'// &
                        new_line('a')
                    exit
                end associate
            end do
        end do
    end subroutine judge_gauges

    !> Planes of symmetry lie at 0: bodies far off one are in other coordinates.
    subroutine judge_planes(case, points, notes)
        type(case_t), intent(in) :: case
        type(points_t), intent(in) :: points(:)
        character(:), allocatable, intent(inout) :: notes
        character, parameter :: axes(3) = ['x', 'y', 'z']
        real(dp) :: away, width
        integer :: b, d

        if (case%air%present .or. size(points) == 0) return ! the box of air begins at the plane
        do d = 1, 3
            if (.not. case%run%symmetry(d)) cycle
            away = minval([(points(b)%shape%lo(d), b=1, size(points))])
            width = maxval([(points(b)%shape%hi - points(b)%shape%lo, b=1, size(points))])
            if (away <= off_plane*width) cycle
            notes = notes//'&run: warning: the plane of symmetry normal to '//axes(d)// &
                ' lies at '//axes(d)//' = 0, and all bodies are '//to_text(real(away, real32))// &
                ' m or more away from it; move the scene to the plane, or leave symmetry out'// &
                new_line('a')
        end do
    end subroutine judge_planes

    !> True for a point within a body; a body from a file of particles has no inside.
    logical function holds(body, points, x)
        type(body_case_t), intent(in) :: body
        type(points_t), intent(in) :: points
        real(dp), intent(in) :: x(3) !! [m]
        logical :: within(1, 1, 1)

        if (body%shape == 'stl') then
            call is_inside(points%mesh, x - body%spacing/2, spread(body%spacing, 1, 3), within)
            holds = within(1, 1, 1)
        else
            holds = inside(body, points%shape, x, 1e-6_dp*body%spacing)
        end if
    end function holds

    !> Report a box whose sides are no whole number of spacings.
    subroutine judge_spacing(input, shape, notes)
        type(body_case_t), intent(in) :: input
        type(shape_t), intent(in) :: shape
        character(:), allocatable, intent(inout) :: notes
        character(12) :: d(3)
        real(dp) :: s(shape%dimension)

        s = shape%spacing(:shape%dimension)
        if (maxval(s) <= (1 + anisotropy)*minval(s)) return
        write (d, '(es12.5)') shape%spacing
        notes = notes//label('body', input%id, input%place)//'warning: sides are no whole '// &
            'number of spacings; layers are '//d(1)//', '//d(2)//', '//d(3)//' m apart'// &
            new_line('a')
    end subroutine judge_spacing

    !> Report angles of plies that the material does not know.
    subroutine judge_plies(input, material, notes)
        type(body_case_t), intent(in) :: input
        type(material_t), intent(in) :: material
        character(:), allocatable, intent(inout) :: notes

        if (input%n_plies == 0 .or. all(material%axial > 0)) return
        notes = notes//label('body', input%id, input%place)//"warning: plies change nothing: "// &
            "its material '"//trim(input%material)//"' is the same in all directions"//new_line('a')
    end subroutine judge_plies

    !> Report particles of a file that lie on no lattice: their sums see a softer body.
    subroutine judge_scatter(input, x, dimension, notes)
        type(body_case_t), intent(in) :: input
        real(dp), intent(in) :: x(:, :) !! (3, n) [m]
        integer, intent(in) :: dimension
        character(:), allocatable, intent(inout) :: notes
        real(dp) :: scatter

        if (input%shape /= 'particles' .or. size(x, 2) < 3) return
        scatter = scatter_of(x(:dimension, :))
        if (scatter <= scattered) return
        notes = notes//label('body', input%id, input%place)//'warning: its particles lie on no '// &
            'lattice: distances to the nearest one vary by '//to_text(nint(100*scatter))// &
            ' %, and it is too soft (E 0.94 with 5 %, 0.82 with 14 % in corrected_hourglass); '// &
            'lay them on a lattice, of any direction'//new_line('a')
    end subroutine judge_scatter

    !> Standard deviation of the distances to the nearest particle over their mean, of a sample.
    pure real(dp) function scatter_of(x) result(scatter)
        real(dp), intent(in) :: x(:, :) !! (dimension, n) [m]
        real(dp) :: nearest(min(sample, size(x, 2))), square
        integer :: i, j, k, n

        n = size(nearest)
        nearest = huge(scatter)
        do k = 1, n
            i = 1 + int((k - 1)*int(size(x, 2), int64)/n)
            do j = 1, size(x, 2)
                square = sum((x(:, j) - x(:, i))**2)
                if (square < nearest(k) .and. square > 0) nearest(k) = square
            end do
        end do
        nearest = sqrt(nearest)
        scatter = sum(nearest)/n
        scatter = sqrt(sum((nearest - scatter)**2)/n)/scatter
    end function scatter_of

    !> Report a body that lies too far from the origin for the places of mixed precision.
    subroutine judge_distance(input, shape, notes)
        type(body_case_t), intent(in) :: input
        type(shape_t), intent(in) :: shape
        character(:), allocatable, intent(inout) :: notes
        real(dp) :: away

        if (rk == dp) return
        away = max(maxval(abs(shape%lo)), maxval(abs(shape%hi)))
        if (away <= far*input%spacing) return
        notes = notes//label('body', input%id, input%place)//'warning: it reaches '// &
            to_text(real(away/input%spacing, real32))//' spacings from the origin, where mixed '// &
            'precision blurs distances on a GPU; lay the origin near it, or use real64'// &
            new_line('a')
    end subroutine judge_distance
end module brz_body_warnings
