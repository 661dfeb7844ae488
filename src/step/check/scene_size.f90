! SPDX-License-Identifier: MIT
!> How large a scene is, before anything of it is built: cells, particles, memory, first time steps.
module brz_scene_size
    use brz_air_setup, only: has_own_gas
    use brz_air_state, only: n_ghost
    use brz_body_count, only: count_particles
    use brz_body_points, only: points_t
    use brz_body_shape, only: shape_t
    use brz_body_setup, only: geometry_of_solid
    use brz_boxes, only: cells_t, crowd_t
    use brz_case, only: air_case_t, case_t
    use brz_cut_cells, only: list_bytes, near
    use brz_errors, only: error_t, exit_deck, exit_device, failed, raise
    use brz_formulation_names, only: form_rigid
    use brz_kinds, only: dp, int64, real32, rk
    use brz_memory, only: free_memory
    use brz_solid_arrays, only: allocate_solid, bytes_per_particle
    use brz_interacting_bodies, only: interacting_bodies_t
    use brz_ranks, only: ranks_t
    use brz_text, only: to_text
    implicit none
    private
    public :: scene_size_t, size_scene, refuse_too_large, too_large_to_look, memory_text, count_text
    public :: cut_bytes

    ! measured: lists of neighbours; what the set-up holds for a while; what steps of the air use
    real(dp), parameter :: neighbour_bytes = 84, set_up_bytes = 200 !! per particle
    real(dp), parameter :: step_bytes = 33 !! per cell
    real(dp), parameter :: working = storage_size(1.0_rk)/8 !! of a number [B]
    integer, parameter :: few_particles = 64
    real(dp), parameter :: program_bytes = 2e7_dp
    real(dp), parameter :: many_cells = 1e7_dp, many_particles = 5e5_dp !! seconds to set up

    type :: scene_size_t
        real(dp) :: cells = 0
        real(dp) :: particles = 0 !! about
        real(dp), allocatable :: of_body(:) !! (bodies) particles
        type(crowd_t), allocatable :: crowds(:) !! (bodies) where these are in the air
        type(cells_t), allocatable :: boxes(:) !! (0:processes - 1) the air of each
        real(dp) :: air_bytes = 0 !! with the maps of walls in it
        real(dp) :: cut_bytes = 0 !! of the list of cells near bodies
        real(dp) :: solid_bytes = 0 !! with lists of neighbours
        real(dp) :: peak_bytes = 0 !! most that the program holds
        real(dp) :: dt_air = huge(1.0_dp), dt_solid = huge(1.0_dp) !! at the start, about [s]
        real(dp) :: quiet = 0 !! until the first load, which is one step [s]
        type(interacting_bodies_t) :: solid !! materials and settings of the bodies, and notes
    end type scene_size_t

contains

    !> Size of a scene. Raises what is wrong with materials and shapes of bodies.
    subroutine size_scene(case, size_of, err)
        type(case_t), intent(in) :: case
        type(scene_size_t), intent(out) :: size_of
        type(error_t), intent(inout) :: err

        if (failed(err)) return
        if (case%air%present) call size_air(case, size_of)
        if (size(case%bodies) > 0) call size_bodies(case, size_of, err)
        if (.not. allocated(size_of%crowds)) allocate (size_of%crowds(0))
        if (case%air%present) size_of%cut_bytes = cut_bytes(case, size_of, &
                                                            cells_t([1, 1, 1], case%air%cells))
        size_of%peak_bytes = program_bytes + size_of%air_bytes + step_bytes*size_of%cells &
                             + size_of%cut_bytes + size_of%solid_bytes &
                             + set_up_bytes*size_of%particles
    end subroutine size_scene

    !> Cells, with their ghosts and walls, and the time step of the gas as it is at the start.
    subroutine size_air(case, size_of)
        type(case_t), intent(in) :: case
        type(scene_size_t), intent(inout) :: size_of
        real(dp) :: all_cells, fastest
        integer :: m, n_var

        associate (air => case%air)
            size_of%cells = product(real(air%cells, dp))
            all_cells = product(real(air%cells + merge(2*n_ghost, 0, air%cells > 1), dp))
            n_var = merge(6, 5, any([(has_own_gas(case, m), m=1, size(case%charges))]))
            size_of%air_bytes = all_cells*(3*n_var*working + 1)
            if (case%coupling%present) size_of%air_bytes = size_of%air_bytes + all_cells &
                                                           + size_of%cells*(4 + 2)
            fastest = speed([0.0_dp, 0.0_dp, 0.0_dp], air%gamma*air%pressure/air%density)
            do m = 1, size(case%gas)
                if (case%gas(m)%file /= '') cycle
                fastest = max(fastest, speed(case%gas(m)%velocity, &
                                             air%gamma*case%gas(m)%pressure/case%gas(m)%density))
            end do
            do m = 1, size(case%charges)
                if (case%charges(m)%start /= '3d') cycle
                associate (g => merge(case%charges(m)%gamma, air%gamma, has_own_gas(case, m)))
                    fastest = max(fastest, speed([0.0_dp, 0.0_dp, 0.0_dp], &
                                                 g*(g - 1)*case%charges(m)%energy))
                end associate
            end do
            size_of%dt_air = air%cfl/fastest
        end associate

    contains

        !> Sum over the directions of the fastest wave in cells per time [1/s].
        pure real(dp) function speed(velocity, sound_squared)
            real(dp), intent(in) :: velocity(3), sound_squared !! [m/s], [m2/s2]

            associate (air => case%air)
                speed = sum((abs(velocity) + sqrt(sound_squared))*air%cells/(air%hi - air%lo), &
                            mask=air%cells > 1)
            end associate
        end function speed
    end subroutine size_air

    !> Particles of the bodies, their memory and their time step at rest.
    subroutine size_bodies(case, size_of, err)
        type(case_t), intent(in) :: case
        type(scene_size_t), intent(inout) :: size_of
        type(error_t), intent(inout) :: err
        type(points_t), allocatable :: points(:)
        integer :: b

        call geometry_of_solid(case, size_of%solid, points, err)
        if (failed(err)) return
        size_of%of_body = count_particles(case%bodies, points)
        size_of%particles = sum(size_of%of_body)
        if (case%air%present) size_of%crowds = [(crowd_in(case%air, points(b)%shape, &
                                                          size_of%of_body(b)), b=1, size(points))]
        if (size_of%particles > real(huge(1), dp)) call raise(err, exit_deck, 'about '// &
            to_text(anint(size_of%particles))//' particles are more than '//to_text(huge(1))// &
            ', the most that can be counted; use larger spacings')
        size_of%solid_bytes = size_of%particles*(of_particle(case, size_of%solid) + &
                                                   neighbour_bytes)
        if (case%coupling%present) size_of%solid_bytes = size_of%solid_bytes &
                                                         + size_of%particles*(4*working + 3*4)
        associate (bodies => size_of%solid%bodies, materials => size_of%solid%materials)
            do b = 1, size(bodies)
                if (bodies(b)%formulation == form_rigid) cycle
                size_of%dt_solid = min(size_of%dt_solid, real(bodies(b)%cfl*bodies(b)%h/ &
                                       materials(bodies(b)%material)%c_wave, dp))
            end do
        end associate
    end subroutine size_bodies

    !> Where a body is on the grid of the air.
    pure type(crowd_t) function crowd_in(air, shape, particles) result(crowd)
        type(air_case_t), intent(in) :: air
        type(shape_t), intent(in) :: shape
        real(dp), intent(in) :: particles

        crowd%lo = merge((shape%lo - air%lo)/(air%hi - air%lo)*air%cells, 0.0_dp, air%cells > 1)
        crowd%hi = merge((shape%hi - air%lo)/(air%hi - air%lo)*air%cells, 1.0_dp, air%cells > 1)
        crowd%particles = particles
    end function crowd_in

    !> Memory of the list of cut cells in a box of the air, about [B]: of the cells in and around
    !> the boxes of bodies or, of hollow ones, of as many as a sheet of their particles has around
    !> it.
    pure real(dp) function cut_bytes(case, size_of, box)
        type(case_t), intent(in) :: case
        type(scene_size_t), intent(in) :: size_of
        type(cells_t), intent(in) :: box
        real(dp), parameter :: rounding = 1e-6_dp !! of places, in cells
        integer, parameter :: most = 100 !! blocks of cells along an axis
        integer, parameter :: across = 2*near + 2 !! a sheet that lies in two layers of cells
        integer :: a, b, blocks(3), dimensions, hi(3), k, lo(3), nodes(3)
        integer, allocatable :: of_side(:, :) !! cells of the blocks along each axis
        logical, allocatable :: near_one(:, :, :) !! (blocks)
        real(dp) :: listed, sheet

        cut_bytes = 0
        if (.not. case%coupling%present .or. case%coupling%scheme == 'paper') return
        dimensions = count(case%air%cells > 1)
        nodes = box%hi - box%lo + 1 ! beyond the last cell lies a node
        nodes = nodes + merge(1, 0, box%hi == case%air%cells .and. case%air%cells > 1)
        blocks = min(nodes, most)
        allocate (near_one(blocks(1), blocks(2), blocks(3)), source=.false.)
        listed = 0
        do b = 1, size(size_of%crowds)
            lo = max(floor(size_of%crowds(b)%lo + rounding) - near - box%lo + 1, 0)
            hi = min(ceiling(size_of%crowds(b)%hi - rounding) + near - box%lo + 1, nodes)
            if (any(hi <= lo)) cycle
            sheet = real(across, dp)**dimensions &
                    + across*in_cells(b)**(dimensions - 1)*size_of%of_body(b)
            if (sheet < product(real(hi - lo, dp))) then
                listed = listed + sheet
            else ! blocks that begin there
                lo = (lo*blocks + nodes - 1)/nodes
                hi = (hi*blocks + nodes - 1)/nodes
                near_one(lo(1) + 1:hi(1), lo(2) + 1:hi(2), lo(3) + 1:hi(3)) = .true.
            end if
        end do
        allocate (of_side(maxval(blocks), 3), source=0)
        do a = 1, 3
            of_side(:blocks(a), a) = [(k*nodes(a)/blocks(a) - (k - 1)*nodes(a)/blocks(a), &
                                       k=1, blocks(a))]
        end do
        do a = 1, blocks(3)
            do b = 1, blocks(2)
                listed = listed + real(of_side(a, 3), dp)*of_side(b, 2) &
                         *sum(of_side(:blocks(1), 1), mask=near_one(:, b, a))
            end do
        end do
        cut_bytes = list_bytes(min(listed, product(real(nodes, dp))))

    contains

        !> Spacing of a body in the smallest side of a cell.
        pure real(dp) function in_cells(b)
            integer, intent(in) :: b

            associate (air => case%air)
                in_cells = size_of%solid%bodies(b)%spacing &
                           /minval((air%hi - air%lo)/air%cells, air%cells > 1)
            end associate
        end function in_cells
    end function cut_bytes

    !> Memory of a particle without lists: that of a few particles of the same bodies [B].
    real(dp) function of_particle(case, solid)
        type(case_t), intent(in) :: case
        type(interacting_bodies_t), intent(in) :: solid
        type(interacting_bodies_t) :: few
        integer :: b

        few = solid
        few%n = few_particles*size(few%bodies)
        few%bodies%first = [(1 + few_particles*(b - 1), b=1, size(few%bodies))]
        few%bodies%last = few%bodies%first + few_particles - 1
        few%links%present = size(few%bodies) > 1
        call allocate_solid(few)
        if (case%air%present) allocate (few%load(3, few%n), source=0.0_rk)
        if (case%air%present .and. any(few%bodies%face_share > 0)) &
            allocate (few%face_stress(6, few%n), source=0.0_rk)
        of_particle = bytes_per_particle(few)
    end function of_particle

    !> True if a look at the scene would take more than seconds, or more memory than there is.
    logical function too_large_to_look(size_of)
        type(scene_size_t), intent(in) :: size_of
        real(dp) :: free

        free = free_memory()
        too_large_to_look = size_of%cells > many_cells .or. &
                            size_of%particles > many_particles .or. size_of%peak_bytes > free
    end function too_large_to_look

    !> A scene that cannot be held is refused before it is built.
    subroutine refuse_too_large(size_of, ranks, err)
        type(scene_size_t), intent(in) :: size_of
        type(ranks_t), intent(in) :: ranks !! each on this machine holds its part
        type(error_t), intent(inout) :: err
        real(dp) :: free

        if (failed(err)) return
        free = free_memory()
        if (size_of%peak_bytes*ranks%here/ranks%n <= free) return
        call raise(err, exit_device, 'too little memory: '//memory_text(size_of)//'; use a '// &
                   'machine with more, larger cells or spacings, or a smaller box of air')
    end subroutine refuse_too_large

    !> What the scene needs and for what, and what is free.
    function memory_text(size_of) result(text)
        type(scene_size_t), intent(in) :: size_of
        character(:), allocatable :: text
        real(dp) :: free

        text = 'about '//bytes_text(size_of%peak_bytes)//' are needed at most'
        if (size_of%cells > 0) text = text//', '//bytes_text(size_of%air_bytes + &
                                                                 size_of%cut_bytes)//' by '// &
                                      count_text(size_of%cells)//' cells'
        if (size_of%particles > 0) text = text//', '//bytes_text(size_of%solid_bytes)//' by '// &
                                          count_text(size_of%particles)//' particles'
        free = free_memory()
        if (free < huge(free)) text = text//'; '//bytes_text(free)//' are free here'
    end function memory_text

    !> Memory in MB or GB.
    pure function bytes_text(bytes) result(text)
        real(dp), intent(in) :: bytes
        character(:), allocatable :: text
        character(32) :: buffer

        write (buffer, '(f0.1, a)') 1e-9_dp*bytes, ' GB'
        if (bytes < 1e9_dp) write (buffer, '(f5.1, a)') 1e-6_dp*bytes, ' MB'
        text = trim(adjustl(buffer))
    end function bytes_text

    !> A whole number, from 1e15 on with seven digits.
    pure function count_text(n) result(text)
        real(dp), intent(in) :: n
        character(:), allocatable :: text

        if (n < 1e15_dp) then
            text = to_text(nint(n, int64))
        else
            text = to_text(real(n, real32))
        end if
    end function count_text
end module brz_scene_size
