! SPDX-License-Identifier: MIT
!> What the air keeps besides its cells, in a checkpoint: what has left, and how often its scheme
!> had to fall back. One list, for the air of one process and of several.
module brz_air_diagnostics
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
    public :: air_diagnostics_t, look_at_air, look_at_all_air, keep_in_air, carry_diagnostics

    !> See air_t.
    type :: air_diagnostics_t
        real(dp) :: outflow(5) = 0, products = 0
        integer(int64) :: left(total_numbers, 6) = 0
        integer(int64) :: faces = 0, cells = 0 !! that fell back, that were held
    end type air_diagnostics_t

contains

    !> Those of this process.
    pure type(air_diagnostics_t) function look_at_air(air) result(diagnostics)
        type(air_t), intent(in) :: air
        integer :: c

        diagnostics%outflow = air%outflow
        diagnostics%products = air%outflow_products
        do c = 1, 6
            diagnostics%left(:, c) = air%left(c)%limb
        end do
        diagnostics%faces = air%fallback_faces
        diagnostics%cells = air%limited_cells
    end function look_at_air

    !> Those of all processes; all must call.
    type(air_diagnostics_t) function look_at_all_air(air) result(diagnostics)
        type(air_t), intent(in) :: air
        integer :: c

        diagnostics = look_at_air(air)
        do c = 1, 6
            call sum_of_all(air%part%ranks, diagnostics%left(:, c))
        end do
        call outflow_of_all(air, diagnostics%outflow, diagnostics%products)
        call counts_of_all(air, diagnostics%faces, diagnostics%cells)
    end function look_at_all_air

    !> Go on from them.
    subroutine keep_in_air(diagnostics, air)
        type(air_diagnostics_t), intent(in) :: diagnostics
        type(air_t), intent(inout) :: air
        integer :: c

        air%outflow = diagnostics%outflow
        air%outflow_products = diagnostics%products
        do c = 1, 6
            air%left(c)%limb = diagnostics%left(:, c)
        end do
        air%fallback_faces = diagnostics%faces
        air%limited_cells = diagnostics%cells
        call take_outflow(air)
    end subroutine keep_in_air

    !> To a checkpoint or back from it.
    subroutine carry_diagnostics(file, diagnostics, err)
        type(h5_t), intent(in) :: file
        type(air_diagnostics_t), intent(inout) :: diagnostics
        type(error_t), intent(inout) :: err

        call carry(file, 'air/outflow', diagnostics%outflow, err)
        call carry(file, 'air/outflow_products', diagnostics%products, err)
        call carry(file, 'air/left', diagnostics%left, err)
        call carry(file, 'air/fallback_faces', diagnostics%faces, err)
        call carry(file, 'air/held_cells', diagnostics%cells, err)
    end subroutine carry_diagnostics
end module brz_air_diagnostics
