! SPDX-License-Identifier: MIT
!> Forces of the pressures on faces and of pushes on bodies, in scenes without air.
module brz_load_driver
    use brz_device_data, only: update_device, update_host
    use brz_face_load, only: mean_pressures, pushes
    use brz_loaded_segment_loops, only: for_each_begin_load, for_each_load_carrier, &
                               for_each_mark_beside, for_each_own_carrier, &
                               for_each_place_particle, for_each_sum_load
    use brz_formulation_names, only: form_rigid
    use brz_kinds, only: dp
    use brz_lists, only: clear_list, clear_reals
    use brz_load_part, only: tell_carriers
    use brz_ranks, only: several
    use brz_bodies, only: bodies_t
    use brz_solid_state, only: solid_t
    use brz_errors, only: error_t
    implicit none
    private
    public :: load_faces, mark_loaded_segments, note_carriers

contains

    !> Set the loads of all particles, of rigid bodies, and of the driven particles of others, to
    !> the mean pressures of the coming step: their impulses are exact.
    subroutine load_faces(solid, dt, err)
        class(bodies_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        real(dp) :: a(3, size(solid%bodies))
        integer :: b

        if (.not. allocated(solid%loads%of)) return
        if (solid%loads%rebuilds /= solid%rebuilds) call place_all(solid, err) ! lists were sorted
        solid%loads%rebuilds = int(solid%rebuilds)
        a = pushes(solid%loads, size(solid%bodies), solid%time, dt)
        call clear_reals(solid%on_gpu, merge(3*solid%stride_d, size(solid%load), solid%on_gpu), &
            solid%load, err)
        do b = 1, size(solid%bodies)
            associate (there => solid%bodies(b))
                if (.not. any(abs(a(:, b)) > 0)) cycle
                call for_each_begin_load(solid%on_gpu, there%last - there%first + 1, there%first, &
                    solid%stride_d, solid%stride_p, a(1, b), a(2, b), a(3, b), solid%mass, &
                    solid%fixed, solid%load, err)
            end associate
        end do
        solid%loads%mean = mean_pressures(solid%loads, solid%time, dt)
        if (solid%on_gpu) call update_device(solid%loads%mean, err)
        associate (there => solid%loads%segments, place => solid%loads%place)
            if (there%carriers > 0) call for_each_load_carrier(solid%on_gpu, there%carriers, &
                solid%wide, solid%stride_d, solid%stride_p, solid%stride_t, solid%time, dt, &
                there%first, there%id, there%load, there%beside, there%mirror, there%width, &
                there%most, there%side, there%wave, solid%loads%mean, place, solid%x, &
                solid%fixed, solid%load, solid%face_stress, err)
        end associate
        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b), there => solid%bodies(b))
                if (body%formulation /= form_rigid .and. body%motion%n == 0) cycle
                call for_each_sum_load(solid%on_gpu, there%last - there%first + 1, solid%ranks, &
                    there%first, merge(0, 1, body%formulation == form_rigid), solid%wide, &
                    solid%stride_d, solid%stride_p, body%rigid%x(1), body%rigid%x(2), &
                    body%rigid%x(3), solid%x, solid%fixed, solid%load, body%rigid%load, err)
            end associate
        end do
    end subroutine load_faces

    !> Where particles and ghosts lie.
    subroutine place_all(solid, err)
        class(bodies_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        integer :: b

        call place_own(solid, err)
        do b = 1, size(solid%bodies)
            associate (there => solid%bodies(b), place => solid%loads%place)
                if (there%rim == there%last) cycle
                call for_each_place_particle(solid%on_gpu, there%rim - there%last, &
                    there%last + 1, -1, solid%id, place, err)
            end associate
        end do
    end subroutine place_all

    !> Where the particles of this process lie.
    subroutine place_own(solid, err)
        class(bodies_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        integer :: b, first

        call clear_list(solid%on_gpu, size(solid%loads%place), solid%loads%place, err)
        first = 1
        do b = 1, size(solid%bodies)
            associate (there => solid%bodies(b), place => solid%loads%place)
                if (b < size(solid%bodies)) then
                    if (solid%bodies(b + 1)%first == there%last + 1) cycle ! they go together
                end if
                call for_each_place_particle(solid%on_gpu, there%last - first + 1, first, 1, &
                                             solid%id, place, err)
            end associate
            if (b < size(solid%bodies)) first = solid%bodies(b + 1)%first
        end do
    end subroutine place_own

    !> Particles may have changed processes: tell all who has those that carry loaded segments.
    subroutine note_carriers(solid, err)
        class(bodies_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        if (.not. (allocated(solid%loads%of) .and. several(solid%ranks))) return
        call place_own(solid, err)
        associate (there => solid%loads%segments, place => solid%loads%place)
            call for_each_own_carrier(solid%on_gpu, there%carriers, solid%ranks%rank + 1, &
                there%first, there%id, place, there%owner, err)
        end associate
        if (solid%on_gpu) call update_host(solid%loads%segments%owner, err)
        call tell_carriers(solid)
        if (solid%on_gpu) call update_device(solid%loads%segments%owner, err)
    end subroutine note_carriers

    !> Mark the particles that others need for loaded segments, of which they are the neighbours.
    subroutine mark_loaded_segments(solid, err)
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        if (.not. allocated(solid%loads%of)) return
        call place_own(solid, err) ! arrays may have been laid anew
        associate (there => solid%loads%segments, place => solid%loads%place, part => solid%part)
            call for_each_mark_beside(solid%on_gpu, there%carriers, solid%n, &
                solid%ranks%rank + 1, there%first, there%beside, there%owner, place, part%sent, &
                part%mark, err)
        end associate
        solid%loads%rebuilds = -1 ! ghosts have no places now
    end subroutine mark_loaded_segments
end module brz_load_driver
