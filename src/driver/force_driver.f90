! SPDX-License-Identifier: MIT
!> Forces on whole bodies, for gauges, and the impulses of their loads.
module brz_force_driver
    use brz_air_force, only: reaction_force_of, load_of
    use brz_errors, only: error_t
    use brz_force_loop_bodies, only: n_forces
    use brz_force_loops, only: for_each_sum_forces
    use brz_formulation_names, only: form_rigid
    use brz_kinds, only: dp
    use brz_rigid, only: cross
    use brz_rigid_motion, only: rigid_forces
    use brz_solid_backend, only: sum_forces_of_all
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: forces_on_bodies, record_impulse, n_forces

contains

    !> Force and moment of bodies on what holds them, force of their loads and of other bodies; on
    !> all processes the same bits.
    subroutine forces_on_bodies(solid, bodies, at, sums, err)
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: bodies(:)
        real(dp), intent(in) :: at(:, :) !! (3, size(bodies)) points of the moments [m]
        real(dp), intent(out) :: sums(:, :) !! (n_forces, size(bodies)) see sum_forces
        type(error_t), intent(inout) :: err
        real(dp) :: all(n_forces, size(solid%bodies)) !! with moments about the origin
        integer :: k

        if (size(bodies) == 0) return
        if (solid%on_gpu) call sum_forces_of_all(solid%device, solid, all, err)
        do k = 1, size(bodies)
            associate (body => solid%bodies(bodies(k)))
                if (body%formulation == form_rigid) then
                    sums(:, k) = rigid_forces(body, at(:, k))
                else if (solid%on_gpu) then
                    sums(:, k) = all(:, bodies(k))
                    sums(4:6, k) = sums(4:6, k) - cross(at(:, k), sums(1:3, k))
                else
                    call for_each_sum_forces(solid%on_gpu, body%last - body%first + 1, &
                        solid%ranks, body%first, solid%wide, solid%stride_d, solid%stride_p, &
                        merge(1, 0, allocated(solid%load)), &
                        merge(1, 0, allocated(solid%reaction_force)), at(1, k), at(2, k), &
                        at(3, k), solid%x, solid%mass, solid%fixed, solid%a, load_of(solid), &
                        reaction_force_of(solid), sums(:, k), err)
                end if
            end associate
        end do
    end subroutine forces_on_bodies

    !> Impulse of the load on all bodies that are active, over a step.
    subroutine record_impulse(solid, dt, err)
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        real(dp) :: sums(n_forces, size(solid%bodies)), origin(3, size(solid%bodies))
        integer, allocatable :: active(:)
        integer :: b, k

        if (.not. solid%impulses) return
        active = pack([(b, b=1, size(solid%bodies))], .not. solid%bodies%inactive)
        origin = 0
        call forces_on_bodies(solid, active, origin(:, :size(active)), sums(:, :size(active)), err)
        do k = 1, size(active)
            associate (impulse => solid%bodies(active(k))%impulse)
                impulse = impulse + dt*sums(7:9, k)
            end associate
        end do
    end subroutine record_impulse
end module brz_force_driver
