! SPDX-License-Identifier: MIT
!> Particles that leave the region are taken out of the computation, where the deck wants it.
!>
!> A particle that is gone keeps its place, velocity and energy, and so its part of all totals. It
!> has no neighbours and no links, no force and no limit of the time step, and the air does not see
!> it. Lists are built without it, so particles go when lists are built anew; then they lie behind
!> the others of their body.
module brz_solid_leaving_driver
    use brz_air_force, only: load_of
    use brz_formulation_names, only: form_rigid, form_total
    use brz_leaving_loops, only: for_each_leave_region, for_each_let_go, for_each_stay_pressed, &
        for_each_take_out
    use brz_link_rows, only: joined_of
    use brz_solid_backend, only: find_press
    use brz_solid_state, only: solid_t
    use brz_errors, only: error_t
    implicit none
    private
    public :: remove_left

contains

    !> Take out what has left the region since the start. What is held, rigid or total Lagrangian
    !> stays, and for the time being what presses on another body. Asked are the places and the
    !> lists alone, which a restart has too, never the forces of the last step.
    subroutine remove_left(solid, err)
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        integer :: b, n

        if (.not. solid%remove) return
        if (solid%links%present) call find_press(solid, err)
        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b), there => solid%bodies(b), l => solid%links)
                if (body%inactive .or. any(body%formulation == [form_rigid, form_total])) cycle
                n = there%last - there%first + 1
                call for_each_leave_region(solid%on_gpu, n, there%first, solid%wide, &
                    solid%region, solid%x, solid%x_ref, solid%fixed, err)
                if (solid%links%present) call for_each_stay_pressed(solid%on_gpu, n, there%first, &
                    merge(1, 0, solid%cohesive%present), l%lay, l%ends, l%table, solid%x, &
                    solid%v, l%press(:, 1:), l%bond, joined_of(solid%links), l%row, &
                    l%slice(1:), l%count(1:), l%list, solid%fixed, err)
                if (allocated(solid%control_due)) call for_each_let_go(solid%on_gpu, n, &
                    there%first, solid%fixed, solid%mass, solid%control_due, solid%energy, err)
                call for_each_take_out(solid%on_gpu, n, there%first, solid%stride_d, &
                    solid%stride_p, merge(1, 0, allocated(solid%load)), solid%a, load_of(solid), &
                    solid%fixed, err)
            end associate
        end do
    end subroutine remove_left
end module brz_solid_leaving_driver
