! SPDX-License-Identifier: MIT
!> What the coupling does in a step, on one process and on several: velocities of the walls, loads
!> of the particles, cells that change hands.
module brz_exchange_driver
    use brz_air_state, only: air_t
    use brz_driven_body_driver, only: sum_loads
    use brz_coupling_state, only: coupling_t
    use brz_coupling_driver, only: find_velocities
    use brz_coupling_windows, only: offer_window, see_beside, see_halo
    use brz_cut_driver, only: feel_loads, load_cut_carriers, move_cut_walls, press_by_cut_cells, &
        stress_by_cut_cells
    use brz_cut_exchange_driver, only: renew_cut_cells
    use brz_errors, only: error_t
    use brz_reclassification_driver, only: move_on
    use brz_coupling_ghost_driver, only: renew_coupling_ghosts, send_loads_to_owners
    use brz_kinds, only: dp, int64
    use brz_lists, only: at_least, clear_list, read_first
    use brz_load_loops, only: for_each_take_wall_traction
    use brz_ranks, only: several, sum_of_all
    use brz_shared_driver, only: share_deferred_sources, share_impulses
    use brz_solid_sleep, only: wake_met
    use brz_bodies, only: bodies_t
    use brz_listed_bodies, only: listed_bodies_t
    use brz_velocity_loops, only: for_each_keep_velocity
    use brz_wall_driver, only: keep_velocities, press_bodies, stress_faces
    implicit none
    private
    public :: set_wall_velocity, spread_load, load_carriers, wake_loaded, reclassify

contains

    !> Velocities of the walls in the middle of the coming step, from the particles in the solid
    !> cells. On several processes `crowd` has the bodies of the ghosts.
    subroutine set_wall_velocity(air, solid, c, dt, err)
        type(air_t), intent(in) :: air
        class(bodies_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: c
        real(dp), intent(in) :: dt !! of the coming step of the air [s]
        type(error_t), intent(inout) :: err !! exit_device where a GPU fails, as everywhere here

        if (c%wall%cells%present) then
            if (several(solid%ranks)) then
                call move_cut_walls(air, c%ghost_bodies, c%ghosts, c, dt, err)
            else
                call move_cut_walls(air, solid, solid, c, dt, err)
                call keep_velocities(solid, c, err)
            end if
        else if (several(solid%ranks)) then
            associate (before => c%ghosts%v_before, seat => c%part%seat)
                call find_velocities(air, c%ghost_bodies, c%ghosts, c, dt, before, seat, err)
            end associate
        else
            call find_velocities(air, solid, solid, c, dt, c%v_before, solid%id, err)
            call keep_velocities(solid, c, err)
        end if
        c%dt_before = dt
    end subroutine set_wall_velocity

    !> Turn the impulses of the wall faces, reference pressure taken off, into forces on particles.
    !>
    !> The forces of a face add up to its impulse over dt. The columns are those of
    !> set_wall_velocity, before the step of the air.
    subroutine spread_load(solid, c, dt, err)
        class(bodies_t), intent(inout) :: solid !! its rigid bodies get their loads
        type(coupling_t), intent(inout) :: c
        real(dp), intent(in) :: dt !! step of the air, over which the impulses were added up [s]
        type(error_t), intent(inout) :: err

        if (several(solid%ranks)) then
            ! the ghosts keep theirs when they are renewed
            call for_each_keep_velocity(c%on_gpu, solid%n, solid%wide, solid%stride_d, &
                                        solid%stride_p, solid%v, c%part%seat, solid%v_before, err)
            if (c%wall%cells%present) then
                call press_by_cut_cells(c%ghosts, c, dt, err)
                call stress_by_cut_cells(solid, c%ghosts, c, err)
            else
                call share_impulses(c, err)
                call press_bodies(c%ghosts, c, dt, err)
                call stress_faces(solid, c%ghosts, c, err)
            end if
            call send_loads_to_owners(solid, c, err)
        else if (c%wall%cells%present) then
            call press_by_cut_cells(solid, c, dt, err)
            call stress_by_cut_cells(solid, solid, c, err)
        else
            call press_bodies(solid, c, dt, err)
            call stress_faces(solid, solid, c, err)
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
        if (c%wall%cells%present .and. several(solid%ranks)) then
            call load_cut_carriers(c%ghosts, c, load, err)
        else if (c%wall%cells%present) then
            call load_cut_carriers(solid, c, load, err)
        else
            call sum_loads(solid, c, load, err)
        end if
        do b = 1, c%bodies
            solid%bodies(b)%rigid%load = load(:, b)
        end do
    end subroutine load_carriers

    !> Wake the bodies with a load beyond rounding on one of their particles, and what they meet.
    !> After spread_load.
    subroutine wake_loaded(solid, c, dt, err)
        class(listed_bodies_t), intent(inout) :: solid
        type(coupling_t), intent(inout) :: c
        real(dp), intent(in) :: dt !! step over which the impulses were added up [s]
        type(error_t), intent(inout) :: err
        integer :: felt(size(solid%bodies))
        integer(int64) :: all_felt(size(solid%bodies))

        if (several(solid%ranks)) then
            call take_wall_tractions(solid, c%ghosts, c, dt, felt, err)
        else
            call take_wall_tractions(solid, solid, c, dt, felt, err)
        end if
        all_felt = felt
        call sum_of_all(solid%ranks, all_felt)
        solid%bodies%inactive = solid%bodies%inactive .and. all_felt == 0
        call wake_met(solid)
    end subroutine wake_loaded

    !> Which bodies that sleep have a load on one of the particles in cells of this process.
    subroutine take_wall_tractions(solid, p, c, dt, felt, err)
        class(bodies_t), intent(in) :: solid !! its bodies
        class(bodies_t), intent(in) :: p !! particles
        type(coupling_t), intent(inout) :: c
        real(dp), intent(in) :: dt !! [s]
        integer, intent(out) :: felt(size(solid%bodies)) !! 1: yes
        type(error_t), intent(inout) :: err
        integer :: b

        call at_least(c%on_gpu, c%felt, size(felt), err)
        call clear_list(c%on_gpu, size(felt), c%felt, err)
        if (c%wall%cells%present) call feel_loads(solid, c, err)
        do b = 1, size(felt)
            if (c%wall%cells%present) exit
            if (.not. solid%bodies(b)%inactive) cycle
            associate (first => p%bodies(b)%first, last => p%bodies(b)%last)
                call for_each_take_wall_traction(c%on_gpu, last - first + 1, first, c%box, dt, &
                    c%cell_of, c%place_of, c%above, c%wall%impulse, c%felt(b:), err)
            end associate
        end do
        call read_first(c%on_gpu, size(felt), c%felt, felt, err)
    end subroutine take_wall_tractions

    !> Bring walls, cell stores and gas up to date with the particles. Once per step of the air.
    !>
    !> Mass, momentum and energy of gas, cell stores and deferred sources together do not change.
    subroutine reclassify(air, solid, c, err)
        type(air_t), intent(inout) :: air
        class(listed_bodies_t), intent(inout) :: solid !! read
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err

        if (several(solid%ranks) .and. c%wall%cells%present) then
            call renew_coupling_ghosts(solid, c, err)
            call renew_cut_cells(air, solid, c%ghost_bodies, c%ghosts, c, err)
            call see_beside(air, c, err)
        else if (several(solid%ranks)) then
            call offer_window(air, c, err)
            call renew_coupling_ghosts(solid, c, err) ! where all meet
            call see_halo(air, c, .true., err)
            call share_deferred_sources(c, err)
            call move_on(air, c%ghost_bodies, c%ghosts, c, err)
            call see_halo(air, c, .false., err)
        else if (c%wall%cells%present) then
            call renew_cut_cells(air, solid, solid, solid, c, err)
        else
            call move_on(air, solid, solid, c, err)
        end if
        if (.not. c%on_gpu) return
        air%device%fetched = .false.
        ! of any process: the diagnostics count cells of this one alone
        if (c%n_covered + c%n_cleared > 0 .or. c%wall%cells%present) &
            c%device%walls_fetched = .false.
    end subroutine reclassify
end module brz_exchange_driver
