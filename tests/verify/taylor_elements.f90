! SPDX-License-Identifier: MIT
!> Taylor's test by axisymmetric finite elements: independent of the particles.
!>
!> Method:  explicit; four-node elements, deviator at 2 x 2 Gauss points, one pressure per element
!>          from its volume (mean dilatation), Jaumann rate, radial return with implicit rate and
!>          hardening, plastic work into heat; bulk viscosity 0.06, 1.5
!> Law:     Johnson & Cook as the bar has it, or Zerilli & Armstrong 1987 for copper
!> Wall:    the nodes of the foot stay on it without friction, as on a plane of symmetry
module taylor_elements
    use brz_kinds, only: dp
    use taylor_bars, only: bar_t, measure, remains_t
    implicit none
    private
    public :: element_bar, za

    real(dp), parameter :: pi = acos(-1.0_dp), room = 293, heat_fraction = 0.9_dp, rate0 = 1
    real(dp), parameter :: corner(2, 4) = reshape([-1.0_dp, -1.0_dp, 1.0_dp, -1.0_dp, 1.0_dp, &
                                                   1.0_dp, -1.0_dp, 1.0_dp], [2, 4])
    real(dp), parameter :: linear = 0.06_dp, quadratic = 1.5_dp !! bulk viscosity
    !> Zerilli & Armstrong's copper: c0 + c2 sqrt(strain) exp((-c3 + c4 ln rate) T) [Pa], [1/K].
    real(dp), parameter :: za(4) = [65e6_dp, 890e6_dp, 0.0028_dp, 0.000115_dp]

    type :: elements_t
        integer :: across = 0, along = 0
        integer, allocatable :: nodes(:, :) !! (4, elements)
        real(dp), allocatable :: x(:, :), v(:, :), f(:, :), mass(:) !! (2, nodes) r, z
        real(dp), allocatable :: content(:), energy(:), p(:) !! (elements) mass, J, Pa
        real(dp), allocatable :: s(:, :, :) !! (4, 4, elements) deviator rr, zz, hoop, rz
        real(dp), allocatable :: strain(:, :), hot(:, :) !! (4, elements) plastic strain, T [K]
        real(dp) :: viscous = 0 !! heat of the bulk viscosity [J]
        logical :: armstrong = .false.
    end type elements_t

    !> An element as it stands: gradients d/dr, d/dz and N/r of its shapes at the Gauss points.
    type :: element_t
        real(dp) :: grad(3, 4, 4), weight(4), volume, size
    end type element_t

contains

    subroutine element_bar(bar, across, law, shape)
        type(bar_t), intent(in) :: bar
        integer, intent(in) :: across !! elements per radius
        character(*), intent(in) :: law !! 'johnson_cook', 'zerilli_armstrong'
        type(remains_t), intent(out) :: shape
        type(elements_t) :: mesh
        real(dp) :: time, dt, dt_next, start, now
        integer :: e

        call cpu_time(start)
        call make_mesh(bar, across, mesh)
        mesh%armstrong = law == 'zerilli_armstrong'
        shape%kinetic = kinetic(mesh)
        time = 0
        dt = 1e-10_dp
        mesh%f = 0
        do while (time < bar%time)
            mesh%v = mesh%v + dt*mesh%f/spread(mesh%mass, 1, 2)
            call hold(mesh)
            mesh%x = mesh%x + dt*mesh%v
            mesh%f = 0
            dt_next = 1.05_dp*dt
            do e = 1, size(mesh%p)
                call step_element(bar, mesh, e, dt, dt_next)
            end do
            time = time + dt
            dt = dt_next
        end do
        call outline(mesh, shape%profile)
        call measure(bar, shape)
        shape%viscous = mesh%viscous/shape%kinetic
        shape%error = (kinetic(mesh) + sum(mesh%energy))/shape%kinetic - 1
        shape%kinetic = kinetic(mesh)/shape%kinetic
        shape%strain = maxval(sum(mesh%strain, 1)/4)
        shape%hottest = maxval(sum(mesh%hot, 1)/4)
        call cpu_time(now)
        shape%seconds = now - start
    end subroutine element_bar

    real(dp) function kinetic(mesh)
        type(elements_t), intent(in) :: mesh

        kinetic = sum(mesh%mass*(mesh%v(1, :)**2 + mesh%v(2, :)**2))/2
    end function kinetic

    subroutine make_mesh(bar, across, mesh)
        type(bar_t), intent(in) :: bar
        integer, intent(in) :: across
        type(elements_t), intent(out) :: mesh
        type(element_t) :: el
        integer :: i, j, k, n, ne

        mesh%across = across
        mesh%along = nint(bar%length/bar%radius*across)
        n = (across + 1)*(mesh%along + 1)
        ne = across*mesh%along
        allocate (mesh%nodes(4, ne), mesh%x(2, n), mesh%v(2, n), mesh%f(2, n), mesh%mass(n))
        allocate (mesh%content(ne), mesh%energy(ne), mesh%p(ne), mesh%s(4, 4, ne))
        allocate (mesh%strain(4, ne), mesh%hot(4, ne))
        mesh%x = reshape([(([bar%radius*i/across, bar%length*j/mesh%along], i=0, across), &
                           j=0, mesh%along)], [2, n])
        mesh%v(1, :) = 0
        mesh%v(2, :) = -bar%speed
        mesh%mass = 0
        mesh%energy = 0
        mesh%p = 0
        mesh%s = 0
        mesh%strain = 0
        mesh%hot = room
        do k = 1, ne
            i = k + (k - 1)/across
            mesh%nodes(:, k) = [i, i + 1, i + across + 2, i + across + 1]
            el = element(mesh%x(:, mesh%nodes(:, k)))
            mesh%content(k) = bar%density*el%volume
            do j = 1, 4
                mesh%mass(mesh%nodes(:, k)) = mesh%mass(mesh%nodes(:, k)) &
                    + bar%density*el%weight(j)*shapes(corner(:, j)/sqrt(3.0_dp))
            end do
        end do
    end subroutine make_mesh

    !> The axis and the wall.
    subroutine hold(mesh)
        type(elements_t), intent(inout) :: mesh

        mesh%v(1, 1::mesh%across + 1) = 0
        mesh%v(2, :mesh%across + 1) = 0
    end subroutine hold

    pure function shapes(at) result(n)
        real(dp), intent(in) :: at(2)
        real(dp) :: n(4)

        n = (1 + corner(1, :)*at(1))*(1 + corner(2, :)*at(2))/4
    end function shapes

    pure function element(x) result(el)
        real(dp), intent(in) :: x(2, 4) !! corners
        type(element_t) :: el
        real(dp) :: at(2), d(2, 4), j(2, 2), det, area, n(4)
        integer :: k

        area = 0
        do k = 1, 4
            at = corner(:, k)/sqrt(3.0_dp)
            n = shapes(at)
            d(1, :) = corner(1, :)*(1 + corner(2, :)*at(2))/4
            d(2, :) = corner(2, :)*(1 + corner(1, :)*at(1))/4
            j = matmul(d, transpose(x))
            det = j(1, 1)*j(2, 2) - j(1, 2)*j(2, 1)
            el%grad(1, :, k) = (j(2, 2)*d(1, :) - j(1, 2)*d(2, :))/det
            el%grad(2, :, k) = (j(1, 1)*d(2, :) - j(2, 1)*d(1, :))/det
            el%grad(3, :, k) = n/dot_product(n, x(1, :))
            el%weight(k) = 2*pi*dot_product(n, x(1, :))*det
            area = area + det
        end do
        el%volume = sum(el%weight)
        el%size = area/sqrt(maxval(sum((x - cshift(x, 1, 2))**2, 1)))
        if (.not. minval(el%weight) > 0) error stop 'an element is turned inside out'
    end function element

    !> Stress of an element after a step that has led to the present places, its forces, and what
    !> it allows the next time step to be.
    subroutine step_element(bar, mesh, e, dt, dt_next)
        type(bar_t), intent(in) :: bar
        type(elements_t), intent(inout) :: mesh
        integer, intent(in) :: e
        real(dp), intent(in) :: dt
        real(dp), intent(inout) :: dt_next
        type(element_t) :: el
        real(dp) :: v(2, 4), x(2, 4), div, work, mu, c, extra, p, total, force(2), rate(2)
        integer :: k, i

        x = mesh%x(:, mesh%nodes(:, e))
        v = mesh%v(:, mesh%nodes(:, e))
        el = element(x - dt/2*v)
        div = 0
        work = 0
        do k = 1, 4
            call flow(bar, mesh, e, k, el%grad(:, :, k), dt, v, rate)
            div = div + el%weight(k)*rate(1)
            work = work + el%weight(k)*rate(2)
        end do
        div = div/el%volume
        el = element(x)
        mu = mesh%content(e)/el%volume/bar%density - 1
        c = sqrt(bar%sound**2*(1 + 4*max(mu, 0.0_dp)) + 4*bar%shear/(3*bar%density))
        extra = 0
        if (div < 0) extra = bar%density*(1 + mu)*el%size*abs(div) &
                             *(linear*c + quadratic*el%size*abs(div))
        mesh%viscous = mesh%viscous - dt*extra*div*el%volume
        mesh%energy(e) = mesh%energy(e) + dt*(work - (mesh%p(e) + extra)*div*el%volume)
        p = pressure(bar, mu, mesh%energy(e)/mesh%content(e))
        mesh%energy(e) = mesh%energy(e) - dt/2*(p - mesh%p(e))*div*el%volume
        mesh%p(e) = p
        total = p + extra
        do k = 1, 4
            do i = 1, 4
                associate (g => el%grad(:, i, k), s => mesh%s(:, k, e))
                    force = [(s(1) - total)*g(1) + s(4)*g(2) + (s(3) - total)*g(3), &
                             s(4)*g(1) + (s(2) - total)*g(2)]
                end associate
                mesh%f(:, mesh%nodes(i, e)) = mesh%f(:, mesh%nodes(i, e)) - el%weight(k)*force
            end do
        end do
        dt_next = min(dt_next, 0.5_dp*el%size/(1.2_dp*c + 2*quadratic*el%size*abs(div)))
    end subroutine step_element

    !> Deviator, plastic strain and temperature of a Gauss point; its divergence and its power.
    subroutine flow(bar, mesh, e, k, grad, dt, v, rate)
        type(bar_t), intent(in) :: bar
        type(elements_t), intent(inout) :: mesh
        integer, intent(in) :: e, k
        real(dp), intent(in) :: grad(3, 4), dt, v(2, 4)
        real(dp), intent(out) :: rate(2)
        real(dp) :: l(2, 2), hoop, tr, d(4), t(4), old(4), q, x, c, s

        l = matmul(v, transpose(grad(1:2, :)))
        hoop = dot_product(grad(3, :), v(1, :))
        tr = l(1, 1) + l(2, 2) + hoop
        d = [l(1, 1) - tr/3, l(2, 2) - tr/3, hoop - tr/3, (l(1, 2) + l(2, 1))/2]
        c = cos(dt*(l(2, 1) - l(1, 2))/2)
        s = sin(dt*(l(2, 1) - l(1, 2))/2)
        t = mesh%s(:, k, e)
        old = [c*c*t(1) - 2*c*s*t(4) + s*s*t(2), s*s*t(1) + 2*c*s*t(4) + c*c*t(2), t(3), &
               c*s*(t(1) - t(2)) + (c*c - s*s)*t(4)]
        t = old + 2*bar%shear*dt*d
        q = sqrt(1.5_dp*(sum(t(1:3)**2) + 2*t(4)**2))
        x = plastic(bar, mesh%armstrong, q, mesh%strain(k, e), mesh%hot(k, e), dt)
        if (x > 0) t = t*(1 - 3*bar%shear*x/q)
        mesh%strain(k, e) = mesh%strain(k, e) + x
        mesh%hot(k, e) = mesh%hot(k, e) &
                         + heat_fraction*(q - 3*bar%shear*x)*x/(bar%density*bar%heat)
        mesh%s(:, k, e) = t
        rate = [tr, (sum((old(1:3) + t(1:3))*d(1:3)) + 2*(old(4) + t(4))*d(4))/2]
    end subroutine flow

    !> Plastic increment: q - 3 G x = Y(strain + x, x/dt, T), by the Illinois method.
    pure real(dp) function plastic(bar, armstrong, q, strain, hot, dt) result(x)
        type(bar_t), intent(in) :: bar
        logical, intent(in) :: armstrong
        real(dp), intent(in) :: q, strain, hot, dt
        real(dp) :: x0, x1, f0, f1, f
        integer :: pass

        x = 0
        x0 = 0
        f0 = q - strength(bar, armstrong, strain, 0.0_dp, hot)
        if (f0 <= 0) return
        x1 = q/(3*bar%shear)
        f1 = -strength(bar, armstrong, strain + x1, x1/dt, hot)
        do pass = 1, 60
            x = x1 - f1*(x1 - x0)/(f1 - f0)
            f = q - 3*bar%shear*x - strength(bar, armstrong, strain + x, x/dt, hot)
            if (abs(f) < 1e-9_dp*q) exit
            if (f*f1 < 0) then
                x0 = x1
                f0 = f1
            else
                f0 = f0/2
            end if
            x1 = x
            f1 = f
        end do
    end function plastic

    pure real(dp) function strength(bar, armstrong, strain, rate, hot) result(y)
        type(bar_t), intent(in) :: bar
        logical, intent(in) :: armstrong
        real(dp), intent(in) :: strain, rate, hot
        real(dp) :: lograte

        lograte = log(max(rate/rate0, 1.0_dp))
        if (armstrong) then
            y = za(1) + za(2)*sqrt(strain)*exp((-za(3) + za(4)*lograte)*hot)
        else
            y = (bar%a + bar%b*strain**bar%n)*(1 + bar%c*lograte) &
                *(1 - min(max((hot - room)/(bar%melt - room), 0.0_dp), 1.0_dp)**bar%m)
        end if
    end function strength

    !> Mie-Grueneisen about the Hugoniot us = sound + s1 up.
    pure real(dp) function pressure(bar, mu, energy) result(p)
        type(bar_t), intent(in) :: bar
        real(dp), intent(in) :: mu, energy !! compression, [J/kg]

        p = bar%density*bar%sound**2*mu
        if (mu > 0) p = p*(1 + (1 - bar%gamma/2)*mu - bar%first/2*mu**2)/(1 - (bar%s1 - 1)*mu)**2
        p = p + (bar%gamma + bar%first*mu)*bar%density*energy
    end function pressure

    !> The nodes of the surface, from the foot upwards.
    subroutine outline(mesh, profile)
        type(elements_t), intent(in) :: mesh
        real(dp), allocatable, intent(out) :: profile(:, :)

        profile = mesh%x(:, mesh%across + 1::mesh%across + 1)
    end subroutine outline
end module taylor_elements
