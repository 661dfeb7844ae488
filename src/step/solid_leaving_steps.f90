! SPDX-License-Identifier: MIT
!> Particles that leave the region are taken out of the computation, where the deck wants it.
!> scripts/steps.py writes the same for the GPU.
!>
!> A particle that is gone keeps its place, velocity and energy, and so its part of all totals. It
!> has no neighbours and no links, no force and no limit of the time step, and the air does not see
!> it. Lists are built without it, so particles go when lists are built anew; then they lie behind
!> the others of their body.
module brz_solid_leaving_steps
    use brz_air_force, only: load_of !@cpu
    use brz_formulation_names, only: form_rigid, form_total
    !@gpu use brz_gpu_solid_contact, only: find_press
    use brz_leaving_loops, only: each_leave_region, each_let_go, each_stay_pressed, each_take_out
    use brz_link_rows, only: joined_of !@cpu
    use brz_solid_contact, only: find_press !@cpu
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: remove_left

contains

    !> Take out what has left the region since the start. What is held, rigid or total Lagrangian
    !> stays, and for the time being what presses on another body. Asked are the places and the
    !> lists alone, which a restart has too, never the forces of the last step.
    subroutine remove_left(solid)
        type(solid_t), intent(inout) :: solid
        integer :: b, n

        if (.not. solid%remove) return
        if (solid%links%present) call find_press(solid)
        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b), there => solid%bodies(b), l => solid%links)
                if (body%asleep .or. any(body%formulation == [form_rigid, form_total])) cycle
                n = there%last - there%first + 1
                call each_leave_region(n, there%first, solid%wide, solid%region, solid%x, &
                    solid%x_ref, solid%fixed) !@gpu solid%region => gpu%region
                if (solid%links%present) call each_stay_pressed(n, there%first, &
                    merge(1, 0, solid%cohesive%present), l%lay, l%ends, l%table, solid%x, &
                    solid%v, l%press(:, 1:), l%bond, joined_of(solid%links), l%row, &
                    l%slice(1:), l%count(1:), l%list, solid%fixed)
                if (allocated(solid%owed)) call each_let_go(n, there%first, solid%fixed, &
                    solid%mass, solid%owed, solid%energy)
                call each_take_out(n, there%first, solid%step_d, solid%step_p, &
                    merge(1, 0, allocated(solid%load)), solid%a, load_of(solid), solid%fixed)
            end associate
        end do
    end subroutine remove_left
end module brz_solid_leaving_steps
