! SPDX-License-Identifier: MIT
!> Pass 1, the loop over the direct neighbours of a group of particles.
!>
!> scripts/variants.py writes a loop for each set of sums. The compiler turns the inner loops, over
!> the lanes, into vector code: constant length, and no branch but those on `kind`, which is known.
module brz_solid_gradient_sums
    use brz_formulation_names, only: form_bending, form_total
    use brz_gradient, only: moment_terms, outer_terms
    use brz_kernel, only: kernel_slope
    use brz_kinds, only: dp, int32, rk
    use brz_moment_layout, only: at_f, at_g, at_s, at_x, at_y, n_sums
    use brz_particle_groups, only: lanes
    use brz_solid_lanes, only: body_kernel, lane_group_t, lane_kernel_t, pair_kernels
    use brz_tilted_arm, only: lifted_arm, ply_arm, tilted_arm
    implicit none
    private
    public :: add_neighbours
    ! loops of their own, each: make vectors looks at them
    public :: sum_plain, sum_bending, sum_drawn, sum_tilted, sum_curved, sum_referred

    integer, parameter :: n_moment = 6, n_outer = 9
    ! kinds, by the number of sums: moments and velocity; also the reference position; also its
    ! moments, for the hold; also the arms of tilts; those of curved walls, with one sum more, which
    ! stays 0; those of total-Lagrangian bodies that bend
    integer, parameter :: plain = at_x, bending = at_s, drawn = at_y, tilted = at_f, &
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
            kind = merge(drawn, plain, any(p%drawn))
            if (p%formulation == form_bending) kind = bending
            if (any(abs(p%tilt) > 0)) kind = merge(curved, tilted, p%curved)
            call sum_neighbours(kind, p, x, v, x_ref, volume, h, list, sums)
        end if
    end subroutine add_neighbours

    !> The sums of one kind, and the velocity along the arms.
    !@variant sum_plain: plain
    !@variant sum_bending: bending
    !@variant sum_drawn: drawn
    !@variant sum_tilted: tilted
    !@variant sum_curved: curved
    !@variant sum_referred: referred
    subroutine sum_neighbours(kind, p, x, v, x_ref, volume, h, list, sums)
        integer, intent(in) :: kind !! of sums, known to the compiler
        type(lane_group_t), intent(in) :: p
        real(dp), intent(in) :: x(3, *), x_ref(3, *)
        real(rk), intent(in) :: v(3, *), volume(*), h(*)
        integer(int32), intent(in) :: list(*)
        real(rk), intent(inout) :: sums(lanes, n_sums)
        real(rk) :: acc(lanes, n_sums), r(3), dv(3), dx(3), y(3), m(n_moment), s(n_moment), w
        real(rk) :: n(3)
        real(rk) :: g(n_outer), a(n_outer), b(n_outer), f(n_outer)
        type(lane_kernel_t) :: q
        integer :: k, l, j, t

        acc(:, :kind) = sums(:, :kind)
        call body_kernel(p, q)
        do k = 1, p%count
            j = list(k)
            if (kind /= referred .and. p%variable) call pair_kernels(p, h(j), q)
            !GCC$ unroll 1
            do l = 1, lanes
                do t = 1, 3
                    r(t) = real(p%x(l, t) - x(t, j), rk)
                    if (kind > plain) dx(t) = real(p%x_ref(l, t) - x_ref(t, j), rk)
                    dv(t) = p%v(l, t) - v(t, j)
                    y(t) = r(t)
                    if (kind == curved) n(t) = p%normals(l, t)
                end do
                w = volume(j)*kernel_slope(q%scale(l), q%half_over_h(l), &
                                           sqrt(r(1)*r(1) + r(2)*r(2) + r(3)*r(3)))
                if (kind == tilted) call tilted_arm(p%tilt(l), p%lift, p%normal, dx, r, y)
                if (kind == curved) call ply_arm(p%tilt(l), p%lift, n, dx, r, y)
                if (kind == referred) call lifted_arm(p%tilt(l), p%lift, p%normal, r, y)
                call moment_terms(w, r, m)
                call outer_terms(w, dv, y, g)
                if (kind > plain) call outer_terms(w, dx, r, a)
                if (kind >= drawn .and. kind <= curved) call moment_terms(w, dx, s)
                if (kind >= tilted) call outer_terms(w, r, y, b)
                if (kind == referred) call outer_terms(w, dx, y, f)
                do t = 1, n_moment
                    acc(l, t) = acc(l, t) + m(t)
                    if (kind < drawn .or. kind > curved) cycle
                    acc(l, at_s + t) = acc(l, at_s + t) + s(t)
                end do
                do t = 1, n_outer
                    acc(l, at_g + t) = acc(l, at_g + t) + g(t)
                    if (kind > plain) acc(l, at_x + t) = acc(l, at_x + t) + a(t)
                    if (kind >= tilted) acc(l, at_y + t) = acc(l, at_y + t) + b(t)
                    if (kind == referred) acc(l, at_f + t) = acc(l, at_f + t) + f(t)
                end do
            end do
        end do
        sums(:, :kind) = acc(:, :kind)
        sums(:, kind + 1:) = 0
    end subroutine sum_neighbours
end module brz_solid_gradient_sums
