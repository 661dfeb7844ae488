! SPDX-License-Identifier: MIT
!> The fields of the gas in a dump: one table. Dumps of the air, of its parts and of a blast in the
!> plane through its axis walk it, so that a new field is one line and its value in a cell.
module brz_gas_fields
    use brz_errors, only: error_t
    use brz_hdf5_box, only: kind_int8, kind_real32
    use brz_hdf5_file, only: h5_t
    use brz_kinds, only: dp, int8, real32
    use brz_vtkhdf, only: write_field
    implicit none
    private
    public :: gas_field_t, gas_values_t, gas_fields, make_values, set_values, write_values

    type :: gas_field_t
        character(12) :: name = ''
        character(5) :: unit = '-'
        integer :: rows = 1 !! numbers of a cell
        integer :: kind = kind_real32
    end type gas_field_t

    !> The table; the products, last, are left out where nothing carries them.
    type(gas_field_t), parameter :: gas_fields(6) = [ &
        gas_field_t('density', 'kg/m3'), gas_field_t('pressure', 'Pa'), &
        gas_field_t('overpressure', 'Pa'), gas_field_t('velocity', 'm/s', rows=3), &
        gas_field_t('solid', kind=kind_int8), gas_field_t('products')]

    !> One field of a box of cells.
    type :: gas_values_t
        real(real32), allocatable :: a(:, :, :, :) !! (rows, cells)
    end type gas_values_t

contains

    !> Reserve the first fields of the table for a box of cells.
    subroutine make_values(n, fields)
        integer, intent(in) :: n(3) !! cells
        type(gas_values_t), intent(inout) :: fields(:)
        integer :: f

        do f = 1, size(fields)
            allocate (fields(f)%a(gas_fields(f)%rows, n(1), n(2), n(3)))
        end do
    end subroutine make_values

    !> The fields of one cell.
    pure subroutine set_values(fields, at, w, p_rest, solid, products)
        type(gas_values_t), intent(inout) :: fields(:)
        integer, intent(in) :: at(3) !! cell
        real(dp), intent(in) :: w(5) !! density [kg/m3], velocity [m/s], pressure [Pa]
        real(dp), intent(in) :: p_rest !! pressure of the undisturbed gas [Pa]
        integer(int8), intent(in) :: solid !! 1: the cell holds solid
        real(dp), intent(in) :: products !! mass fraction [-]
        real(dp) :: values(8) !! in the order of the table
        integer :: f, first, last

        values = [w(1), w(5), w(5) - p_rest, w(2:4), real(solid, dp), products]
        first = 0
        do f = 1, size(fields)
            last = first + gas_fields(f)%rows
            fields(f)%a(:, at(1), at(2), at(3)) = real(values(first + 1:last), real32)
            first = last
        end do
    end subroutine set_values

    !> Write the fields to a dump, or to a part of one.
    subroutine write_values(file, fields, err)
        type(h5_t), intent(in) :: file
        type(gas_values_t), intent(in), target :: fields(:)
        type(error_t), intent(inout) :: err
        real(real32), pointer :: scalar(:, :, :)
        type(gas_field_t) :: field
        character(:), allocatable :: name
        integer :: f, n(4)

        do f = 1, size(fields)
            field = gas_fields(f)
            name = 'CellData/'//trim(field%name)
            n = shape(fields(f)%a)
            scalar(1:n(2), 1:n(3), 1:n(4)) => fields(f)%a
            if (field%kind == kind_int8) then
                call write_field(file, name, trim(field%unit), int(scalar, int8), err)
            else if (field%rows == 1) then
                call write_field(file, name, trim(field%unit), scalar, err)
            else
                call write_field(file, name, trim(field%unit), fields(f)%a, err)
            end if
        end do
    end subroutine write_values
end module brz_gas_fields
