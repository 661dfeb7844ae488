! SPDX-License-Identifier: MIT
!> Numbers of the fields of the particles on their way to a GPU and back: rows of four numbers,
!> columns, marks. Nothing is laid down in between; all threads work.
module brz_field_values
    use, intrinsic :: iso_c_binding, only: c_f_pointer
    use brz_kinds, only: int16, int32, int8, real32, real64, rk
    use brz_solid_fields, only: field_t, is_double, is_integer, is_short, is_single
    implicit none
    private
    public :: get_rows, set_rows, get_columns, set_columns, get_marks, set_marks

    !> Copy a field of real numbers to x(rows, n).
    interface get_rows
        module procedure get_rows_double, get_rows_single
    end interface get_rows

    !> Set a field of real numbers from x(rows, n).
    interface set_rows
        module procedure set_rows_double, set_rows_single
    end interface set_rows

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

    subroutine get_rows_double(field, x)
        type(field_t), intent(in) :: field
        real(real64), intent(inout) :: x(:, :)
        real(real64), pointer :: double(:, :)
        real(real32), pointer :: single(:, :)
        integer :: i

        call see_reals(field, size(x, 2), double, single)
        !$omp parallel do schedule(static)
        do i = 1, size(x, 2)
            if (associated(double)) x(:, i) = double(:, i)
            if (associated(single)) x(:, i) = single(:, i)
        end do
    end subroutine get_rows_double

    subroutine get_rows_single(field, x)
        type(field_t), intent(in) :: field
        real(real32), intent(inout) :: x(:, :)
        real(real64), pointer :: double(:, :)
        real(real32), pointer :: single(:, :)
        integer :: i

        call see_reals(field, size(x, 2), double, single)
        !$omp parallel do schedule(static)
        do i = 1, size(x, 2)
            if (associated(double)) x(:, i) = real(double(:, i), real32)
            if (associated(single)) x(:, i) = single(:, i)
        end do
    end subroutine get_rows_single

    subroutine set_rows_double(field, x)
        type(field_t), intent(in) :: field
        real(real64), intent(in) :: x(:, :)
        real(real64), pointer :: double(:, :)
        real(real32), pointer :: single(:, :)
        integer :: i

        call see_reals(field, size(x, 2), double, single)
        !$omp parallel do schedule(static)
        do i = 1, size(x, 2)
            if (associated(double)) double(:, i) = x(:, i)
            if (associated(single)) single(:, i) = real(x(:, i), real32)
        end do
    end subroutine set_rows_double

    subroutine set_rows_single(field, x)
        type(field_t), intent(in) :: field
        real(real32), intent(in) :: x(:, :)
        real(real64), pointer :: double(:, :)
        real(real32), pointer :: single(:, :)
        integer :: i

        call see_reals(field, size(x, 2), double, single)
        !$omp parallel do schedule(static)
        do i = 1, size(x, 2)
            if (associated(double)) double(:, i) = x(:, i)
            if (associated(single)) single(:, i) = x(:, i)
        end do
    end subroutine set_rows_single

    !> Copy some rows of a field of real numbers to columns.
    subroutine get_columns(field, first, x)
        type(field_t), intent(in) :: field
        integer, intent(in) :: first !! row
        real(rk), intent(inout) :: x(:, :) !! (n, rows from the first on)
        real(real64), pointer :: double(:, :)
        real(real32), pointer :: single(:, :)
        integer :: i, last

        last = first + size(x, 2) - 1
        call see_reals(field, size(x, 1), double, single)
        !$omp parallel do schedule(static)
        do i = 1, size(x, 1)
            if (associated(double)) x(i, :) = real(double(first:last, i), rk)
            if (associated(single)) x(i, :) = real(single(first:last, i), rk)
        end do
    end subroutine get_columns

    !> The way back.
    subroutine set_columns(field, first, x)
        type(field_t), intent(in) :: field
        integer, intent(in) :: first !! row
        real(rk), intent(in) :: x(:, :) !! (n, rows from the first on)
        real(real64), pointer :: double(:, :)
        real(real32), pointer :: single(:, :)
        integer :: i, last

        last = first + size(x, 2) - 1
        call see_reals(field, size(x, 1), double, single)
        !$omp parallel do schedule(static)
        do i = 1, size(x, 1)
            if (associated(double)) double(first:last, i) = x(i, :)
            if (associated(single)) single(first:last, i) = real(x(i, :), real32)
        end do
    end subroutine set_columns

    !> Copy a field (n) to marks: a whole number, or the bits of a real32.
    subroutine get_marks(field, marks)
        type(field_t), intent(in) :: field
        integer(int32), intent(out) :: marks(:) !! (n)
        integer(int32), pointer :: number(:)
        integer(int16), pointer :: short(:)
        integer(int8), pointer :: byte(:)

        select case (field%kind)
        case (is_integer, is_single) ! the same bits
            call c_f_pointer(field%values, number, shape(marks))
            marks = number
        case (is_short)
            call c_f_pointer(field%values, short, shape(marks))
            marks = short
        case default
            call c_f_pointer(field%values, byte, shape(marks))
            marks = byte
        end select
    end subroutine get_marks

    !> The way back.
    subroutine set_marks(field, marks)
        type(field_t), intent(in) :: field
        integer(int32), intent(in) :: marks(:) !! (n)
        integer(int32), pointer :: number(:)
        integer(int16), pointer :: short(:)
        integer(int8), pointer :: byte(:)

        select case (field%kind)
        case (is_integer, is_single) ! the same bits
            call c_f_pointer(field%values, number, shape(marks))
            number = marks
        case (is_short)
            call c_f_pointer(field%values, short, shape(marks))
            short = int(marks, int16)
        case default
            call c_f_pointer(field%values, byte, shape(marks))
            byte = int(marks, int8)
        end select
    end subroutine set_marks
end module brz_field_values
