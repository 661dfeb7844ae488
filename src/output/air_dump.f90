! SPDX-License-Identifier: MIT
!> Dump of the air: a VTKHDF image with cell data in single precision.
!>
!> Cells that hold solid carry `solid` = 1 and the state of the undisturbed air: what the solver
!> keeps there is a ledger, not a state. A direction that is not modelled is one cell thick (VTK
!> cannot read cells of a flat image), the whole box: volumes and masses of cells are the real ones.
!> The field data hold what is needed besides for the temperature and the speed of sound: the ratios
!> of the specific heats, and the undisturbed air.
module brz_air_dump
    use brz_air_state, only: air_t, cell_gamma, wall_t
    use brz_errors, only: error_t
    use brz_gas, only: to_primitive
    use brz_hdf5_array, only: h5_write
    use brz_hdf5_attribute, only: h5_put
    use brz_hdf5_file, only: h5_t
    use brz_kinds, only: dp, int8, real32, rk
    use brz_meta, only: meta_t
    use brz_vtkhdf, only: begin_dump, end_dump, root, write_field
    implicit none
    private
    public :: write_air_dump

    !> Fields of the interior cells.
    type :: fields_t
        real(real32), allocatable :: density(:, :, :) !! [kg/m3]
        real(real32), allocatable :: pressure(:, :, :) !! [Pa]
        real(real32), allocatable :: overpressure(:, :, :) !! over the undisturbed air [Pa]
        real(real32), allocatable :: velocity(:, :, :, :) !! (3, ...) [m/s]
        integer(int8), allocatable :: solid(:, :, :)
        real(real32), allocatable :: products(:, :, :) !! mass fraction, if it is carried [-]
    end type fields_t

contains

    !> Write the air to `path`.
    subroutine write_air_dump(path, air, wall, meta, err)
        character(*), intent(in) :: path
        type(air_t), intent(in) :: air
        type(wall_t), intent(in) :: wall
        type(meta_t), intent(in) :: meta
        type(error_t), intent(inout) :: err
        type(h5_t) :: file
        type(fields_t) :: fields

        call fill_fields(air, wall, fields)
        call begin_dump(file, path, 'ImageData', err)
        call put_grid(file, air, err)
        call put_gas(file, air, err)
        call write_field(file, 'CellData/density', 'kg/m3', fields%density, err)
        call write_field(file, 'CellData/pressure', 'Pa', fields%pressure, err)
        call write_field(file, 'CellData/overpressure', 'Pa', fields%overpressure, err)
        call write_field(file, 'CellData/velocity', 'm/s', fields%velocity, err)
        call write_field(file, 'CellData/solid', '-', fields%solid, err)
        if (air%n_var == 6) call write_field(file, 'CellData/products', '-', fields%products, err)
        call end_dump(file, meta, err)
    end subroutine write_air_dump

    !> Attributes of the grid.
    subroutine put_grid(file, air, err)
        type(h5_t), intent(in) :: file
        type(air_t), intent(in) :: air
        type(error_t), intent(inout) :: err
        integer :: extent(6)

        extent = 0
        extent(2::2) = air%n
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
        type(fields_t), intent(out) :: fields
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
