! SPDX-License-Identifier: MIT
!> One time step of the air on the GPU: the same list of operations as on the CPU, as launches.
module brz_gpu_air_step
    use brz_air_state, only: air_ok, air_t, air_unphysical, bc_outflow, bc_periodic
    use brz_device, only: arguments_t, buffer_t, clear_buffer, copy_out, kernel_t, launch
    use brz_errors, only: error_t, failed
    use brz_gpu_air_state, only: gpu_air_t, leave_threads
    use brz_gpu_air_sums, only: sum_of_columns
    use brz_kinds, only: dp, int64, rk
    use brz_runge_kutta, only: least_ratio, new_weight, repair_passes, share_of
    implicit none
    private
    public :: gpu_air_step

contains

    !> Advance the air by dt. `status` is air_ok, or air_unphysical: air%bad_cell tells where.
    subroutine gpu_air_step(gpu, air, dt, status, err)
        type(gpu_air_t), intent(inout) :: gpu
        type(air_t), intent(inout) :: air
        real(dp), intent(in) :: dt !! time step [s]
        integer, intent(out) :: status
        type(error_t), intent(inout) :: err !! exit_device where the GPU fails
        integer :: d, m
        logical :: lost

        status = air_ok
        gpu%fetched = .false.
        do m = 1, air%n_stages
            call fill_ghosts(gpu, air, err)
            do d = 1, 3
                if (air%n(d) > 1) call compute_fluxes(gpu, air, gpu%faces, d, 0, err)
            end do
            call repair(gpu, air, real(dt, rk), lost, err)
            if (lost) status = air_unphysical
            if (failed(err) .or. lost) return
            do d = 1, 3
                if (air%n(d) > 1) call add_outflow(gpu, air, d, share_of(m, air%n_stages)*dt, err)
            end do
            call update(gpu, air, real(dt, rk), m, err)
        end do
    end subroutine gpu_air_step

    !> Cells and, in direction d, one more: the number of faces.
    pure function faces_of(n, d) result(faces)
        integer, intent(in) :: n(3) !! cells
        integer, intent(in) :: d !! direction
        integer :: faces(3)

        faces = n
        faces(d) = faces(d) + 1
    end function faces_of

    subroutine fill_ghosts(gpu, air, err)
        type(gpu_air_t), intent(in) :: gpu
        type(air_t), intent(in) :: air
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments
        integer :: d, side, plane(3)

        do d = 1, 3
            if (air%n(d) == 1) cycle
            plane = [pack(air%n, [1, 2, 3] /= d), 1]
            do side = 1, 2
                arguments%n = 0
                call arguments%add(d)
                call arguments%add(side)
                if (air%bc(side, d) == bc_outflow) then
                    call arguments%add(gpu%grid_at)
                    call arguments%add(gpu%scheme_at)
                    call arguments%add(gpu%outside(side, d))
                    call arguments%add(gpu%u)
                    call launch(gpu%ghosts_open, plane, arguments, err)
                else
                    call arguments%add(air%bc(side, d))
                    call arguments%add(gpu%grid_at)
                    call arguments%add(gpu%u)
                    call launch(gpu%ghosts, plane, arguments, err)
                end if
            end do
        end do
    end subroutine fill_ghosts

    !> Fluxes of direction d, of all faces or only of those next to marked cells.
    subroutine compute_fluxes(gpu, air, kernel, d, only_bad, err)
        type(gpu_air_t), intent(in) :: gpu
        type(air_t), intent(in) :: air
        type(kernel_t), intent(in) :: kernel !! of a scheme
        integer, intent(in) :: d !! direction
        integer, intent(in) :: only_bad !! 1: next to marked cells
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments

        call arguments%add(d)
        call arguments%add(only_bad)
        call arguments%add(gpu%grid_at)
        call arguments%add(gpu%scheme_at)
        call arguments%add(gpu%u)
        call arguments%add(gpu%bad)
        call arguments%add(gpu%flux(d))
        call launch(kernel, faces_of(air%n, d), arguments, err)
    end subroutine compute_fluxes

    !> Find the cells whose Euler step loses nearly all density or pressure, and give their faces
    !> the flux of the fallback. `lost` if that does not help.
    subroutine repair(gpu, air, dt, lost, err)
        type(gpu_air_t), intent(in) :: gpu
        type(air_t), intent(inout) :: air
        real(rk), intent(in) :: dt !! time step [s]
        logical, intent(out) :: lost
        type(error_t), intent(inout) :: err
        integer :: d, pass
        logical :: found

        lost = .false.
        call look(gpu, gpu%check, air, dt, merge(least_ratio, 0.0_rk, air%fallback), found, err)
        if (.not. found) return
        if (air%fallback) then
            do pass = 1, repair_passes
                do d = 1, 3
                    if (air%n(d) > 1) call compute_fluxes(gpu, air, gpu%fallback, d, 1, err)
                end do
                call look(gpu, gpu%check, air, dt, least_ratio, found, err)
                if (.not. found) exit
            end do
            call count_lowered(gpu, air, err)
        end if
        call look(gpu, gpu%judge, air, dt, 0.0_rk, lost, err)
        if (lost) call find_lost_cell(gpu, air, err)
        call clear_buffer(gpu%bad, err)
    end subroutine repair

    !> Launch a kernel that looks at the Euler step of every cell. Did it mark one?
    subroutine look(gpu, kernel, air, dt, floor, found, err)
        type(gpu_air_t), intent(in) :: gpu
        type(kernel_t), intent(in) :: kernel
        type(air_t), intent(in) :: air
        real(rk), intent(in) :: dt !! [s]
        real(rk), intent(in) :: floor !! least ratio of new to old density and pressure
        logical, intent(out) :: found
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments
        integer, target :: any_bad(1)

        call clear_buffer(gpu%any_bad, err)
        call arguments%add(gpu%grid_at)
        call arguments%add(dt)
        call arguments%add(floor)
        call arguments%add(gpu%u)
        call arguments%add(gpu%flux(1))
        call arguments%add(gpu%flux(2))
        call arguments%add(gpu%flux(3))
        call arguments%add(gpu%bad)
        call arguments%add(gpu%any_bad)
        call launch(kernel, air%n, arguments, err)
        any_bad = 0
        call copy_out(gpu%any_bad, any_bad, 4_int64, err)
        found = any_bad(1) /= 0
    end subroutine look

    !> Count the faces next to marked cells.
    subroutine count_lowered(gpu, air, err)
        type(gpu_air_t), intent(in) :: gpu
        type(air_t), intent(inout) :: air
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments
        integer :: d, across(3)
        real(dp) :: n

        call clear_buffer(gpu%part, err)
        do d = 1, 3
            if (air%n(d) == 1) cycle
            across = faces_of(air%n, d)
            across(3) = 1
            arguments%n = 0
            call arguments%add(d)
            call arguments%add(gpu%grid_at)
            call arguments%add(gpu%bad)
            call arguments%add(gpu%part)
            call launch(gpu%lowered, across, arguments, err)
        end do
        call sum_of_columns(gpu, (air%n(1) + 1)*(air%n(2) + 1), n, err)
        air%fallback_faces = air%fallback_faces + nint(n, int64)
    end subroutine count_lowered

    !> Where the first lost cell is, for the message.
    subroutine find_lost_cell(gpu, air, err)
        type(gpu_air_t), intent(in) :: gpu
        type(air_t), intent(inout) :: air
        type(error_t), intent(inout) :: err
        character, allocatable, target :: marks(:)
        integer(int64) :: at
        integer :: i

        allocate (marks(gpu%grid%apart))
        call copy_out(gpu%bad, marks, gpu%grid%apart, err)
        call copy_out(gpu%u, air%u, gpu%u%bytes, err)
        at = findloc(ichar(marks), 2, dim=1) - 1
        do i = 3, 1, -1
            air%bad_cell(i) = int(at/gpu%grid%step(i)) + 1 - air%g(i)
            at = mod(at, int(gpu%grid%step(i), int64))
        end do
        air%bad_state = air%u(air%bad_cell(1), air%bad_cell(2), air%bad_cell(3), 1:5)
    end subroutine find_lost_cell

    !> Book what left through the two outer faces of a direction.
    subroutine add_outflow(gpu, air, d, share, err)
        type(gpu_air_t), intent(in) :: gpu
        type(air_t), intent(in) :: air
        integer, intent(in) :: d !! direction
        real(dp), intent(in) :: share !! weight of the stage times dt [s]
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments

        if (air%bc(1, d) == bc_periodic) return
        call arguments%add(d)
        call arguments%add(leave_threads)
        call arguments%add(share*product(air%dx)/air%dx(d))
        call arguments%add(gpu%grid_at)
        call arguments%add(gpu%flux(d))
        call arguments%add(gpu%outflow)
        call launch(gpu%leave, [leave_threads, 1, 1], arguments, err)
    end subroutine add_outflow

    subroutine update(gpu, air, dt, m, err)
        type(gpu_air_t), intent(in) :: gpu
        type(air_t), intent(in) :: air
        real(rk), intent(in) :: dt !! time step [s]
        integer, intent(in) :: m !! stage
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments

        call arguments%add(gpu%grid_at)
        call arguments%add(dt)
        call arguments%add(new_weight(m, air%n_stages))
        call arguments%add(merge(1, 0, m == 1))
        call arguments%add(gpu%flux(1))
        call arguments%add(gpu%flux(2))
        call arguments%add(gpu%flux(3))
        call arguments%add(gpu%u)
        call arguments%add(gpu%u_start)
        call launch(gpu%update, air%n, arguments, err)
    end subroutine update
end module brz_gpu_air_step
