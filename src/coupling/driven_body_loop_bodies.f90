! SPDX-License-Identifier: MIT
!> Sums over the particles of a body that carries them in the gas. A rigid body turns about the
!> middle of its cells, and its walls push at the middles of theirs.
module brz_driven_body_loop_bodies
    use brz_driven_body_rules, only: add_force, add_yield, driven_body_t, is_carried
    use brz_cell_place, only: cell_middle
    use brz_column_loop_bodies, only: depth_weight, force_from
    use brz_coupling_box, only: box_t, is_own
    use brz_kinds, only: dp, int32, rk
    use brz_particle_marks, only: is_fixed
    implicit none
    private
    public :: sum_shift, sum_push, sum_air_load

contains

    !> Mass times the way from a particle to the middle of its cell.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine sum_shift(p, first, box, wide, x, mass, shift)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        type(box_t), intent(in) :: box
        integer, intent(in) :: wide !! rows of x
        real(dp), intent(in) :: x(wide, *)
        real(rk), intent(in) :: mass(*)
        real(dp), intent(inout) :: shift(3) !@exact [kg m]
        real(dp) :: middle(3)
        integer :: d, i

        i = first - 1 + p
        middle = cell_middle(x(1, i), box%lo, box%dx)
        do d = 1, 3
            shift(d) = shift(d) + mass(i)*(middle(d) - x(d, i))
        end do
    end subroutine sum_shift

    !> Middle of the cell that holds a particle, from the centre of its body [m].
    !@cuf attributes(host,device) &
    pure function arm_of(box, driven, x) result(arm)
        type(box_t), intent(in) :: box
        type(driven_body_t), intent(in) :: driven
        real(dp), intent(in) :: x(3)
        real(dp) :: arm(3)
        integer :: d

        arm = cell_middle(x, box%lo, box%dx)
        do d = 1, 3
            arm(d) = arm(d) - driven%centre(d)
        end do
    end function arm_of

    !> Force and torque of the gas on a particle if its body keeps its motion, and how they fall if
    !> that yields. Particles in the cells of other processes are theirs to count.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine sum_push(p, first, box, driven, wide, cell, home, above, gas, rows, surface, &
                             weight, force, impedance, x, mass, push)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        type(box_t), intent(in) :: box
        type(driven_body_t), intent(in) :: driven
        integer, intent(in) :: wide !! rows of x
        integer(int32), intent(in) :: cell(*), home(*)
        integer, intent(in) :: above(6, *)
        integer(int32), intent(in) :: gas(*), rows(*)
        real(dp), intent(in) :: surface(*)
        real(rk), intent(in) :: weight(*), force(*), impedance(*)
        real(dp), intent(in) :: x(wide, *)
        real(rk), intent(in) :: mass(*)
        real(dp), intent(inout) :: push(18) !@exact n_push of brz_driven_body_rules
        real(dp) :: arm(3)
        real(rk) :: now(3), yield(3), share
        integer :: d, f, i, row, side

        i = first - 1 + p
        if (home(i) == 0) return
        if (.not. is_own(box, cell(i))) return
        do d = 1, 3
            now(d) = 0
            yield(d) = 0
            if (box%n(d) == 1) cycle
            do side = 0, 1
                row = 2*d - side
                f = above(row, home(i))
                if (f == 0) cycle
                share = depth_weight(box, rows(f), row, gas(f), surface(f), x(d, i), mass(i)) &
                        /weight(f)
                now(d) = now(d) + share*force_from(rows(f), row, force(f))
                yield(d) = yield(d) + share*impedance(f)
            end do
        end do
        arm = arm_of(box, driven, x(1, i))
        call add_force(arm, now, push)
        call add_yield(arm, yield, push)
    end subroutine sum_push

    !> Force and torque of the air on a body by the load of a particle that it carries.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine sum_air_load(p, first, box, driven, wide, stride_d, stride_p, fixed, x, load, &
    push)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        type(box_t), intent(in) :: box
        type(driven_body_t), intent(in) :: driven
        integer, intent(in) :: wide !! rows of x
        integer, intent(in) :: stride_d, stride_p !! distances of directions and particles in load
        integer(int32), intent(in) :: fixed(*)
        real(dp), intent(in) :: x(wide, *)
        real(rk), intent(in) :: load(*) !! [N]
        real(dp), intent(inout) :: push(6) !@exact force [N], torque [N m]
        real(dp) :: arm(3)
        real(rk) :: force(3)
        integer :: d, i
        logical :: loaded

        i = first - 1 + p
        if (.not. is_carried(driven%carries, fixed(i) == is_fixed)) return
        loaded = .false.
        do d = 1, 3
            force(d) = load(1 + (i - 1)*stride_p + (d - 1)*stride_d)
            loaded = loaded .or. abs(force(d)) > 0
        end do
        if (.not. loaded) return
        arm = arm_of(box, driven, x(1, i))
        call add_force(arm, force, push)
    end subroutine sum_air_load
end module brz_driven_body_loop_bodies
