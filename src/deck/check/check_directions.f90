! SPDX-License-Identifier: MIT
!> What has a direction, against those that the scene has: nothing moves, turns or is held along
!> others.
module brz_check_directions
    use brz_case, only: body_case_t, case_t
    use brz_deck, only: add_warning, complain, deck_t, group_label
    use brz_kinds, only: dp
    use brz_body_geometries, only: body_box
    implicit none
    private
    public :: check_directions

    character(*), parameter :: axes = 'xyz'

contains

    !> Check velocities of gas and bodies, spins, and faces that are held.
    subroutine check_directions(deck, case)
        type(deck_t), intent(inout) :: deck
        type(case_t), intent(in) :: case
        integer :: b, g, k

        b = 0
        k = 0
        do g = 1, deck%n
            select case (deck%groups(g)%name)
            case ('gas')
                k = k + 1
                call check_velocity(deck, g, 'velocity', case%run%dimension, case%gas(k)%velocity)
            case ('body')
                b = b + 1
                call check_body(deck, g, case, case%bodies(b))
            end select
        end do
    end subroutine check_directions

    subroutine check_body(deck, g, case, body)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(body_case_t), intent(in) :: body
        integer :: d, i

        d = case%run%dimension
        call check_velocity(deck, g, 'velocity', d, body%velocity)
        do i = 1, body%n_motion
            call check_velocity(deck, g, 'motion_velocity', d, body%motion_velocity(:, i))
        end do
        do i = 1, size(body%fix)
            if (len_trim(body%fix(i)) /= 2 .or. index(axes, body%fix(i) (1:1)) <= d) cycle
            call complain(deck, g, 'fix', "the scene has no face '"//trim(body%fix(i))// &
                          "'; take it out of fix")
        end do
        if (any(abs(body%spin(:merge(3, 2, d == 1))) > 0) .and. d < 3) then
            call complain(deck, g, 'spin', 'a scene in two dimensions turns about z alone, one '// &
                          'in one dimension does not turn; make the other components 0')
        else
            call check_turn(deck, g, case%run%symmetry, body)
        end if
    end subroutine check_body

    !> A component along a direction that is not modelled is a mistake.
    subroutine check_velocity(deck, g, key, dimension, v)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g, dimension
        character(*), intent(in) :: key
        real(dp), intent(in) :: v(3)
        integer :: d

        do d = dimension + 1, 3
            if (abs(v(d)) > 0) call complain(deck, g, key, 'the scene has no direction '// &
                                             axes(d:d)//'; make that component of '//key//' 0')
        end do
    end subroutine check_velocity

    !> A body on a plane of symmetry whose spin is not about its normal turns against its image.
    subroutine check_turn(deck, g, symmetry, body)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        logical, intent(in) :: symmetry(3)
        type(body_case_t), intent(in) :: body
        real(dp) :: lo(3), hi(3)
        integer :: d

        if (deck%groups(g)%bad .or. body%file /= '') return
        call body_box(body, lo, hi)
        do d = 1, 3
            if (.not. symmetry(d) .or. lo(d) > 1e-9_dp*(hi(d) - lo(d))) cycle
            if (.not. any(abs(body%spin) > 0 .and. [1, 2, 3] /= d)) cycle
            call add_warning(deck, deck%groups(g)%line, group_label(deck%groups(g))//'behind '// &
                'the plane of symmetry '//axes(d:d)//'=0 its image turns the other way; that '// &
                'is one body only where the spin is about '//axes(d:d))
        end do
    end subroutine check_turn
end module brz_check_directions
