! SPDX-License-Identifier: MIT
!> Dump of the air: a VTKHDF image with cell data in single precision.
!>
!> Of several processes each writes the cells of its box beside the dump, and the dump names these
!> parts as one.
!>
!> Cells without gas carry `solid` = 1 and the state of the undisturbed air: what the solver keeps
!> there is no state. A direction that is not modelled is one cell thick (VTK cannot read cells of a
!> flat image), the whole box: volumes and masses of cells are the real ones. The field data hold
!> what is needed besides for the temperature and the speed of sound: the ratios of the specific
!> heats, and the undisturbed air.
module brz_air_dump
    use brz_air_parts, only: part_name
    use brz_air_state, only: air_t, cell_gamma, wall_t
    use brz_errors, only: error_t
    use brz_gas, only: to_primitive
    use brz_gas_fields, only: gas_field_t, gas_fields, gas_values_t, make_values, set_values, &
        write_values
    use brz_hdf5_array, only: h5_write
    use brz_hdf5_attribute, only: h5_put
    use brz_hdf5_box, only: h5_piece_t, h5_virtual
    use brz_hdf5_file, only: h5_close, h5_create, h5_packed, h5_t
    use brz_kinds, only: dp, int8, rk
    use brz_meta, only: meta_t
    use brz_ranks, only: several
    use brz_vtkhdf, only: begin_dump, end_dump, root
    implicit none
    private
    public :: write_air_dump

contains

    !> Write the air to `path`.
    subroutine write_air_dump(path, air, wall, meta, err)
        character(*), intent(in) :: path
        type(air_t), intent(in) :: air
        type(wall_t), intent(in) :: wall
        type(meta_t), intent(in) :: meta
        type(error_t), intent(inout) :: err
        type(h5_t) :: file
        type(gas_values_t) :: fields(air%n_var)

        call fill_fields(air, wall, fields)
        if (several(air%part%ranks)) then
            call h5_create(file, part_name(path, air%part%ranks%rank + 1), h5_packed, err)
            call write_values(file, fields, err)
            call h5_close(file, err)
            if (air%part%ranks%rank > 0) return
        end if
        call begin_dump(file, path, 'ImageData', err)
        call put_grid(file, air, err)
        call put_gas(file, air, err)
        if (several(air%part%ranks)) then
            call name_parts(file, path, air, err)
        else
            call write_values(file, fields, err)
        end if
        call end_dump(file, meta, err)
    end subroutine write_air_dump

    !> The fields of the whole grid, which lie in the files of the processes.
    subroutine name_parts(file, path, air, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: path
        type(air_t), intent(in) :: air
        type(error_t), intent(inout) :: err
        type(gas_field_t) :: field
        integer, allocatable :: front(:) !! a vector comes before the cell
        type(h5_piece_t) :: pieces(air%part%ranks%n)
        character(:), allocatable :: place
        integer :: f, r

        do f = 1, air%n_var
            field = gas_fields(f)
            place = root//'/CellData/'//trim(field%name)
            front = pack([field%rows], [field%rows > 1])
            do r = 1, size(pieces)
                associate (box => air%part%boxes(r - 1))
                    pieces(r)%file = part_name(path(index(path, '/', back=.true.) + 1:), r)
                    pieces(r)%name = place
                    pieces(r)%lo = [front/field%rows, box%lo]
                    pieces(r)%extent = [front, box%hi - box%lo + 1]
                end associate
            end do
            call h5_virtual(file, place, field%kind, [front, air%whole], pieces, err)
            call h5_put(file, place, 'units', trim(field%unit), err)
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

    !> The fields of all interior cells.
    subroutine fill_fields(air, wall, fields)
        type(air_t), intent(in) :: air
        type(wall_t), intent(in) :: wall
        type(gas_values_t), intent(inout) :: fields(:)
        integer :: i, j, k
        integer(int8) :: solid
        real(rk) :: u(5), w(5), products

        call make_values(air%n, fields)
        !$omp parallel do collapse(2) schedule(static) private(i, u, w, solid, products)
        do k = 1, air%n(3)
            do j = 1, air%n(2)
                do i = 1, air%n(1)
                    solid = 0
                    if (wall%present) solid = wall%solid(i, j, k)
                    w = [air%rho_rest, 0.0_rk, 0.0_rk, 0.0_rk, air%p_rest]
                    products = 0
                    if (solid == 0) then
                        u = air%u(i, j, k, 1:5)
                        call to_primitive(cell_gamma(air, i, j, k), u, w)
                        if (air%n_var == 6) products = air%u(i, j, k, 6)/u(1)
                    end if
                    call set_values(fields, [i, j, k], real(w, dp), real(air%p_rest, dp), &
                                    solid, real(products, dp))
                end do
            end do
        end do
    end subroutine fill_fields
end module brz_air_dump
