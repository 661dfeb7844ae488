! SPDX-License-Identifier: MIT
!> Pass 1, the loop over the direct neighbours of a group of particles.
!>
!> There is a loop for each set of sums: the one in solid_gradient_sums.inc, of which the compiler
!> makes vector code for each `kind`.
module brz_solid_gradient_sums
    use brz_formulation_names, only: form_bending, form_total
    use brz_gradient, only: moment_terms, outer_terms
    use brz_kernel, only: kernel_slope
    use brz_kinds, only: dp, int32, rk
    use brz_moment_layout, only: at_f, at_g, at_s, at_x, at_y, n_sums
    use brz_particle_groups, only: lanes
    use brz_solid_lanes, only: body_kernel, lane_group_t, lane_kernel_t, pair_kernels
    use brz_one_sided_arm, only: curved_arm, ply_arm, one_sided_arm
    implicit none
    private
    public :: add_neighbours
    ! loops of their own, each: make vectors looks at them
    public :: sum_plain, sum_bending, sum_drawn, sum_tilted, sum_curved, sum_referred

    integer, parameter :: n_moment = 6, n_outer = 9
    ! kinds, by the number of sums
    integer, parameter :: plain = at_x, bending = at_s, in_tension = at_y, tilted = at_f, &
                          curved = at_f + 1, referred = n_sums

contains

    !> Add particles of a list to the sums. A total-Lagrangian body weighs its pairs by X_ij, and x
    !> takes the place of the reference position: the sums then lead to dx/dX.
    subroutine add_neighbours(p, x, v, x_ref, volume, h, list, sums)
        type(lane_group_t), intent(in) :: p
        real(dp), intent(in) :: x(3, *), x_ref(3, *)
        real(rk), intent(in) :: v(3, *), volume(*), h(*)
        integer(int32), intent(in) :: list(*)
        real(rk), intent(inout) :: sums(lanes, n_sums)
        type(lane_group_t) :: q
        integer :: kind

        if (p%formulation == form_total) then
            kind = merge(referred, bending, any(abs(p%tilt) > 0))
            q = p
            q%x = p%x_ref
            q%x_ref = p%x
            call sum_neighbours(kind, q, x_ref, v, x, volume, h, list, sums)
        else
            kind = merge(in_tension, plain, any(p%in_tension))
            if (p%formulation == form_bending) kind = bending
            if (any(abs(p%tilt) > 0)) kind = merge(curved, tilted, p%curved)
            call sum_neighbours(kind, p, x, v, x_ref, volume, h, list, sums)
        end if
    end subroutine add_neighbours

    !> The sums of one kind, and the velocity along the arms.
    subroutine sum_neighbours(kind, p, x, v, x_ref, volume, h, list, sums)
        integer, intent(in) :: kind
        type(lane_group_t), intent(in) :: p
        real(dp), intent(in) :: x(3, *), x_ref(3, *)
        real(rk), intent(in) :: v(3, *), volume(*), h(*)
        integer(int32), intent(in) :: list(*)
        real(rk), intent(inout) :: sums(lanes, n_sums)

        select case (kind)
        case (plain); call sum_plain(p, x, v, x_ref, volume, h, list, sums)
        case (bending); call sum_bending(p, x, v, x_ref, volume, h, list, sums)
        case (in_tension); call sum_drawn(p, x, v, x_ref, volume, h, list, sums)
        case (tilted); call sum_tilted(p, x, v, x_ref, volume, h, list, sums)
        case (curved); call sum_curved(p, x, v, x_ref, volume, h, list, sums)
        case (referred); call sum_referred(p, x, v, x_ref, volume, h, list, sums)
        end select
    end subroutine sum_neighbours

    !> Moments and velocity.
    subroutine sum_plain(p, x, v, x_ref, volume, h, list, sums)
        integer, parameter :: kind = plain

        include 'solid_gradient_sums.inc'
    end subroutine sum_plain

    !> Also the reference position.
    subroutine sum_bending(p, x, v, x_ref, volume, h, list, sums)
        integer, parameter :: kind = bending

        include 'solid_gradient_sums.inc'
    end subroutine sum_bending

    !> Also its moments, for the tensile control.
    subroutine sum_drawn(p, x, v, x_ref, volume, h, list, sums)
        integer, parameter :: kind = in_tension

        include 'solid_gradient_sums.inc'
    end subroutine sum_drawn

    !> Also the arms of tilts.
    subroutine sum_tilted(p, x, v, x_ref, volume, h, list, sums)
        integer, parameter :: kind = tilted

        include 'solid_gradient_sums.inc'
    end subroutine sum_tilted

    !> The same in curved walls, with one sum more, which stays 0.
    subroutine sum_curved(p, x, v, x_ref, volume, h, list, sums)
        integer, parameter :: kind = curved

        include 'solid_gradient_sums.inc'
    end subroutine sum_curved

    !> As bending, and the arms of tilts: total-Lagrangian bodies that bend.
    subroutine sum_referred(p, x, v, x_ref, volume, h, list, sums)
        integer, parameter :: kind = referred

        include 'solid_gradient_sums.inc'
    end subroutine sum_referred
end module brz_solid_gradient_sums
