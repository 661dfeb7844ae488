! SPDX-License-Identifier: MIT
!> Rigid bodies on the GPU: the host moves the body, the GPU its particles.
module brz_gpu_solid_rigid
    use brz_buffers, only: from
    use brz_device, only: clear_buffer, copy_in
    use brz_drive, only: book_drive
    use brz_errors, only: error_t
    use brz_gpu_solid_layout, only: at_accel
    use brz_gpu_solid_state, only: column_of, gpu_solid_t, moved_flags, threads_of
    use brz_kinds, only: dp, int64
    use brz_list_drift, only: level_unit
    use brz_rigid_motion, only: advance_rigid, rigid_step, settle_rigid
    use brz_rigid_pose, only: n_pose, pose_of
    use brz_solid_state, only: ledger_t, solid_t
    implicit none
    private
    public :: move_rigid, fill_rigid, balance_rigid

contains

    !> Kick and drift of rigid body b, and its particles.
    subroutine move_rigid(gpu, solid, b, dt, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: b
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        type(ledger_t) :: ledger
        real(dp) :: v(3), omega(3), q_mid(4), reaction(3)

        associate (body => solid%bodies(b), there => gpu%bodies(b))
            ledger = body%ledger
            reaction = body%reaction
            if (body%motion%n > 0) then
                call book_drive(body, solid%time, dt, v)
                body%rigid%p = body%rigid%mass*v
            end if
            call advance_rigid(body, (solid%dt_last + dt)/2, dt, v, omega, q_mid)
            if (solid%ranks%rank > 0) then ! all processes move the body, the first books it
                body%ledger = ledger
                body%reaction = reaction
            end if
            call copy_in(pose_of(body%rigid, v, omega, q_mid), there%drive, 8_int64*n_pose, err)
            call gpu%moves%place_rigid(there%last - there%first + 1, there%first, 4, &
                there%drive, gpu%reference, gpu%place, gpu%motion, err)
            call gpu%moves%note_particle(there%last - there%first + 1, there%first, 4, &
                level_unit(solid), body%drift(1), body%drift(2), body%drift(3), gpu%place, &
                gpu%built, moved_flags(gpu, b), err)
        end associate
    end subroutine move_rigid

    !> What contact gathers of the particles of body b.
    subroutine fill_rigid(gpu, b, err)
        type(gpu_solid_t), intent(in) :: gpu
        integer, intent(in) :: b
        type(error_t), intent(inout) :: err

        associate (there => gpu%bodies(b))
            call gpu%moves%fill_rigid_row(there%last - there%first + 1, there%first, 4, &
                there%drive, from(gpu%motion, 4_int64), gpu%row, err)
            ! the host knows its time step
            call clear_buffer(from(gpu%rate, int(there%first, int64)), err, &
                              8_int64*(there%last - there%first + 1))
        end associate
    end subroutine fill_rigid

    !> Force and torque of contact on body b at the step, `a` of its particles, its time step.
    subroutine balance_rigid(gpu, solid, b, dt, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: b
        real(dp), intent(in) :: dt !! step just made [s]
        type(error_t), intent(inout) :: err
        real(dp) :: push(6), reaction(3), v(3)

        associate (body => solid%bodies(b), there => gpu%bodies(b))
            push = 0
            if (gpu%linked) then
                call gpu%moves%sum_pairs(there%last - there%first + 1, there%first, 4, gpu%n, &
                                        there%drive, gpu%place, gpu%extra, gpu%exact, err)
                push = gpu%exact%total(:6)
            end if
            body%rigid%force = push(1:3)
            body%rigid%torque = push(4:6)
            reaction = body%reaction
            call settle_rigid(body, solid%time, dt, v)
            if (solid%ranks%rank > 0) body%reaction = reaction ! the first books it
            body%dt_limit = rigid_step(body, solid%skin)
            call copy_in(pose_of(body%rigid, v, body%rigid%omega, body%rigid%q), there%drive, &
                         8_int64*n_pose, err)
            call gpu%moves%follow_rigid(there%last - there%first + 1, there%first, 4, gpu%n, 1, &
                dt, there%drive, gpu%place, gpu%motion, column_of(gpu, at_accel + 1), err)
            if (gpu%linked) call gpu%kernels%solid_rigid_drag(threads_of(there), gpu%n, &
                there%params, dt, there%drive, gpu%row, gpu%extra, gpu%state, gpu%book, err)
        end associate
    end subroutine balance_rigid
end module brz_gpu_solid_rigid
