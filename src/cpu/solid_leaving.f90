! SPDX-License-Identifier: MIT
!> Particles that leave the region are taken out of the computation, where the deck wants it.
!>
!> A particle that is gone keeps its place, velocity and energy, and so its part of all totals. It
!> has no neighbours and no links, no force and no limit of the time step, and the air does not see
!> it. Lists are built without it, so particles go when lists are built anew.
module brz_solid_leaving
    use brz_kinds, only: dp
    use brz_solid_contact, only: find_press, is_pressed
    use brz_solid_state, only: form_rigid, form_total, is_free, is_gone, loose_by, solid_t
    implicit none
    private
    public :: remove_left

contains

    !> Take out what has left the region since the start. What is held, rigid or total Lagrangian
    !> stays, and for the time being what presses on another body: contact holds energy. Asked are
    !> the places and the lists alone, which a restart has too, never the forces of the last step.
    subroutine remove_left(solid)
        type(solid_t), intent(inout) :: solid
        integer :: b, i

        if (.not. solid%remove) return
        if (solid%links%present) call find_press(solid)
        do b = 1, size(solid%bodies)
            if (solid%bodies(b)%asleep .or. any(solid%bodies(b)%formulation &
                                                == [form_rigid, form_total])) cycle
            do i = solid%bodies(b)%first, solid%bodies(b)%last
                if (solid%fixed(i) /= is_free .or. is_inside(solid, solid%x(:, i))) cycle
                if (.not. is_inside(solid, solid%x_ref(:, i))) cycle
                if (is_pressed(solid, i)) cycle
                if (solid%cohesive%present) then ! so does what is glued
                    if (iand(solid%links%joined(i), ibset(0, loose_by) - 1) /= 0) cycle
                end if
                solid%fixed(i) = is_gone
                solid%a(:, i) = 0
                call let_go(solid, i)
                if (allocated(solid%load)) solid%load(:, i) = 0
            end do
        end do
    end subroutine remove_left

    !> What the hold owes to a particle becomes heat.
    subroutine let_go(solid, i)
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: i

        if (.not. allocated(solid%owed)) return
        solid%energy(i) = solid%energy(i) + solid%owed(i)/solid%mass(i)
        solid%owed(i) = 0
    end subroutine let_go

    pure logical function is_inside(solid, x)
        type(solid_t), intent(in) :: solid
        real(dp), intent(in) :: x(3) !! [m]

        is_inside = all(x >= solid%region(:, 1) .and. x <= solid%region(:, 2))
    end function is_inside
end module brz_solid_leaving
