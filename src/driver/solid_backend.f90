! SPDX-License-Identifier: MIT
!> The operations of a step of the solids that are not loop bodies: loops over pairs of particles,
!> lists and messages, on the CPU or as kernels on a GPU. The drivers put them in order.
module brz_solid_backend
    use brz_errors, only: error_t
    use brz_gpu_solid_diagnostics, only: gpu_add_held_impulse => add_held_impulse, fetch_limit, &
        note_boxes, sum_forces_of_all, sum_states
    use brz_gpu_solid_contact, only: gpu_break_bonds => break_bonds, &
        gpu_contact_pass => contact_pass, gpu_find_press => find_press, note_active
    use brz_gpu_solid_copy, only: fetch_faults
    use brz_gpu_solid_forces, only: gpu_force_pass => force_pass
    use brz_gpu_solid_ghosts, only: offer_motion, gpu_refresh_bonds => refresh_bonds, &
        gpu_refresh_joined => refresh_joined, gpu_refresh_rows => refresh_rows, refresh_kept, &
        take_motion
    use brz_gpu_solid_gradients, only: gpu_gradient_pass => gradient_pass, renew_sleepers
    use brz_gpu_solid_links, only: gpu_build_links => build_links, &
        gpu_settle_links => settle_links
    use brz_gpu_solid_motion, only: gpu_end_support => end_support
    use brz_gpu_solid_search, only: gpu_build_list => build_list, &
        gpu_choose_lists => choose_lists, gpu_mean_velocities => mean_velocities, &
        gpu_note_positions => note_positions, gpu_renew_places => renew_places, &
        gpu_sort_bodies => sort_bodies
    use brz_kinds, only: dp, int64
    use brz_solid_bonds, only: cpu_break_bonds => break_bonds
    use brz_solid_contact, only: cpu_contact_pass => contact_pass, cpu_find_press => find_press
    use brz_solid_forces, only: cpu_force_pass => force_pass
    use brz_solid_diagnostics, only: cpu_add_held_impulse => add_held_impulse
    use brz_solid_ghosts, only: cpu_refresh_bonds => refresh_bonds, &
        cpu_refresh_joined => refresh_joined, cpu_refresh_rows => refresh_rows, &
        refresh_motion
    use brz_solid_gradients, only: cpu_gradient_pass => gradient_pass
    use brz_solid_links, only: cpu_build_links => build_links, cpu_settle_links => settle_links
    use brz_solid_motion, only: cpu_end_support => end_support
    use brz_solid_search, only: cpu_build_list => build_list
    use brz_solid_sort, only: cpu_choose_lists => choose_lists, &
        cpu_mean_velocity => mean_velocity, cpu_note_positions => note_positions, &
        cpu_renew_places => renew_places, cpu_sort_body => sort_body
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: gradient_pass, refresh_rows, break_bonds, refresh_bonds, contact_pass, force_pass
    public :: find_press, end_support, refresh_joined, add_held_impulse
    public :: build_list, choose_lists, mean_velocities, note_positions, renew_places, sort_bodies
    public :: build_links, settle_links
    ! what only a GPU needs
    public :: fetch_faults, fetch_limit, note_active, note_boxes, offer_motion, refresh_kept, &
        renew_sleepers, sum_forces_of_all, sum_states
    public :: exchange_motion

contains

    !> Gradients, materials and what pairs read of them, over dt, the step just made.
    subroutine gradient_pass(solid, dt, err)
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err

        if (solid%on_gpu) then
            call gpu_gradient_pass(solid%device, solid, dt, err)
        else
            call cpu_gradient_pass(solid, dt)
        end if
    end subroutine gradient_pass

    !> Bring what pass 1 has left of ghosts up to date.
    subroutine refresh_rows(solid, err)
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        if (solid%on_gpu) then
            call gpu_refresh_rows(solid%device, solid, err)
        else
            call cpu_refresh_rows(solid, solid%part)
        end if
    end subroutine refresh_rows

    !> Break the bonds whose traction exceeds their strength.
    subroutine break_bonds(solid, err)
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        if (solid%on_gpu) then
            call gpu_break_bonds(solid%device, solid, err)
        else
            call cpu_break_bonds(solid)
        end if
    end subroutine break_bonds

    !> Bring the bonds of ghosts up to date.
    subroutine refresh_bonds(solid, err)
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        if (solid%on_gpu) then
            call gpu_refresh_bonds(solid%device, solid, err)
        else
            call cpu_refresh_bonds(solid, solid%part)
        end if
    end subroutine refresh_bonds

    !> Bring up to date which cohesive interfaces hold ghosts.
    subroutine refresh_joined(solid, err)
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        if (solid%on_gpu) then
            call gpu_refresh_joined(solid%device, solid, err)
        else
            call cpu_refresh_joined(solid, solid%part)
        end if
    end subroutine refresh_joined

    !> All forces between bodies.
    subroutine contact_pass(solid, dt, err)
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! step just made [s]
        type(error_t), intent(inout) :: err

        if (solid%on_gpu) then
            call gpu_contact_pass(solid%device, solid, dt, err)
        else
            call cpu_contact_pass(solid, solid%part, dt)
        end if
    end subroutine contact_pass

    !> Accelerations by the internal forces, heat and energy accounts over dt, the step just made.
    subroutine force_pass(solid, dt, err)
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err

        if (solid%on_gpu) then
            call gpu_force_pass(solid%device, solid, dt, err)
        else
            call cpu_force_pass(solid, dt)
        end if
    end subroutine force_pass

    !> Pressures of contact at the present positions.
    subroutine find_press(solid, err)
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        if (solid%on_gpu) then
            call gpu_find_press(solid%device, solid, err)
        else
            call cpu_find_press(solid, solid%part)
        end if
    end subroutine find_press

    !> End what lacks its neighbours for good, in bodies whose lists are new.
    subroutine end_support(solid, anew, err)
        type(solid_t), intent(inout) :: solid
        logical, intent(in) :: anew(:) !! (bodies)
        type(error_t), intent(inout) :: err

        if (solid%on_gpu) then
            call gpu_end_support(solid%device, solid, anew, err)
        else
            call cpu_end_support(solid, anew)
        end if
    end subroutine end_support

    !> Add the mean force of body b on what holds it in the last pass 2, and record its impulse.
    subroutine add_held_impulse(solid, b, dt, force, err)
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: b
        real(dp), intent(in) :: dt !! step just made [s]
        real(dp), intent(inout) :: force(3) !! [N]
        type(error_t), intent(inout) :: err

        if (solid%on_gpu) then
            call gpu_add_held_impulse(solid%device, solid, b, dt, force, err)
        else
            call cpu_add_held_impulse(solid, b, dt, force)
        end if
    end subroutine add_held_impulse

    !> Lists of neighbours of body b, or those that are chosen.
    subroutine build_list(solid, b, err)
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: b
        type(error_t), intent(inout) :: err

        if (solid%on_gpu) then
            call gpu_build_list(solid%device, solid, b, err)
        else
            call cpu_build_list(solid, b)
        end if
    end subroutine build_list

    !> Mean velocities of some bodies, of all processes.
    subroutine mean_velocities(solid, which, v, err)
        type(solid_t), intent(inout) :: solid
        logical, intent(in) :: which(:) !! (bodies)
        real(dp), intent(out) :: v(:, :) !! (3, bodies), of others 0 [m/s]
        type(error_t), intent(inout) :: err
        integer :: b

        if (solid%on_gpu) then
            call gpu_mean_velocities(solid%device, solid, which, v, err)
        else
            v = 0
            do b = 1, size(which)
                if (which(b)) call cpu_mean_velocity(solid, b, v(:, b))
            end do
        end if
    end subroutine mean_velocities

    !> The lists of body b are about to be built for the places of now.
    subroutine note_positions(solid, b, err)
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: b
        type(error_t), intent(inout) :: err

        if (solid%on_gpu) then
            call gpu_note_positions(solid%device, solid, b, err)
        else
            call cpu_note_positions(solid, b)
        end if
    end subroutine note_positions

    !> Give the particles of body b that have moved far new places to be listed for.
    subroutine renew_places(solid, b, moved, err)
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: b
        integer(int64), intent(out) :: moved(3) !! particles of this process
        type(error_t), intent(inout) :: err

        if (solid%on_gpu) then
            call gpu_renew_places(solid%device, solid, solid%part, b, moved, err)
        else
            call cpu_renew_places(solid, b, moved)
        end if
    end subroutine renew_places

    !> Bring the particles of some bodies into the order of the cells at their places.
    subroutine sort_bodies(solid, which, err)
        type(solid_t), intent(inout) :: solid
        logical, intent(in) :: which(:) !! (bodies)
        type(error_t), intent(inout) :: err
        integer :: b

        if (solid%on_gpu) then
            call gpu_sort_bodies(solid%device, solid, which, err)
        else
            do b = 1, size(which)
                if (which(b)) call cpu_sort_body(solid, b)
            end do
        end if
    end subroutine sort_bodies

    !> Inter-body neighbours for the positions that lists are built for.
    subroutine build_links(solid, err)
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        if (solid%on_gpu) then
            call gpu_build_links(solid%device, solid, err)
        else
            call cpu_build_links(solid)
        end if
    end subroutine build_links

    !> They are about to be built, for the drifts of now or, to resume, those that they had.
    subroutine settle_links(solid, anew, resume, err)
        type(solid_t), intent(inout) :: solid
        logical, intent(in) :: anew(:) !! (bodies) with new lists
        logical, intent(in) :: resume
        type(error_t), intent(inout) :: err

        if (solid%on_gpu) then
            call gpu_settle_links(solid%device, solid, anew, resume, err)
        else
            call cpu_settle_links(solid, anew, resume)
        end if
    end subroutine settle_links

    !> Bring places and velocities of ghosts up to date, where lists stay. On a GPU others have been
    !> offered them since the kick.
    subroutine exchange_motion(solid, err)
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        if (solid%on_gpu) then
            call take_motion(solid%device, solid, err)
        else
            call refresh_motion(solid, solid%part)
        end if
    end subroutine exchange_motion

    !> Choose the particles of body b whose lists are built anew, near those with new places.
    subroutine choose_lists(solid, b, news, err)
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: b
        integer, intent(in) :: news !! the last of its ghosts that are new, on a GPU
        type(error_t), intent(inout) :: err

        if (solid%on_gpu) then
            call gpu_choose_lists(solid%device, solid, b, news, err)
        else
            call cpu_choose_lists(solid, b)
        end if
    end subroutine choose_lists
end module brz_solid_backend
