! SPDX-License-Identifier: MIT
!> Pass 1 on the GPU: gradients of every particle, and its material over the step just made.
module brz_gpu_solid_gradients
    use brz_buffers, only: doubles_t, from, reals_t
    use brz_device, only: clear_buffer, copy_within, reserve_buffer, side_by_side
    use brz_errors, only: error_t
    use brz_gpu_solid_contact, only: add_bond_moments
    use brz_gpu_solid_state, only: tags_of, words_of_real
    use brz_gpu_solid_tiles, only: lay_tiles, threads_of_kind, tiles_of
    use brz_solid_device, only: body_kind_t, solid_device_t
    use brz_gpu_solid_layout, only: tag_unsupported
    use brz_kinds, only: dp, int64, rk
    use brz_motion_launches, only: motion_kernels
    use brz_rigid_pose, only: resting_pose
    use brz_solid_launches, only: launch_advance_point, launch_solid_moments, solid_kernels
    use brz_bodies, only: bodies_t
    use brz_listed_bodies, only: listed_bodies_t
    implicit none
    private
    public :: gradient_pass, renew_sleepers
    public :: sum_moments, find_gradients, update_material, fill_rows ! apart, to be timed

contains

    !> Pass 1, and the material over the step just made; with dt = 0 no material, and nothing loses
    !> its support: the host has found what has none at the start. Of bodies that are active, or of
    !> the others.
    subroutine gradient_pass(gpu, solid, dt, err, of_sleepers)
        type(solid_device_t), intent(inout) :: gpu
        class(listed_bodies_t), intent(in) :: solid
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        logical, intent(in), optional :: of_sleepers
        integer :: b, k

        if (.not. dt > 0) &
            call copy_within(tags_of(gpu, tag_unsupported), gpu%picked, 4_int64*gpu%n, err)
        call lay_tiles(gpu, err, of_sleepers)
        call pack_places(gpu, err)
        do k = 1, size(gpu%kinds)
            call side_by_side(merge(k, 0, size(gpu%kinds) > 1))
            call sum_moments(gpu, gpu%kinds(k), err)
        end do
        call side_by_side(0)
        call add_bond_moments(gpu, err)
        do b = 1, size(gpu%bodies)
            if (gpu%bodies(b)%rigid .and. (gpu%bodies(b)%inactive .eqv. present(of_sleepers))) &
                call fill_rigid(gpu, solid, b, err)
        end do
        do k = 1, size(gpu%kinds)
            call side_by_side(merge(k, 0, size(gpu%kinds) > 1))
            call find_gradients(gpu, gpu%kinds(k), real(dt, rk), err)
            if (dt > 0) then
                call free_faces(gpu, gpu%kinds(k), real(dt/2, rk), err)
                call update_material(gpu, gpu%kinds(k), real(dt, rk), err)
                call free_faces(gpu, gpu%kinds(k), real(dt/2, rk), err)
            end if
            if (solid%links%faces) call move_faces(gpu, gpu%kinds(k), real(dt, rk), err)
            call fill_rows(gpu, gpu%kinds(k), real(dt, rk), err)
        end do
        call side_by_side(0)
        if (.not. dt > 0) &
            call copy_within(gpu%picked, tags_of(gpu, tag_unsupported), 4_int64*gpu%n, err)
    end subroutine gradient_pass

    !> What contact gathers of the particles of body b.
    subroutine fill_rigid(gpu, solid, b, err)
        type(solid_device_t), intent(in) :: gpu
        class(bodies_t), intent(in) :: solid
        integer, intent(in) :: b
        type(error_t), intent(inout) :: err

        associate (there => gpu%bodies(b), n => gpu%bodies(b)%last - gpu%bodies(b)%first + 1)
            call motion_kernels%fill_rigid_row(n, there%first, 4, &
                resting_pose(solid%bodies(b)%rigid), gpu%volume, gpu%pair, err)
            ! the host knows its time step
            call clear_buffer(from(gpu%rate, int(there%first, int64)), err, 8_int64*n)
        end associate
    end subroutine fill_rigid

    !> Pass 1 of bodies that sleep, where regions are cut anew: their particles may be others now.
    subroutine renew_sleepers(gpu, solid, err)
        type(solid_device_t), intent(inout) :: gpu
        class(listed_bodies_t), intent(in) :: solid
        type(error_t), intent(inout) :: err

        call gradient_pass(gpu, solid, 0.0_dp, err, of_sleepers=.true.)
    end subroutine renew_sleepers

    !> Places and reference positions as pairs read them: in real64 they are these themselves. The
    !> reference of a particle stays, so it is packed where particles have changed their places.
    subroutine pack_places(gpu, err)
        type(solid_device_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err
        integer :: b, first

        if (words_of_real > 1) then
            gpu%near%address = gpu%place%address
            gpu%far%address = gpu%reference%address
            return
        end if
        call reserve_buffer(gpu%near, 16_int64*gpu%n, err)
        call reserve_buffer(gpu%far, 16_int64*gpu%n, err)
        first = 1
        do b = 1, size(gpu%bodies)
            associate (body => gpu%bodies(b))
                if (.not. body%packed) call pack(gpu%reference, gpu%far, body%first, body%rim)
                body%packed = .true.
                if (b < size(gpu%bodies)) then
                    if (gpu%bodies(b + 1)%first == body%rim + 1) cycle ! no room in between
                end if
                call pack(gpu%place, gpu%near, first, body%rim)
                first = body%first + body%room
            end associate
        end do

    contains

        subroutine pack(place, packed, from, to)
            type(doubles_t), intent(in) :: place
            type(reals_t), intent(in) :: packed
            integer, intent(in) :: from, to !! particles

            if (to >= from) call solid_kernels%solid_pack([to - from + 1, 1, 1], from, to, place, &
                packed, err)
        end subroutine pack
    end subroutine pack_places

    subroutine sum_moments(gpu, kind, err)
        type(solid_device_t), intent(in) :: gpu
        type(body_kind_t), intent(in) :: kind
        type(error_t), intent(inout) :: err
        type(doubles_t) :: place, other
        type(reals_t) :: near, far

        if (kind%tiles == 0) return
        place = gpu%place
        other = gpu%reference
        near = gpu%near
        far = gpu%far
        ! total-Lagrangian: pairs are weighed by X_ij, and the sums lead to dx/dX
        if (gpu%bodies(kind%like)%total) then
            place = gpu%reference
            other = gpu%place
            near = gpu%far
            far = gpu%near
        end if
        call launch_solid_moments(gpu%bodies(kind%like)%moments, threads_of_kind(kind), &
            gpu%stride_d, tiles_of(gpu, kind), gpu%params, gpu%offsets, place, other, near, far, &
            gpu%motion, gpu%count, gpu%count, gpu%count, gpu%row, gpu%grad, gpu%state, gpu%tag, &
            gpu%k_axes, gpu%control, gpu%acting, gpu%count, err)
    end subroutine sum_moments

    subroutine find_gradients(gpu, kind, dt, err)
        type(solid_device_t), intent(in) :: gpu
        type(body_kind_t), intent(in) :: kind
        real(rk), intent(in) :: dt !! step just made, 0: none [s]
        type(error_t), intent(inout) :: err

        if (kind%tiles == 0) return
        call solid_kernels%solid_gradients(threads_of_kind(kind), gpu%stride_d, &
            tiles_of(gpu, kind), gpu%params, gpu%row, gpu%grad, gpu%tag, gpu%k_axes, gpu%control, &
            gpu%state, dt, err)
    end subroutine find_gradients

    !> Single layers: take out of the energy what the stress does on their faces.
    subroutine free_faces(gpu, kind, time, err)
        type(solid_device_t), intent(in) :: gpu
        type(body_kind_t), intent(in) :: kind
        real(rk), intent(in) :: time !! [s]
        type(error_t), intent(inout) :: err

        if (kind%tiles == 0 .or. .not. gpu%bodies(kind%like)%layer) return
        call solid_kernels%solid_free_faces(threads_of_kind(kind), gpu%stride_d, &
            tiles_of(gpu, kind), gpu%params, time, gpu%row, gpu%grad, gpu%stress, gpu%motion, &
            gpu%mass, gpu%energy, err)
    end subroutine free_faces

    subroutine update_material(gpu, kind, dt, err)
        type(solid_device_t), intent(in) :: gpu
        type(body_kind_t), intent(in) :: kind
        real(rk), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err

        if (kind%tiles == 0) return
        call launch_advance_point(gpu%bodies(kind%like)%update, threads_of_kind(kind), &
            gpu%stride_d, dt, tiles_of(gpu, kind), gpu%params, gpu%grad, gpu%state, &
            gpu%tag, gpu%diag, gpu%flags, err)
    end subroutine update_material

    !> Strain the half layers at the faces of particles that may touch others.
    subroutine move_faces(gpu, kind, dt, err)
        type(solid_device_t), intent(in) :: gpu
        type(body_kind_t), intent(in) :: kind
        real(rk), intent(in) :: dt !! step just made, 0: none [s]
        type(error_t), intent(inout) :: err

        if (kind%tiles == 0) return
        call solid_kernels%solid_move_faces(threads_of_kind(kind), gpu%stride_d, &
            tiles_of(gpu, kind), gpu%params, dt, gpu%links%count, gpu%tag, &
            gpu%row, gpu%grad, gpu%mu, gpu%motion, gpu%mass, gpu%links%face, gpu%links%press, err)
    end subroutine move_faces

    subroutine fill_rows(gpu, kind, dt, err)
        type(solid_device_t), intent(in) :: gpu
        type(body_kind_t), intent(in) :: kind
        real(rk), intent(in) :: dt !! step just made, 0: none [s]
        type(error_t), intent(inout) :: err

        if (kind%tiles == 0) return
        call solid_kernels%solid_rows(threads_of_kind(kind), gpu%stride_d, dt, &
            tiles_of(gpu, kind), gpu%params, gpu%place, gpu%grad, gpu%state, &
            gpu%tag, gpu%motion, gpu%row, gpu%rate, gpu%axes, gpu%k_axes, gpu%control, gpu%diag, &
            gpu%flags, err)
    end subroutine fill_rows
end module brz_gpu_solid_gradients
