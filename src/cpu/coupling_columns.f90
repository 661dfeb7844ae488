! SPDX-License-Identifier: MIT
!> Columns of solid cells behind wall faces.
module brz_coupling_columns
    use brz_air_state, only: air_t
    use brz_column_loops, only: each_weigh_column
    use brz_coupling_state, only: coupling_t
    use brz_kinds, only: dp
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: weigh_columns, area

contains

    !> Surface of the column behind each face, and the sum of the weights in it.
    subroutine weigh_columns(solid, coupling)
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling

        associate (wall => coupling%wall)
            call each_weigh_column(wall%n_faces, coupling%box, size(solid%x, 1), coupling%gas, &
                                   coupling%rows, wall%face_cell, coupling%cell, wall%solid, &
                                   wall%index, coupling%ends, coupling%binned, solid%x, &
                                   solid%mass, coupling%surface, coupling%weight)
        end associate
    end subroutine weigh_columns

    !> Area of a face normal to direction d [m2].
    pure real(dp) function area(air, d)
        type(air_t), intent(in) :: air
        integer, intent(in) :: d

        area = product(air%dx)/air%dx(d)
    end function area
end module brz_coupling_columns
