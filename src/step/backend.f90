! SPDX-License-Identifier: MIT
!> Where a scene is computed: on the CPU, or its air or its bodies on a GPU. The operations of a
!> step that differ.
module brz_backend
    use brz_air_energy, only: air_kinetic
    use brz_air_probe, only: cells_around
    use brz_air_state, only: air_ok, air_t, wall_t
    use brz_air_step, only: air_step
    use brz_air_sums, only: air_time_step
    use brz_coupling_state, only: coupling_t
    use brz_cell_shells, only: cell_at, reach
    use brz_coupling_totals, only: coupling_products, coupling_totals, ledger_totals
    use brz_device, only: device_t, load_kernels, open_device
    use brz_errors, only: error_t, exit_device, failed, raise
    use brz_files, only: program_path
    use brz_gpu_air_state, only: fetch_air, fetch_cells, gpu_air_t, open_gpu_air
    use brz_gpu_air_step, only: gpu_air_step
    use brz_gpu_air_sums, only: gpu_air_time_step, gpu_air_totals, gpu_outflow
    use brz_gpu_air_walls, only: fetch_walls, put_wall_velocity, put_walls, return_cells
    use brz_gpu_solid_copy, only: fetch_particles, fetch_solid, open_gpu_solid
    use brz_gpu_solid_state, only: cannot_run_solid, gpu_solid_t
    use brz_gpu_solid_step, only: gpu_solid_step
    use brz_gpu_solid_sums, only: fetch_ledgers, gpu_solid_totals
    use brz_kinds, only: dp, int64, rk
    use brz_solid_state, only: solid_t
    use brz_solid_step, only: solid_step
    use brz_solid_totals, only: solid_totals, solid_totals_t
    use brz_version, only: device_code
    implicit none
    private
    public :: backend_t, choose_backend, settle_backend, start_backend
    public :: advance_air, hand_back, limit_of_air, stock_of_air, advance_solid, stock_of_solid
    public :: fetch_state, fetch_around, fetch_followed

    type :: backend_t
        logical :: on_gpu = .false. !! the air
        logical :: bodies_on_gpu = .false.
        type(device_t) :: device
        type(gpu_air_t) :: air
        type(gpu_solid_t) :: solid
        integer, allocatable :: owed(:, :) !! (3, n) gas cells with debts, also shared
        integer(int64) :: wall_changes = -1
        !! cells that had changed hands when the walls were last copied
    end type backend_t

contains

    !> Open the GPU if it is wanted and there. 'auto' falls back to the CPU, in silence where there
    !> is no driver; where a GPU is there but cannot be used the note says why.
    subroutine choose_backend(wanted, has_air, has_solid, backend, note, err)
        character(*), intent(in) :: wanted !! 'cpu', 'gpu', 'auto'
        logical, intent(in) :: has_air, has_solid !! in the scene
        type(backend_t), intent(inout) :: backend
        character(:), allocatable, intent(out) :: note !! what the user should know, '' for nothing
        type(error_t), intent(inout) :: err !! exit_device if 'gpu' is not possible
        type(error_t) :: trial

        note = ''
        if (failed(err) .or. wanted == 'cpu') return
        call open_device(backend%device, trial)
        if (wanted == 'auto' .and. failed(trial)) return
        call load_kernels(backend%device, kernel_file(), device_code, trial)
        backend%on_gpu = has_air .and. .not. failed(trial)
        backend%bodies_on_gpu = has_solid .and. .not. has_air .and. .not. failed(trial)
        if (backend%on_gpu) then
            note = 'the air runs on '//backend%device%name
            if (has_solid) note = note//', bodies and coupling on the CPU'
        else if (backend%bodies_on_gpu) then
            note = '' ! settle_backend has the last word
        else if (wanted == 'gpu') then
            call raise(err, trial%code, trial%text)
        else
            note = 'the scene runs on the CPU: '//trial%text
        end if
    end subroutine choose_backend

    !> Decide on what the scene holds once it is set up.
    subroutine settle_backend(wanted, solid, coupling, backend, note, err)
        character(*), intent(in) :: wanted !! 'cpu', 'gpu', 'auto'
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(in) :: coupling
        type(backend_t), intent(inout) :: backend
        character(:), allocatable, intent(out) :: note !! what the user should know, '' for nothing
        type(error_t), intent(inout) :: err !! exit_device if 'gpu' is not possible
        character(:), allocatable :: why

        note = ''
        if (backend%bodies_on_gpu) call cannot_run_solid(solid, why)
        if (backend%on_gpu .and. coupling%paper) why = "the coupling scheme='paper'"
        if (.not. allocated(why)) then
            if (backend%bodies_on_gpu) note = 'the bodies run on '//backend%device%name
            return
        end if
        backend%on_gpu = .false.
        backend%bodies_on_gpu = .false.
        note = 'the scene runs on the CPU: this version does not have '//why//' on the GPU'
        if (wanted == 'gpu') call raise(err, exit_device, 'this version does not have '//why// &
                                        ' on the GPU: run with --backend cpu')
    end subroutine settle_backend

    !> The GPU code: beside the program, or where the environment variable BRISANCE_PTX says.
    function kernel_file() result(path)
        character(:), allocatable :: path
        character(4096) :: named

        call get_environment_variable('BRISANCE_PTX', named)
        path = trim(named)
        if (path == '') path = program_path()//'.ptx'
    end function kernel_file

    !> Hand the state to the GPU, once it is set up or read from a checkpoint.
    subroutine start_backend(backend, air, coupling, solid, err)
        type(backend_t), intent(inout) :: backend
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(in) :: coupling
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        if (backend%on_gpu .and. .not. failed(err)) then
            call open_gpu_air(backend%device, air, coupling%present, backend%air, err)
            call renew_walls(backend, air, coupling, err)
            call list_owed(backend, air, coupling)
        end if
        if (backend%bodies_on_gpu .and. .not. failed(err)) &
            call open_gpu_solid(backend%device, solid, backend%solid, err)
    end subroutine start_backend

    !> Copy the walls to the GPU if cells have changed between gas and solid.
    subroutine renew_walls(backend, air, coupling, err)
        type(backend_t), intent(inout) :: backend
        type(air_t), intent(in) :: air
        type(coupling_t), intent(in) :: coupling
        type(error_t), intent(inout) :: err
        integer(int64) :: changes

        changes = coupling%covered_total + coupling%uncovered_total
        if (.not. coupling%present .or. failed(err) .or. changes == backend%wall_changes) return
        call put_walls(backend%air, air, coupling%wall, coupling%face_of, reach, err)
        backend%wall_changes = changes
    end subroutine renew_walls

    !> After the coupling has handed gas over: bring the GPU up to date.
    subroutine hand_back(backend, air, coupling, err)
        type(backend_t), intent(inout) :: backend
        type(air_t), intent(in) :: air
        type(coupling_t), intent(in) :: coupling
        type(error_t), intent(inout) :: err

        if (.not. backend%on_gpu .or. failed(err)) return
        call return_cells(backend%air, air, backend%owed, err)
        call renew_walls(backend, air, coupling, err)
        call list_owed(backend, air, coupling)
    end subroutine hand_back

    !> List the gas cells with debts: they may lie far from the walls by now.
    subroutine list_owed(backend, air, coupling)
        type(backend_t), intent(inout) :: backend
        type(air_t), intent(in) :: air
        type(coupling_t), intent(in) :: coupling
        integer :: e

        if (allocated(backend%owed)) then
            if (size(backend%owed, 2) /= coupling%n_debts) deallocate (backend%owed)
        end if
        if (.not. allocated(backend%owed)) allocate (backend%owed(3, coupling%n_debts))
        do e = 1, coupling%n_debts
            backend%owed(:, e) = cell_at(air%n, coupling%debt_cell(e))
        end do
    end subroutine list_owed

    !> One step of the air. `status` as air_step has it.
    subroutine advance_air(backend, air, wall, dt, status, err)
        type(backend_t), intent(inout) :: backend
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        real(dp), intent(in) :: dt !! [s]
        integer, intent(out) :: status
        type(error_t), intent(inout) :: err

        if (backend%on_gpu) then
            if (wall%present) call put_wall_velocity(backend%air, wall, err)
            call gpu_air_step(backend%air, air, dt, status, err)
            if (.not. wall%present .or. status /= air_ok) return
            call fetch_walls(backend%air, air, wall, err)
            call fetch_cells(backend%air, backend%owed, air, err)
        else
            call air_step(air, wall, dt, status)
        end if
    end subroutine advance_air

    !> Largest stable time step of the air [s].
    real(dp) function limit_of_air(backend, air, wall, cfl, err) result(dt)
        type(backend_t), intent(in) :: backend
        type(air_t), intent(in) :: air
        type(wall_t), intent(in) :: wall
        real(dp), intent(in) :: cfl !! Courant number [-]
        type(error_t), intent(inout) :: err

        if (backend%on_gpu) then
            dt = gpu_air_time_step(backend%air, air, cfl, err)
            if (wall%present) dt = min(dt, cfl/max(fastest_wall(air, wall), tiny(dt)))
        else
            dt = air_time_step(air, wall, cfl)
        end if
    end function limit_of_air

    !> Largest sum_d |v_d|/dx_d of the walls [1/s].
    pure real(dp) function fastest_wall(air, wall) result(fastest)
        type(air_t), intent(in) :: air
        type(wall_t), intent(in) :: wall
        integer :: c

        fastest = 0
        do c = 1, wall%n_cells
            fastest = max(fastest, real(sum(abs(wall%v(:, c)) &
                *merge(real(1/air%dx, rk), 0.0_rk, air%n > 1)), dp))
        end do
    end function fastest_wall

    !> Totals of the air; what left through its boundaries is brought up to date in `air`.
    subroutine stock_of_air(backend, air, coupling, gas, kept, kinetic, products, err)
        type(backend_t), intent(in) :: backend
        type(air_t), intent(inout) :: air !! its row sums are overwritten
        type(coupling_t), intent(in) :: coupling
        real(dp), intent(out) :: gas(5) !! mass [kg], momentum [kg m/s], energy [J]
        real(dp), intent(out) :: kept(5) !! the same in ledgers and debts
        real(dp), intent(out) :: kinetic !! energy of the gas [J]
        real(dp), intent(out) :: products !! mass of products of explosives [kg]
        type(error_t), intent(inout) :: err
        real(dp) :: debt(5), totals(0:6), more

        if (backend%on_gpu) then
            call gpu_air_totals(backend%air, air, totals, err)
            call gpu_outflow(backend%air, air, err)
            gas = totals(1:5)
            call ledger_totals(air, coupling, kept, more)
            kinetic = totals(0)
            products = totals(6) + more
        else
            call coupling_totals(air, coupling, gas, kept, debt)
            kept = kept + debt
            kinetic = air_kinetic(air, coupling%wall)
            products = coupling_products(air, coupling)
        end if
    end subroutine stock_of_air

    !> One step of the bodies.
    subroutine advance_solid(backend, solid, dt, err)
        type(backend_t), intent(inout) :: backend
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err

        if (backend%bodies_on_gpu) then
            call gpu_solid_step(backend%solid, solid, dt, err)
        else
            call solid_step(solid, dt, err)
        end if
    end subroutine advance_solid

    !> Totals of body b, or of all with b = 0; the ledgers of the bodies are brought up to date.
    subroutine stock_of_solid(backend, solid, b, totals, err)
        type(backend_t), intent(inout) :: backend
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: b
        type(solid_totals_t), intent(out) :: totals
        type(error_t), intent(inout) :: err

        if (backend%bodies_on_gpu) then
            call gpu_solid_totals(backend%solid, solid, b, totals, err)
        else
            call solid_totals(solid, b, totals)
        end if
    end subroutine stock_of_solid

    !> Bring the whole state to the host, for a dump or a checkpoint.
    subroutine fetch_state(backend, air, solid, err)
        type(backend_t), intent(inout) :: backend
        type(air_t), intent(inout) :: air
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        if (failed(err)) return
        if (backend%on_gpu) then
            call fetch_air(backend%air, air, err)
            call gpu_outflow(backend%air, air, err)
        end if
        if (backend%bodies_on_gpu) then
            call fetch_solid(backend%solid, solid, err)
            call fetch_ledgers(backend%solid, solid, err)
        end if
    end subroutine fetch_state

    !> Bring the motion of some particles to the host, for gauges.
    subroutine fetch_followed(backend, id, solid, err)
        type(backend_t), intent(in) :: backend
        integer, intent(in) :: id(:) !! numbers of the particles
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        if (backend%bodies_on_gpu .and. .not. failed(err)) &
            call fetch_particles(backend%solid, id, solid, err)
    end subroutine fetch_followed

    !> Bring the cells around some points to the host, for gauges.
    subroutine fetch_around(backend, points, air, err)
        type(backend_t), intent(in) :: backend
        real(dp), intent(in) :: points(:, :) !! (3, n) [m]
        type(air_t), intent(inout) :: air
        type(error_t), intent(inout) :: err
        integer :: cells(3, 8*size(points, 2)), g

        if (.not. backend%on_gpu .or. failed(err)) return
        do g = 1, size(points, 2)
            call cells_around(air, points(:, g), cells(:, 8*g - 7:8*g))
        end do
        call fetch_cells(backend%air, cells, air, err)
    end subroutine fetch_around
end module brz_backend
