! SPDX-License-Identifier: MIT
!> Velocities of the walls in a step, and the loads of the particles behind them: the operations in
!> their order.
module brz_wall_driver
    use brz_air_state, only: air_t
    use brz_column_loops, only: for_each_add_wall_impulse, for_each_bear_load, &
        for_each_find_wall_pressure, for_each_load_particle, for_each_weigh_column
    use brz_coupling_device, only: diag_at, diag_work
    use brz_coupling_state, only: coupling_t
    use brz_coupling_sum_loops, only: for_each_record_face
    use brz_errors, only: error_t
    use brz_kinds, only: dp, int32, rk
    use brz_particles, only: particles_t
    use brz_bodies, only: bodies_t
    use brz_velocity_loops, only: for_each_keep_velocity, for_each_mean_velocity_of, &
        for_each_find_wall_velocity
    implicit none
    private
    public :: find_mean_velocity, weigh_columns, find_wall_pressure, find_wall_velocities, &
        keep_velocities, press_bodies
    public :: stress_faces

contains

    !> Give each solid cell the mean velocity by mass of its particles: at the step where a body
    !> carries them, else as it is kept, half a step before. The driven bodies must be there.
    subroutine find_mean_velocity(p, c, err)
        class(particles_t), intent(in) :: p !! particles
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err

        call for_each_mean_velocity_of(c%on_gpu, 3*c%wall%n_cells, c%box, p%wide, c%bodies, &
                                       c%driven, c%ends, c%binned, p%x, p%v, p%mass, p%fixed, &
                                       c%wall%v, err)
    end subroutine find_mean_velocity

    !> Surface of the column behind each face, and the sum of the weights in it.
    subroutine weigh_columns(p, c, err)
        class(particles_t), intent(in) :: p
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err

        call for_each_weigh_column(c%on_gpu, c%wall%n_faces, c%box, p%wide, c%gas, c%rows, &
                                   c%wall%face_cell, c%cell, c%wall%solid, c%wall%index, c%ends, &
                                   c%binned, p%x, p%mass, c%surface, c%weight, err)
    end subroutine weigh_columns

    !> What the gas would do to the walls.
    subroutine find_wall_pressure(air, c, err)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err

        call for_each_find_wall_pressure(c%on_gpu, c%wall%n_faces, c%box, air%scheme, c%gas, &
            c%rows, c%wall%face_cell, air%u, c%wall%v, c%force, c%impedance, err)
    end subroutine find_wall_pressure

    !> Velocities of the walls in the middle of the coming step, where that of a particle a step
    !> ago is a column of v_before.
    subroutine find_wall_velocities(p, c, dt, v_before, column, err)
        class(particles_t), intent(in) :: p
        type(coupling_t), intent(inout) :: c
        real(dp), intent(in) :: dt !! of the coming step of the air [s]
        real(rk), intent(in) :: v_before(:, :) !! [m/s]
        integer(int32), intent(in) :: column(:) !! of each particle in it
        type(error_t), intent(inout) :: err

        call for_each_find_wall_velocity(c%on_gpu, 3*c%wall%n_cells, c%box, p%wide, p%stride_d, &
            p%stride_p, c%bodies, real(dt, rk), real(c%dt_before, rk), c%driven, c%gas, c%rows, &
            c%wall%face_cell, c%wall%face_of, c%above, c%ends, c%binned, p%x, p%v, p%mass, &
            p%load, v_before, column, p%fixed, c%surface, c%weight, c%force, c%impedance, &
            c%wall%v, err)
    end subroutine find_wall_velocities

    !> Keep the velocities for the coming step.
    subroutine keep_velocities(p, c, err)
        class(particles_t), intent(in) :: p
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err

        call for_each_keep_velocity(c%on_gpu, p%n, p%wide, 1, 3, p%v, p%id, c%v_before, err)
    end subroutine keep_velocities

    !> Loads of the particles, and the diagnostics of the walls. The columns are those of before the
    !> step.
    subroutine press_bodies(p, c, dt, err)
        class(particles_t), intent(inout) :: p
        type(coupling_t), intent(inout) :: c
        real(dp), intent(in) :: dt !! step of the air [s]
        type(error_t), intent(inout) :: err
        real(dp) :: work(2), given(3), taken(3) !! on a GPU in its diagnostics

        work = 0
        given = 0
        taken = 0
        call for_each_add_wall_impulse(c%on_gpu, c%wall%n_faces, c%box, dt, c%rows, &
            c%wall%impulse, c%force, err)
        call for_each_record_face(c%on_gpu, c%wall%n_faces, c%box, dt, c%gas, c%rows, &
                                c%wall%face_cell, c%wall%impulse, c%wall%v, work, given, taken, &
                                diag_at(c%device, diag_work), err)
        call for_each_load_particle(c%on_gpu, p%n, c%box, p%wide, p%stride_d, p%stride_p, &
                                    c%place_of, c%above, c%gas, c%rows, c%surface, c%weight, &
                                    c%force, p%x, p%mass, p%load, err)
        c%diagnostics%work = c%diagnostics%work + work(1)
        c%diagnostics%work_reference = c%diagnostics%work_reference + work(2)
        c%diagnostics%impulse = c%diagnostics%impulse + given
        c%diagnostics%impulse_reference = c%diagnostics%impulse_reference + taken
    end subroutine press_bodies

    !> Stress that the loads bring to the faces of bodies, after press_bodies.
    subroutine stress_faces(solid, p, c, err)
        class(bodies_t), intent(in) :: solid !! its bodies
        class(bodies_t), intent(inout) :: p !! its particles
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err
        integer :: b

        if (.not. allocated(solid%face_stress)) return
        do b = 1, size(solid%bodies)
            if (.not. solid%bodies(b)%face_share > 0 .or. solid%bodies(b)%inactive) cycle
            associate (first => p%bodies(b)%first, last => p%bodies(b)%last)
                call for_each_bear_load(c%on_gpu, last - first + 1, first, c%box, &
                                        solid%bodies(b)%layers, p%wide, p%stride_d, p%stride_t, &
                                        c%place_of, c%above, c%gas, c%rows, c%surface, c%weight, &
                                        c%force, p%x, p%mass, p%face_stress, err)
            end associate
        end do
    end subroutine stress_faces
end module brz_wall_driver
