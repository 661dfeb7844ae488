! SPDX-License-Identifier: MIT
!> How the particles move on the CPU: kick and drift, how far they have gone since their lists were
!> built, and how many intact neighbours they have left.
module brz_solid_motion
    use brz_cell_grid, only: reach_of_lists
    use brz_kinds, only: dp, int16, int64, int8, rk
    use brz_list_drift, only: level_unit
    use brz_material, only: strength_left
    use brz_motion_items, only: kick_and_drift
    use brz_move_level, only: level_of
    use brz_solid_arrays, only: group_of
    use brz_solid_mirror, only: signs
    use brz_solid_state, only: form_bending, form_rigid, form_total, intact_share, is_gone, &
        solid_t, worth_threads
    use brz_tension_hold, only: may_be_drawn
    implicit none
    private
    public :: kick_bodies, find_levels, count_support, end_support

    integer, parameter :: most_support = huge(1_int16)

contains

    !> Velocity by the mean of the last and this time step, then position.
    subroutine kick_bodies(solid, dt)
        type(solid_t), intent(inout), target :: solid
        real(dp), intent(in) :: dt
        real(rk), pointer, contiguous :: load(:, :)
        real(dp) :: work
        integer :: i, k, loaded

        loaded = merge(1, 0, allocated(solid%load))
        load => solid%a ! not read where there is no load
        if (loaded == 1) load => solid%load
        !$omp parallel do if(solid%n >= worth_threads) schedule(static) private(i, work)
        do k = 1, size(solid%block, 2)
            solid%search%sums(1, k) = 0
            associate (body => solid%bodies(solid%block(1, k)))
                if (body%formulation == form_rigid .or. body%asleep) cycle
            end associate
            do i = solid%block(2, k), solid%block(3, k)
                call kick_and_drift(i, 3, 1, 3, real((solid%dt_last + dt)/2, rk), dt, loaded, &
                                    solid%a, load, solid%mass, solid%fixed, solid%x, solid%v, work)
                solid%search%sums(1, k) = solid%search%sums(1, k) + work
            end do
        end do
        do k = 1, size(solid%block, 2)
            associate (ledger => solid%bodies(solid%block(1, k))%ledger)
                ledger%load = ledger%load + solid%search%sums(1, k)
            end associate
        end do
    end subroutine kick_bodies

    !> How far the particles of each body have moved relative to it since its list was built: the
    !> highest level of brz_list_drift, of this process.
    subroutine find_levels(solid, level)
        type(solid_t), intent(inout) :: solid !! its block sums are overwritten
        integer(int64), intent(out) :: level(:) !! (bodies)
        real(dp) :: far, d(3)
        integer :: i, k

        !$omp parallel do if(solid%n >= worth_threads) schedule(static) private(i, d, far)
        do k = 1, size(solid%block, 2)
            solid%search%limit(k) = 0
            associate (body => solid%bodies(solid%block(1, k)))
                if (body%asleep) cycle
                if (body%formulation == form_total .and. .not. solid%links%present) cycle
                far = 0
                do i = solid%block(2, k), solid%block(3, k)
                    if (solid%fixed(i) == is_gone) cycle
                    d = solid%x(:, i) - solid%x_built(:, i) - body%drift
                    far = max(far, d(1)*d(1) + d(2)*d(2) + d(3)*d(3))
                end do
                solid%search%limit(k) = far
            end associate
        end do
        level = 0
        do k = 1, size(solid%block, 2)
            associate (b => solid%block(1, k))
                level(b) = max(level(b), int(level_of(solid%search%limit(k), level_unit(solid)), &
                                             int64))
            end associate
        end do
    end subroutine find_levels

    !> Neighbours that particles have at the start.
    subroutine count_support(solid)
        type(solid_t), intent(inout) :: solid
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
        type(solid_t), intent(in) :: solid
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
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: i

        yes = allocated(solid%tilt)
        if (yes) yes = abs(solid%tilt(i)) > 0
    end function is_tilted

    !> End the stiff hourglass force, and the tilt, for good where half of the intact neighbours are
    !> gone.
    subroutine end_support(solid, anew)
        type(solid_t), intent(inout) :: solid
        logical, intent(in) :: anew(:) !! (bodies) whose lists were built anew
        integer :: fails, i, k

        !$omp parallel do if(solid%n >= worth_threads) schedule(static) private(fails, i)
        do k = 1, size(solid%block, 2)
            associate (body => solid%bodies(solid%block(1, k)))
                if (.not. anew(solid%block(1, k))) cycle
                if (body%formulation /= form_bending .and. .not. body%tension_hold > 0) cycle
                fails = solid%materials(body%material)%fails
                do i = solid%block(2, k), solid%block(3, k)
                    if (solid%cut(i) == 1) cycle
                    if (body%tension_hold > 0) then ! no hold that could end, and no tilt
                        if (.not. (may_be_drawn(solid%stress(:, i)) .or. is_tilted(solid, i))) &
                            cycle
                    end if
                    if (count_intact(solid, solid%block(1, k), i, fails) &
                        < intact_share*solid%support(i)) solid%cut(i) = 1_int8
                end do
            end associate
        end do
    end subroutine end_support
end module brz_solid_motion
