! SPDX-License-Identifier: MIT
!> Initial velocity and stress of a body from the points of a file: a table, or a dump of particles.
!>
!> A particle takes what the nearest point has. With the stress of a dump that is the point of the
!> unloaded body, and the particle is moved by its displacement. A stress is that of a body that is
!> strained as Hooke says; so it is for linear_elastic alone.
module brz_start_fields
    use brz_body, only: body_t
    use brz_case, only: body_case_t, label
    use brz_csv_table, only: read_columns
    use brz_errors, only: error_t, exit_deck, failed, raise
    use brz_formulation_names, only: form_bending, form_corrected_hourglass, form_rigid, form_total
    use brz_hdf5_array, only: h5_read, h5_shape
    use brz_hdf5_file, only: h5_close, h5_open, h5_t
    use brz_kinds, only: dp, int64, real32, rk
    use brz_material, only: material_t
    use brz_nearest_point, only: nearest_point
    use brz_particle_file, only: read_triples
    use brz_row_order, only: order_rows
    use brz_particles, only: particles_t
    use brz_bodies, only: bodies_t
    use brz_text, only: to_text
    implicit none
    private
    public :: move_from_dump, start_from_file

    character(10), parameter :: names(18) = [character(10) :: 'x', 'y', 'z', 'velocity_x', &
        'velocity_y', 'velocity_z', 'stress_xx', 'stress_yy', 'stress_zz', 'stress_xy', &
        'stress_yz', 'stress_xz', 'strain_xx', 'strain_yy', 'strain_zz', 'strain_xy', &
        'strain_yz', 'strain_xz']

contains

    !> Add the velocities of the file to those of a body, and set its stress.
    subroutine start_from_file(input, hooke, solid, body, err)
        type(body_case_t), intent(in) :: input
        logical, intent(in) :: hooke !! its material is linear_elastic
        class(bodies_t), intent(inout) :: solid
        type(body_t), intent(in) :: body
        type(error_t), intent(inout) :: err
        real(dp), allocatable :: values(:, :) !! (names, points)
        integer, allocatable :: order(:)
        integer :: i, n
        logical :: found(size(names))
        real(dp) :: largest

        if (input%start_file == '' .or. failed(err)) return
        n = solid%dimension
        if (index(input%start_file, '.csv') > 0) then
            call read_columns(trim(input%start_file), names, values, found, err)
        else
            call read_dump(trim(input%start_file), input%start_stress, lies_as_dumped(input), &
                           values, found, largest, err)
            if (input%start_stress .and. lies_as_dumped(input) .and. any(body%formulation == &
                [form_bending, form_total, form_corrected_hourglass])) call refuse('is a dump '// &
                'at whose points the body lies, as if it were unloaded there: this formulation '// &
                'would forget what it holds; lay the body as the run did that wrote the dump')
            if (largest > 0 .and. .not. input%start_stress) solid%notes = solid%notes// &
                label('body', input%id, input%place)//'warning: the body starts with the '// &
                'velocities of start_file, without its stresses of up to '//to_text(real( &
                largest, real32))//' Pa; to go on from there, use a checkpoint (--restart)'// &
                new_line('a')
        end if
        if (failed(err)) return
        if (.not. all(found(:n)) .or. .not. any(found(4:))) &
            call refuse('must have the columns x, y, z and velocity_x, ..., stress_xx, ... or '// &
            'strain_xx, ...')
        if (any(found(7:12)) .and. any(found(13:))) &
            call refuse('has stresses and strains; take one of them out')
        if (body%formulation == form_rigid) &
            call refuse('is for bodies that deform; give a rigid one velocity and spin')
        if (any(found(7:)) .and. .not. hooke) call refuse('has stresses or strains, and only a '// &
            "body of model='linear_elastic' can start with these; take them out")
        if (failed(err)) return
        allocate (order(size(values, 2)))
        call order_rows(values(1:1, :), order)
        do i = body%first, body%last
            associate (row => values(:, nearest_point(values(:n, :), order, solid%x(:n, i))))
                solid%v(:n, i) = solid%v(:n, i) + real(row(4:3 + n), rk)
                if (any(found(13:))) row(7:12) = hooke_stress(solid%materials(body%material), &
                                                              row(13:18))
                if (any(found(7:))) call strain(solid%materials(body%material), row(7:12), &
                    solid%stress(:, i), solid%mu(i), solid%energy(i))
            end associate
        end do

    contains

        subroutine refuse(why)
            character(*), intent(in) :: why

            call raise(err, exit_deck, label('body', input%id, input%place)//'start_file '//why)
        end subroutine refuse
    end subroutine start_from_file

    !> Stress of Hooke's material under a small strain, shear components those of the tensor [Pa].
    pure function hooke_stress(material, e) result(stress)
        type(material_t), intent(in) :: material
        real(dp), intent(in) :: e(6)
        real(dp) :: stress(6), trace

        trace = sum(e(1:3))
        stress = 2*material%shear*e
        stress(1:3) = stress(1:3) + (material%bulk - 2*material%shear/3)*trace
    end function hooke_stress

    !> A point of Hooke's material under a stress: with its compression and its elastic energy.
    pure subroutine strain(material, given, stress, mu, energy)
        type(material_t), intent(in) :: material
        real(dp), intent(in) :: given(6) !! [Pa]
        real(rk), intent(out) :: stress(6), mu, energy !! [Pa], [-], [J/kg]
        real(dp) :: p, s(6)

        p = -sum(given(1:3))/3
        s = given
        s(1:3) = s(1:3) + p
        stress = real(given, rk)
        mu = real(p/material%bulk, rk)
        energy = real(p*p/(2*material%bulk)/material%density, rk)
        if (material%shear > 0) energy = energy + real((sum(s(1:3)**2) + 2*sum(s(4:6)**2)) &
            /(4*material%shear)/material%density, rk)
    end subroutine strain

    !> Move the particles of a body that takes its stress from a dump by the displacements there:
    !> what holds them to the unloaded body then has the forces that it had. To be called once
    !> supports have their particles, which are known by their places in the unloaded body.
    subroutine move_from_dump(input, solid, body, err)
        type(body_case_t), intent(in) :: input
        class(particles_t), intent(inout) :: solid
        type(body_t), intent(in) :: body
        type(error_t), intent(inout) :: err
        type(h5_t) :: file
        real(dp), allocatable :: x(:, :), d(:, :)
        integer, allocatable :: order(:)
        integer :: i, n

        if (input%start_file == '' .or. .not. input%start_stress .or. failed(err)) return
        if (lies_as_dumped(input)) return
        if (index(input%start_file, '.csv') > 0) return
        n = solid%dimension
        call h5_open(file, trim(input%start_file), err)
        call read_triples(file, 'VTKHDF/Points', x, err)
        call read_triples(file, 'VTKHDF/PointData/displacement', d, err)
        call h5_close(file, err)
        if (failed(err)) return
        x = x - d
        allocate (order(size(x, 2)))
        call order_rows(x(1:1, :), order)
        do i = body%first, body%last
            solid%x(:n, i) = solid%x(:n, i) + d(:n, nearest_point(x(:n, :), order, solid%x(:n, i)))
        end do
    end subroutine move_from_dump

    !> True for a body of the points of a dump, which lies displaced, as if unloaded there.
    pure logical function lies_as_dumped(input)
        type(body_case_t), intent(in) :: input

        lies_as_dumped = input%shape == 'particles' .and. index(input%file, '.csv') == 0
    end function lies_as_dumped

    !> Points, velocity and, if asked for, stress of a dump of particles. With the stress the points
    !> are those of the unloaded body, unless the body lies as the dump does.
    subroutine read_dump(path, stress, displaced, values, found, largest, err)
        character(*), intent(in) :: path
        logical, intent(in) :: stress
        logical, intent(in) :: displaced !! the body lies as the dump does
        real(dp), allocatable, intent(out) :: values(:, :)
        logical, intent(out) :: found(:)
        real(dp), intent(out) :: largest !! stress of the dump [Pa]
        type(error_t), intent(inout) :: err
        type(h5_t) :: file
        type(error_t) :: absent
        integer(int64), allocatable :: dims(:)
        real(dp), allocatable :: x(:, :), v(:, :), d(:, :), s(:, :)

        found = .false.
        largest = 0
        call h5_open(file, path, err)
        call read_triples(file, 'VTKHDF/Points', x, err)
        call read_triples(file, 'VTKHDF/PointData/velocity', v, err)
        if (failed(err)) return
        allocate (values(size(names), size(x, 2)), source=0.0_dp)
        values(1:3, :) = x
        values(4:6, :) = v
        found(1:6) = .true.
        found(7:12) = stress
        allocate (s(6, size(x, 2)), source=0.0_dp)
        call h5_shape(file, 'VTKHDF/PointData/stress', dims, absent)
        if (stress .or. .not. failed(absent)) call h5_read(file, 'VTKHDF/PointData/stress', s, err)
        if (size(s) > 0) largest = maxval(abs(s))
        if (stress) values(7:12, :) = s
        if (stress .and. .not. displaced) then
            call read_triples(file, 'VTKHDF/PointData/displacement', d, err)
            if (failed(err)) return
            values(1:3, :) = values(1:3, :) - d
        end if
        call h5_close(file, err)
    end subroutine read_dump
end module brz_start_fields
