! SPDX-License-Identifier: MIT
!> Writes dumps of hand-made states into the folder named on the command line, for test_output.py.
program sample_dumps
    use brz_air_state, only: air_t, wall_t
    use brz_case, only: case_t
    use brz_clock, only: clock_t, start_clock
    use brz_dumps, only: dumps_t, name_dump, start_dumps, write_dump_files
    use brz_errors, only: error_t, failed
    use brz_kinds, only: dp, rk
    use brz_material, only: material_t
    use brz_output_folder, only: folder_fresh, prepare_folder
    use brz_solid_arrays, only: allocate_solid
    use brz_listed_bodies, only: listed_bodies_t
    use brz_interacting_bodies, only: interacting_bodies_t
    use brz_together, only: together_t
    implicit none
    character(200) :: folder
    integer :: cells(3, 3) = reshape([5, 4, 3, 6, 4, 1, 7, 1, 1], [3, 3]), i

    call get_command_argument(1, folder)
    do i = 1, 3
        call write_scene(trim(folder)//'/'//achar(iachar('4') - i)//'d', cells(:, i))
    end do

contains

    !> Three dumps of a scene with air and two bodies.
    subroutine write_scene(folder, n)
        character(*), intent(in) :: folder
        integer, intent(in) :: n(3)
        type(case_t) :: case
        type(clock_t) :: clock
        type(dumps_t) :: dumps
        type(together_t) :: together
        type(air_t) :: air
        type(wall_t) :: wall
        type(interacting_bodies_t) :: solid
        type(error_t) :: err
        integer :: step

        case%run%job = 'sample'
        case%run%title = 'A sample'
        case%echo = '&run t_end = 1 /'//new_line('a')//repeat('! a long deck'//new_line('a'), 10000)
        allocate (case%materials(1))
        case%materials%id = 'steel'
        call start_clock(case, clock)
        call fill_air(n, air, wall)
        call fill_solid(solid)
        call prepare_folder(folder, 'sample', case%echo, folder_fresh, err)
        together%folder = folder
        call start_dumps(dumps, folder, [.true., .true.], .false., clock, err)
        do step = 0, 2
            clock%time = 0.1_dp*step
            clock%cycle = 10*step
            call write_dump_files(together, case, clock, air, wall, solid, err)
            if (failed(err)) exit
            call name_dump(dumps, clock%dump_number, clock%time, air%present, solid%present, err)
            clock%dump_number = clock%dump_number + 1
        end do
        if (failed(err)) then
            write (*, '(a)') err%text
            error stop 1
        end if
    end subroutine write_scene

    !> Density 1 + i + 10 j + 100 k, velocity (i, j, k), overpressure 1000 i; cell (2,1,1) is solid.
    subroutine fill_air(n, air, wall)
        integer, intent(in) :: n(3)
        type(air_t), intent(out) :: air
        type(wall_t), intent(out) :: wall
        integer :: i, j, k
        real(rk) :: rho, v(3)

        air%present = .true.
        air%n = n
        air%whole = n
        air%g = merge(2, 0, n > 1)
        air%lo = [-1.0_dp, 2.0_dp, 3.0_dp]
        air%dx = [0.1_dp, 0.2_dp, 0.4_dp]
        associate (g => air%g)
            allocate (air%u(1 - g(1):n(1) + g(1), 1 - g(2):n(2) + g(2), 1 - g(3):n(3) + g(3), 5))
            allocate (wall%solid(1 - g(1):n(1) + g(1), 1 - g(2):n(2) + g(2), 1 - g(3):n(3) + g(3)))
        end associate
        air%u = -huge(1.0_rk)
        do k = 1, n(3)
            do j = 1, n(2)
                do i = 1, n(1)
                    rho = 1 + i + 10*j + 100*k
                    v = real([i, j, k], rk)
                    air%u(i, j, k, 1) = rho
                    air%u(i, j, k, 2:4) = rho*v
                    air%u(i, j, k, 5) = (air%p_rest + 1000*i)/(air%scheme%gamma - 1) &
                                        + rho*dot_product(v, v)/2
                end do
            end do
        end do
        wall%present = .true.
        wall%solid = 0
        wall%solid(2, 1, 1) = 1
        air%u(2, 1, 1, :) = 0
    end subroutine fill_air

    !> Bodies of 3 and 4 particles whose numbers run backwards.
    subroutine fill_solid(solid)
        class(listed_bodies_t), intent(inout) :: solid
        integer :: i

        solid%present = .true.
        solid%n = 7
        solid%n_hist = 0
        allocate (solid%bodies(2), solid%materials(1))
        solid%materials(1)%model = 0
        solid%materials(1)%density = 2000
        solid%bodies%material = 1
        solid%bodies(1)%id = 'plate'
        solid%bodies(2)%id = 'a longer name'
        solid%bodies(1)%last = 3
        solid%bodies(2)%first = 4
        solid%bodies(2)%last = 7
        call allocate_solid(solid)
        solid%dt_last = 2
        do i = 1, 7
            solid%id(i) = 8 - i
            solid%x_ref(:, i) = real([i, 2*i, 3*i], dp)
            solid%x(:, i) = solid%x_ref(:, i) + 0.25_dp
            solid%v(:, i) = real([i, i, i], rk)
            solid%a(:, i) = real([0, 10, 0], rk)
            solid%stress(:, i) = real([1, 2, 3, 4, 5, 6]*i, rk)
            solid%mu(i) = 0.5_rk
            solid%mass(i) = 0.5_rk*real(i, rk)
        end do
        solid%fixed(1) = 1 ! held: the solver keeps its velocity and acceleration at zero
        solid%v(:, 1) = 0
        solid%a(:, 1) = 0
        solid%ply(7) = 3
    end subroutine fill_solid
end program sample_dumps
