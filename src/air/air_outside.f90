! SPDX-License-Identifier: MIT
!> The gas beyond the open boundaries, for which they let waves pass.
module brz_air_outside
    use brz_air_state, only: air_t, bc_outflow
    use brz_grid_lines, only: across
    implicit none
    private
    public :: keep_outside

contains

    !> Keep the state of the cells at the open boundaries, once: nothing happens where it is known.
    !>
    !> Called when the air is set up, before charges are placed, and before the first step.
    subroutine keep_outside(air)
        type(air_t), intent(inout) :: air
        integer :: d, s, j, k, cell(3)

        do d = 1, 3
            if (air%n(d) == 1) cycle
            do s = 1, 2
                if (air%bc(s, d) /= bc_outflow .or. allocated(air%outside(s, d)%q)) cycle
                allocate (air%outside(s, d)%q(air%n_var, air%n(across(1, d)), air%n(across(2, d))))
                cell(d) = merge(1, air%n(d), s == 1)
                do k = 1, air%n(across(2, d))
                    do j = 1, air%n(across(1, d))
                        cell(across(1, d)) = j
                        cell(across(2, d)) = k
                        air%outside(s, d)%q(:, j, k) = air%u(cell(1), cell(2), cell(3), :)
                        if (.not. air%outside(s, d)%q(1, j, k) > 0) & ! a solid cell
                            air%outside(s, d)%q(:, j, k) = air%rest(:air%n_var)
                    end do
                end do
            end do
        end do
    end subroutine keep_outside
end module brz_air_outside
