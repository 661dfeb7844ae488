! SPDX-License-Identifier: MIT
!> Which bodies the air loads, and how fast the walls are.
module brz_load_loop_bodies
    use brz_air_grid, only: grid_t
    use brz_column_rules, only: direction_of
    use brz_coupling_box, only: box_t, is_own
    use brz_kinds, only: dp, int32, rk
    use brz_load_rules, only: is_felt
    implicit none
    private
    public :: take_wall_traction, wall_speed

contains

    !> felt = 1 where a particle of a body lies in the column of a wall face that feels more than
    !> rounding above or below the reference pressure. Others look at those in cells of theirs.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine take_wall_traction(t, first, box, dt, cell, home, above, impulse, felt)
        integer, intent(in) :: t !! particles of the body
        integer, intent(in) :: first !! the first of them
        type(box_t), intent(in) :: box
        real(dp), intent(in) :: dt !! step of the air, over which the impulses were added up [s]
        integer(int32), intent(in) :: cell(*), home(*)
        integer, intent(in) :: above(6, *)
        real(rk), intent(in) :: impulse(*)
        integer(int32), intent(inout) :: felt(*)
        integer :: c, f, row

        c = home(first - 1 + t)
        if (c == 0) return
        if (.not. is_own(box, cell(first - 1 + t))) return
        do row = 1, 6
            if (box%n(direction_of(row)) == 1) cycle
            f = above(row, c)
            if (f == 0) cycle
            if (.not. is_felt(impulse(f), box%reference, box%area(direction_of(row)), dt)) cycle
            felt(1) = 1
            return
        end do
    end subroutine take_wall_traction

    !> Largest sum_d |v_d|/dx_d of the solid cells.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine wall_speed(c, grid, v, fastest)
        integer, intent(in) :: c !! solid cells
        type(grid_t), intent(in) :: grid
        real(rk), intent(in) :: v(3, *) !! [m/s]
        real(rk), intent(inout) :: fastest !@most [1/s]

        fastest = max(fastest, abs(v(1, c))*grid%inverse_dx(1) &
                      + abs(v(2, c))*grid%inverse_dx(2) + abs(v(3, c))*grid%inverse_dx(3))
    end subroutine wall_speed
end module brz_load_loop_bodies
