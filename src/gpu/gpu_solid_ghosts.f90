! SPDX-License-Identifier: MIT
!> Ghosts of particles on several GPUs: what brz_solid_ghosts does on the CPU, and how particles and
!> ghosts are laid anew when lists are built, by the procedures of the CPU on the host.
module brz_gpu_solid_ghosts
    use brz_buffers, only: from, integers_t
    use brz_device, only: copy_in, device_t
    use brz_errors, only: error_t, failed
    use brz_gpu_parcels, only: words_of
    use brz_gpu_solid_copy, only: fetch_solid, open_gpu_solid
    use brz_gpu_solid_layout, only: flag_drawn
    use brz_gpu_solid_search, only: begin_body
    use brz_gpu_solid_state, only: close_gpu_solid, gpu_solid_t, words_of_real
    use brz_gpu_solid_sums, only: fetch_ledgers
    use brz_kinds, only: int64
    use brz_ranks, only: agree, several
    use brz_solid_home, only: place_ghosts, send_home
    use brz_solid_sort, only: sort_body
    use brz_solid_state, only: n_held, n_pair, solid_t
    implicit none
    private
    public :: refresh_gpu_motion, refresh_gpu_rows, lay_gpu_anew

contains

    !> Places, velocities, volumes and smoothing lengths: what pass 1 reads.
    subroutine refresh_gpu_motion(gpu, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err

        if (.not. several(gpu%ghosts%ranks)) return
        call gpu%ghosts%refresh([words_of(gpu%place), words_of(gpu%motion)], &
                                [8, 4*words_of_real], err)
    end subroutine refresh_gpu_motion

    !> What pass 1 has left, and pass 2 reads. What of a body is held may be a ghost, so then all
    !> look for it.
    subroutine refresh_gpu_rows(gpu, solid, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(in) :: solid
        type(error_t), intent(inout) :: err
        type(integers_t) :: arrays(3)
        integer :: n, words(3)

        if (.not. several(gpu%ghosts%ranks)) return
        arrays(1) = words_of(gpu%row)
        words(1) = n_pair*words_of_real
        n = 1
        if (allocated(solid%hold) .or. allocated(solid%tilt)) then
            n = 2
            arrays(n) = words_of(gpu%hold)
            words(n) = 6
        end if
        if (allocated(solid%held)) then
            n = n + 1
            arrays(n) = words_of(gpu%held)
            words(n) = n_held*words_of_real
        end if
        call gpu%ghosts%refresh(arrays(:n), words(:n), err)
        if (any(gpu%bodies%drawn)) call copy_in([1], &
            from(gpu%flags, int(flag_drawn, int64)), 4_int64, err)
    end subroutine refresh_gpu_rows

    !> The stale bodies get lists for the places of now: particles go home and ghosts are laid, on
    !> the host, and the GPU takes over again. All processes must call.
    subroutine lay_gpu_anew(gpu, solid, stale, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        logical, intent(in) :: stale(:) !! (bodies)
        type(error_t), intent(inout) :: err
        type(device_t) :: device
        integer :: b
        logical :: loaded

        do b = 1, size(stale)
            if (stale(b)) call begin_body(gpu, solid, b, err)
        end do
        gpu%fetched = .false.
        gpu%summed = .false.
        call fetch_solid(gpu, solid, err)
        call fetch_ledgers(gpu, solid, err)
        call agree(solid%ranks, err)
        if (failed(err)) return
        call send_home(solid)
        do b = 1, size(stale)
            call sort_body(solid, b)
        end do
        call place_ghosts(solid)
        device = gpu%device
        loaded = gpu%load > 0
        call close_gpu_solid(gpu)
        call open_gpu_solid(device, solid, loaded, gpu, err)
        call agree(solid%ranks, err)
        gpu%bodies%asleep = solid%bodies%asleep
        gpu%stepped = .true.
        gpu%fetched = .false.
        gpu%summed = .false.
    end subroutine lay_gpu_anew
end module brz_gpu_solid_ghosts
