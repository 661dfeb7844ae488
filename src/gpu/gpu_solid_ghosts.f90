! SPDX-License-Identifier: MIT
!> Ghosts of particles on several GPUs: what brz_solid_ghosts does on the CPU.
module brz_gpu_solid_ghosts
    use brz_buffers, only: from
    use brz_device, only: copy_in
    use brz_errors, only: error_t
    use brz_face_layout, only: n_face
    use brz_rows, only: rows_t, rows_of => rows_of_copy
    use brz_gpu_solid_layout, only: at_damage, flag_tension
    use brz_gpu_solid_state, only: column_of, words_of_real
    use brz_solid_device, only: solid_device_t
    use brz_kinds, only: int64
    use brz_link_layout, only: n_press
    use brz_ranks, only: several
    use brz_particles, only: particles_t
    implicit none
    private
    public :: offer_motion, take_motion, refresh_kept, refresh_motion, refresh_rows, &
        refresh_press, refresh_bonds, refresh_joined

contains

    !> Others get what take_motion takes, before all of them reduce their errors, with lists: mostly
    !> these last.
    subroutine offer_motion(gpu, solid, err)
        type(solid_device_t), intent(inout) :: gpu
        class(particles_t), intent(in) :: solid
        type(error_t), intent(inout) :: err

        if (.not. several(solid%ranks)) return
        gpu%offered = gpu%rebuilds == solid%rebuilds
        gpu%rebuilds = solid%rebuilds
        if (gpu%offered) call gpu%ghosts%offer(gpu%ghosts%out, gpu%ghosts%in, motion_of(gpu), err)
    end subroutine offer_motion

    !> Places, velocities, volumes and smoothing lengths: what pass 1 reads.
    subroutine refresh_motion(gpu, solid, err)
        type(solid_device_t), intent(inout) :: gpu
        class(particles_t), intent(in) :: solid
        type(error_t), intent(inout) :: err

        if (several(solid%ranks)) call gpu%ghosts%refresh(motion_of(gpu), err)
    end subroutine refresh_motion

    !> The same after the all-reduce.
    subroutine take_motion(gpu, solid, err)
        type(solid_device_t), intent(inout) :: gpu
        class(particles_t), intent(in) :: solid
        type(error_t), intent(inout) :: err

        if (gpu%offered) then
            call gpu%ghosts%take(gpu%ghosts%in, motion_of(gpu), .true., err)
        else
            call refresh_motion(gpu, solid, err)
        end if
    end subroutine take_motion

    pure function motion_of(gpu) result(rows)
        type(solid_device_t), intent(in) :: gpu
        type(rows_t) :: rows(2)

        rows = [rows_of(gpu%place, 8), rows_of(gpu%motion, 4*words_of_real)]
    end function motion_of

    !> The same before lists are built anew in part, and the damage, which end_support reads then.
    subroutine refresh_kept(gpu, err)
        type(solid_device_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err

        call gpu%ghosts%refresh([motion_of(gpu), &
                                 rows_of(column_of(gpu, at_damage), words_of_real)], err)
    end subroutine refresh_kept

    !> What pass 1 has left, and pass 2 reads. What of a body is held may be a ghost, so then all
    !> look for it.
    subroutine refresh_rows(gpu, solid, err)
        type(solid_device_t), intent(inout) :: gpu
        class(particles_t), intent(in) :: solid
        type(error_t), intent(inout) :: err
        integer :: n

        if (.not. several(solid%ranks)) return
        n = gpu%n_left
        if (gpu%linked) then
            call gpu%ghosts%refresh([gpu%left(:n), &
                                     rows_of(gpu%stress, words_of_real, 6, gpu%stride_d), &
                                     rows_of(gpu%links%face, 1, n_face, gpu%stride_d)], err)
        else
            call gpu%ghosts%refresh(gpu%left(:n), err)
        end if
        if (any(gpu%bodies%in_tension)) call copy_in([1], &
            from(gpu%flags, int(flag_tension, int64)), 4_int64, err)
    end subroutine refresh_rows

    !> Pressures of contact.
    subroutine refresh_press(gpu, err)
        type(solid_device_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err

        if (several(gpu%ghosts%ranks)) call gpu%ghosts%refresh( &
            [rows_of(gpu%links%press, n_press*words_of_real)], err)
    end subroutine refresh_press

    !> Which bonds are whole.
    subroutine refresh_bonds(gpu, solid, err)
        type(solid_device_t), intent(inout) :: gpu
        class(particles_t), intent(in) :: solid
        type(error_t), intent(inout) :: err

        if (several(solid%ranks) .and. gpu%bonded) &
            call gpu%ghosts%refresh([rows_of(gpu%links%bond, 1)], err)
    end subroutine refresh_bonds

    !> Which cohesive interfaces hold them.
    subroutine refresh_joined(gpu, solid, err)
        type(solid_device_t), intent(inout) :: gpu
        class(particles_t), intent(in) :: solid
        type(error_t), intent(inout) :: err

        if (several(solid%ranks)) call gpu%ghosts%refresh([rows_of(gpu%links%joined, 1)], err)
    end subroutine refresh_joined
end module brz_gpu_solid_ghosts
