! SPDX-License-Identifier: MIT
!> Pressures on faces of bodies and pushes on whole bodies on the GPU: memory, launches.
module brz_gpu_solid_load
    use brz_device, only: allocate_buffer, clear_buffer, copy_in, device_t, put_buffer
    use brz_errors, only: error_t, failed
    use brz_face_load, only: loads_t, mean_pressures, pushes
    use brz_gpu_solid_layout, only: at_mass, tag_fixed, tag_id
    use brz_gpu_solid_state, only: column_of, gpu_solid_t, tags_of
    use brz_kinds, only: dp, int64
    use brz_ranks, only: several
    use brz_solid_state, only: solid_t
    use brz_tallies, only: tally_threads
    implicit none
    private
    public :: open_gpu_loads, gpu_load_faces

contains

    !> Reserve memory and copy the facets.
    subroutine open_gpu_loads(device, loads, gpu, err)
        type(device_t), intent(in) :: device
        type(loads_t), intent(in) :: loads
        type(gpu_solid_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err

        gpu%loads%present = allocated(loads%of)
        if (.not. gpu%loads%present) return
        associate (there => gpu%loads, f => loads%facets)
            there%carriers = f%carriers
            call put_buffer(f%first, there%first, 4_int64*(f%carriers + 1), err)
            call put_buffer(f%id, there%id, 4_int64*f%n, err)
            call put_buffer(f%load, there%of, 4_int64*f%n, err)
            call put_buffer(f%beside, there%beside, 16_int64*f%n, err)
            call put_buffer(f%mirror, there%mirror, 16_int64*f%n, err)
            call put_buffer(f%width, there%width, 16_int64*f%n, err)
            call put_buffer(f%most, there%most, 16_int64*f%n, err)
            call put_buffer(f%side, there%side, 4_int64*f%n, err)
            call put_buffer(f%wave, there%wave, 48_int64*f%n, err)
            call allocate_buffer(there%mean, 8_int64*size(loads%of), err)
            call allocate_buffer(there%place, 4_int64*size(loads%place), err)
            call there%kernels%open(device, err)
        end associate
    end subroutine open_gpu_loads

    !> Set the loads of all particles, and those of rigid bodies, as load_faces does.
    subroutine gpu_load_faces(gpu, solid, dt, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        real(dp) :: a(3, size(solid%bodies))
        integer :: b

        if (.not. gpu%loads%present .or. failed(err)) return
        associate (there => gpu%loads, load => column_of(gpu, gpu%load + 1), &
                   fixed => tags_of(gpu, tag_fixed))
            if (there%rebuilds /= solid%rebuilds) then ! lists were sorted
                call place_all(gpu, solid, err)
                there%rebuilds = int(solid%rebuilds)
            end if
            a = pushes(solid%loads, size(solid%bodies), solid%time, dt)
            do b = 1, size(solid%bodies)
                associate (body => gpu%bodies(b))
                    call there%kernels%begin_load(body%last - body%first + 1, body%first, gpu%n, &
                        1, a(1, b), a(2, b), a(3, b), column_of(gpu, at_mass), fixed, load, err)
                end associate
            end do
            if (there%carriers > 0) then
                call copy_in(mean_pressures(solid%loads, solid%time, dt), there%mean, &
                             8_int64*size(solid%loads%of), err)
                call there%kernels%load_carrier(there%carriers, 4, gpu%n, 1, solid%time, dt, &
                    there%first, there%id, there%of, there%beside, there%mirror, there%width, &
                    there%most, there%side, there%wave, there%mean, there%place, gpu%place, &
                    fixed, load, err)
            end if
            do b = 1, size(solid%bodies)
                if (gpu%bodies(b)%rigid .or. solid%bodies(b)%motion%n > 0) &
                    call sum_body(gpu, solid, b, err)
            end do
        end associate
    end subroutine gpu_load_faces

    !> Where particles and ghosts lie, and whether this process sees all neighbours of what is
    !> loaded.
    subroutine place_all(gpu, solid, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        integer :: b

        associate (there => gpu%loads, id => tags_of(gpu, tag_id))
            call clear_buffer(there%place, err)
            do b = 1, size(gpu%bodies)
                associate (body => gpu%bodies(b))
                    call there%kernels%place_particle(body%last - body%first + 1, body%first, 1, &
                                                      id, there%place, err)
                    call there%kernels%place_particle(body%rim - body%last, body%last + 1, -1, &
                                                      id, there%place, err)
                end associate
            end do
            if (.not. several(solid%ranks)) return
            call clear_buffer(gpu%sums_of_forces, err)
            call there%kernels%see_carrier(there%carriers, there%first, there%id, there%beside, &
                there%place, tags_of(gpu, tag_fixed), gpu%sums_of_forces, err)
            b = nint(gpu%common%largest(gpu%sums_of_forces, tally_threads, err))
            if (b > 0 .and. .not. failed(err)) solid%loads%lost = b
        end associate
    end subroutine place_all

    !> Force and torque on rigid body b, or on what is driven of it.
    subroutine sum_body(gpu, solid, b, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: b
        type(error_t), intent(inout) :: err

        associate (body => gpu%bodies(b), rigid => solid%bodies(b)%rigid)
            call gpu%loads%kernels%sum_load(body%last - body%first + 1, body%first, &
                merge(0, 1, body%rigid), 4, gpu%n, 1, rigid%x(1), rigid%x(2), rigid%x(3), &
                gpu%place, tags_of(gpu, tag_fixed), column_of(gpu, gpu%load + 1), &
                gpu%exact, err)
            rigid%load = gpu%exact%total(:6)
        end associate
    end subroutine sum_body
end module brz_gpu_solid_load
