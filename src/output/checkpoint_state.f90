! SPDX-License-Identifier: MIT
!> What a checkpoint holds: everything that a run needs to go on to the same bits.
!>
!> Left out is what the set-up or the parts themselves derive from it: neighbour lists (from
!> x_built), volumes, wall lists, bins, fluxes. Arrays are allocated by the set-up of the scene
!> before they are read, so their shapes are checked against the file.
module brz_checkpoint_state
    use, intrinsic :: iso_c_binding, only: c_f_pointer
    use brz_air_diagnostics, only: air_diagnostics_t, carry_diagnostics, keep_in_air, look_at_air
    use brz_air_state, only: air_t
    use brz_carry, only: carry
    use brz_clock, only: clock_t, resume_clock
    use brz_coupling_state, only: coupling_t
    use brz_cut_cells, only: cut_cells_t
    use brz_energy_account, only: energy_account_t
    use brz_errors, only: error_t, failed
    use brz_hdf5_array, only: h5_shape
    use brz_hdf5_file, only: h5_has, h5_t
    use brz_kept_cells, only: kept_cells_t
    use brz_motion, only: motion_t
    use brz_kinds, only: dp, int16, int32, int64, int8, real32, real64, rk
    use brz_solid_fields, only: field_t, fields_of, fields_t, is_double, is_integer, &
        is_short, is_single
    use brz_scheme, only: max_var
    use brz_bodies, only: bodies_t
    use brz_listed_bodies, only: listed_bodies_t
    use brz_interacting_bodies, only: interacting_bodies_t
    use brz_text, only: to_text
    implicit none
    private
    public :: carry_clock, carry_air, carry_solid, carry_coupling

contains

    subroutine carry_clock(file, clock, err)
        type(h5_t), intent(in) :: file
        type(clock_t), intent(inout) :: clock
        type(error_t), intent(inout) :: err

        call carry(file, 'clock/time', clock%time, err)
        call carry(file, 'clock/dt', clock%dt, err)
        call carry(file, 'clock/cycle', clock%cycle, err)
        call carry(file, 'clock/dump_number', clock%dump_number, err)
        call carry(file, 'clock/dump_time', clock%dump_time, err)
        call carry(file, 'clock/history_bytes', clock%marks%bytes, err)
        call carry(file, 'clock/history_sums', clock%marks%sum, err)
        if (.not. (file%writing .or. failed(err))) call resume_clock(clock)
    end subroutine carry_clock

    subroutine carry_air(file, air, err)
        type(h5_t), intent(in) :: file
        type(air_t), intent(inout) :: air
        type(error_t), intent(inout) :: err
        type(air_diagnostics_t) :: diagnostics

        call carry(file, 'air/u', air%u, err)
        call carry(file, 'air/reached', air%reached, err)
        diagnostics = look_at_air(air)
        call carry_diagnostics(file, diagnostics, err)
        if (.not. (file%writing .or. failed(err))) call keep_in_air(diagnostics, air)
    end subroutine carry_air

    subroutine carry_solid(file, solid, err)
        type(h5_t), intent(in) :: file
        class(interacting_bodies_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        call carry(file, 'solid/time', solid%time, err)
        call carry(file, 'solid/dt_last', solid%dt_last, err)
        call carry(file, 'solid/dt_limit', solid%dt_limit, err)
        call carry(file, 'solid/steps', solid%steps, err)
        call carry(file, 'solid/rebuilds', solid%rebuilds, err)
        call carry_fields(file, solid, err)
        call carry_bodies(file, solid, err)
        call carry_body_pair_force(file, solid, err)
        if (.not. solid%cohesive%present) return
        call carry(file, 'solid/interface_damage', solid%cohesive%damage, err)
        call carry(file, 'solid/interface_spent', solid%cohesive%spent, err)
        call carry(file, 'solid/interface_held', solid%cohesive%held, err)
    end subroutine carry_solid

    !> Forces and impulses between two bodies; from zero where the deck asks for them only now.
    subroutine carry_body_pair_force(file, solid, err)
        type(h5_t), intent(in) :: file
        class(interacting_bodies_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        character(:), allocatable :: name
        real(dp) :: state(6)
        integer :: k

        if (.not. allocated(solid%between)) return
        do k = 1, size(solid%between)
            associate (between => solid%between(k))
                name = 'solid/between_'//to_text(between%body(1))//'_'//to_text(between%body(2))
                if (.not. file%writing) then
                    if (.not. h5_has(file, name)) cycle
                end if
                state = [between%force, between%impulse]
                call carry(file, name, state, err)
                between%force = state(1:3)
                between%impulse = state(4:6)
            end associate
        end do
    end subroutine carry_body_pair_force

    !> All fields of the particles that nothing else gives. Checkpoints up to November 2026 call one
    !> of them `cut`.
    subroutine carry_fields(file, solid, err)
        type(h5_t), intent(in) :: file
        class(listed_bodies_t), intent(inout), target :: solid
        type(error_t), intent(inout) :: err
        type(fields_t) :: fields
        integer :: k

        call fields_of(solid, fields)
        do k = 1, fields%n
            if (.not. fields%of(k)%kept) cycle
            if (fields%of(k)%name == 'limp' .and. .not. file%writing) then
                if (h5_has(file, 'solid/cut')) fields%of(k)%name = 'cut'
            end if
            call carry_field(file, fields%of(k), solid%n, err)
        end do
    end subroutine carry_fields

    subroutine carry_field(file, field, n, err)
        type(h5_t), intent(in) :: file
        type(field_t), intent(in) :: field
        integer, intent(in) :: n !! particles
        type(error_t), intent(inout) :: err
        real(real64), pointer :: double(:, :), double_of(:)
        real(real32), pointer :: single(:, :), single_of(:)
        integer(int32), pointer :: number(:)
        integer(int16), pointer :: short(:)
        integer(int8), pointer :: byte(:)
        character(:), allocatable :: name

        name = 'solid/'//trim(field%name)
        select case (field%kind)
        case (is_double)
            call c_f_pointer(field%values, double, [field%rows, n])
            call c_f_pointer(field%values, double_of, [n])
            if (field%flat) call carry(file, name, double_of, err)
            if (.not. field%flat) call carry(file, name, double, err)
        case (is_single)
            call c_f_pointer(field%values, single, [field%rows, n])
            call c_f_pointer(field%values, single_of, [n])
            if (field%flat) call carry(file, name, single_of, err)
            if (.not. field%flat) call carry(file, name, single, err)
        case (is_integer)
            call c_f_pointer(field%values, number, [n])
            call carry(file, name, number, err)
        case (is_short)
            call c_f_pointer(field%values, short, [n])
            call carry(file, name, short, err)
        case default
            call c_f_pointer(field%values, byte, [n])
            call carry(file, name, byte, err)
        end select
    end subroutine carry_field

    !> The sums that each body keeps: its reaction, its impulse and, whatever components it may
    !> get, its energy account.
    subroutine carry_bodies(file, solid, err)
        type(h5_t), intent(in) :: file
        class(listed_bodies_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        type(energy_account_t), parameter :: empty = energy_account_t()
        integer, parameter :: n = size(transfer(empty, [0.0_dp])) ! all components are real(dp)
        real(dp) :: sums(6 + n, size(solid%bodies)), limit(size(solid%bodies))
        integer(int8) :: inactive(size(solid%bodies))
        integer :: b

        do b = 1, size(solid%bodies)
            sums(1:6, b) = [solid%bodies(b)%reaction, solid%bodies(b)%impulse]
            sums(7:, b) = transfer(solid%bodies(b)%account, sums(7:, b))
        end do
        limit = solid%bodies%dt_limit
        inactive = merge(1_int8, 0_int8, solid%bodies%inactive)
        call carry(file, 'solid/body_sums', sums, err)
        call carry(file, 'solid/body_limit', limit, err)
        call carry(file, 'solid/body_asleep', inactive, err)
        do b = 1, size(solid%bodies)
            solid%bodies(b)%reaction = sums(1:3, b)
            solid%bodies(b)%impulse = sums(4:6, b)
            solid%bodies(b)%account = transfer(sums(7:, b), empty)
        end do
        solid%bodies%dt_limit = limit
        solid%bodies%inactive = inactive == 1
        call carry_drifts(file, solid, err)
        call carry_rigid(file, solid, err)
    end subroutine carry_bodies

    !> What the lists are measured by.
    subroutine carry_drifts(file, solid, err)
        type(h5_t), intent(in) :: file
        class(listed_bodies_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        real(dp) :: state(6, size(solid%bodies)), cells(7, size(solid%bodies))
        real(dp) :: apart(3*size(solid%bodies), size(solid%bodies))
        integer :: b
        logical :: there

        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b))
                state(:, b) = [body%drift, body%drift_velocity]
                cells(:, b) = [body%cells%lo, real([body%cells%along, body%cells%renewals], dp)]
            end associate
        end do
        call carry(file, 'solid/body_drift', state, err)
        there = file%writing
        if (.not. there) there = h5_has(file, 'solid/body_cells')
        if (there) call carry(file, 'solid/body_cells', cells, err)
        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b))
                body%drift = state(1:3, b)
                body%drift_velocity = state(4:6, b)
                body%cells = kept_cells_t(nint(cells(7, b)), nint(cells(4:6, b)), cells(1:3, b))
            end associate
        end do
        if (.not. solid%links%present) return
        apart = reshape(solid%links%drift, shape(apart))
        call carry(file, 'solid/links_drift', apart, err)
        solid%links%drift = reshape(apart, shape(solid%links%drift))
    end subroutine carry_drifts

    !> The motion of rigid and driven bodies.
    subroutine carry_rigid(file, solid, err)
        type(h5_t), intent(in) :: file
        class(bodies_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        real(dp) :: state(34, size(solid%bodies))
        integer :: b

        do b = 1, size(solid%bodies)
            associate (r => solid%bodies(b)%rigid)
                state(:, b) = [r%x, r%q, r%p, r%l, r%force, r%torque, r%omega, r%spin, &
                               solid%bodies(b)%motion%force, r%load]
            end associate
        end do
        call carry(file, 'solid/rigid', state, err)
        do b = 1, size(solid%bodies)
            associate (r => solid%bodies(b)%rigid)
                r%x = state(1:3, b)
                r%q = state(4:7, b)
                r%p = state(8:10, b)
                r%l = state(11:13, b)
                r%force = state(14:16, b)
                r%torque = state(17:19, b)
                r%omega = state(20:22, b)
                r%spin = state(23:25, b)
                solid%bodies(b)%motion%force = state(26:28, b)
                r%load = state(29:34, b)
            end associate
            if (allocated(solid%bodies(b)%regions)) call carry_regions(file, b, &
                                                                     solid%bodies(b)%regions, err)
        end do
    end subroutine carry_rigid

    !> Forces on the regions of body b that are moved.
    subroutine carry_regions(file, b, regions, err)
        type(h5_t), intent(in) :: file
        integer, intent(in) :: b
        type(motion_t), intent(inout) :: regions(:)
        type(error_t), intent(inout) :: err
        real(dp) :: state(6, size(regions))
        integer :: m

        do m = 1, size(regions)
            state(:, m) = [regions(m)%force, regions(m)%reaction_force]
        end do
        call carry(file, 'solid/regions_'//to_text(b), state, err)
        do m = 1, size(regions)
            regions(m)%force = state(1:3, m)
            regions(m)%reaction_force = state(4:6, m)
        end do
    end subroutine carry_regions

    subroutine carry_coupling(file, coupling, err)
        type(h5_t), intent(in) :: file
        type(coupling_t), intent(inout) :: coupling
        type(error_t), intent(inout) :: err

        logical :: mapped !! the map of one process is there; it follows from the particles, too

        mapped = allocated(coupling%wall%solid)
        if (mapped .and. .not. file%writing) mapped = h5_has(file, 'coupling/solid')
        if (mapped) call carry(file, 'coupling/solid', coupling%wall%solid, err)
        call carry(file, 'coupling/dt_before', coupling%dt_before, err)
        call carry(file, 'coupling/v_before', coupling%v_before, err)
        call carry(file, 'coupling/work', coupling%diagnostics%work, err)
        call carry(file, 'coupling/work_reference', coupling%diagnostics%work_reference, err)
        call carry(file, 'coupling/impulse', coupling%diagnostics%impulse, err)
        call carry(file, 'coupling/impulse_reference', coupling%diagnostics%impulse_reference, err)
        if (coupling%wall%cells%present) call carry_cut_cells(file, coupling%wall%cells, err)
    end subroutine carry_coupling

    !> What the listed cut cells hold, in the order of the list, which follows from the particles.
    subroutine carry_cut_cells(file, cells, err)
        type(h5_t), intent(in) :: file
        type(cut_cells_t), intent(inout) :: cells
        type(error_t), intent(inout) :: err
        integer(int64), allocatable :: shape_there(:)
        integer(int32), allocatable :: cell(:), master(:), shut(:)
        real(rk), allocatable :: kept(:, :), volume(:)
        integer :: n

        if (file%writing) then
            n = cells%n
            cell = cells%cell(:n)
            volume = cells%volume(:n)
            kept = cells%kept(:, :n)
            shut = cells%shut(:n)
            master = cells%master(:n)
        else
            call h5_shape(file, 'coupling/gas_volume', shape_there, err)
            if (failed(err)) return
            n = int(shape_there(1))
            allocate (cell(n), volume(n), kept(max_var + 1, n), shut(n), master(n))
        end if
        call carry(file, 'coupling/cell', cell, err)
        call carry(file, 'coupling/gas_volume', volume, err)
        call carry(file, 'coupling/waiting', kept, err)
        call carry(file, 'coupling/shut', shut, err)
        call carry(file, 'coupling/master', master, err)
        if (file%writing) return
        cells%before%n = n
        cells%resumes = .true.
        call move_alloc(cell, cells%before%cell)
        call move_alloc(volume, cells%before%volume)
        call move_alloc(kept, cells%before%kept)
        call move_alloc(shut, cells%before%shut)
        call move_alloc(master, cells%before%master)
    end subroutine carry_cut_cells

end module brz_checkpoint_state
