! SPDX-License-Identifier: MIT
!> Laminates and plates of metal of unit particles, for the tests of tilted gradients.
module layered_bodies
    use brz_body_setup, only: set_up_solid
    use brz_errors, only: failed
    use brz_formulation_names, only: form_corrected_hourglass
    use brz_kinds, only: dp, rk
    use brz_pair_layout, only: pair_affine
    use brz_solid_gradients, only: gradient_pass
    use brz_particles, only: particles_t
    use brz_solid_start, only: solid_time_step, start_solid
    use brz_solid_driver, only: solid_step
    use solid_scenes, only: metal, noise, solid_scene_t
    implicit none
    private
    public :: alike, carbon, block, sheet, pipe, strain, linear_field, take_steps, difference, &
              breathing, turned

    real(dp), parameter :: alike(9) = [1.0_dp, 1.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.5_dp, &
                                       0.5_dp, 0.5_dp]
    real(dp), parameter :: carbon(9) = [1.0_dp, 8.2_dp/150, 8.2_dp/150, 0.34_dp, 0.34_dp, 0.53_dp, &
                                        4.34_dp/150, 4.34_dp/150, 2.7_dp/150]

contains

    !> A block of unit particles and unit density, plies along z at 0, 90, 0, ... degrees. With the
    !> moduli `alike` its stress is the strain.
    subroutine block(sides, moduli, s)
        integer, intent(in) :: sides(3)
        real(dp), intent(in) :: moduli(9)
        type(solid_scene_t), intent(out) :: s

        call metal(s%case, 'orthotropic_ply', [character(24) :: 'density', 'e1', 'e2', 'e3', &
                   'nu12', 'nu13', 'nu23', 'g12', 'g13', 'g23'], [1.0_dp, moduli])
        s%case%run%dimension = 3
        associate (body => s%case%bodies(1))
            body%lo = -sides/2.0_dp
            body%hi = sides/2.0_dp
            body%spacing = 1
            body%formulation = 'bending'
            body%n_plies = sides(3)
            body%ply_angle(2:sides(3):2) = 90
        end associate
    end subroutine block

    !> The same of metal with Young's modulus 1, Poisson's ratio 0: its stress is the strain until
    !> it yields.
    subroutine sheet(sides, yield, s)
        integer, intent(in) :: sides(3)
        real(dp), intent(in) :: yield !! stress
        type(solid_scene_t), intent(out) :: s

        call metal(s%case, 'bilinear_j2', [character(24) :: 'density', 'youngs_modulus', &
                   'poisson_ratio', 'yield_stress'], [1.0_dp, 1.0_dp, 0.0_dp, yield])
        s%case%run%dimension = 3
        associate (body => s%case%bodies(1))
            body%lo = -sides/2.0_dp
            body%hi = sides/2.0_dp
            body%spacing = 1
        end associate
    end subroutine sheet

    !> A ring of so many layers, a spacing apart, of E = 1, nu = 0; of length 0 in plane strain.
    subroutine pipe(layers, radius, length, yield, s)
        integer, intent(in) :: layers, length
        real(dp), intent(in) :: radius !! of the middle of the wall
        real(dp), intent(in) :: yield !! stress
        type(solid_scene_t), intent(out) :: s

        call sheet([1, 1, 1], yield, s)
        if (length == 0) s%case%run%dimension = 2
        associate (body => s%case%bodies(1))
            body%shape = 'cylinder'
            body%layered = .true.
            body%radius = radius + layers/2.0_dp
            body%inner_radius = radius - layers/2.0_dp
            body%length = max(length, 1)
        end associate
    end subroutine pipe

    !> Strain rates that particles see now: of plies, whose rows do not hold them, by their stress.
    subroutine strain(s, rate)
        type(solid_scene_t), intent(inout) :: s
        real(rk), allocatable, intent(out) :: rate(:, :) !! (6, n) xx, yy, zz, xy, yz, xz
        real(dp), parameter :: dt = 1e-14_dp

        if (s%solid%bodies(1)%formulation == form_corrected_hourglass) then
            call gradient_pass(s%solid, 0.0_dp)
            associate (h => s%solid%pair(pair_affine + 1:pair_affine + 9, :))
                rate = h([1, 5, 9, 4, 8, 7], :)
                rate(4:6, :) = (rate(4:6, :) + h([2, 6, 3], :))/2
            end associate
        else
            s%solid%stress = 0
            s%solid%hist = 0
            call gradient_pass(s%solid, dt)
            rate = s%solid%stress/real(dt, rk)
        end if
    end subroutine strain

    !> Largest error of the strain rates in a linear field, on the lattice of a scene that is set up
    !> here and then shaken.
    real(rk) function linear_field(s) result(worst)
        type(solid_scene_t), intent(inout) :: s
        real(rk), allocatable :: rate(:, :)
        real(rk) :: a(3, 3), e(6)
        integer :: i

        call set_up_solid(s%case, s%solid, s%err)
        call start_solid(s%solid, s%err)
        a = reshape([0.3_rk, -1.0_rk, 0.7_rk, 2.0_rk, 0.1_rk, -0.4_rk, 0.9_rk, 1.1_rk, -0.6_rk], &
                    [3, 3])
        e = [a(1, 1), a(2, 2), a(3, 3), (a(1, 2) + a(2, 1))/2, (a(2, 3) + a(3, 2))/2, &
             (a(1, 3) + a(3, 1))/2]
        do i = 1, s%solid%n
            s%solid%x(:, i) = s%solid%x(:, i) + 0.05_dp*noise(i)
            s%solid%v(:, i) = matmul(a, real(s%solid%x(:, i), rk)) + 1
        end do
        call strain(s, rate)
        worst = maxval(abs(rate - spread(e, 2, s%solid%n)))
    end function linear_field

    subroutine take_steps(s, steps)
        type(solid_scene_t), intent(inout) :: s
        integer, intent(in) :: steps
        integer :: k

        do k = 1, steps
            if (.not. failed(s%err)) call solid_step(s%solid, solid_time_step(s%solid), s%err)
        end do
    end subroutine take_steps

    !> Largest difference in place and stress of particles that started at the same place; huge
    !> where one has no partner.
    real(dp) function difference(whole, part)
        class(particles_t), intent(in) :: whole, part
        integer :: i, j, n

        difference = 0
        n = 0
        do i = 1, part%n
            do j = 1, whole%n
                if (norm2(whole%x_ref(:, j) - part%x_ref(:, i)) > 0.01_dp) cycle
                n = n + 1
                difference = max(difference, norm2(whole%x(:, j) - part%x(:, i)), &
                                 real(maxval(abs(whole%stress(:, j) - part%stress(:, i))), dp))
            end do
        end do
        if (n /= part%n) difference = huge(difference)
    end function difference

    !> A laminate 0, 90, 90, 0, or a plate of metal, that breathes, symmetric to all three planes,
    !> after 60 steps: the whole (0), a quarter (1), the upper half (2), or two halves that are
    !> bonded (3).
    subroutine breathing(what, of_metal, s)
        integer, intent(in) :: what
        logical, intent(in) :: of_metal
        type(solid_scene_t), intent(out) :: s
        integer :: i

        if (of_metal) then
            call sheet([18, 20, 6], 0.01_dp, s)
        else
            call block([8, 6, 4], carbon, s)
            s%case%bodies(1)%ply_angle(1:4) = [0, 90, 90, 0]
        end if
        s%case%run%symmetry = [what == 1, what == 1, what == 2]
        if (what == 3) then
            s%case%bodies = [s%case%bodies(1), s%case%bodies(1)]
            s%case%bodies(1)%hi(3) = 0
            s%case%bodies(2)%lo(3) = 0
            s%case%bodies(2)%id = 'upper'
            if (.not. of_metal) s%case%bodies%n_plies = 2
            s%case%bodies(2)%ply_angle(1:2) = [90, 0]
            allocate (s%case%interactions(1))
            s%case%interactions(1)%law = 'bonded'
        end if
        call set_up_solid(s%case, s%solid, s%err)
        do i = 1, s%solid%n
            associate (x => s%solid%x(:, i))
                s%solid%v(:, i) = real([0.02_dp*sin(0.4_dp*x(1))*cos(x(3)), &
                                        0.01_dp*sin(0.5_dp*x(2)), &
                                        0.02_dp*sin(x(3))*cos(0.3_dp*x(1)*x(2))], rk)
            end associate
        end do
        call start_solid(s%solid, s%err)
        call take_steps(s, 60)
    end subroutine breathing

    !> Turned about (1, 2, 3) by an angle.
    pure function turned(x, angle) result(y)
        real(dp), intent(in) :: x(3), angle
        real(dp) :: y(3), e(3)

        e = [1.0_dp, 2.0_dp, 3.0_dp]/sqrt(14.0_dp)
        y = x*cos(angle) + dot_product(e, x)*(1 - cos(angle))*e + sin(angle)* &
            [e(2)*x(3) - e(3)*x(2), e(3)*x(1) - e(1)*x(3), e(1)*x(2) - e(2)*x(1)]
    end function turned
end module layered_bodies
