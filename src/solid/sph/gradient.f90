! SPDX-License-Identifier: MIT
!> Corrected gradients of one particle: pair terms, correction matrix, velocity gradient; its CFL
!> limit.
!>
!> With w = V_j F_ij, M = sum w x_ij (x) x_ij and B = M^-1, the gradient of a field u is
!> sum w u_ij (x) x_ij B: exact for linear fields on any arrangement of particles. Point physics.
!>
!> Source: docs/theory/solids.md; Randles & Libersky 1996, Bonet & Lok 1999
module brz_gradient
    use brz_algebra, only: determinant3, inverse3, multiply3, to_matrix
    use brz_eigen, only: diagonalise
    use brz_kinds, only: rk
    implicit none
    private
    public :: moment_terms, outer_terms, correction, midstep_gradient, shear_limiter, &
              stable_step, total_gradient, piola, invert_supported
    public :: limiter_none, limiter_balsara, limiter_compression, limiter_slope

    ! of the artificial viscosity; the last one is one of pairs, jump_speed of brz_pair_force
    integer, parameter :: limiter_none = 0, limiter_balsara = 1, limiter_compression = 2, &
                          limiter_slope = 3

    ! smaller eigenvalues of M are not inverted in full; at the corner of a regular block the
    ! smallest is 0.25 in 2-D and 0.18 in 3-D
    real(rk), parameter :: weakest_2d = 0.15_rk, weakest_3d = 0.1_rk
    real(rk), parameter :: blur = 64*epsilon(1.0_rk) !! of a determinant over the cube of its matrix
    real(rk), parameter :: most_strain = 0.2_rk !! and rotation of one step

contains

    !> Terms of a pair in the moment matrix M.
    !@cuf attributes(host,device) &
    pure subroutine moment_terms(w, r, m)
        real(rk), intent(in) :: w !! V_j F_ij
        real(rk), intent(in) :: r(3) !! x_ij [m]
        real(rk), intent(out) :: m(6) !! xx, yy, zz, xy, yz, xz
        real(rk) :: x, y, z

        x = w*r(1)
        y = w*r(2)
        z = w*r(3)
        m(1) = x*r(1)
        m(2) = y*r(2)
        m(3) = z*r(3)
        m(4) = x*r(2)
        m(5) = y*r(3)
        m(6) = x*r(3)
    end subroutine moment_terms

    !> Terms w u (x) r of a pair in the sum of a vector field.
    !@cuf attributes(host,device) &
    pure subroutine outer_terms(w, u, r, g)
        real(rk), intent(in) :: w !! V_j F_ij
        real(rk), intent(in) :: u(3) !! difference of the field over the pair
        real(rk), intent(in) :: r(3) !! x_ij [m]
        real(rk), intent(out) :: g(9) !! column by column
        real(rk) :: x, y, z

        x = w*u(1)
        y = w*u(2)
        z = w*u(3)
        g(1) = x*r(1)
        g(2) = y*r(1)
        g(3) = z*r(1)
        g(4) = x*r(2)
        g(5) = y*r(2)
        g(6) = z*r(2)
        g(7) = x*r(3)
        g(8) = y*r(3)
        g(9) = z*r(3)
    end subroutine outer_terms

    !> Correction B: the inverse of M, tamed where the neighbours leave a direction unsupported.
    !@cuf attributes(host,device) &
    pure subroutine correction(dimension, m, b, weak)
        integer, intent(in) :: dimension
        real(rk), intent(in) :: m(6) !! moment matrix, xx, yy, zz, xy, yz, xz
        real(rk), intent(out) :: b(3, 3)
        integer, intent(out) :: weak !! 1 where a direction is unsupported, else 0
        real(rk) :: a(3, 3)

        call to_matrix(m, a)
        call invert_supported(dimension, a, b, weak)
        if (weak == 1) call tamed_inverse(weakest_of(dimension), a, b)
    end subroutine correction

    !> Inverse of a moment matrix, and whether its neighbours support every direction. Minors and
    !> determinant of that of a single neighbour are rounding alone, and their ratios no inverse.
    !@cuf attributes(host,device) &
    pure subroutine invert_supported(dimension, a, b, weak)
        integer, intent(in) :: dimension
        real(rk), intent(in) :: a(3, 3)
        real(rk), intent(out) :: b(3, 3)
        integer, intent(out) :: weak !! 1 where a direction is unsupported, else 0
        real(rk) :: norm, size2
        logical :: ok
        integer :: i, j

        call inverse3(a, b, ok)
        norm = 0
        size2 = 0
        do j = 1, 3
            do i = 1, 3
                norm = norm + b(i, j)*b(i, j)
                size2 = size2 + a(i, j)*a(i, j)
            end do
        end do
        weak = 1
        if (.not. abs(determinant3(a)) > blur*size2*sqrt(size2)) return
        if (ok .and. norm <= 1/weakest_of(dimension)**2) weak = 0
    end subroutine invert_supported

    !> Smallest eigenvalue of M that is inverted in full.
    !@cuf attributes(host,device) &
    pure function weakest_of(dimension) result(weakest)
        integer, intent(in) :: dimension
        real(rk) :: weakest

        weakest = weakest_2d
        if (dimension == 3) weakest = weakest_3d
    end function weakest_of

    !> Inverse by eigenvalues l: 1/l above the limit, l/limit^2 below, which goes to 0 with l.
    !@cuf attributes(host,device) &
    pure subroutine tamed_inverse(weakest, a, b)
        real(rk), intent(in) :: weakest !! the limit
        real(rk), intent(inout) :: a(3, 3) !! symmetric, destroyed
        real(rk), intent(out) :: b(3, 3)
        real(rk) :: q(3, 3), l(3)
        integer :: i, j

        call diagonalise(a, q)
        do i = 1, 3
            l(i) = a(i, i)/weakest**2
            if (a(i, i) > weakest) l(i) = 1/a(i, i)
            l(i) = max(l(i), 0.0_rk)
        end do
        do j = 1, 3
            do i = 1, 3
                b(i, j) = l(1)*q(i, 1)*q(j, 1) + l(2)*q(i, 2)*q(j, 2) + l(3)*q(i, 3)*q(j, 3)
            end do
        end do
    end subroutine tamed_inverse

    !> Velocity gradient in the middle of the step, L = H (I - dt/2 H)^-1.
    !>
    !> H is the gradient of the mid-step velocity with respect to the positions just reached; left
    !> as it is it would inflate a spinning body at the rate w^2 dt/2 (Hughes & Winget 1980).
    !@cuf attributes(host,device) &
    pure subroutine midstep_gradient(h, dt, l)
        real(rk), intent(in) :: h(3, 3) !! dv/dx at the new positions [1/s]
        real(rk), intent(in) :: dt !! [s]
        real(rk), intent(out) :: l(3, 3) !! [1/s]
        real(rk) :: a(3, 3), b(3, 3)
        logical :: ok
        integer :: i, j

        do j = 1, 3
            do i = 1, 3
                a(i, j) = -dt/2*h(i, j)
            end do
            a(j, j) = 1 + a(j, j)
        end do
        call inverse3(a, b, ok)
        call multiply3(h, b, l)
    end subroutine midstep_gradient

    !> Share of the artificial viscosity that is left where the flow is no shock.
    !>
    !> `limiter_balsara`: |div v|/(|div v| + |curl v|), Balsara 1995. It spares what turns, not what
    !> is strained without turning, as the material around a penetrating body.
    !> `limiter_compression`: (4 c)^2/((4 c)^2 + S:S + |curl v|^2), c = max(-div v, 0), S the
    !> deviatoric rate of strain. 0.96 in a plane shock, 0 where the volume does not shrink. After
    !> Cullen and Dehnen 2010, whose factor has |curl v| within S and their shock indicator for 4.
    !@cuf attributes(host,device) &
    pure function shear_limiter(limiter, h, rate) result(share)
        integer, intent(in) :: limiter !! limiter_none, ...
        real(rk), intent(in) :: h(3, 3) !! dv/dx [1/s]
        real(rk), intent(in) :: rate !! sound speed over smoothing length [1/s]
        real(rk) :: share
        real(rk) :: div, curl2, shear2, shrink2

        share = 1
        if (limiter == limiter_none .or. limiter == limiter_slope) return
        div = h(1, 1) + h(2, 2) + h(3, 3)
        curl2 = (h(3, 2) - h(2, 3))**2 + (h(1, 3) - h(3, 1))**2 + (h(2, 1) - h(1, 2))**2
        if (limiter == limiter_balsara) then
            share = abs(div)/(abs(div) + sqrt(curl2) + 1e-4_rk*rate)
        else
            shear2 = (h(1, 1) - div/3)**2 + (h(2, 2) - div/3)**2 + (h(3, 3) - div/3)**2 &
                + ((h(3, 2) + h(2, 3))**2 + (h(1, 3) + h(3, 1))**2 + (h(2, 1) + h(1, 2))**2)/2
            shrink2 = 16*min(div, 0.0_rk)**2
            share = shrink2/(shrink2 + shear2 + curl2 + (1e-4_rk*rate)**2)
        end if
    end function shear_limiter

    !> Largest time step of a particle: no wave, with what the viscosity adds to it, crosses more
    !> than `cfl` of its size, it is not strained by more than a fifth, and the viscosity does not
    !> turn the velocity of neighbours round (`viscous_step`).
    !@cuf attributes(host,device) &
    pure function stable_step(cfl, size, c, c_bulk, alpha, beta, h) result(dt)
        real(rk), intent(in) :: cfl
        real(rk), intent(in) :: size !! smoothing length [m]
        real(rk), intent(in) :: c !! fastest wave [m/s]
        real(rk), intent(in) :: c_bulk !! sound speed in the viscosity [m/s]
        real(rk), intent(in) :: alpha, beta !! linear and quadratic viscosity
        real(rk), intent(in) :: h(3, 3) !! dv/dx [1/s]
        real(rk) :: dt !! [s]
        real(rk) :: rate
        integer :: i

        dt = cfl*size/(c + 0.6_rk*beta*size*abs(h(1, 1) + h(2, 2) + h(3, 3)))
        rate = tiny(rate)
        do i = 1, 3
            rate = rate + h(1, i)*h(1, i) + h(2, i)*h(2, i) + h(3, i)*h(3, i)
        end do
        dt = min(dt, most_strain/sqrt(rate), viscous_step(size, c_bulk, alpha, beta, h))
    end function stable_step

    !> Largest explicit step of the viscosity, 0.8 h/(alpha c + 2 beta h |D|), D the strain rate.
    !>
    !> Velocities that change sign from neighbour to neighbour decay at the rate of at most
    !> k = 2 (alpha c + 2 beta |phi|)/h sum_j V_j F_ij h^2/d, where |phi| <= h |D| and the sum is
    !> 1.27, 1.05, 0.90 on a lattice with h = 1.2 spacings in one, two, three dimensions (only
    !> pairs that approach count: all do in a shock). An explicit step amplifies them from k dt = 2.
    !@cuf attributes(host,device) &
    pure function viscous_step(size, c_bulk, alpha, beta, h) result(dt)
        real(rk), intent(in) :: size, c_bulk, alpha, beta, h(3, 3) !! see stable_step
        real(rk) :: dt !! [s]
        real(rk) :: rate

        rate = sqrt(h(1, 1)**2 + h(2, 2)**2 + h(3, 3)**2 + ((h(2, 1) + h(1, 2))**2 &
                    + (h(3, 2) + h(2, 3))**2 + (h(1, 3) + h(3, 1))**2)/2)
        dt = 0.8_rk*size/(alpha*c_bulk + 2*beta*size*rate + tiny(rate))
    end function viscous_step

    !> Velocity gradient dv/dx from dv/dX, and how much shorter the reference looks to a wave.
    !@cuf attributes(host,device) &
    pure subroutine total_gradient(at_rest, f, h, shrink)
        real(rk), intent(in) :: at_rest !! sum of the squares of the two smaller stretches of dX
                                        !! over dx of the unloaded body: 2, see brz_wide_lattice
        real(rk), intent(in) :: f(3, 3) !! deformation dx/dX
        real(rk), intent(inout) :: h(3, 3) !! dv/dX in, dv/dx out [1/s]
        real(rk), intent(out) :: shrink !! largest ratio of a distance dX to dx, at least 1 or what
                                        !! it is in the unloaded body
        real(rk) :: a(3, 3), g(3, 3), sum
        logical :: ok
        integer :: i, j

        call inverse3(f, a, ok)
        call multiply3(h, a, g)
        sum = -at_rest
        do j = 1, 3
            do i = 1, 3
                h(i, j) = g(i, j)
                sum = sum + a(i, j)*a(i, j)
            end do
        end do
        shrink = sqrt(max(sum, 1.0_rk))
    end subroutine total_gradient

    !> First Piola-Kirchhoff stress P = det(F) sigma F^-T from the Cauchy stress.
    !@cuf attributes(host,device) &
    pure subroutine piola(f, s)
        real(rk), intent(in) :: f(3, 3) !! deformation dx/dX
        real(rk), intent(inout) :: s(3, 3) !! Cauchy in, Piola out [Pa]
        real(rk) :: a(3, 3), c(3, 3), p(3, 3), d
        logical :: ok
        integer :: i, j

        call inverse3(f, a, ok)
        d = determinant3(f)
        do j = 1, 3
            do i = 1, 3
                c(i, j) = d*a(j, i)
            end do
        end do
        call multiply3(s, c, p)
        do j = 1, 3
            do i = 1, 3
                s(i, j) = p(i, j)
            end do
        end do
    end subroutine piola
end module brz_gradient
