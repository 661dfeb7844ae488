! SPDX-License-Identifier: MIT
!> Boxes of air with bodies that are held, by cut cells. Lengths are in cells, gas at rest is that
!> of coupling_tools.
module cut_scenes
    use brz_air_grid, only: cell_at
    use brz_air_state, only: air_ok, bc_outflow, bc_wall
    use brz_air_sums, only: air_time_step
    use brz_cut_cells, only: cut_cells_t
    use brz_kinds, only: dp, rk
    use brz_particle_marks, only: is_fixed
    use brz_scheme, only: hllc, muscl_cells
    use coupling_tools, only: box_scene_t, c0, fill, gamma, move, open_box, p0, put_body, rho0
    use shared_steps, only: air_step, reclassify, set_wall_velocity, spread_load
    implicit none
    private
    public :: open_tunnel, hold, carry, ball, sheet, both, march, ride, cut_of, reached, stream
    public :: drag_of_cylinder, drag_of_sphere, channel, band_width

    real(dp), parameter :: mach_stream = 3
    real(dp), parameter :: band_width = 5 !! of a cylinder [degrees]

contains

    !> A box of still air of whole cells, by the default scheme.
    subroutine open_tunnel(scene, cells, bc)
        type(box_scene_t), intent(out) :: scene
        integer, intent(in) :: cells(3)
        integer, intent(in) :: bc(2, 3)

        call open_box(scene, cells, 1.0_dp, bc_outflow)
        scene%air%bc = bc
        scene%air%outer = bc
        scene%air%scheme%reconstruction = muscl_cells
        scene%air%scheme%flux = hllc
        scene%air%n_stages = 2
        scene%air%activity = .false.
    end subroutine open_tunnel

    !> Put particles in and hold them.
    subroutine hold(scene, x, spacing)
        type(box_scene_t), intent(inout) :: scene
        real(dp), intent(in) :: x(:, :) !! (3, particles)
        real(dp), intent(in) :: spacing

        scene%free = .false.
        call put_body(scene, x, spacing**count(scene%air%n > 1), 1.0_dp*size(x, 2), &
                      [0.0_dp, 0.0_dp, 0.0_dp], cut=.true.)
        scene%solid%fixed = is_fixed
    end subroutine hold

    !> Put particles in that move alike; the gas moves them, or, without mass, nothing does.
    subroutine carry(scene, x, spacing, v, density)
        type(box_scene_t), intent(inout) :: scene
        real(dp), intent(in) :: x(:, :) !! (3, particles)
        real(dp), intent(in) :: spacing
        real(dp), intent(in) :: v(3) !! [m/s]
        real(dp), intent(in) :: density !! over that of the gas; < 0: driven
        real(dp) :: volume

        volume = spacing**count(scene%air%n > 1)
        scene%free = density > 0
        call put_body(scene, x, volume, abs(density)*rho0*volume*size(x, 2), v, cut=.true.)
        if (.not. scene%free) scene%solid%fixed = is_fixed ! nothing but the test moves them
    end subroutine carry

    !> One step of air and body, of at most dt_max.
    subroutine ride(scene, dt_max, cfl)
        type(box_scene_t), intent(inout) :: scene
        real(dp), intent(in) :: dt_max
        real(dp), intent(in), optional :: cfl !! else 0.5

        call march(scene, dt_max, cfl)
        call move(scene)
        call reclassify(scene%air, scene%solid, scene%coupling)
    end subroutine ride

    !> The particles of two bodies.
    pure function both(a, b) result(x)
        real(dp), intent(in) :: a(:, :), b(:, :)
        real(dp) :: x(3, size(a, 2) + size(b, 2))

        x(:, :size(a, 2)) = a
        x(:, size(a, 2) + 1:) = b
    end function both

    !> Lattice points within a radius of a centre; in two dimensions a disc.
    function ball(dimensions, centre, radius, spacing) result(x)
        integer, intent(in) :: dimensions
        real(dp), intent(in) :: centre(3), radius, spacing
        real(dp), allocatable :: x(:, :)
        real(dp) :: y(3)
        integer :: i, j, k, m, n, pass

        n = ceiling(radius/spacing) + 1
        do pass = 1, 2
            m = 0
            do k = merge(-n, 0, dimensions == 3), merge(n - 1, 0, dimensions == 3)
                do j = -n, n - 1
                    do i = -n, n - 1
                        y = ([i, j, k] + 0.5_dp)*spacing
                        if (dimensions == 2) y(3) = 0
                        if (norm2(y) >= radius) cycle
                        m = m + 1
                        if (pass == 2) x(:, m) = centre + y
                    end do
                end do
            end do
            if (pass == 1) allocate (x(3, m))
        end do
    end function ball

    !> Layers of a lattice along a and b, through a point, as far as lengths to both sides.
    function sheet(middle, a, b, long, wide, layers, spacing) result(x)
        real(dp), intent(in) :: middle(3)
        real(dp), intent(in) :: a(3), b(3) !! unit vectors in the sheet; b = 0 in two dimensions
        real(dp), intent(in) :: long, wide
        integer, intent(in) :: layers
        real(dp), intent(in) :: spacing
        real(dp), allocatable :: x(:, :)
        real(dp) :: n(3), w(3)
        integer :: i, j, k, m, most(2)

        w = b
        most = [nint(long/spacing), nint(wide/spacing)]
        if (norm2(b) <= 0) then
            w = [0.0_dp, 0.0_dp, 1.0_dp]
            most(2) = 0
        end if
        n = [a(2)*w(3) - a(3)*w(2), a(3)*w(1) - a(1)*w(3), a(1)*w(2) - a(2)*w(1)]
        allocate (x(3, layers*product(2*most + 1)))
        m = 0
        do k = 1, layers
            do j = -most(2), most(2)
                do i = -most(1), most(1)
                    m = m + 1
                    x(:, m) = middle + spacing*(i*a + j*b + (k - (layers + 1)/2.0_dp)*n)
                end do
            end do
        end do
    end function sheet

    !> One step of the air, of at most dt_max.
    subroutine march(scene, dt_max, cfl)
        type(box_scene_t), intent(inout) :: scene
        real(dp), intent(in) :: dt_max
        real(dp), intent(in), optional :: cfl !! else 0.5
        integer :: status
        real(dp) :: courant

        courant = 0.5_dp
        if (present(cfl)) courant = cfl
        scene%dt = min(air_time_step(scene%air, scene%coupling%wall, courant), dt_max)
        call set_wall_velocity(scene%air, scene%solid, scene%coupling, scene%dt)
        call air_step(scene%air, scene%coupling%wall, scene%dt, status)
        scene%failed = scene%failed .or. status /= air_ok
        call spread_load(scene%solid, scene%coupling, scene%dt)
        scene%t = scene%t + scene%dt
    end subroutine march

    !> Cells that a path through open faces reaches from one, over the list and the plain gas
    !> around it: 1.
    function reached(scene, from) result(seen)
        type(box_scene_t), intent(in) :: scene
        integer, intent(in) :: from(3)
        integer, allocatable :: seen(:, :, :)
        integer :: d, found, i, ijk(3), side, to(3)
        integer, allocatable :: queue(:, :)

        associate (n => scene%air%n)
            allocate (seen(n(1), n(2), n(3)), source=0)
            allocate (queue(3, product(n)))
            queue(:, 1) = from
            seen(from(1), from(2), from(3)) = 1
            found = 1
            i = 0
            do while (i < found)
                i = i + 1
                ijk = queue(:, i)
                do d = 1, 3
                    do side = 0, 1
                        to = ijk
                        to(d) = to(d) + 2*side - 1
                        if (to(d) < 1 .or. to(d) > n(d)) cycle
                        if (.not. share_at(scene%coupling%wall%cells, ijk, 2*d - 1 + side) > 0) &
                            cycle
                        if (seen(to(1), to(2), to(3)) == 1) cycle
                        seen(to(1), to(2), to(3)) = 1
                        found = found + 1
                        queue(:, found) = to
                    end do
                end do
            end do
        end associate
    end function reached

    !> Open share of a face of a cell.
    pure real(rk) function share_at(cells, ijk, row)
        type(cut_cells_t), intent(in) :: cells
        integer, intent(in) :: ijk(3), row
        integer :: s

        s = cut_of(cells, ijk)
        share_at = 1
        if (s > 0) share_at = cells%aperture(row, s)
    end function share_at

    !> Entry of a cell in the list, or 0.
    pure integer function cut_of(cells, ijk) result(s)
        type(cut_cells_t), intent(in) :: cells
        integer, intent(in) :: ijk(3)

        associate (n => cells%nodes%n)
            s = cells%slot(ijk(1) + n(1)*(ijk(2) - 1 + n(2)*(ijk(3) - 1)))
        end associate
    end function cut_of

    !> Drag coefficient of a cylinder held in a stream of Mach 3, half of it.
    function drag_of_cylinder(cells, shift, gap, bands) result(drag)
        integer, intent(in) :: cells !! per diameter
        real(dp), intent(in) :: shift !! of the middle
        real(dp), intent(out), optional :: gap !! between bow shock and cylinder, over its radius
        real(dp), intent(out), optional :: bands(:, :) !! (2, bands) mean angle from the stagnation
                                                       !! point [degrees], mean pressure [Pa]
        real(dp) :: drag, radius
        type(box_scene_t) :: scene

        call open_tunnel(scene, [7*cells/2, 5*cells/2, 1], tunnel())
        call stream(scene, mach_stream*c0)
        call hold(scene, ball(2, [1.5_dp*cells + shift, 0.0_dp, 0.0_dp], 0.5_dp*cells, 0.5_dp), &
                  0.5_dp)
        drag = 2*pushed(scene, cells, bands)/(0.5_dp*rho0*(mach_stream*c0)**2*cells)
        if (.not. present(gap)) return
        ! of the circle of the particles' area
        radius = sqrt(sum(real(scene%solid%volume, dp))/acos(-1.0_dp))
        gap = (1.5_dp*cells + shift - radius - bow_shock(scene))/radius
    end function drag_of_cylinder

    !> Place of the bow shock on the axis, where the pressure is half of that behind a plane shock.
    function bow_shock(scene) result(x)
        type(box_scene_t), intent(in) :: scene
        real(dp) :: x
        real(dp), parameter :: half = p0*(1 + (2*gamma*mach_stream**2 - (gamma - 1))/(gamma + 1))/2
        real(dp) :: before, p
        integer :: i

        before = p0
        do i = 1, scene%air%n(1)
            associate (u => scene%air%u(i, 1, 1, :))
                p = (gamma - 1)*(u(5) - (u(2)**2 + u(3)**2 + u(4)**2)/(2*u(1)))
            end associate
            x = i - 0.5_dp
            if (p > half) exit
            before = p
        end do
        x = x - (p - half)/(p - before)
    end function bow_shock

    !> The same of a sphere, a quarter of it.
    function drag_of_sphere(cells, shift) result(drag)
        integer, intent(in) :: cells !! per diameter
        real(dp), intent(in) :: shift !! of the middle, along the stream
        real(dp) :: drag
        type(box_scene_t) :: scene
        integer :: bc(2, 3)
        real(dp), parameter :: pi = acos(-1.0_dp)

        bc = tunnel()
        bc(1, 3) = bc_wall
        call open_tunnel(scene, [3*cells, 3*cells/2, 3*cells/2], bc)
        call stream(scene, mach_stream*c0)
        call hold(scene, ball(3, [1.25_dp*cells + shift, 0.0_dp, 0.0_dp], 0.5_dp*cells, &
                              0.5_dp), 0.5_dp)
        drag = 4*pushed(scene, cells)/(0.5_dp*rho0*(mach_stream*c0)**2*pi/4*cells**2)
    end function drag_of_sphere

    !> Force along x: mean over the last three tenths of the time in which the stream covers 14
    !> diameters.
    function pushed(scene, cells, bands) result(force)
        type(box_scene_t), intent(inout) :: scene
        integer, intent(in) :: cells !! per diameter
        real(dp), intent(out), optional :: bands(:, :) !! see drag_of_cylinder
        real(dp) :: force
        real(dp), allocatable :: sums(:, :)
        real(dp) :: t_end, began, before

        t_end = 14*cells/(mach_stream*c0)
        began = 0
        before = 0
        if (present(bands)) allocate (sums(3, size(bands, 2)), source=0.0_dp)
        do while (scene%t < t_end .and. .not. scene%failed)
            call march(scene, t_end - scene%t)
            if (allocated(sums) .and. began > 0) call add_bands(scene, sums)
            if (began > 0 .or. scene%t < 0.7_dp*t_end) cycle
            began = scene%t
            before = scene%coupling%diagnostics%impulse(1)
        end do
        force = (scene%coupling%diagnostics%impulse(1) - before)/(t_end - began)
        if (allocated(sums)) bands = sums(2:3, :)/spread(max(sums(1, :), tiny(1.0_dp)), 1, 2)
    end function pushed

    !> Add the walls of a step to the bands round a cylinder on the axis: area, angle, pressure.
    subroutine add_bands(scene, sums)
        type(box_scene_t), intent(in) :: scene
        real(dp), intent(inout) :: sums(:, :) !! (3, bands)
        real(dp) :: angle, area, centre, x(2)
        integer :: band, ijk(3), s

        centre = sum(scene%solid%x(1, :))/scene%solid%n
        associate (cells => scene%coupling%wall%cells)
            do s = 1, cells%n
                area = norm2(real(cells%area(:, s), dp))
                if (.not. area > 1e-6_dp) cycle
                ijk = cell_at(cells%nodes%n, cells%cell(s))
                x = ijk(1:2) - 1 + cells%middle(1:2, s)
                angle = atan2(x(2), centre - x(1))*180/acos(-1.0_dp)
                band = int(angle/band_width) + 1
                if (band < 1 .or. band > size(sums, 2)) cycle
                sums(1:2, band) = sums(1:2, band) + scene%dt*area*[1.0_dp, angle]
                sums(3, band) = sums(3, band) + norm2(real(cells%impulse(:, s), dp))
            end do
        end associate
    end subroutine add_bands

    !> Ends of half a wind tunnel: a wall along the axis, the rest open.
    pure function tunnel() result(bc)
        integer :: bc(2, 3)

        bc = bc_outflow
        bc(1, 2) = bc_wall
    end function tunnel

    !> The same with a wall at the top, along which a plane shock runs on.
    pure function channel() result(bc)
        integer :: bc(2, 3)

        bc = bc_outflow
        bc(:, 2) = bc_wall
    end function channel

    !> All gas moves along x.
    subroutine stream(scene, u)
        type(box_scene_t), intent(inout) :: scene
        real(dp), intent(in) :: u

        call fill(scene, lbound(scene%air%u, 1), ubound(scene%air%u, 1), &
                  [rho0, u, 0.0_dp, 0.0_dp, p0])
    end subroutine stream
end module cut_scenes
