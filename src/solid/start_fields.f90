! SPDX-License-Identifier: MIT
!> Initial velocity and stress of a body from the points of a file: a table, or a dump of particles.
!>
!> A particle takes what the nearest point has. A stress is that of a body that is strained as Hooke
!> says and lies where the deck puts it; so it is for linear_elastic alone.
module brz_start_fields
    use brz_case, only: body_case_t, label
    use brz_csv_table, only: read_columns
    use brz_errors, only: error_t, exit_deck, failed, raise
    use brz_hdf5_file, only: h5_close, h5_open, h5_t
    use brz_kinds, only: dp, rk
    use brz_material, only: material_t
    use brz_nearest_point, only: nearest_point
    use brz_particle_file, only: read_triples
    use brz_row_order, only: order_rows
    use brz_solid_state, only: body_t, form_rigid, solid_t
    implicit none
    private
    public :: start_from_file

    character(10), parameter :: names(12) = [character(10) :: 'x', 'y', 'z', 'velocity_x', &
        'velocity_y', 'velocity_z', 'stress_xx', 'stress_yy', 'stress_zz', 'stress_xy', &
        'stress_yz', 'stress_xz']

contains

    !> Add the velocities of the file to those of a body, and set its stress.
    subroutine start_from_file(input, hooke, solid, body, err)
        type(body_case_t), intent(in) :: input
        logical, intent(in) :: hooke !! its material is linear_elastic
        type(solid_t), intent(inout) :: solid
        type(body_t), intent(in) :: body
        type(error_t), intent(inout) :: err
        real(dp), allocatable :: values(:, :) !! (names, points)
        integer, allocatable :: order(:)
        integer :: i, n
        logical :: found(size(names))

        if (input%start_file == '' .or. failed(err)) return
        n = solid%dimension
        if (index(input%start_file, '.csv') > 0) then
            call read_columns(trim(input%start_file), names, values, found, err)
        else
            call read_dump(trim(input%start_file), values, found, err)
        end if
        if (failed(err)) return
        if (.not. all(found(:n)) .or. .not. any(found(4:))) &
            call refuse('must have the columns x, y, z and velocity_x, ... or stress_xx, ...')
        if (body%formulation == form_rigid) &
            call refuse('is for bodies that deform; give a rigid one velocity and spin')
        if (any(found(7:)) .and. .not. hooke) call refuse('has stresses, and only a body of '// &
            "model='linear_elastic' can start with these; take the columns out")
        if (failed(err)) return
        allocate (order(size(values, 2)))
        call order_rows(values(1:1, :), order)
        do i = body%first, body%last
            associate (row => values(:, nearest_point(values(:n, :), order, solid%x(:n, i))))
                solid%v(:n, i) = solid%v(:n, i) + real(row(4:3 + n), rk)
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

    !> Points, velocity and stress of a dump of particles.
    subroutine read_dump(path, values, found, err)
        character(*), intent(in) :: path
        real(dp), allocatable, intent(out) :: values(:, :)
        logical, intent(out) :: found(:)
        type(error_t), intent(inout) :: err
        type(h5_t) :: file
        real(dp), allocatable :: x(:, :), v(:, :)

        found = .false.
        call h5_open(file, path, err)
        call read_triples(file, 'VTKHDF/Points', x, err)
        call read_triples(file, 'VTKHDF/PointData/velocity', v, err)
        if (failed(err)) return
        allocate (values(size(names), size(x, 2)), source=0.0_dp)
        values(1:3, :) = x
        values(4:6, :) = v
        found(1:6) = .true.
        call h5_close(file, err)
    end subroutine read_dump
end module brz_start_fields
