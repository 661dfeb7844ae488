! SPDX-License-Identifier: MIT
!> Numbers of the fields of the particles on their way to a GPU and back: rows of four numbers,
!> columns, marks. Nothing is laid down in between; all threads work.
module brz_field_values
    use, intrinsic :: iso_c_binding, only: c_f_pointer
    use brz_kinds, only: int16, int32, int8, real32, real64, rk
    use brz_solid_fields, only: field_t, is_double, is_integer, is_short, is_single
    implicit none
    private
    public :: carry_rows, carry_columns, carry_marks

    !> Copy a field of real numbers to x(rows, n), or set it from there.
    interface carry_rows
        module procedure carry_doubles, carry_singles
    end interface carry_rows

contains

    !> The numbers of a field of real numbers; one of the two is associated.
    subroutine see_reals(field, n, double, single)
        type(field_t), intent(in) :: field !! is_double or is_single
        integer, intent(in) :: n
        real(real64), pointer, intent(out) :: double(:, :)
        real(real32), pointer, intent(out) :: single(:, :)

        nullify (double, single)
        if (field%kind == is_double) call c_f_pointer(field%values, double, [field%rows, n])
        if (field%kind == is_single) call c_f_pointer(field%values, single, [field%rows, n])
    end subroutine see_reals

    subroutine carry_doubles(field, x, gets)
        type(field_t), intent(in) :: field
        real(real64), intent(inout) :: x(:, :)
        logical, intent(in) :: gets !! else x goes to the field
        real(real64), pointer :: double(:, :)
        real(real32), pointer :: single(:, :)
        integer :: i

        call see_reals(field, size(x, 2), double, single)
        !$omp parallel do schedule(static)
        do i = 1, size(x, 2)
            if (associated(double) .and. gets) then
                x(:, i) = double(:, i)
            else if (associated(double)) then
                double(:, i) = x(:, i)
            else if (gets) then
                x(:, i) = single(:, i)
            else
                single(:, i) = real(x(:, i), real32)
            end if
        end do
    end subroutine carry_doubles

    subroutine carry_singles(field, x, gets)
        type(field_t), intent(in) :: field
        real(real32), intent(inout) :: x(:, :)
        logical, intent(in) :: gets !! else x goes to the field
        real(real64), pointer :: double(:, :)
        real(real32), pointer :: single(:, :)
        integer :: i

        call see_reals(field, size(x, 2), double, single)
        !$omp parallel do schedule(static)
        do i = 1, size(x, 2)
            if (associated(double) .and. gets) then
                x(:, i) = real(double(:, i), real32)
            else if (associated(double)) then
                double(:, i) = x(:, i)
            else if (gets) then
                x(:, i) = single(:, i)
            else
                single(:, i) = x(:, i)
            end if
        end do
    end subroutine carry_singles

    !> Copy some rows of a field of real numbers to columns, or set them from there.
    subroutine carry_columns(field, first, x, gets)
        type(field_t), intent(in) :: field
        integer, intent(in) :: first !! row
        real(rk), intent(inout) :: x(:, :) !! (n, rows from the first on)
        logical, intent(in) :: gets !! else x goes to the field
        real(real64), pointer :: double(:, :)
        real(real32), pointer :: single(:, :)
        integer :: i, last

        last = first + size(x, 2) - 1
        call see_reals(field, size(x, 1), double, single)
        !$omp parallel do schedule(static)
        do i = 1, size(x, 1)
            if (associated(double) .and. gets) then
                x(i, :) = real(double(first:last, i), rk)
            else if (associated(double)) then
                double(first:last, i) = x(i, :)
            else if (gets) then
                x(i, :) = real(single(first:last, i), rk)
            else
                single(first:last, i) = real(x(i, :), real32)
            end if
        end do
    end subroutine carry_columns

    !> Copy a field (n) to marks, or set it from there: a whole number, or the bits of a real32.
    subroutine carry_marks(field, row, marks, gets)
        type(field_t), intent(in) :: field
        integer, intent(in) :: row !! of the field
        integer(int32), intent(inout) :: marks(:) !! (n)
        logical, intent(in) :: gets !! else marks go to the field
        integer(int32), pointer :: number(:, :)
        integer(int16), pointer :: short(:)
        integer(int8), pointer :: byte(:)

        select case (field%kind)
        case (is_integer, is_single) ! the same bits
            call c_f_pointer(field%values, number, [field%rows, size(marks)])
            if (gets) marks = number(row, :)
            number(row, :) = marks
        case (is_short)
            call c_f_pointer(field%values, short, shape(marks))
            if (gets) marks = short
            short = int(marks, int16)
        case default
            call c_f_pointer(field%values, byte, shape(marks))
            if (gets) marks = byte
            byte = int(marks, int8)
        end select
    end subroutine carry_marks
end module brz_field_values
