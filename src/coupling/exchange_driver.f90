! SPDX-License-Identifier: MIT
!> What the coupling does in a step, on one process and on several: velocities of the walls, loads
!> of the particles, gas that goes over to new shapes.
module brz_exchange_driver
    use brz_air_state, only: air_t
    use brz_coupling_state, only: coupling_t
    use brz_coupling_windows, only: see_beside
    use brz_cut_driver, only: feel_loads, load_cut_carriers, move_cut_walls, press_by_cut_cells, &
        stress_by_cut_cells
    use brz_cut_exchange_driver, only: renew_cut_cells
    use brz_errors, only: error_t
    use brz_coupling_ghost_driver, only: renew_coupling_ghosts, send_loads_to_owners
    use brz_kinds, only: dp, int64
    use brz_lists, only: at_least, clear_list, read_first
    use brz_ranks, only: several, sum_of_all
    use brz_solid_sleep, only: all_asleep, wake_met
    use brz_bodies, only: bodies_t
    use brz_listed_bodies, only: listed_bodies_t
    use brz_velocity_loops, only: for_each_keep_velocity
    implicit none
    private
    public :: set_wall_velocity, spread_load, wake_loaded, reclassify

contains

    !> Velocities of the walls in the middle of the coming step; while all bodies sleep they stand.
    subroutine set_wall_velocity(air, solid, c, dt, err)
        type(air_t), intent(in) :: air
        class(bodies_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: c
        real(dp), intent(in) :: dt !! of the coming step of the air [s]
        type(error_t), intent(inout) :: err !! exit_device where a GPU fails, as everywhere here

        if (several(solid%ranks)) then
            if (.not. all_asleep(solid)) &
                call move_cut_walls(air, c%ghost_bodies, c%ghosts, c, dt, err)
        else
            if (.not. all_asleep(solid)) call move_cut_walls(air, solid, solid, c, dt, err)
            call for_each_keep_velocity(c%on_gpu, solid%n, solid%wide, 1, 3, solid%v, solid%id, &
                                        c%v_before, err)
        end if
        c%dt_before = dt
    end subroutine set_wall_velocity

    !> Turn the impulses on the walls, reference pressure taken off, into forces on particles. Those
    !> of a wall add up to its impulse over dt.
    subroutine spread_load(solid, c, dt, err)
        class(bodies_t), intent(inout) :: solid !! its rigid bodies get their loads
        type(coupling_t), intent(inout) :: c
        real(dp), intent(in) :: dt !! step of the air, over which the impulses were added up [s]
        type(error_t), intent(inout) :: err

        if (several(solid%ranks)) then
            ! the ghosts keep theirs when they are renewed
            call for_each_keep_velocity(c%on_gpu, solid%n, solid%wide, solid%stride_d, &
                                        solid%stride_p, solid%v, c%part%seat, solid%v_before, err)
            call press_by_cut_cells(c%ghosts, c, dt, err)
            call stress_by_cut_cells(solid, c%ghosts, c, err)
            call send_loads_to_owners(solid, c, err)
        else
            call press_by_cut_cells(solid, c, dt, err)
            call stress_by_cut_cells(solid, solid, c, err)
        end if
        call load_carriers(solid, c, err)
    end subroutine spread_load

    !> Force and torque of the air on the bodies that carry particles.
    subroutine load_carriers(solid, c, err)
        class(bodies_t), intent(inout) :: solid
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err
        real(dp) :: load(6, c%bodies)
        integer :: b

        if (.not. allocated(solid%bodies)) return
        if (several(solid%ranks)) then
            call load_cut_carriers(c%ghosts, c, load, err)
        else
            call load_cut_carriers(solid, c, load, err)
        end if
        do b = 1, c%bodies
            solid%bodies(b)%rigid%load = load(:, b)
        end do
    end subroutine load_carriers

    !> Wake the bodies with a load beyond rounding on one of their particles, and what they meet.
    !> After spread_load.
    subroutine wake_loaded(solid, c, err)
        class(listed_bodies_t), intent(inout) :: solid
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err
        integer :: felt(size(solid%bodies))
        integer(int64) :: all_felt(size(solid%bodies))

        call at_least(c%on_gpu, c%felt, size(felt), err)
        call clear_list(c%on_gpu, size(felt), c%felt, err)
        call feel_loads(solid, c, err)
        call read_first(c%on_gpu, size(felt), c%felt, felt, err)
        all_felt = felt
        call sum_of_all(solid%ranks, all_felt)
        solid%bodies%inactive = solid%bodies%inactive .and. all_felt == 0
        call wake_met(solid)
    end subroutine wake_loaded

    !> Bring walls and gas up to date with the particles. Once per step of the air; while all bodies
    !> sleep there is nothing to do.
    !>
    !> Mass, momentum and energy of gas and of content that waits together do not change.
    subroutine reclassify(air, solid, c, err)
        type(air_t), intent(inout) :: air
        class(listed_bodies_t), intent(inout) :: solid !! read
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err

        associate (asleep => all_asleep(solid) .and. solid%rebuilds == c%wall%cells%rebuilds)
            if (several(solid%ranks)) then
                if (.not. asleep) then
                    call renew_coupling_ghosts(solid, c, err)
                    call renew_cut_cells(air, solid, c%ghost_bodies, c%ghosts, c, err)
                end if
                call see_beside(air, c, err)
            else if (.not. asleep) then
                call renew_cut_cells(air, solid, solid, solid, c, err)
            end if
        end associate
        if (.not. c%on_gpu) return
        air%device%fetched = .false.
        c%device%walls_fetched = .false.
    end subroutine reclassify
end module brz_exchange_driver
