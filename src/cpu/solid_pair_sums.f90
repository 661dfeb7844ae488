! SPDX-License-Identifier: MIT
!> Pass 2, the loop over the direct neighbours of a group of particles: stress, artificial
!> viscosity, hourglass control.
!>
!> There is a loop for each set of forces, so that no body pays for a force that it does not use:
!> the one in solid_pair_sums.inc, of which the compiler makes vector code for each `kind`.
module brz_solid_pair_sums
    use brz_force_layout, only: at_drag, at_friction, at_heat, at_stiff, at_work, n_terms
    use brz_formulation_names, only: form_bending, form_corrected_hourglass, form_total
    use brz_hold_layout, only: control_affine, control_stiffness, control_whole, n_control
    use brz_kernel, only: kernel_slope
    use brz_kinds, only: dp, int32, real32, rk
    use brz_pair_force, only: hourglass_axial, hourglass_stiff, hourglass_viscous, jump_speed, &
                              metric_square, most_bent, most_in_tension, stress_force, viscous_force
    use brz_pair_layout, only: n_pair, pair_affine, pair_keep, pair_linear, pair_quadratic, &
        pair_stress, pair_tilt, pair_volume, pair_zeta
    use brz_particle_groups, only: lanes
    use brz_solid_lanes, only: body_kernel, lane_group_t, lane_kernel_t, pair_kernels
    use brz_one_sided_arm, only: curved_arm, ply_arm, radial_normal, one_sided_arm, tilted_force
    implicit none
    private
    public :: add_pairs
    ! loops of their own, each: make vectors looks at them
    public :: sum_plain, sum_viscous, sum_held, sum_plate, sum_stiff, sum_total, sum_axial, sum_wide
    public :: sum_viscous_jump, sum_held_jump, sum_plate_jump, sum_wall, sum_wall_jump

    ! kinds, in an order in which those that share a force follow each other
    integer, parameter :: plain = 1, viscous = 2, viscous_jump = 3, control = 4, held_jump = 5, &
                          plate = 6, plate_jump = 7, wall = 8, wall_jump = 9, stiff = 10, &
                          total = 11, axial = 12, wide = 13

contains

    !> Add the forces of the particles of a list to p%sums, by the loop that has just those of the
    !> body.
    subroutine add_pairs(p, x, v, x_ref, pair, h, list, k_axes, in_tension)
        type(lane_group_t), intent(inout) :: p
        real(dp), intent(in) :: x(3, *), x_ref(3, *)
        real(rk), intent(in) :: v(3, *), pair(n_pair, *), h(*)
        integer(int32), intent(in) :: list(*)
        real(real32), intent(in), optional :: k_axes(6, *) !! only with a stiffness along axes
        real(rk), intent(in), optional :: in_tension(n_control, *) !! only with the tensile control
        integer :: kind

        kind = plain
        if (p%formulation == form_corrected_hourglass) kind = viscous
        if (p%formulation == form_bending) kind = merge(axial, stiff, p%directional)
        if (p%formulation == form_total) kind = merge(wide, total, p%directional)
        if (p%control) kind = merge(plate, control, any(p%normal > 0))
        if (p%control .and. p%curved) kind = wall
        if (p%jumps) kind = merge(kind, viscous, p%control) + 1
        if (p%control .and. p%curved) call find_normals(p, x_ref, list)
        select case (kind)
        case (plain); call sum_plain(p, x, v, x_ref, pair, h, list, k_axes, in_tension)
        case (viscous); call sum_viscous(p, x, v, x_ref, pair, h, list, k_axes, in_tension)
        case (viscous_jump); call sum_viscous_jump(p, x, v, x_ref, pair, h, list, k_axes, &
            in_tension)
        case (control); call sum_held(p, x, v, x_ref, pair, h, list, k_axes, in_tension)
        case (held_jump); call sum_held_jump(p, x, v, x_ref, pair, h, list, k_axes, in_tension)
        case (plate); call sum_plate(p, x, v, x_ref, pair, h, list, k_axes, in_tension)
        case (plate_jump); call sum_plate_jump(p, x, v, x_ref, pair, h, list, k_axes, in_tension)
        case (wall); call sum_wall(p, x, v, x_ref, pair, h, list, k_axes, in_tension)
        case (wall_jump); call sum_wall_jump(p, x, v, x_ref, pair, h, list, k_axes, in_tension)
        case (stiff); call sum_stiff(p, x, v, x_ref, pair, h, list, k_axes, in_tension)
        case (total); call sum_total(p, x, v, x_ref, pair, h, list, k_axes, in_tension)
        case (axial); call sum_axial(p, x, v, x_ref, pair, h, list, k_axes, in_tension)
        case (wide); call sum_wide(p, x, v, x_ref, pair, h, list, k_axes, in_tension)
        end select
    end subroutine add_pairs

    !> Stress and viscosity alone.
    subroutine sum_plain(p, x, v, x_ref, pair, h, list, k_axes, in_tension)
        integer, parameter :: kind = plain

        include 'solid_pair_sums.inc'
    end subroutine sum_plain

    !> Also the viscous hourglass force.
    subroutine sum_viscous(p, x, v, x_ref, pair, h, list, k_axes, in_tension)
        integer, parameter :: kind = viscous

        include 'solid_pair_sums.inc'
    end subroutine sum_viscous

    !> The same with a viscosity that sees jumps alone.
    subroutine sum_viscous_jump(p, x, v, x_ref, pair, h, list, k_axes, in_tension)
        integer, parameter :: kind = viscous_jump

        include 'solid_pair_sums.inc'
    end subroutine sum_viscous_jump

    !> Also the viscous hourglass force, and the tensile control.
    subroutine sum_held(p, x, v, x_ref, pair, h, list, k_axes, in_tension)
        integer, parameter :: kind = control

        include 'solid_pair_sums.inc'
    end subroutine sum_held

    !> The same with a viscosity that sees jumps alone.
    subroutine sum_held_jump(p, x, v, x_ref, pair, h, list, k_axes, in_tension)
        integer, parameter :: kind = held_jump

        include 'solid_pair_sums.inc'
    end subroutine sum_held_jump

    !> As control, and tilts: plates.
    subroutine sum_plate(p, x, v, x_ref, pair, h, list, k_axes, in_tension)
        integer, parameter :: kind = plate

        include 'solid_pair_sums.inc'
    end subroutine sum_plate

    !> The same with a viscosity that sees jumps alone.
    subroutine sum_plate_jump(p, x, v, x_ref, pair, h, list, k_axes, in_tension)
        integer, parameter :: kind = plate_jump

        include 'solid_pair_sums.inc'
    end subroutine sum_plate_jump

    !> As plate, in curved walls.
    subroutine sum_wall(p, x, v, x_ref, pair, h, list, k_axes, in_tension)
        integer, parameter :: kind = wall

        include 'solid_pair_sums.inc'
    end subroutine sum_wall

    !> The same with a viscosity that sees jumps alone.
    subroutine sum_wall_jump(p, x, v, x_ref, pair, h, list, k_axes, in_tension)
        integer, parameter :: kind = wall_jump

        include 'solid_pair_sums.inc'
    end subroutine sum_wall_jump

    !> The stiff hourglass force.
    subroutine sum_stiff(p, x, v, x_ref, pair, h, list, k_axes, in_tension)
        integer, parameter :: kind = stiff

        include 'solid_pair_sums.inc'
    end subroutine sum_stiff

    !> The same in total-Lagrangian bodies: X_ij weighs the pairs and Piola's stress acts along it.
    subroutine sum_total(p, x, v, x_ref, pair, h, list, k_axes, in_tension)
        integer, parameter :: kind = total

        include 'solid_pair_sums.inc'
    end subroutine sum_total

    !> As stiff, along the axes of the material, and tilts.
    subroutine sum_axial(p, x, v, x_ref, pair, h, list, k_axes, in_tension)
        integer, parameter :: kind = axial

        include 'solid_pair_sums.inc'
    end subroutine sum_axial

    !> The same in total-Lagrangian bodies, in the metric of their lattice.
    subroutine sum_wide(p, x, v, x_ref, pair, h, list, k_axes, in_tension)
        integer, parameter :: kind = wide

        include 'solid_pair_sums.inc'
    end subroutine sum_wide

    !> Normals at the neighbours of a list in a wall round an axis.
    subroutine find_normals(p, x_ref, list)
        type(lane_group_t), intent(inout) :: p
        real(dp), intent(in) :: x_ref(3, *)
        integer(int32), intent(in) :: list(*)
        integer :: k

        if (allocated(p%there)) then
            if (size(p%there, 2) < p%count) deallocate (p%there)
        end if
        if (.not. allocated(p%there)) allocate (p%there(3, 2*p%count))
        do k = 1, p%count
            call radial_normal(p%normal, p%middle, x_ref(1, list(k)), p%there(1, k))
        end do
    end subroutine find_normals

    !> Force of the stresses of a pair in a wall round an axis, along its arms.
    pure subroutine pull_in_wall(lift, n, n_j, own, other, r, dx, w, g)
        real(rk), intent(in) :: lift, n(3), n_j(3) !! see one_sided_arm; normals of both
        real(rk), intent(in) :: own(n_pair), other(n_pair), r(3), dx(3), w
        real(rk), intent(out) :: g(3)
        real(rk) :: arm(3), arm_j(3)

        call ply_arm(own(pair_tilt), lift, n, dx, r, arm)
        call ply_arm(-other(pair_tilt), lift, n_j, dx, r, arm_j)
        call tilted_force(w, own(pair_stress + 1), other(pair_stress + 1), arm, arm_j, g)
    end subroutine pull_in_wall
end module brz_solid_pair_sums
