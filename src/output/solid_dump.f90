! SPDX-License-Identifier: MIT
!> Dump of the bodies: a VTKHDF cloud of points with one vertex cell per particle.
!>
!> Particles stand in the order of their numbers, so row i is the same particle in every dump of a
!> run, although the solver sorts them again and again. `body` and `material` are places, from 1,
!> in the lists of names in the field data. The volume of a particle is that of the moment. Fields
!> of the material history appear under the names that the models give them; particles of other
!> materials have 0 there.
module brz_solid_dump
    use brz_cohesive_setup, only: interface_name
    use brz_errors, only: error_t
    use brz_hdf5_array, only: h5_write
    use brz_hdf5_file, only: h5_t
    use brz_kinds, only: int8, int32, int64, real32, real64, rk
    use brz_material, only: n_hist
    use brz_materials, only: history_names
    use brz_meta, only: meta_t
    use brz_bodies, only: bodies_t
    use brz_interacting_bodies, only: interacting_bodies_t
    use brz_step_velocity, only: velocity_at_step
    use brz_tensile_control, only: largest_tension
    use brz_wide_lattice, only: unloaded_place
    use brz_vtkhdf, only: begin_dump, end_dump, root, write_field
    implicit none
    private
    public :: write_solid_dump

    !> Rows of a dump: the place of the particle that stands there, and its body.
    type :: dump_rows_t
        integer :: n = 0
        integer, allocatable :: place(:), body(:) !! (n)
    end type dump_rows_t

contains

    !> Write the particles to `path`.
    subroutine write_solid_dump(path, solid, materials, meta, err)
        character(*), intent(in) :: path
        class(interacting_bodies_t), intent(in) :: solid
        character(*), intent(in) :: materials(:) !! names of them
        type(meta_t), intent(in) :: meta
        type(error_t), intent(inout) :: err
        type(h5_t) :: file
        type(dump_rows_t) :: rows

        call order_by_number(solid, rows)
        call begin_dump(file, path, 'PolyData', err)
        call write_points(file, solid, rows, err)
        call write_cells(file, solid%n, err)
        call write_motion(file, solid, rows, err)
        call write_stress(file, solid, rows, err)
        call write_history(file, solid, rows, err)
        if (solid%cohesive%present) call write_interfaces(file, solid, rows, err)
        call h5_write(file, root//'/FieldData/body_names', solid%bodies%id, err)
        call h5_write(file, root//'/FieldData/material_names', materials, err)
        call end_dump(file, meta, err)
    end subroutine write_solid_dump

    !> The particles in the order of their numbers.
    subroutine order_by_number(solid, rows)
        class(bodies_t), intent(in) :: solid
        type(dump_rows_t), intent(out) :: rows
        integer, allocatable :: place(:)
        integer :: body(solid%n), b, i

        do b = 1, size(solid%bodies)
            body(solid%bodies(b)%first:solid%bodies(b)%last) = b
        end do
        allocate (place(maxval([0, solid%id(:solid%n)])), source=0)
        do i = 1, solid%n
            place(solid%id(i)) = i
        end do
        rows%n = solid%n
        rows%place = pack(place, place > 0)
        rows%body = body(rows%place)
    end subroutine order_by_number

    !> Position, in real64: bodies may lie far from the origin. And who is who.
    subroutine write_points(file, solid, rows, err)
        type(h5_t), intent(in) :: file
        class(bodies_t), intent(in) :: solid
        type(dump_rows_t), intent(in) :: rows
        type(error_t), intent(inout) :: err
        real(real64) :: x(3, rows%n)
        integer(int32) :: id(rows%n), material(rows%n), ply(rows%n)
        integer(int8) :: fixed(rows%n)
        integer :: k

        !$omp parallel do schedule(static)
        do k = 1, rows%n
            associate (i => rows%place(k))
                x(:, k) = real(solid%x(:, i), real64)
                id(k) = solid%id(i)
                material(k) = solid%bodies(rows%body(k))%material
                ply(k) = solid%ply(i)
                fixed(k) = int(solid%fixed(i), int8)
            end associate
        end do
        call h5_write(file, root//'/NumberOfPoints', [int(rows%n, int64)], err)
        call write_field(file, 'Points', 'm', x, err)
        call write_field(file, 'PointData/id', '-', id, err)
        call write_field(file, 'PointData/body', '-', rows%body, err)
        call write_field(file, 'PointData/material', '-', material, err)
        call write_field(file, 'PointData/ply', '-', ply, err)
        call write_field(file, 'PointData/fixed', '-', fixed, err)
    end subroutine write_points

    !> One vertex per particle; no lines, polygons and strips.
    subroutine write_cells(file, n, err)
        type(h5_t), intent(in) :: file
        integer, intent(in) :: n
        type(error_t), intent(inout) :: err
        character(*), parameter :: empty(3) = [character(8) :: 'Lines', 'Polygons', 'Strips']
        integer(int64) :: i

        call write_topology(file, 'Vertices', [(i, i=0, n)], err)
        do i = 1, 3
            call write_topology(file, trim(empty(i)), [0_int64], err)
        end do
    end subroutine write_cells

    subroutine write_topology(file, kind, offsets, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: kind
        integer(int64), intent(in) :: offsets(:) !! (cells + 1) 0, 1, 2, ...
        type(error_t), intent(inout) :: err
        character(:), allocatable :: group
        integer :: cells

        group = root//'/'//kind
        cells = size(offsets) - 1
        call h5_write(file, group//'/NumberOfCells', [int(cells, int64)], err)
        call h5_write(file, group//'/NumberOfConnectivityIds', [int(cells, int64)], err)
        call h5_write(file, group//'/Offsets', offsets, err)
        call h5_write(file, group//'/Connectivity', offsets(:cells), err)
    end subroutine write_topology

    !> Velocity at the step and displacement from the unloaded body.
    subroutine write_motion(file, solid, rows, err)
        type(h5_t), intent(in) :: file
        class(bodies_t), intent(in) :: solid
        type(dump_rows_t), intent(in) :: rows
        type(error_t), intent(inout) :: err
        real(real32) :: v(3, rows%n), d(3, rows%n)
        integer :: k

        !$omp parallel do schedule(static)
        do k = 1, rows%n
            associate (i => rows%place(k))
                v(:, k) = real(velocity_at_step(solid, i), real32)
                d(:, k) = real(solid%x(:, i) - unloaded_place(solid, rows%body(k), i), real32)
            end associate
        end do
        call write_field(file, 'PointData/velocity', 'm/s', v, err)
        call write_field(file, 'PointData/displacement', 'm', d, err)
    end subroutine write_motion

    !> Stress with its invariants, mass, density and volume, damage and energy.
    subroutine write_stress(file, solid, rows, err)
        type(h5_t), intent(in) :: file
        class(bodies_t), intent(in) :: solid
        type(dump_rows_t), intent(in) :: rows
        type(error_t), intent(inout) :: err
        real(real32) :: stress(6, rows%n)
        real(real32), dimension(rows%n) :: p, mises, tension, mass, density, energy, damage
        integer :: k

        !$omp parallel do schedule(static)
        do k = 1, rows%n
            associate (i => rows%place(k))
                stress(:, k) = real(solid%stress(:, i), real32)
                call invariants(solid%stress(:, i), p(k), mises(k))
                tension(k) = real(largest_tension(solid%stress(:, i)), real32)
                mass(k) = real(solid%mass(i), real32)
                density(k) = real(solid%materials(solid%bodies(rows%body(k))%material)%density &
                                  *(1 + solid%mu(i)), real32)
                energy(k) = real(solid%energy(i), real32)
                damage(k) = real(solid%damage(i), real32)
            end associate
        end do
        call write_field(file, 'PointData/stress', 'Pa', stress, err)
        call write_field(file, 'PointData/pressure', 'Pa', p, err)
        call write_field(file, 'PointData/von_mises', 'Pa', mises, err)
        call write_field(file, 'PointData/principal_tension', 'Pa', tension, err)
        call write_field(file, 'PointData/mass', 'kg', mass, err)
        call write_field(file, 'PointData/density', 'kg/m3', density, err)
        call write_field(file, 'PointData/volume', 'm3', mass/density, err)
        call write_field(file, 'PointData/energy', 'J/kg', energy, err)
        call write_field(file, 'PointData/damage', '-', damage, err)
    end subroutine write_stress

    !> Pressure and von Mises stress [Pa].
    pure subroutine invariants(stress, p, mises)
        real(rk), intent(in) :: stress(6) !! [Pa]
        real(real32), intent(out) :: p, mises
        real(rk) :: s(6), mean

        s = stress
        mean = (s(1) + s(2) + s(3))/3
        s(1:3) = s(1:3) - mean
        p = real(-mean, real32)
        mises = real(sqrt(1.5_rk*(dot_product(s(1:3), s(1:3)) &
                                  + 2*dot_product(s(4:6), s(4:6)))), real32)
    end subroutine invariants

    !> Cohesive interfaces: damage of the points beside each particle, the largest of them; in the
    !> field data the points themselves, at the particle of their near side in the unloaded body.
    subroutine write_interfaces(file, solid, rows, err)
        type(h5_t), intent(in) :: file
        class(interacting_bodies_t), intent(in) :: solid
        type(dump_rows_t), intent(in) :: rows
        type(error_t), intent(inout) :: err
        real(real32), allocatable :: field(:)
        real(real64), allocatable :: at(:, :)
        character(68) :: names(size(solid%cohesive%law))
        integer :: i, k, p, s

        allocate (field(solid%n), source=0.0_real32)
        allocate (at(3, solid%cohesive%n))
        associate (cohesive => solid%cohesive)
            do p = 1, cohesive%n
                do s = 1, 2
                    i = cohesive%place(cohesive%beside(s, p))
                    field(i) = max(field(i), real(cohesive%damage(p), real32))
                    if (s == 1) at(:, p) = real(solid%x_ref(:, i), real64)
                end do
            end do
            do k = 1, size(names)
                names(k) = interface_name(solid, k)
            end do
            call write_field(file, 'PointData/bond_damage', '-', field(rows%place), err)
            call write_field(file, 'FieldData/interface_at', 'm', at, err)
            call write_field(file, 'FieldData/interface', '-', cohesive%of, err)
            call write_field(file, 'FieldData/interface_damage', '-', &
                             real(cohesive%damage, real32), err)
            call write_field(file, 'FieldData/interface_area', 'm2', real(cohesive%area, real32), &
                err)
            call h5_write(file, root//'/FieldData/interface_names', names, err)
        end associate
    end subroutine write_interfaces

    !> Named history variables: each name once, filled in by every body whose material has it.
    subroutine write_history(file, solid, rows, err)
        type(h5_t), intent(in) :: file
        class(bodies_t), intent(in) :: solid
        type(dump_rows_t), intent(in) :: rows
        type(error_t), intent(inout) :: err
        character(32) :: names(n_hist, size(solid%materials))
        character(12) :: units(n_hist, size(solid%materials))
        real(real32) :: field(rows%n)
        integer :: m, slot

        do m = 1, size(solid%materials)
            call history_names(solid%materials(m), names(:, m), units(:, m))
        end do
        do m = 1, size(solid%materials)
            do slot = 1, min(n_hist, solid%n_hist)
                if (names(slot, m) == '' .or. any(names(:, :m - 1) == names(slot, m))) cycle
                call gather_history(solid, rows, names, names(slot, m), field)
                call write_field(file, 'PointData/'//trim(names(slot, m)), trim(units(slot, m)), &
                                 field, err)
            end do
        end do
    end subroutine write_history

    !> One history variable by name; 0 where a material has none of it.
    subroutine gather_history(solid, rows, names, name, field)
        class(bodies_t), intent(in) :: solid
        type(dump_rows_t), intent(in) :: rows
        character(*), intent(in) :: names(:, :) !! (slot, material)
        character(*), intent(in) :: name
        real(real32), intent(out) :: field(:) !! (n)
        integer :: k, slot(size(solid%bodies))

        do k = 1, size(slot)
            slot(k) = findloc(names(:, solid%bodies(k)%material), name, dim=1)
        end do
        where (slot > solid%n_hist) slot = 0
        !$omp parallel do schedule(static)
        do k = 1, rows%n
            field(k) = 0
            if (slot(rows%body(k)) > 0) &
                field(k) = real(solid%hist(slot(rows%body(k)), rows%place(k)), real32)
        end do
    end subroutine gather_history
end module brz_solid_dump
