! SPDX-License-Identifier: MIT
!> Motions of regions of bodies: their values, and the bodies that they name.
module brz_check_motions
    use brz_case, only: body_case_t, case_t, name_len, region_case_t
    use brz_check_bodies, only: miss_body, moves_across, warn_cut
    use brz_deck, only: complain, deck_t, place
    use brz_get, only: get, get_boxes, get_list, is_usable
    use brz_kinds, only: dp
    use brz_text, only: to_text
    implicit none
    private
    public :: check_motions

contains

    !> Fill and check the motions of a case; its bodies must be there.
    subroutine check_motions(deck, case)
        type(deck_t), intent(inout) :: deck
        type(case_t), intent(inout) :: case
        type(region_case_t) :: region
        character(name_len) :: body
        integer :: b, g

        do g = 1, deck%n
            if (deck%groups(g)%name /= 'motion') cycle
            body = ''
            call get(deck%groups(g), 'body', body)
            b = findloc(case%bodies%id, body, 1)
            if (b == 0 .and. is_usable(deck%groups(g), 'body')) &
                call miss_body(deck, g, case, 'body', body)
            call fill(deck, g, region)
            if (b == 0) cycle
            call check_body(deck, g, case, case%bodies(b))
            call check_axes(deck, g, case, region)
            call check_planes(deck, g, case, case%bodies(b)%spacing, region)
            if (.not. allocated(case%bodies(b)%regions)) allocate (case%bodies(b)%regions(0))
            case%bodies(b)%regions = [case%bodies(b)%regions, region]
        end do
    end subroutine check_motions

    subroutine fill(deck, g, region)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(region_case_t), intent(out) :: region
        character(name_len) :: axes(3)
        real(dp), allocatable :: v(:)
        integer :: d, m, n

        region%place = place(deck, deck%groups(g)%line)
        region%id = deck%groups(g)%id
        call get_boxes(deck, g, 'box', region%box, region%n_boxes)
        axes = ''
        call get(deck%groups(g), 'axes', axes, n)
        region%along = [(any(axes == 'xyz' (d:d)), d=1, 3)]
        if (.not. any(region%along)) region%along = .true.
        call get_list(deck%groups(g), 'time', region%time)
        call get_list(deck%groups(g), 'velocity', v)
        n = size(region%time)
        m = size(v)
        if (n == 0 .and. m == 3) then
            region%time = [0.0_dp]
            n = 1
        end if
        if (m /= 3*n) then
            call complain(deck, g, 'velocity', 'velocity has '//to_text(m)//' numbers for '// &
                          to_text(n)//' times; give three numbers for each time')
            v = [(0.0_dp, d=1, 3*n)]
        end if
        if (any(region%time(2:) <= region%time(:max(n - 1, 0)))) &
            call complain(deck, g, 'time', 'the times must grow')
        region%velocity = reshape(v, [3, n])
    end subroutine fill

    !> A body whose particles move by themselves, in a scene where that is computed.
    subroutine check_body(deck, g, case, body)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(body_case_t), intent(in) :: body

        if (case%air%present) call complain(deck, g, 'body', &
            "is for scenes without air; in air drive what is held of a body by its motion_time")
        if (body%formulation == 'rigid') call complain(deck, g, 'body', 'regions of a rigid '// &
            'body cannot move apart; drive it by its motion_time and motion_velocity')
        if (body%n_motion > 0) call complain(deck, g, 'body', 'the body has a motion_time for '// &
            'all that is fixed of it; make that a &motion, too')
    end subroutine check_body

    !> What is prescribed lies along axes that move, and in the space of the scene.
    subroutine check_axes(deck, g, case, region)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(region_case_t), intent(in) :: region
        integer :: d

        do d = 1, 3
            if (.not. any(abs(region%velocity(d, :)) > 0)) cycle
            if (d > case%run%dimension) then
                call complain(deck, g, 'velocity', 'the scene has no direction '// &
                              'xyz' (d:d)//'; make that component 0')
            else if (.not. region%along(d)) then
                call complain(deck, g, 'velocity', "the regions are free along '"// &
                              'xyz' (d:d)//"'; make that component 0, or add the axis to axes")
            end if
        end do
    end subroutine check_axes

    !> Warn of what is at a plane of symmetry and moves across it.
    subroutine check_planes(deck, g, case, spacing, region)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        real(dp), intent(in) :: spacing !! of the body [m]
        type(region_case_t), intent(in) :: region
        integer :: d

        do d = 1, case%run%dimension
            if (.not. (case%run%symmetry(d) .and. any(abs(region%velocity(d, :)) > 0))) cycle
            if (any(region%box(2*d - 1, :region%n_boxes) < spacing/2 .and. &
                    region%box(2*d, :region%n_boxes) >= spacing/2)) &
                call warn_cut(deck, g, d, 'a region that is driven', moves_across)
        end do
    end subroutine check_planes
end module brz_check_motions
