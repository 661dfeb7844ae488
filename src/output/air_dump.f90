! SPDX-License-Identifier: MIT
!> Dump of the air: a VTKHDF image with cell data in single precision.
!>
!> Of several processes each writes the cells of its box beside the dump, and the dump names these
!> parts as one.
!>
!> Cells that hold solid carry `solid` = 1 and the state of the undisturbed air: what the solver
!> keeps there is a ledger, not a state. A direction that is not modelled is one cell thick (VTK
!> cannot read cells of a flat image), the whole box: volumes and masses of cells are the real ones.
!> The field data hold what is needed besides for the temperature and the speed of sound: the ratios
!> of the specific heats, and the undisturbed air.
module brz_air_dump
    use brz_air_parts, only: part_name
    use brz_air_state, only: air_t, cell_gamma, wall_t
    use brz_errors, only: error_t
    use brz_gas, only: to_primitive
    use brz_hdf5_array, only: h5_write
    use brz_hdf5_attribute, only: h5_put
    use brz_hdf5_box, only: h5_piece_t, h5_virtual, kind_int8, kind_real32
    use brz_hdf5_file, only: h5_close, h5_create, h5_packed, h5_t
    use brz_kinds, only: dp, int8, real32, rk
    use brz_meta, only: meta_t
    use brz_ranks, only: agree, several
    use brz_vtkhdf, only: begin_dump, end_dump, root, write_field
    implicit none
    private
    public :: write_air_dump

    !> Fields of the interior cells.
    type :: air_fields_t
        real(real32), allocatable :: density(:, :, :) !! [kg/m3]
        real(real32), allocatable :: pressure(:, :, :) !! [Pa]
        real(real32), allocatable :: overpressure(:, :, :) !! over the undisturbed air [Pa]
        real(real32), allocatable :: velocity(:, :, :, :) !! (3, ...) [m/s]
        integer(int8), allocatable :: solid(:, :, :)
        real(real32), allocatable :: products(:, :, :) !! mass fraction, if it is carried [-]
    end type air_fields_t

contains

    !> Write the air to `path`.
    subroutine write_air_dump(path, air, wall, meta, err)
        character(*), intent(in) :: path
        type(air_t), intent(in) :: air
        type(wall_t), intent(in) :: wall
        type(meta_t), intent(in) :: meta
        type(error_t), intent(inout) :: err
        type(h5_t) :: file
        type(air_fields_t) :: fields

        call fill_fields(air, wall, fields)
        if (several(air%part%ranks)) then
            call h5_create(file, part_name(path, air%part%ranks%rank + 1), h5_packed, err)
            call put_fields(file, air, fields, err)
            call h5_close(file, err)
            call agree(air%part%ranks, err)
            if (air%part%ranks%rank > 0) return
        end if
        call begin_dump(file, path, 'ImageData', err)
        call put_grid(file, air, err)
        call put_gas(file, air, err)
        if (several(air%part%ranks)) then
            call name_parts(file, path, air, err)
        else
            call put_fields(file, air, fields, err)
        end if
        call end_dump(file, meta, err)
    end subroutine write_air_dump

    !> The fields of the cells of this process.
    subroutine put_fields(file, air, fields, err)
        type(h5_t), intent(in) :: file
        type(air_t), intent(in) :: air
        type(air_fields_t), intent(in) :: fields
        type(error_t), intent(inout) :: err

        call write_field(file, 'CellData/density', 'kg/m3', fields%density, err)
        call write_field(file, 'CellData/pressure', 'Pa', fields%pressure, err)
        call write_field(file, 'CellData/overpressure', 'Pa', fields%overpressure, err)
        call write_field(file, 'CellData/velocity', 'm/s', fields%velocity, err)
        call write_field(file, 'CellData/solid', '-', fields%solid, err)
        if (air%n_var == 6) call write_field(file, 'CellData/products', '-', fields%products, err)
    end subroutine put_fields

    !> The same fields of the whole grid, which lie in the files of the processes.
    subroutine name_parts(file, path, air, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: path
        type(air_t), intent(in) :: air
        type(error_t), intent(inout) :: err
        character(12), parameter :: names(6) = [character(12) :: 'density', 'pressure', &
                                                'overpressure', 'velocity', 'solid', 'products']
        character(5), parameter :: units(6) = [character(5) :: 'kg/m3', 'Pa', 'Pa', 'm/s', '-', '-']
        integer, allocatable :: front(:) !! a vector comes before the cell
        type(h5_piece_t) :: pieces(air%part%ranks%n)
        character(:), allocatable :: place
        integer :: m, r

        do m = 1, air%n_var
            place = root//'/CellData/'//trim(names(m))
            front = [integer ::]
            if (names(m) == 'velocity') front = [3]
            do r = 1, size(pieces)
                associate (box => air%part%boxes(r - 1))
                    pieces(r)%file = part_name(path(index(path, '/', back=.true.) + 1:), r)
                    pieces(r)%name = place
                    pieces(r)%lo = [front/3, box%lo]
                    pieces(r)%extent = [front, box%hi - box%lo + 1]
                end associate
            end do
            call h5_virtual(file, place, merge(kind_int8, kind_real32, names(m) == 'solid'), &
                            [front, air%whole], pieces, err)
            call h5_put(file, place, 'units', trim(units(m)), err)
        end do
    end subroutine name_parts

    !> Attributes of the grid.
    subroutine put_grid(file, air, err)
        type(h5_t), intent(in) :: file
        type(air_t), intent(in) :: air
        type(error_t), intent(inout) :: err
        integer :: extent(6)

        extent = 0
        extent(2::2) = air%whole
        call h5_put(file, root, 'WholeExtent', extent, err)
        call h5_put(file, root, 'Origin', air%lo, err)
        call h5_put(file, root, 'Spacing', air%dx, err)
        call h5_put(file, root, 'Direction', [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 1.0_dp, 0.0_dp, &
                                              0.0_dp, 0.0_dp, 1.0_dp], err)
    end subroutine put_grid

    !> What the gas is.
    subroutine put_gas(file, air, err)
        type(h5_t), intent(in) :: file
        type(air_t), intent(in) :: air
        type(error_t), intent(inout) :: err
        character(*), parameter :: place = root//'/FieldData/'

        call h5_write(file, place//'gamma', [real(air%scheme%gamma, dp)], err)
        if (air%n_var == 6) &
            call h5_write(file, place//'gamma_products', [real(air%scheme%gamma_products, dp)], err)
        call h5_write(file, place//'rest_density', [real(air%rho_rest, dp)], err)
        call h5_write(file, place//'rest_pressure', [real(air%p_rest, dp)], err)
    end subroutine put_gas

    !> Primitive variables of all interior cells.
    subroutine fill_fields(air, wall, fields)
        type(air_t), intent(in) :: air
        type(wall_t), intent(in) :: wall
        type(air_fields_t), intent(out) :: fields
        integer :: i, j, k
        real(rk) :: u(5), w(5)

        associate (n => air%n)
            allocate (fields%density(n(1), n(2), n(3)), fields%pressure(n(1), n(2), n(3)), &
                      fields%overpressure(n(1), n(2), n(3)), fields%velocity(3, n(1), n(2), n(3)), &
                      fields%solid(n(1), n(2), n(3)))
            if (air%n_var == 6) allocate (fields%products(n(1), n(2), n(3)), source=0.0_real32)
        end associate
        !$omp parallel do collapse(2) schedule(static) private(i, u, w)
        do k = 1, air%n(3)
            do j = 1, air%n(2)
                do i = 1, air%n(1)
                    fields%solid(i, j, k) = 0
                    if (wall%present) fields%solid(i, j, k) = wall%solid(i, j, k)
                    w = [air%rho_rest, 0.0_rk, 0.0_rk, 0.0_rk, air%p_rest]
                    if (fields%solid(i, j, k) == 0) then
                        u = air%u(i, j, k, 1:5)
                        call to_primitive(cell_gamma(air, i, j, k), u, w)
                        if (air%n_var == 6) &
                            fields%products(i, j, k) = real(air%u(i, j, k, 6)/u(1), real32)
                    end if
                    fields%density(i, j, k) = real(w(1), real32)
                    fields%velocity(:, i, j, k) = real(w(2:4), real32)
                    fields%pressure(i, j, k) = real(w(5), real32)
                    fields%overpressure(i, j, k) = real(w(5) - air%p_rest, real32)
                end do
            end do
        end do
    end subroutine fill_fields
end module brz_air_dump
