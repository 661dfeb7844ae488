! SPDX-License-Identifier: MIT
!> What the air keeps besides its cells, in a checkpoint: what has left, and how often its scheme
!> had to fall back. One list, for the air of one process and of several.
module brz_air_books
    use brz_air_state, only: air_t
    use brz_air_totals, only: counts_of_all, outflow_of_all, take_outflow
    use brz_carry, only: carry
    use brz_errors, only: error_t
    use brz_hdf5_file, only: h5_t
    use brz_kinds, only: dp, int64
    use brz_ranks, only: sum_of_all
    use brz_running_total, only: total_numbers
    implicit none
    private
    public :: air_books_t, look_at_air, look_at_all_air, keep_in_air, carry_books

    !> See air_t.
    type :: air_books_t
        real(dp) :: outflow(5) = 0, products = 0
        integer(int64) :: left(total_numbers, 6) = 0
        integer(int64) :: faces = 0, cells = 0 !! that fell back, that were held
    end type air_books_t

contains

    !> Those of this process.
    pure type(air_books_t) function look_at_air(air) result(books)
        type(air_t), intent(in) :: air
        integer :: c

        books%outflow = air%outflow
        books%products = air%outflow_products
        do c = 1, 6
            books%left(:, c) = air%left(c)%limb
        end do
        books%faces = air%fallback_faces
        books%cells = air%held_cells
    end function look_at_air

    !> Those of all processes; all must call.
    type(air_books_t) function look_at_all_air(air) result(books)
        type(air_t), intent(in) :: air
        integer :: c

        books = look_at_air(air)
        do c = 1, 6
            call sum_of_all(air%part%ranks, books%left(:, c))
        end do
        call outflow_of_all(air, books%outflow, books%products)
        call counts_of_all(air, books%faces, books%cells)
    end function look_at_all_air

    !> Go on from them.
    subroutine keep_in_air(books, air)
        type(air_books_t), intent(in) :: books
        type(air_t), intent(inout) :: air
        integer :: c

        air%outflow = books%outflow
        air%outflow_products = books%products
        do c = 1, 6
            air%left(c)%limb = books%left(:, c)
        end do
        air%fallback_faces = books%faces
        air%held_cells = books%cells
        call take_outflow(air)
    end subroutine keep_in_air

    !> To a checkpoint or back from it.
    subroutine carry_books(file, books, err)
        type(h5_t), intent(in) :: file
        type(air_books_t), intent(inout) :: books
        type(error_t), intent(inout) :: err

        call carry(file, 'air/outflow', books%outflow, err)
        call carry(file, 'air/outflow_products', books%products, err)
        call carry(file, 'air/left', books%left, err)
        call carry(file, 'air/fallback_faces', books%faces, err)
        call carry(file, 'air/held_cells', books%cells, err)
    end subroutine carry_books
end module brz_air_books
