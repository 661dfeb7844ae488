! SPDX-License-Identifier: MIT
!> Forces of the pressures on faces and of pushes on bodies, in scenes without air.
!> scripts/steps.py writes the same for the GPU.
module brz_load_steps
    !@gpu use brz_device, only: clear_buffer, copy_in
    use brz_face_load, only: mean_pressures, pushes
    use brz_facet_loops, only: each_begin_load, each_load_carrier, each_place_particle, &
                               each_see_carrier, each_sum_load
    !@gpu use brz_gpu_solid_load, only: see_carriers
    use brz_kinds, only: dp
    use brz_ranks, only: several
    use brz_solid_state, only: form_rigid, solid_t
    implicit none
    private
    public :: load_faces

contains

    !> Set the loads of all particles, of rigid bodies, and of the driven particles of others, to
    !> the mean pressures of the coming step: their impulses are exact.
    subroutine load_faces(solid, dt)
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        real(dp) :: a(3, size(solid%bodies))
        real(dp), allocatable :: mean(:)
        integer :: b

        if (.not. allocated(solid%loads%of)) return
        if (solid%loads%rebuilds /= solid%rebuilds) call place_all(solid) ! lists were sorted
        solid%loads%rebuilds = int(solid%rebuilds)
        a = pushes(solid%loads, size(solid%bodies), solid%time, dt)
        do b = 1, size(solid%bodies)
            associate (there => solid%bodies(b))
                call each_begin_load(there%last - there%first + 1, there%first, solid%step_d, &
                    solid%step_p, a(1, b), a(2, b), a(3, b), solid%mass, solid%fixed, solid%load)
            end associate
        end do
        mean = mean_pressures(solid%loads, solid%time, dt)
        !@gpu call copy_in(mean, gpu%loads%mean, 8_int64*size(mean))
        associate (there => solid%loads%facets, place => solid%loads%place)
            call each_load_carrier(there%carriers, solid%wide, solid%step_d, solid%step_p, &
                solid%time, dt, there%first, there%id, there%load, there%beside, there%mirror, &
                there%width, there%most, there%side, there%wave, mean, place, solid%x, &
                solid%fixed, solid%load) !@gpu mean => gpu%loads%mean
        end associate
        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b), there => solid%bodies(b))
                if (body%formulation /= form_rigid .and. body%motion%n == 0) cycle
                call each_sum_load(there%last - there%first + 1, solid%ranks, there%first, &
                    merge(0, 1, body%formulation == form_rigid), solid%wide, solid%step_d, &
                    solid%step_p, body%rigid%x(1), body%rigid%x(2), body%rigid%x(3), solid%x, &
                    solid%fixed, solid%load, body%rigid%load)
            end associate
        end do
    end subroutine load_faces

    !> Where particles and ghosts lie. A particle whose facets this process does not see as a whole
    !> is noted: the run must end.
    subroutine place_all(solid)
        type(solid_t), intent(inout) :: solid
        real(dp) :: lost
        integer :: b

        associate (place => solid%loads%place)
            place = 0 !@cpu
            !@gpu call clear_buffer(place)
            do b = 1, size(solid%bodies)
                associate (there => solid%bodies(b))
                    call each_place_particle(there%last - there%first + 1, there%first, 1, &
                                             solid%id, place)
                    call each_place_particle(there%rim - there%last, there%last + 1, -1, solid%id, &
                                             place)
                end associate
            end do
            if (.not. several(solid%ranks)) return
            lost = 0
            !@gpu call see_carriers(gpu, lost)
            associate (there => solid%loads%facets)
                call each_see_carrier(there%carriers, there%first, there%id, there%beside, place, &
                                      solid%fixed, lost) !@cpu
            end associate
        end associate
        if (lost > 0) solid%loads%lost = nint(lost)
    end subroutine place_all
end module brz_load_steps
