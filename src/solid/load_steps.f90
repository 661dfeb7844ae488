! SPDX-License-Identifier: MIT
!> Forces of the pressures on faces and of pushes on bodies, in scenes without air.
!> scripts/steps.py writes the same for the GPU.
module brz_load_steps
    !@gpu use brz_device, only: clear_buffer, copy_in
    use brz_face_load, only: mean_pressures, pushes
    use brz_facet_loops, only: each_begin_load, each_load_carrier, each_mark_beside, &
                               each_own_carrier, each_place_particle, each_sum_load
    use brz_formulation_names, only: form_rigid
    !@gpu use brz_gpu_solid_load, only: fetch_loaded, put_loaded
    use brz_kinds, only: dp
    use brz_load_part, only: tell_carriers
    use brz_ranks, only: several
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: load_faces, mark_facets, note_carriers

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
            if (there%carriers > 0) call each_load_carrier(there%carriers, solid%wide, &
                solid%step_d, solid%step_p, solid%step_t, solid%time, dt, there%first, there%id, &
                there%load, there%beside, there%mirror, there%width, there%most, there%side, &
                there%wave, mean, place, solid%x, solid%fixed, solid%load, &
                solid%face_stress) !@gpu mean => gpu%loads%mean
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

    !> Where particles and ghosts lie.
    subroutine place_all(solid)
        type(solid_t), intent(inout) :: solid
        integer :: b

        call place_own(solid)
        do b = 1, size(solid%bodies)
            associate (there => solid%bodies(b), place => solid%loads%place)
                call each_place_particle(there%rim - there%last, there%last + 1, -1, solid%id, &
                                         place)
            end associate
        end do
    end subroutine place_all

    !> Where the particles of this process lie.
    subroutine place_own(solid)
        type(solid_t), intent(inout) :: solid
        integer :: b

        solid%loads%place = 0 !@cpu
        !@gpu call clear_buffer(gpu%loads%place)
        do b = 1, size(solid%bodies)
            associate (there => solid%bodies(b), place => solid%loads%place)
                call each_place_particle(there%last - there%first + 1, there%first, 1, &
                                         solid%id, place)
            end associate
        end do
    end subroutine place_own

    !> Particles may have changed processes: tell all who has those that carry facets.
    subroutine note_carriers(solid)
        type(solid_t), intent(inout) :: solid

        if (.not. (allocated(solid%loads%of) .and. several(solid%ranks))) return
        call place_own(solid)
        associate (there => solid%loads%facets, place => solid%loads%place)
            call each_own_carrier(there%carriers, solid%ranks%rank + 1, there%first, there%id, &
                                  place, there%owner)
        end associate
        !@gpu call fetch_loaded(gpu, solid%loads%facets)
        call tell_carriers(solid) !@host
        !@gpu call put_loaded(gpu, solid%loads%facets)
    end subroutine note_carriers

    !> Mark the particles that others need for facets, of which they are the neighbours.
    subroutine mark_facets(solid)
        type(solid_t), intent(inout) :: solid

        if (.not. allocated(solid%loads%of)) return
        call place_own(solid) ! arrays may have been laid anew
        associate (there => solid%loads%facets, place => solid%loads%place, part => solid%part)
            call each_mark_beside(there%carriers, solid%n, solid%ranks%rank + 1, there%first, &
                there%beside, there%owner, place, part%sent, part%mark)
        end associate
        solid%loads%rebuilds = -1 ! ghosts have no places now
    end subroutine mark_facets
end module brz_load_steps
