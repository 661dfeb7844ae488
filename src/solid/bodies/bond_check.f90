! SPDX-License-Identifier: MIT
!> A rule of the deck that bonds nothing: its bodies are out of reach of each other at the start.
module brz_bond_check
    use brz_case, only: case_t, label
    use brz_cell_grid, only: cell_span, extent, fill_cells, lay_grid, number_of_cell
    use brz_interaction_setup, only: rule_of
    use brz_kinds, only: dp, real32
    use brz_listed_bodies, only: listed_bodies_t
    use brz_text, only: to_text
    implicit none
    private
    public :: judge_bonds

contains

    !> A warning for each &interaction with law = 'bonded' none of whose pairs is within reach. The
    !> particles are placed. Beyond the support of the kernel a bond would hold nothing.
    subroutine judge_bonds(case, solid)
        type(case_t), intent(in) :: case
        class(listed_bodies_t), intent(inout) :: solid !! its search tables are overwritten
        real(dp) :: apart, box(3, 2, size(solid%bodies)), gap, reach
        integer :: a, b, k, nearest(2)

        if (.not. (solid%links%present .and. allocated(case%interactions))) return
        if (.not. (any(case%interactions%law == 'bonded') .or. any([(case%bodies(b)%cuts /= '', &
                                                            b=1, size(case%bodies))]))) return
        do b = 1, size(solid%bodies)
            call extent(solid%x_ref, solid%fixed, solid%bodies(b), box(:, 1, b), box(:, 2, b))
        end do
        do b = 1, size(case%bodies)
            do k = 1, size(case%bodies(b)%cuts)
                a = findloc(case%bodies%id, case%bodies(b)%cuts(k), 1)
                if (case%bodies(b)%cuts(k) == '' .or. a == 0) cycle
                reach = 2*real(solid%links%table(a, b)%h, dp)
                if (distance(box(:, :, a), box(:, :, b)) < reach) cycle
                solid%notes = solid%notes//label('body', case%bodies(b)%id, &
                    case%bodies(b)%place)//"warning: it cuts nothing: it is "// &
                    to_text(real(distance(box(:, :, a), box(:, :, b)), real32))// &
                    " m from '"//trim(case%bodies(a)%id)//"', out of reach of a bond; look at "// &
                    'its place'//new_line('a')
            end do
        end do
        rules: do k = 1, size(case%interactions)
            if (case%interactions(k)%law /= 'bonded') cycle rules
            apart = huge(apart)
            do b = 2, size(solid%bodies)
                do a = 1, b - 1
                    if (rule_of(case, a, b) /= k) cycle
                    reach = 2*real(solid%links%table(a, b)%h, dp)
                    gap = distance(box(:, :, a), box(:, :, b))
                    if (gap < reach) then
                        if (any_within(solid, a, b, reach)) cycle rules
                        gap = reach
                    end if
                    if (gap >= apart) cycle
                    apart = gap
                    nearest = [a, b]
                end do
            end do
            if (apart < huge(apart)) call warn(case, k, nearest, apart, solid)
        end do rules
    end subroutine judge_bonds

    subroutine warn(case, k, pair, apart, solid)
        type(case_t), intent(in) :: case
        integer, intent(in) :: k !! rule
        integer, intent(in) :: pair(2) !! the bodies that are nearest to each other
        real(dp), intent(in) :: apart !! [m]
        class(listed_bodies_t), intent(inout) :: solid

        associate (reach => 2*solid%links%table(pair(1), pair(2))%h)
            solid%notes = solid%notes//label('interaction', '', case%interactions(k)%place)// &
                "warning: it bonds nothing: the particles of '"// &
                trim(solid%bodies(pair(1))%id)//"' and '"//trim(solid%bodies(pair(2))%id)// &
                "' are "//to_text(real(apart, real32))//' m or more apart, and a bond reaches '// &
                to_text(real(reach, real32))//' m; they meet by contact; move them together '// &
                'or take another law'//new_line('a')
        end associate
    end subroutine warn

    !> Distance of the boxes around the particles of two bodies: they are at least so far apart (and
    !> images in a plane are farther) [m].
    pure real(dp) function distance(p, q)
        real(dp), intent(in) :: p(3, 2), q(3, 2) !! corners [m]

        distance = norm2(max(p(:, 1) - q(:, 2), q(:, 1) - p(:, 2), 0.0_dp))
    end function distance

    !> True where a particle of body a and one of body b are nearer than `reach`. Cells are laid
    !> over the smaller one.
    logical function any_within(solid, a, b, reach)
        class(listed_bodies_t), intent(inout) :: solid
        integer, intent(in) :: a, b
        real(dp), intent(in) :: reach !! [m]
        integer :: i, large, small

        large = a
        small = b
        if (solid%bodies(a)%last - solid%bodies(a)%first < &
            solid%bodies(b)%last - solid%bodies(b)%first) then
            large = b
            small = a
        end if
        any_within = .true.
        call lay_grid(solid%search, solid%x_ref, solid%fixed, solid%bodies(small), reach)
        call fill_cells(solid%search, solid%x_ref, solid%fixed, solid%bodies(small))
        do i = solid%bodies(large)%first, solid%bodies(large)%last
            if (has_near(solid, solid%x_ref(:, i), reach)) return
        end do
        any_within = .false.
    end function any_within

    !> True where a particle in the cells is nearer than `reach`.
    pure logical function has_near(solid, x, reach)
        class(listed_bodies_t), intent(in) :: solid
        real(dp), intent(in) :: x(3), reach !! [m]
        integer :: c, c1, c2, c3, k, lo(3), hi(3)

        has_near = .true.
        call cell_span(solid%search, x, reach, lo, hi)
        do c3 = lo(3), hi(3)
            do c2 = lo(2), hi(2)
                do c1 = lo(1), hi(1)
                    c = number_of_cell(solid%search, c1, c2, c3)
                    do k = solid%search%start(c), solid%search%start(c + 1) - 1
                        if (norm2(solid%x_ref(:, solid%search%order(k)) - x) < reach) return
                    end do
                end do
            end do
        end do
        has_near = .false.
    end function has_near
end module brz_bond_check
