! SPDX-License-Identifier: MIT
!> Bodies that do not deform, and particles that are driven: their part of the time step.
!>
!> The particles of a rigid body carry its mass to contact, air and output. Their velocity is kept
!> at half steps like that of all others, and `a` is what brings it to the step. All processes move
!> a rigid body, the first records its work.
module brz_rigid_driver
    use brz_air_force, only: reaction_force_of, load_of
    use brz_energy_account, only: energy_account_t
    use brz_force_loops, only: for_each_sum_region
    use brz_formulation_names, only: form_rigid
    use brz_kinds, only: dp
    use brz_link_rows, only: glue_of, layout_of_pushes, nodes_of
    use brz_motion, only: mean_velocity, velocity_of
    use brz_rigid_loops, only: for_each_drive_particle, for_each_follow_drive, &
        for_each_follow_rigid, for_each_place_rigid, for_each_settle_heat, for_each_sum_pairs
    use brz_rigid_motion, only: advance_rigid, rigid_step, settle_rigid
    use brz_push_layout, only: push_layout_t
    use brz_rigid_pose, only: pose_of, resting_pose
    use brz_solid_backend, only: add_held_impulse
    use brz_solid_diagnostics, only: begin_motion, end_motion, record_drag, record_drive, size_work
    use brz_bodies, only: bodies_t
    use brz_listed_bodies, only: listed_bodies_t
    use brz_interacting_bodies, only: interacting_bodies_t
    use brz_solid_state, only: solid_t
    use brz_errors, only: error_t
    implicit none
    private
    public :: move_rigid, sum_pushes, balance_rigid, settle_drag

contains

    !> Kick and drift of rigid and driven bodies over dt, from solid%time on.
    subroutine move_rigid(solid, dt, err)
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        type(energy_account_t) :: was
        real(dp) :: load(6), omega(3), q_mid(4), reaction(3), v(3)
        integer :: b

        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b), there => solid%bodies(b))
                if (body%inactive) cycle
                was = body%account
                reaction = body%reaction
                if (body%motion%n > 0) then
                    load = body%rigid%load
                    if (solid%ranks%rank > 0) body%rigid%load = 0 ! the first records it
                    call record_drive(body, solid%time, dt, v)
                    body%rigid%load = load
                    body%rigid%p = body%rigid%mass*v
                    ! the work on free particles is in `diag`, and added to this
                    if (solid%on_gpu) call add_work(solid, b, body%account%load - was%load)
                end if
                if (body%motion%n > 0 .and. body%formulation /= form_rigid) &
                    call for_each_drive_particle(solid%on_gpu, there%last - there%first + 1, &
                        there%first, solid%wide, 0, dt, v(1), v(2), v(3), solid%fixed, solid%x, &
                        solid%v, err)
                if (allocated(body%regions)) call move_regions(solid, b, dt, err)
                if (body%formulation /= form_rigid) cycle
                call advance_rigid(body, (solid%dt_last + dt)/2, dt, v, omega, q_mid)
                call for_each_place_rigid(solid%on_gpu, there%last - there%first + 1, &
                    there%first, solid%wide, pose_of(body%rigid, v, omega, q_mid), solid%x_ref, &
                    solid%x, solid%v, err)
                if (solid%ranks%rank > 0) then
                    body%account = was
                    body%reaction = reaction
                end if
            end associate
        end do
    end subroutine move_rigid

    !> Work on body b that a GPU's own sums do not have.
    subroutine add_work(solid, b, work)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: b
        real(dp), intent(in) :: work !! [J]

        solid%device%account(b)%load = solid%device%account(b)%load + work
    end subroutine add_work

    !> Carry the regions of body b along that are moved.
    subroutine move_regions(solid, b, dt, err)
        class(bodies_t), intent(inout) :: solid
        integer, intent(in) :: b
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        type(energy_account_t) :: was
        real(dp) :: v(3)
        integer :: m

        associate (body => solid%bodies(b), there => solid%bodies(b))
            do m = 1, size(body%regions)
                was = body%account
                call begin_motion(body%regions(m), solid%time, dt, v, was)
                if (solid%ranks%rank == 0) body%account = was
                call for_each_drive_particle(solid%on_gpu, there%last - there%first + 1, &
                    there%first, solid%wide, m, dt, v(1), v(2), v(3), solid%fixed, solid%x, &
                    solid%v, err)
            end do
        end associate
    end subroutine move_regions

    !> Force and torque of contact and of interfaces on rigid bodies: exact sums, as they act back.
    subroutine sum_pushes(solid, dt, push, err)
        class(interacting_bodies_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! step just made [s]
        real(dp), intent(out) :: push(6, size(solid%bodies)) !! [N], [N m]
        type(error_t), intent(inout) :: err
        type(push_layout_t) :: lay
        integer :: b

        push = 0
        lay = layout_of_pushes(solid)
        do b = 1, merge(size(solid%bodies), 0, solid%links%present)
            associate (body => solid%bodies(b), there => solid%bodies(b), l => solid%links)
                if (body%formulation /= form_rigid .or. body%inactive .and. dt > 0) cycle
                call for_each_sum_pairs(solid%on_gpu, there%last - there%first + 1, solid%ranks, &
                    there%first, solid%wide, lay, resting_pose(body%rigid), l%row, solid%id, &
                    nodes_of(solid), glue_of(solid), solid%x, l%push(:, 1:), push(:, b), err)
            end associate
        end do
    end subroutine sum_pushes

    !> The heat of drag on particles of rigid bodies.
    subroutine settle_drag(solid, dt, err)
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! step just made [s]
        type(error_t), intent(inout) :: err
        real(dp) :: turn(3)
        type(push_layout_t) :: lay
        integer :: b

        if (.not. solid%on_gpu) call size_work(solid)
        lay = layout_of_pushes(solid)
        do b = 1, merge(size(solid%bodies), 0, solid%links%present .and. dt > 0)
            associate (body => solid%bodies(b), there => solid%bodies(b), l => solid%links)
                if (body%formulation /= form_rigid .or. body%inactive) cycle
                turn = body%rigid%omega - body%rigid%spin
                call for_each_settle_heat(solid%on_gpu, there%last - there%first + 1, &
                    there%first, lay, solid%stride_d, solid%stride_p, dt, turn(1), turn(2), &
                    turn(3), l%row, solid%mass, l%push(:, 1:), solid%a, solid%energy, &
                    heat_of(solid), err)
                if (.not. solid%on_gpu) call record_drag(solid, b)
            end associate
        end do
    end subroutine settle_drag

    !> Forces on rigid and driven bodies at the step, `a` of their particles, and what time step
    !> they bear.
    subroutine balance_rigid(solid, push, dt, err)
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: push(:, :) !! (6, bodies) on rigid ones by others [N], [N m]
        real(dp), intent(in) :: dt !! step just made [s]
        type(error_t), intent(inout) :: err
        integer :: b

        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b))
                ! a rigid body that sleeps may be met in the next step: its limit holds on
                if (body%inactive .and. body%formulation == form_rigid) &
                    solid%dt_limit = min(solid%dt_limit, body%dt_limit)
                if (body%inactive .and. dt > 0) cycle
                if (body%formulation == form_rigid) call balance_body(solid, b, push(:, b), dt, err)
                if (dt > 0 .and. body%motion%n > 0) call balance_drive(solid, b, dt, err)
                if (dt > 0 .and. allocated(body%regions)) call balance_regions(solid, b, dt, err)
            end associate
        end do
    end subroutine balance_rigid

    subroutine balance_body(solid, b, push, dt, err)
        class(listed_bodies_t), intent(inout) :: solid
        integer, intent(in) :: b
        real(dp), intent(in) :: push(6) !! [N], [N m]
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        real(dp) :: reaction(3), v(3)

        associate (body => solid%bodies(b), there => solid%bodies(b))
            body%rigid%force = push(1:3)
            body%rigid%torque = push(4:6)
            reaction = body%reaction
            call settle_rigid(body, solid%time, dt, v)
            if (solid%ranks%rank > 0) body%reaction = reaction
            body%dt_limit = rigid_step(body, solid%skin)
            solid%dt_limit = min(solid%dt_limit, body%dt_limit)
            if (.not. dt > 0) return
            call for_each_follow_rigid(solid%on_gpu, there%last - there%first + 1, there%first, &
                solid%wide, solid%stride_d, solid%stride_p, dt, pose_of(body%rigid, v, &
                body%rigid%omega, body%rigid%q), solid%x, solid%v, solid%a, err)
        end associate
    end subroutine balance_body

    !> Force of body b on what is driven, the work of the half step up to now, and its velocity.
    subroutine balance_drive(solid, b, dt, err)
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: b
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        real(dp) :: v(3)

        associate (body => solid%bodies(b), there => solid%bodies(b))
            v = velocity_of(body%motion, solid%time)
            body%motion%force = body%rigid%force
            if (body%formulation /= form_rigid) then
                body%motion%force = merge(-body%rigid%load(1:3), 0.0_dp, solid%ranks%rank == 0)
                call add_held_impulse(solid, b, dt, body%motion%force, err)
                call for_each_follow_drive(solid%on_gpu, there%last - there%first + 1, &
                    there%first, solid%wide, 0, solid%stride_d, solid%stride_p, dt, v(1), v(2), &
                    v(3), solid%fixed, solid%v, solid%a, err)
            end if
            if (body%formulation == form_rigid .and. solid%ranks%rank > 0) return
            body%account%drive = body%account%drive - dt/2*dot_product( &
                body%motion%force, mean_velocity(body%motion, solid%time - dt, dt))
        end associate
    end subroutine balance_drive

    !> Forces of body b on the regions of it that are moved, the work of the half step up to now,
    !> and their velocities.
    subroutine balance_regions(solid, b, dt, err)
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: b
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        type(energy_account_t) :: was
        real(dp) :: sums(6), v(3), work
        integer :: m

        associate (body => solid%bodies(b), there => solid%bodies(b))
            do m = 1, size(body%regions)
                call for_each_sum_region(solid%on_gpu, there%last - there%first + 1, solid%ranks, &
                    there%first, m, solid%stride_d, solid%stride_p, merge(1, 0, &
                    allocated(solid%load)), solid%fixed, load_of(solid), &
                    reaction_force_of(solid), sums, err)
                was = body%account
                call end_motion(body%regions(m), solid%time, dt, sums, was, work)
                if (solid%ranks%rank == 0) body%account = was
                ! the work on free particles is in `diag`, and added to this
                if (solid%on_gpu .and. solid%ranks%rank == 0) call add_work(solid, b, work)
                v = velocity_of(body%regions(m), solid%time)
                call for_each_follow_drive(solid%on_gpu, there%last - there%first + 1, &
                    there%first, solid%wide, m, solid%stride_d, solid%stride_p, dt, v(1), v(2), &
                    v(3), solid%fixed, solid%v, solid%a, err)
            end do
        end associate
    end subroutine balance_regions

    !> Heat of contact of each particle [J]; on the CPU among the work of the loads.
    function heat_of(solid) result(heat)
        type(solid_t), intent(in), target :: solid
        real(dp), pointer, contiguous :: heat(:)

        heat => solid%work
        if (solid%on_gpu) heat => solid%device%heat
    end function heat_of
end module brz_rigid_driver
