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
    use brz_kinds, only: int8, int32, int64, real32, rk
    use brz_material, only: n_hist
    use brz_materials, only: history_names
    use brz_meta, only: meta_t
    use brz_solid_state, only: solid_t
    use brz_solid_sums, only: velocity_at_step
    use brz_wide_lattice, only: unloaded_place
    use brz_vtkhdf, only: begin_dump, end_dump, root, write_field
    implicit none
    private
    public :: write_solid_dump

contains

    !> Write the particles to `path`.
    subroutine write_solid_dump(path, solid, materials, meta, err)
        character(*), intent(in) :: path
        type(solid_t), intent(in) :: solid
        character(*), intent(in) :: materials(:) !! names of them
        type(meta_t), intent(in) :: meta
        type(error_t), intent(inout) :: err
        type(h5_t) :: file
        integer, allocatable :: order(:)

        call order_by_number(solid, order)
        call begin_dump(file, path, 'PolyData', err)
        call write_points(file, solid, order, err)
        call write_cells(file, solid%n, err)
        call write_motion(file, solid, order, err)
        call write_stress(file, solid, order, err)
        call write_history(file, solid, order, err)
        if (solid%cohesive%present) call write_interfaces(file, solid, order, err)
        call h5_write(file, root//'/FieldData/body_names', solid%bodies%id, err)
        call h5_write(file, root//'/FieldData/material_names', materials, err)
        call end_dump(file, meta, err)
    end subroutine write_solid_dump

    !> Places of the particles in the order of their numbers.
    subroutine order_by_number(solid, order)
        type(solid_t), intent(in) :: solid
        integer, allocatable, intent(out) :: order(:) !! (n)
        integer, allocatable :: place(:)
        integer :: i

        if (solid%n == 0) then
            allocate (order(0))
            return
        end if
        allocate (place(maxval(solid%id)), source=0)
        do i = 1, solid%n
            place(solid%id(i)) = i
        end do
        order = pack(place, place > 0)
    end subroutine order_by_number

    !> Position and who is who.
    subroutine write_points(file, solid, order, err)
        type(h5_t), intent(in) :: file
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: order(:)
        type(error_t), intent(inout) :: err
        integer(int32), allocatable :: body(:), material(:)
        integer :: b

        allocate (body(solid%n), material(solid%n))
        do b = 1, size(solid%bodies)
            associate (i => solid%bodies(b)%first, j => solid%bodies(b)%last)
                body(i:j) = b
                material(i:j) = solid%bodies(b)%material
            end associate
        end do
        call h5_write(file, root//'/NumberOfPoints', [int(solid%n, int64)], err)
        call write_field(file, 'Points', 'm', real(solid%x(:, order), real32), err)
        call write_field(file, 'PointData/id', '-', solid%id(order), err)
        call write_field(file, 'PointData/body', '-', body(order), err)
        call write_field(file, 'PointData/material', '-', material(order), err)
        call write_field(file, 'PointData/ply', '-', int(solid%ply(order), int32), err)
        call write_field(file, 'PointData/fixed', '-', int(solid%fixed(order), int8), err)
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
    subroutine write_motion(file, solid, order, err)
        type(h5_t), intent(in) :: file
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: order(:)
        type(error_t), intent(inout) :: err
        real(real32), allocatable :: v(:, :), d(:, :)
        integer :: b, i

        allocate (v(3, solid%n), d(3, solid%n))
        do b = 1, size(solid%bodies)
            do i = solid%bodies(b)%first, solid%bodies(b)%last
                v(:, i) = real(velocity_at_step(solid, i), real32)
                d(:, i) = real(solid%x(:, i) - unloaded_place(solid, b, i), real32)
            end do
        end do
        v = v(:, order)
        d = d(:, order)
        call write_field(file, 'PointData/velocity', 'm/s', v, err)
        call write_field(file, 'PointData/displacement', 'm', d, err)
    end subroutine write_motion

    !> Stress with its invariants, mass, density and volume, damage and energy.
    subroutine write_stress(file, solid, order, err)
        type(h5_t), intent(in) :: file
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: order(:)
        type(error_t), intent(inout) :: err
        real(real32), allocatable :: p(:), mises(:), density(:), mass(:)
        real(rk) :: s(6), mean
        integer :: b, i, k

        allocate (p(solid%n), mises(solid%n), density(solid%n))
        do k = 1, solid%n
            s = solid%stress(:, order(k))
            mean = (s(1) + s(2) + s(3))/3
            s(1:3) = s(1:3) - mean
            p(k) = real(-mean, real32)
            mises(k) = real(sqrt(1.5_rk*(dot_product(s(1:3), s(1:3)) &
                                         + 2*dot_product(s(4:6), s(4:6)))), real32)
        end do
        do b = 1, size(solid%bodies)
            do i = solid%bodies(b)%first, solid%bodies(b)%last
                density(i) = real(solid%materials(solid%bodies(b)%material)%density &
                                  *(1 + solid%mu(i)), real32)
            end do
        end do
        call write_field(file, 'PointData/stress', 'Pa', real(solid%stress(:, order), real32), err)
        call write_field(file, 'PointData/pressure', 'Pa', p, err)
        call write_field(file, 'PointData/von_mises', 'Pa', mises, err)
        mass = real(solid%mass, real32)
        call write_field(file, 'PointData/mass', 'kg', mass(order), err)
        call write_field(file, 'PointData/density', 'kg/m3', density(order), err)
        call write_field(file, 'PointData/volume', 'm3', mass(order)/density(order), err)
        call write_field(file, 'PointData/energy', 'J/kg', real(solid%energy(order), real32), err)
        call write_field(file, 'PointData/damage', '-', real(solid%damage(order), real32), err)
    end subroutine write_stress

    !> Cohesive interfaces: damage of the points beside each particle, the largest of them; in the
    !> field data the points themselves, at the particle of their near side in the unloaded body.
    subroutine write_interfaces(file, solid, order, err)
        type(h5_t), intent(in) :: file
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: order(:)
        type(error_t), intent(inout) :: err
        real(real32), allocatable :: field(:), at(:, :)
        character(68) :: names(size(solid%cohesive%law))
        integer :: i, k, p, s

        allocate (field(solid%n), source=0.0_real32)
        allocate (at(3, solid%cohesive%n))
        associate (glue => solid%cohesive)
            do p = 1, glue%n
                do s = 1, 2
                    i = glue%place(glue%beside(s, p))
                    field(i) = max(field(i), real(glue%damage(p), real32))
                    if (s == 1) at(:, p) = real(solid%x_ref(:, i), real32)
                end do
            end do
            do k = 1, size(names)
                names(k) = interface_name(solid, k)
            end do
            call write_field(file, 'PointData/bond_damage', '-', field(order), err)
            call write_field(file, 'FieldData/interface_at', 'm', at, err)
            call write_field(file, 'FieldData/interface', '-', glue%of, err)
            call write_field(file, 'FieldData/interface_damage', '-', &
                             real(glue%damage, real32), err)
            call write_field(file, 'FieldData/interface_area', 'm2', real(glue%area, real32), err)
            call h5_write(file, root//'/FieldData/interface_names', names, err)
        end associate
    end subroutine write_interfaces

    !> Named history variables: each name once, filled in by every body whose material has it.
    subroutine write_history(file, solid, order, err)
        type(h5_t), intent(in) :: file
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: order(:)
        type(error_t), intent(inout) :: err
        character(32) :: names(n_hist, size(solid%materials))
        character(12) :: units(n_hist, size(solid%materials))
        real(real32), allocatable :: field(:)
        integer :: m, slot

        do m = 1, size(solid%materials)
            call history_names(solid%materials(m), names(:, m), units(:, m))
        end do
        allocate (field(solid%n))
        do m = 1, size(solid%materials)
            do slot = 1, min(n_hist, solid%n_hist)
                if (names(slot, m) == '' .or. any(names(:, :m - 1) == names(slot, m))) cycle
                call gather_history(solid, names, names(slot, m), field)
                call write_field(file, 'PointData/'//trim(names(slot, m)), trim(units(slot, m)), &
                                 field(order), err)
            end do
        end do
    end subroutine write_history

    !> One history variable by name.
    subroutine gather_history(solid, names, name, field)
        type(solid_t), intent(in) :: solid
        character(*), intent(in) :: names(:, :) !! (slot, material)
        character(*), intent(in) :: name
        real(real32), intent(out) :: field(:) !! (n)
        integer :: b, slot

        field = 0
        do b = 1, size(solid%bodies)
            slot = findloc(names(:, solid%bodies(b)%material), name, dim=1)
            if (slot == 0 .or. slot > solid%n_hist) cycle
            associate (i => solid%bodies(b)%first, j => solid%bodies(b)%last)
                field(i:j) = real(solid%hist(slot, i:j), real32)
            end associate
        end do
    end subroutine gather_history
end module brz_solid_dump
