! SPDX-License-Identifier: MIT
!> Pass 2: accelerations by the internal forces, heat of the viscous ones, and their ledger.
module brz_solid_forces
    use brz_kernel, only: kernel_scale, kernel_slope
    use brz_kinds, only: dp, int32, int64, rk
    use brz_pair_force, only: hourglass_stiff, hourglass_viscous, stress_force, viscous_force
    use brz_solid_state, only: body_t, form_bending, form_corrected_hourglass, lanes, n_pair, &
                               pair_affine, pair_c, pair_density, pair_keep, pair_stress, &
                               pair_volume, solid_t, worth_threads
    implicit none
    private
    public :: force_pass

    integer, parameter :: n_terms = 7 !! force, power of heat, stiff hourglass force
    integer, parameter :: at_heat = 4, at_hold = 4

    !> The particle whose pairs are summed over, the kernel and the settings of its body.
    type :: centre_t
        integer :: i = 0
        integer :: count = 0 !! entries of its list
        real(rk) :: scale = 0, half_over_h = 0, h = 0
        real(rk) :: alpha = 0, beta = 0
        real(rk) :: zeta = 0 !! viscous: zeta h; stiff: 2 zeta G
    end type centre_t

contains

    !> Accelerations at the present positions; heat over dt, the step just made.
    subroutine force_pass(solid, dt)
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        integer :: k

        !$omp parallel do if(solid%n >= worth_threads) schedule(static)
        do k = 1, size(solid%block, 2)
            call force_block(solid, solid%bodies(solid%block(1, k)), dt, k)
        end do
        do k = 1, size(solid%bodies)
            associate (ledger => solid%bodies(k)%ledger)
                ledger%hourglass = ledger%hourglass + ledger%hourglass_ahead
                ledger%hourglass_ahead = 0
            end associate
        end do
        do k = 1, size(solid%block, 2)
            associate (body => solid%bodies(solid%block(1, k)), sums => solid%search%sums(:, k))
                body%ledger%viscous = body%ledger%viscous + sums(1)
                body%ledger%hourglass = body%ledger%hourglass + sums(2)
                body%ledger%hourglass_ahead = body%ledger%hourglass_ahead + sums(6)
                body%reaction = body%reaction + sums(3:5)
            end associate
        end do
    end subroutine force_pass

    subroutine force_block(solid, body, dt, k)
        type(solid_t), intent(inout) :: solid
        type(body_t), intent(in) :: body
        real(dp), intent(in) :: dt
        integer, intent(in) :: k !! block
        type(centre_t) :: p
        real(rk) :: f(n_terms)
        integer :: i

        solid%search%sums(:, k) = 0
        p%scale = kernel_scale(body%h, solid%dimension)
        p%half_over_h = 1/(2*body%h)
        p%h = body%h
        p%alpha = body%alpha/4
        p%beta = body%beta/2
        p%zeta = 0
        if (body%formulation == form_corrected_hourglass) p%zeta = body%zeta_viscous*body%h
        if (body%formulation == form_bending) &
            p%zeta = 2*body%zeta*solid%materials(body%material)%shear
        do i = solid%block(2, k), solid%block(3, k)
            p%i = i
            p%count = int(solid%image(i) - solid%first(i))
            select case (body%formulation)
            case (form_bending)
                call sum_stiff(solid%n, p, solid%x, solid%v, solid%x_ref, solid%pair, &
                               solid%list(solid%first(i)), f)
            case (form_corrected_hourglass)
                call sum_viscous(solid%n, p, solid%x, solid%v, solid%pair, &
                                 solid%list(solid%first(i)), f)
            case default
                call sum_plain(solid%n, p, solid%x, solid%v, solid%pair, &
                               solid%list(solid%first(i)), f)
            end select
            if (solid%image(i) < solid%first(i + 1)) call add_images(solid, body, p, f)
            call accelerate(solid, real(dt, rk), i, k, f)
        end do
    end subroutine force_block

    !> Use the sums of particle i: acceleration, heat, ledger of its block.
    subroutine accelerate(solid, dt, i, k, f)
        type(solid_t), intent(inout) :: solid
        real(rk), intent(in) :: dt
        integer, intent(in) :: i, k
        real(rk), intent(in) :: f(n_terms)
        real(rk) :: v(3), held

        solid%volume(i) = solid%mass(i)/solid%pair(pair_density, i)
        solid%energy(i) = solid%energy(i) + dt*f(at_heat)/solid%mass(i)
        held = solid%fixed(i)
        solid%a(:, i) = (1 - held)*f(1:3)/solid%mass(i)
        v = solid%v(:, i) + (1 - held)*dt*(solid%a(:, i) + solid%load(:, i)/solid%mass(i))
        associate (sums => solid%search%sums(:, k))
            sums(1) = sums(1) + dt*f(at_heat)
            sums(2) = sums(2) - dt/2*dot_product(f(at_hold + 1:at_hold + 3), solid%v(:, i))
            sums(6) = sums(6) - dt/2*dot_product(f(at_hold + 1:at_hold + 3), v)
            sums(3:5) = sums(3:5) + dt*held*(f(1:3) + solid%load(:, i))
        end associate
        if (.not. (dot_product(f, f) <= huge(dt)) .or. solid%mu(i) <= -1) then
            if (solid%search%bad(k) == 0) solid%search%bad(k) = i
        end if
    end subroutine accelerate

    !> Add the lanes in a fixed order.
    pure subroutine add_lanes(m, acc, f)
        integer, intent(in) :: m
        real(rk), intent(in) :: acc(lanes, m)
        real(rk), intent(out) :: f(n_terms)
        integer :: t

        f = 0
        do t = 1, m
            f(t) = ((acc(1, t) + acc(5, t)) + (acc(2, t) + acc(6, t))) &
                   + ((acc(3, t) + acc(7, t)) + (acc(4, t) + acc(8, t)))
        end do
    end subroutine add_lanes

    !> Stress and viscosity over the direct neighbours.
    subroutine sum_plain(n, p, x, v, pair, list, f)
        integer, intent(in) :: n
        type(centre_t), intent(in) :: p
        real(dp), intent(in) :: x(3, n)
        real(rk), intent(in) :: v(3, n), pair(n_pair, n)
        integer(int32), intent(in) :: list(*)
        real(rk), intent(out) :: f(n_terms)
        real(rk) :: acc(lanes, 4), r(3), dv(3), own(n_pair), other(n_pair), g(3), w, u, r2, vr
        integer :: k, l, j, t

        own = pair(:, p%i)
        acc = 0
        do k = 0, p%count - 1, lanes
            !GCC$ unroll 1
            do l = 1, lanes
                j = list(k + l)
                do t = 1, 3
                    r(t) = real(x(t, p%i) - x(t, j), rk)
                    dv(t) = v(t, p%i) - v(t, j)
                end do
                do t = 1, pair_affine
                    other(t) = pair(t, j)
                end do
                r2 = r(1)*r(1) + r(2)*r(2) + r(3)*r(3)
                vr = r(1)*dv(1) + r(2)*dv(2) + r(3)*dv(3)
                w = own(pair_volume)*other(pair_volume) &
                    *kernel_slope(p%scale, p%half_over_h, sqrt(r2))
                call stress_force(w, own(pair_stress + 1), other(pair_stress + 1), r, g)
                u = viscosity(p, own, other, w, r2, vr)
                do t = 1, 3
                    acc(l, t) = acc(l, t) + g(t) + u*r(t)
                end do
                acc(l, at_heat) = acc(l, at_heat) - u*vr/2
            end do
        end do
        call add_lanes(4, acc, f)
    end subroutine sum_plain

    !> Stress, viscosity and viscous hourglass force over the direct neighbours.
    subroutine sum_viscous(n, p, x, v, pair, list, f)
        integer, intent(in) :: n
        type(centre_t), intent(in) :: p
        real(dp), intent(in) :: x(3, n)
        real(rk), intent(in) :: v(3, n), pair(n_pair, n)
        integer(int32), intent(in) :: list(*)
        real(rk), intent(out) :: f(n_terms)
        real(rk) :: acc(lanes, 4), r(3), dv(3), own(n_pair), other(n_pair), g(3), d(3)
        real(rk) :: w, u, z, r2, vr, heat
        integer :: k, l, j, t

        own = pair(:, p%i)
        acc = 0
        do k = 0, p%count - 1, lanes
            !GCC$ unroll 1
            do l = 1, lanes
                j = list(k + l)
                do t = 1, 3
                    r(t) = real(x(t, p%i) - x(t, j), rk)
                    dv(t) = v(t, p%i) - v(t, j)
                end do
                do t = 1, pair_affine
                    other(t) = pair(t, j)
                end do
                do t = pair_affine + 1, pair_affine + 9
                    other(t) = pair(t, j)
                end do
                r2 = r(1)*r(1) + r(2)*r(2) + r(3)*r(3)
                vr = r(1)*dv(1) + r(2)*dv(2) + r(3)*dv(3)
                w = own(pair_volume)*other(pair_volume) &
                    *kernel_slope(p%scale, p%half_over_h, sqrt(r2))
                call stress_force(w, own(pair_stress + 1), other(pair_stress + 1), r, g)
                u = viscosity(p, own, other, w, r2, vr)
                z = p%zeta*w*own(pair_keep)*other(pair_keep)
                call hourglass_viscous(z*own(pair_density)*own(pair_c), &
                                       z*other(pair_density)*other(pair_c), own(pair_affine + 1), &
                                       other(pair_affine + 1), dv, r, d, heat)
                do t = 1, 3
                    acc(l, t) = acc(l, t) + g(t) + u*r(t) + d(t)
                end do
                acc(l, at_heat) = acc(l, at_heat) + (heat - u*vr/2)
            end do
        end do
        call add_lanes(4, acc, f)
    end subroutine sum_viscous

    !> Stress, viscosity and stiff hourglass force over the direct neighbours.
    subroutine sum_stiff(n, p, x, v, x_ref, pair, list, f)
        integer, intent(in) :: n
        type(centre_t), intent(in) :: p
        real(dp), intent(in) :: x(3, n), x_ref(3, n)
        real(rk), intent(in) :: v(3, n), pair(n_pair, n)
        integer(int32), intent(in) :: list(*)
        real(rk), intent(out) :: f(n_terms)
        real(rk) :: acc(lanes, n_terms), r(3), dv(3), dx(3), own(n_pair), other(n_pair), g(3), d(3)
        real(rk) :: w, u, r2, vr
        integer :: k, l, j, t

        own = pair(:, p%i)
        acc = 0
        do k = 0, p%count - 1, lanes
            !GCC$ unroll 1
            do l = 1, lanes
                j = list(k + l)
                do t = 1, 3
                    r(t) = real(x(t, p%i) - x(t, j), rk)
                    dx(t) = real(x_ref(t, p%i) - x_ref(t, j), rk)
                    dv(t) = v(t, p%i) - v(t, j)
                end do
                do t = 1, pair_affine
                    other(t) = pair(t, j)
                end do
                do t = pair_affine + 1, pair_affine + 9
                    other(t) = pair(t, j)
                end do
                r2 = r(1)*r(1) + r(2)*r(2) + r(3)*r(3)
                vr = r(1)*dv(1) + r(2)*dv(2) + r(3)*dv(3)
                w = own(pair_volume)*other(pair_volume) &
                    *kernel_slope(p%scale, p%half_over_h, sqrt(r2))
                call stress_force(w, own(pair_stress + 1), other(pair_stress + 1), r, g)
                u = viscosity(p, own, other, w, r2, vr)
                call hourglass_stiff(p%zeta*w*own(pair_keep)*other(pair_keep), &
                                     own(pair_affine + 1), other(pair_affine + 1), dx, r, d)
                do t = 1, 3
                    acc(l, t) = acc(l, t) + g(t) + u*r(t) + d(t)
                    acc(l, at_hold + t) = acc(l, at_hold + t) + d(t)
                end do
                acc(l, at_heat) = acc(l, at_heat) - u*vr/2
            end do
        end do
        call add_lanes(n_terms, acc, f)
    end subroutine sum_stiff

    !> Monaghan's viscosity of a pair, as a factor of x_ij.
    pure function viscosity(p, own, other, w, r2, vr) result(u)
        type(centre_t), intent(in) :: p
        real(rk), intent(in) :: own(n_pair), other(n_pair), w, r2, vr
        real(rk) :: u
        real(rk) :: rho

        rho = own(pair_density) + other(pair_density)
        u = viscous_force(w, p%h, r2, vr, p%alpha*rho*(own(pair_c) + other(pair_c)), p%beta*rho)
    end function viscosity

    !> Add the pairs with mirror images: marked components change sign, tensors in both indices.
    subroutine add_images(solid, body, p, f)
        type(solid_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        type(centre_t), intent(in) :: p
        real(rk), intent(inout) :: f(n_terms)
        real(rk) :: s(3), r(3), dv(3), dx(3), own(n_pair), other(n_pair), g(3), d(3)
        real(rk) :: w, u, z, r2, vr, heat
        integer(int64) :: k
        integer :: j, t

        own = solid%pair(:, p%i)
        do k = solid%image(p%i), solid%first(p%i + 1) - 1
            j = solid%list(k)
            do t = 1, 3
                s(t) = merge(-1, 1, btest(solid%mask(k), t - 1))
                r(t) = real(solid%x(t, p%i) - s(t)*solid%x(t, j), rk)
                dx(t) = real(solid%x_ref(t, p%i) - s(t)*solid%x_ref(t, j), rk)
                dv(t) = solid%v(t, p%i) - s(t)*solid%v(t, j)
            end do
            other = solid%pair(:, j)
            do t = 1, 3
                other(pair_stress + 3*t - 2:pair_stress + 3*t) = &
                    s(t)*s*other(pair_stress + 3*t - 2:pair_stress + 3*t)
                other(pair_affine + 3*t - 2:pair_affine + 3*t) = &
                    s(t)*s*other(pair_affine + 3*t - 2:pair_affine + 3*t)
            end do
            r2 = r(1)*r(1) + r(2)*r(2) + r(3)*r(3)
            vr = r(1)*dv(1) + r(2)*dv(2) + r(3)*dv(3)
            w = own(pair_volume)*other(pair_volume)*kernel_slope(p%scale, p%half_over_h, sqrt(r2))
            call stress_force(w, own(pair_stress + 1), other(pair_stress + 1), r, g)
            u = viscosity(p, own, other, w, r2, vr)
            f(1:3) = f(1:3) + g + u*r
            f(at_heat) = f(at_heat) - u*vr/2
            z = p%zeta*w*own(pair_keep)*other(pair_keep)
            if (body%formulation == form_corrected_hourglass) then
                call hourglass_viscous(z*own(pair_density)*own(pair_c), &
                                       z*other(pair_density)*other(pair_c), own(pair_affine + 1), &
                                       other(pair_affine + 1), dv, r, d, heat)
                f(1:3) = f(1:3) + d
                f(at_heat) = f(at_heat) + heat
            else if (body%formulation == form_bending) then
                call hourglass_stiff(z, own(pair_affine + 1), other(pair_affine + 1), dx, r, d)
                f(1:3) = f(1:3) + d
                f(at_hold + 1:) = f(at_hold + 1:) + d
            end if
        end do
    end subroutine add_images
end module brz_solid_forces
