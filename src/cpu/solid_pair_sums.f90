! SPDX-License-Identifier: MIT
!> Pass 2, the loop over the direct neighbours of a group of particles: stress, artificial
!> viscosity, hourglass control.
!>
!> scripts/variants.py writes a loop for each set of forces, so that no body pays for a force that
!> it does not use. The compiler turns the inner loops, over the lanes, into vector code: constant
!> length, and no branch but those on `kind`, which is known.
module brz_solid_pair_sums
    use brz_force_layout, only: at_drag, at_friction, at_heat, at_stiff, at_work, n_terms
    use brz_formulation_names, only: form_bending, form_corrected_hourglass, form_total
    use brz_hold_layout, only: held_affine, held_stiffness, held_whole, n_held
    use brz_kernel, only: kernel_slope
    use brz_kinds, only: dp, int32, real32, rk
    use brz_pair_force, only: hourglass_axial, hourglass_stiff, hourglass_viscous, jump_speed, &
                              metric_square, most_bent, most_drawn, stress_force, viscous_force
    use brz_pair_layout, only: n_pair, pair_affine, pair_keep, pair_linear, pair_quadratic, &
        pair_stress, pair_tilt, pair_volume, pair_zeta
    use brz_particle_groups, only: lanes
    use brz_solid_lanes, only: body_kernel, lane_group_t, lane_kernel_t, pair_kernels
    use brz_tilted_arm, only: lifted_arm, ply_arm, radial_normal, tilted_arm, tilted_force
    implicit none
    private
    public :: add_pairs
    ! loops of their own, each: make vectors looks at them
    public :: sum_plain, sum_viscous, sum_held, sum_plate, sum_stiff, sum_total, sum_axial, sum_wide
    public :: sum_viscous_jump, sum_held_jump, sum_plate_jump, sum_wall, sum_wall_jump

    ! Forces besides those of stress and viscosity: none; the viscous hourglass force; also the
    ! hold; also tilts (plates); those of curved walls, each of the four also with a viscosity
    ! that sees jumps alone, the kind behind; the stiff hourglass force; the same in total-
    ! Lagrangian bodies, where X_ij weighs the pairs and the stress (Piola's) acts along it; the
    ! stiff one along the axes of the material, and tilts; the same in total-Lagrangian bodies, in
    ! the metric of their lattice.
    integer, parameter :: plain = 1, viscous = 2, viscous_jump = 3, held = 4, held_jump = 5, &
                          plate = 6, plate_jump = 7, wall = 8, wall_jump = 9, stiff = 10, &
                          total = 11, axial = 12, wide = 13

contains

    !> Add the forces of the particles of a list to p%sums, by the loop that has just those of the
    !> body.
    subroutine add_pairs(p, x, v, x_ref, pair, h, list, k_axes, drawn)
        type(lane_group_t), intent(inout) :: p
        real(dp), intent(in) :: x(3, *), x_ref(3, *)
        real(rk), intent(in) :: v(3, *), pair(n_pair, *), h(*)
        integer(int32), intent(in) :: list(*)
        real(real32), intent(in), optional :: k_axes(6, *) !! only with a stiffness along axes
        real(rk), intent(in), optional :: drawn(n_held, *) !! only with the hold
        integer :: kind

        kind = plain
        if (p%formulation == form_corrected_hourglass) kind = viscous
        if (p%formulation == form_bending) kind = merge(axial, stiff, p%directional)
        if (p%formulation == form_total) kind = merge(wide, total, p%directional)
        if (p%held) kind = merge(plate, held, any(p%normal > 0))
        if (p%held .and. p%curved) kind = wall
        if (p%jumps) kind = merge(kind, viscous, p%held) + 1
        if (p%held .and. p%curved) call find_normals(p, x_ref, list)
        call sum_pairs(kind, p, x, v, x_ref, pair, h, list, k_axes, drawn)
    end subroutine add_pairs

    !> The same with the forces of one kind.
    !@variant sum_plain: plain
    !@variant sum_viscous: viscous
    !@variant sum_viscous_jump: viscous_jump
    !@variant sum_held: held
    !@variant sum_held_jump: held_jump
    !@variant sum_plate: plate
    !@variant sum_plate_jump: plate_jump
    !@variant sum_wall: wall
    !@variant sum_wall_jump: wall_jump
    !@variant sum_stiff: stiff
    !@variant sum_total: total
    !@variant sum_axial: axial
    !@variant sum_wide: wide
    subroutine sum_pairs(kind, p, x, v, x_ref, pair, h, list, k_axes, drawn)
        integer, intent(in) :: kind !! of forces, known to the compiler
        type(lane_group_t), intent(inout) :: p
        real(dp), intent(in) :: x(3, *), x_ref(3, *)
        real(rk), intent(in) :: v(3, *), pair(n_pair, *), h(*)
        integer(int32), intent(in) :: list(*)
        real(real32), intent(in), optional :: k_axes(6, *)
        real(rk), intent(in), optional :: drawn(n_held, *)
        real(rk) :: acc(lanes, n_terms), r(3), dv(3), dx(3), own(n_pair), f(3), g(3), d(3), e(3)
        real(rk) :: w, u, y, r2, s2, vr, jump, heat, across(3)
        type(lane_kernel_t) :: q
        integer :: k, l, j, n, t

        n = merge(at_stiff, n_terms, kind <= viscous_jump)
        acc(:, :n) = p%sums(:, :n)
        call body_kernel(p, q)
        do k = 1, p%count
            j = list(k)
            if (kind /= wide .and. p%variable) call pair_kernels(p, h(j), q)
            !GCC$ unroll 1
            do l = 1, lanes
                do t = 1, 3
                    r(t) = real(p%x(l, t) - x(t, j), rk)
                    if (kind > viscous_jump) dx(t) = real(p%x_ref(l, t) - x_ref(t, j), rk)
                    dv(t) = p%v(l, t) - v(t, j)
                    if (kind == wall .or. kind == wall_jump) across(t) = p%normals(l, t)
                end do
                do t = 1, 8
                    own(t) = p%row(l, t)
                    own(t + 8) = p%row(l, t + 8)
                    own(t + 16) = p%row(l, t + 16)
                end do
                r2 = r(1)*r(1) + r(2)*r(2) + r(3)*r(3)
                vr = r(1)*dv(1) + r(2)*dv(2) + r(3)*dv(3)
                s2 = r2
                if (kind == total .or. kind == wide) s2 = dx(1)*dx(1) + dx(2)*dx(2) + dx(3)*dx(3)
                w = own(pair_volume)*pair(pair_volume, j) &
                    *kernel_slope(q%scale(l), q%half_over_h(l), sqrt(s2))
                if (kind == wall .or. kind == wall_jump) then
                    call pull_in_wall(p%lift, across, p%there(1, k), own, pair(1, j), r, dx, w, g)
                else
                    call pull(kind, p%lift, p%normal, own, pair(1, j), r, dx, w, g)
                end if
                s2 = 1
                if (kind == wide) s2 = metric_square(dx, p%width*dx)
                jump = vr
                if (kind == viscous_jump .or. kind == held_jump .or. &
                    kind == plate_jump .or. kind == wall_jump) &
                    jump = jump_speed(own(pair_affine + 1), pair(pair_affine + 1, j), r, vr)
                u = viscous_force(w*s2, q%h(l)/sqrt(s2), r2, jump, &
                                  own(pair_linear) + pair(pair_linear, j), &
                                  own(pair_quadratic) + pair(pair_quadratic, j))
                y = w*own(pair_keep)*pair(pair_keep, j)
                if (kind >= viscous .and. kind <= wall_jump) &
                    call hourglass_viscous(y*own(pair_zeta), y*pair(pair_zeta, j), &
                                           own(pair_affine + 1), pair(pair_affine + 1, j), dv, r, &
                                           d, heat)
                if (kind > viscous_jump) &
                    call keep(kind, p, l, j, own, pair(1, j), k_axes, drawn, r, dx, y, e)
                do t = 1, 3
                    acc(l, t) = acc(l, t) + g(t)
                    f(t) = u*r(t)
                    if (kind >= viscous .and. kind <= wall_jump) f(t) = f(t) + d(t)
                    acc(l, at_drag + t) = acc(l, at_drag + t) + f(t)
                    if (kind > viscous_jump) acc(l, at_stiff + t) = acc(l, at_stiff + t) + e(t)
                end do
                acc(l, at_heat) = acc(l, at_heat) - u*vr/2
                if (kind >= viscous .and. kind <= wall_jump) &
                    acc(l, at_friction) = acc(l, at_friction) + heat
                if (kind >= held .and. kind <= wall_jump) &
                    acc(l, at_work) = acc(l, at_work) - (e(1)*dv(1) + e(2)*dv(2) + e(3)*dv(3))/2
            end do
        end do
        p%sums(:, :n) = acc(:, :n)
        p%sums(:, n + 1:) = 0
    end subroutine sum_pairs

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
        real(rk), intent(in) :: lift, n(3), n_j(3) !! see tilted_arm; normals of both
        real(rk), intent(in) :: own(n_pair), other(n_pair), r(3), dx(3), w
        real(rk), intent(out) :: g(3)
        real(rk) :: arm(3), arm_j(3)

        call ply_arm(own(pair_tilt), lift, n, dx, r, arm)
        call ply_arm(-other(pair_tilt), lift, n_j, dx, r, arm_j)
        call tilted_force(w, own(pair_stress + 1), other(pair_stress + 1), arm, arm_j, g)
    end subroutine pull_in_wall

    !> Force of the stresses of a pair, along its arms.
    !@variant
    pure subroutine pull(kind, lift, n, own, other, r, dx, w, g)
        integer, intent(in) :: kind
        real(rk), intent(in) :: lift, n(3) !! see tilted_arm
        real(rk), intent(in) :: own(n_pair), other(n_pair), r(3), dx(3), w
        real(rk), intent(out) :: g(3)
        real(rk) :: arm(3), arm_j(3)

        if (kind == plate .or. kind == plate_jump) then
            call tilted_arm(own(pair_tilt), lift, n, dx, r, arm)
            call tilted_arm(-other(pair_tilt), lift, n, dx, r, arm_j)
        else if (kind == axial) then
            call ply_arm(own(pair_tilt), lift, n, dx, r, arm)
            call ply_arm(-other(pair_tilt), lift, n, dx, r, arm_j)
        else if (kind == wide) then
            call lifted_arm(own(pair_tilt), lift, n, dx, arm)
            call lifted_arm(-other(pair_tilt), lift, n, dx, arm_j)
        end if
        if (kind == plate .or. kind == plate_jump .or. kind >= axial) then
            call tilted_force(w, own(pair_stress + 1), other(pair_stress + 1), arm, arm_j, g)
        else if (kind == total) then
            call stress_force(w, own(pair_stress + 1), other(pair_stress + 1), dx, g)
        else
            call stress_force(w, own(pair_stress + 1), other(pair_stress + 1), r, g)
        end if
    end subroutine pull

    !> Force of what keeps a pair at its place in the unloaded body.
    !@variant
    pure subroutine keep(kind, p, l, j, own, other, k_axes, drawn, r, dx, w, f)
        integer, intent(in) :: kind
        type(lane_group_t), intent(in) :: p
        integer, intent(in) :: l, j !! lane, neighbour
        real(rk), intent(in) :: own(n_pair), other(n_pair), r(3), dx(3), w
        real(real32), intent(in), optional :: k_axes(6, *)
        real(rk), intent(in), optional :: drawn(n_held, *)
        real(rk), intent(out) :: f(3)
        real(rk) :: mine(n_held), axes(6), unloaded(3)
        integer :: t

        if (kind >= held .and. kind <= wall_jump) then
            do t = 1, 6
                mine(t) = p%own(l, t)
                mine(t + 6) = p%own(l, t + 6)
            end do
            call hourglass_stiff(most_drawn, w*mine(held_whole)*drawn(held_whole, j), &
                                 mine(held_stiffness) + drawn(held_stiffness, j), &
                                 mine(held_affine + 1), drawn(held_affine + 1, j), dx, r, f)
        else if (kind >= axial) then
            do t = 1, 6
                axes(t) = p%k_axes(l, t) + real(k_axes(t, j), rk)
            end do
            do t = 1, 3
                unloaded(t) = dx(t)
                if (kind == wide) unloaded(t) = p%width(t)*dx(t)
            end do
            call hourglass_axial(w, axes, own(pair_affine + 1), other(pair_affine + 1), dx, &
                                 unloaded, r, f)
        else
            call hourglass_stiff(most_bent, w, own(pair_zeta) + other(pair_zeta), &
                                 own(pair_affine + 1), other(pair_affine + 1), dx, r, f)
        end if
    end subroutine keep
end module brz_solid_pair_sums
