! SPDX-License-Identifier: MIT
!> Forces of contact between two bodies that gauges name, on the GPU: see brz_solid_between.
module brz_gpu_solid_between
    use brz_between_items, only: add_impulse
    use brz_errors, only: error_t
    use brz_gpu_solid_layout, only: at_mass, at_stress, tag_bond, tag_joined, tag_weight
    use brz_gpu_solid_state, only: column_of, gpu_solid_t, tags_of
    use brz_kinds, only: dp
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: book_gpu_between

contains

    !> The forces after a step, and what they gave in it.
    subroutine book_gpu_between(gpu, solid, dt, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        real(dp) :: force(3)
        integer :: k

        if (.not. allocated(solid%between)) return
        do k = 1, size(solid%between)
            call force_between(gpu, solid%between(k)%body, force, err)
            call add_impulse(solid%between(k), force, dt)
        end do
    end subroutine book_gpu_between

    !> Force on the first of two bodies by the second [N].
    subroutine force_between(gpu, body, force, err)
        type(gpu_solid_t), intent(inout) :: gpu
        integer, intent(in) :: body(2)
        real(dp), intent(out) :: force(3)
        type(error_t), intent(inout) :: err

        force = 0
        if (.not. gpu%linked) return
        associate (l => gpu%links, own => gpu%bodies(body(1)), weight => tags_of(gpu, tag_weight))
            call l%between%sum_between(own%last - own%first + 1, own%first, body(2), l%lay, &
                                       l%ends, l%table, l%cell, gpu%place, gpu%motion, &
                                       column_of(gpu, at_mass), weight%buffer_t, &
                                       column_of(gpu, at_stress + 1), gpu%row, l%press, &
                                       tags_of(gpu, tag_bond), tags_of(gpu, tag_joined), l%count, &
                                       l%slice, l%count, l%list, gpu%exact, err)
        end associate
        force = gpu%exact%total(:3)
    end subroutine force_between
end module brz_gpu_solid_between
