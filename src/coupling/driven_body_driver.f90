! SPDX-License-Identifier: MIT
!> Bodies that carry particles, in the gas: what it does to them, and how they move in its next
!> step.
module brz_driven_body_driver
    use brz_driven_body_loops, only: for_each_sum_air_load, for_each_sum_push, for_each_sum_shift
    use brz_driven_body_motion, only: foresee_driven_bodies, read_driven_bodies
    use brz_driven_body_rules, only: carries_all, carries_none, n_push
    use brz_coupling_state, only: coupling_t
    use brz_device_data, only: update_device_bytes
    use brz_errors, only: error_t
    use brz_formulation_names, only: form_rigid
    use brz_kinds, only: dp, int64
    use brz_ranks, only: several
    use brz_particles, only: particles_t
    use brz_bodies, only: bodies_t
    implicit none
    private
    public :: see_driven_bodies, put_driven_bodies, sum_shifts, move_driven_bodies, sum_loads

contains

    !> Motion of the bodies at the step. A rigid body turns about the middle of its cells.
    subroutine see_driven_bodies(solid, p, c, err)
        class(bodies_t), intent(in) :: solid !! its bodies
        class(bodies_t), intent(in) :: p !! particles
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err
        integer :: b

        call read_driven_bodies(solid, c%driven)
        c%bodies = size(c%driven)
        if (.not. several(solid%ranks)) call sum_shifts(solid, p, c, err)
        do b = 1, c%bodies
            if (c%driven(b)%carries == carries_all) c%driven(b)%centre = c%driven(b)%centre &
                + c%shift(:, b)/solid%bodies(b)%rigid%mass
        end do
        call put_driven_bodies(c, err)
    end subroutine see_driven_bodies

    !> Tell the GPU how the bodies move.
    subroutine put_driven_bodies(c, err)
        type(coupling_t), intent(in) :: c
        type(error_t), intent(inout) :: err

        if (c%on_gpu) call update_device_bytes(c%driven, &
            size(c%driven)*(storage_size(c%driven)/8_int64), err)
    end subroutine put_driven_bodies

    !> Where the middles of the cells are, against the particles of rigid bodies. On several
    !> processes of the particles that each steps.
    subroutine sum_shifts(solid, p, c, err)
        class(bodies_t), intent(in) :: solid
        class(bodies_t), intent(in) :: p
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err
        integer :: b

        if (.not. allocated(solid%bodies)) return
        if (.not. allocated(c%shift)) allocate (c%shift(3, size(solid%bodies)), source=0.0_dp)
        do b = 1, size(solid%bodies)
            if (solid%bodies(b)%formulation /= form_rigid) cycle
            associate (first => p%bodies(b)%first, last => p%bodies(b)%last)
                call for_each_sum_shift(c%on_gpu, last - first + 1, solid%ranks, first, c%box, &
                                        p%wide, p%x, p%mass, c%shift(:, b), err)
            end associate
        end do
    end subroutine sum_shifts

    !> Bring the bodies that carry particles to the middle of the coming step, from what the gas
    !> does to each rigid one if that keeps its motion.
    subroutine move_driven_bodies(solid, p, c, dt, err)
        class(bodies_t), intent(in) :: solid
        class(particles_t), intent(in) :: p
        type(coupling_t), intent(inout) :: c
        real(dp), intent(in) :: dt !! of the air [s]
        type(error_t), intent(inout) :: err
        real(dp) :: push(n_push, size(c%driven))
        integer :: b

        if (all(c%driven%carries == carries_none)) return
        push = 0
        do b = 1, c%bodies
            if (c%driven(b)%carries /= carries_all) cycle
            associate (first => c%driven(b)%first, last => c%driven(b)%last)
                call for_each_sum_push(c%on_gpu, last - first + 1, solid%ranks, first, c%box, &
                                       c%driven(b), p%wide, c%cell_of, c%place_of, c%above, &
                                       c%gas, c%rows, c%surface, c%weight, c%force, c%impedance, &
                                       p%x, p%mass, push(:, b), err)
            end associate
        end do
        call foresee_driven_bodies(solid, push, dt, c%driven)
        call put_driven_bodies(c, err)
    end subroutine move_driven_bodies

    !> Force and torque of the air on the bodies that carry particles, from the loads of these.
    subroutine sum_loads(solid, c, load, err)
        class(bodies_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: c
        real(dp), intent(out) :: load(6, c%bodies) !! [N], [N m]
        type(error_t), intent(inout) :: err
        integer :: b

        load = 0
        do b = 1, size(solid%bodies)
            if (c%driven(b)%carries == carries_none) cycle
            associate (first => solid%bodies(b)%first, last => solid%bodies(b)%last)
                call for_each_sum_air_load(c%on_gpu, last - first + 1, solid%ranks, first, c%box, &
                                           c%driven(b), solid%wide, solid%stride_d, &
                                           solid%stride_p, solid%fixed, solid%x, solid%load, &
                                           load(:, b), err)
            end associate
        end do
    end subroutine sum_loads
end module brz_driven_body_driver
