! SPDX-License-Identifier: MIT
!> How many intact neighbours particles have left, on the CPU.
module brz_solid_motion
    use brz_cell_grid, only: reach_of_lists
    use brz_formulation_names, only: form_bending
    use brz_intact_share, only: intact_share
    use brz_kinds, only: dp, int16, int64, int8
    use brz_material, only: strength_left
    use brz_solid_arrays, only: group_of
    use brz_solid_mirror, only: signs
    use brz_listed_bodies, only: listed_bodies_t
    use brz_tensile_control, only: may_be_in_tension
    use brz_threads, only: worth_threads
    implicit none
    private
    public :: count_support, end_support

    integer, parameter :: most_support = huge(1_int16)

contains

    !> Neighbours that particles have at the start.
    subroutine count_support(solid)
        class(listed_bodies_t), intent(inout) :: solid
        integer :: i, k

        !$omp parallel do if(solid%n >= worth_threads) schedule(static) private(i)
        do k = 1, size(solid%block, 2)
            do i = solid%block(2, k), solid%block(3, k)
                solid%support(i) = int(min(count_intact(solid, solid%block(1, k), i, 0), &
                                           most_support), int16)
            end do
        end do
    end subroutine count_support

    !> Neighbours of a particle within the reach of its list, when that was built, that still carry
    !> load.
    pure integer function count_intact(solid, b, i, fails) result(n)
        type(listed_bodies_t), intent(in) :: solid
        integer, intent(in) :: b, i !! body, particle
        integer, intent(in) :: fails !! how the material of the body fails
        integer(int64) :: k
        integer :: g, j
        real(dp) :: d(3), reach2

        n = 0
        reach2 = reach_of_lists(solid, b)**2
        g = group_of(solid%bodies(b), i)
        do k = solid%first(g), solid%first(g + 1) - 1
            j = solid%list(k)
            d = solid%x_built(:, j) - solid%x_built(:, i)
            if (j == i .or. dot_product(d, d) >= reach2) cycle
            if (strength_left(fails, solid%damage(j)) > intact_share) n = n + 1
        end do
        if (.not. any(solid%mirror)) return
        do k = solid%image_first(g), solid%image_first(g + 1) - 1
            j = solid%image(k)
            d = signs(int(solid%mask(k)))*solid%x_built(:, j) - solid%x_built(:, i)
            if (dot_product(d, d) >= reach2) cycle
            if (strength_left(fails, solid%damage(j)) > intact_share) n = n + 1
        end do
    end function count_intact

    !> True where a particle has a tilted gradient while it has its support.
    pure logical function is_tilted(solid, i) result(yes)
        type(listed_bodies_t), intent(in) :: solid
        integer, intent(in) :: i

        yes = allocated(solid%tilt)
        if (yes) yes = abs(solid%tilt(i)) > 0
    end function is_tilted

    !> End the stiff hourglass force, and the tilt, for good where half of the intact neighbours are
    !> gone.
    subroutine end_support(solid, anew)
        class(listed_bodies_t), intent(inout) :: solid
        logical, intent(in) :: anew(:) !! (bodies) whose lists were built anew
        integer :: fails, i, k

        !$omp parallel do if(solid%n >= worth_threads) schedule(static) private(fails, i)
        do k = 1, size(solid%block, 2)
            associate (body => solid%bodies(solid%block(1, k)))
                if (.not. anew(solid%block(1, k))) cycle
                if (body%formulation /= form_bending .and. .not. body%tensile_control > 0) cycle
                fails = solid%materials(body%material)%fails
                do i = solid%block(2, k), solid%block(3, k)
                    if (solid%unsupported(i) == 1) cycle
                    ! no tensile control that could end, and no tilt
                    if (body%tensile_control > 0) then
                        if (.not. (may_be_in_tension(solid%stress(:, i)) .or. &
                            is_tilted(solid, i))) cycle
                    end if
                    if (count_intact(solid, solid%block(1, k), i, fails) &
                        < intact_share*solid%support(i)) solid%unsupported(i) = 1_int8
                end do
            end associate
        end do
    end subroutine end_support
end module brz_solid_motion
