! SPDX-License-Identifier: MIT
!> Plies of bodies: their layers of particles, and what planes of symmetry make of them.
module brz_check_plies
    use brz_case, only: body_case_t, case_t, material_case_t
    use brz_deck, only: add_warning, deck_t, group_label
    use brz_kinds, only: dp
    use brz_body_geometries, only: body_box
    use brz_text, only: to_text
    implicit none
    private
    public :: check_plies

    character(*), parameter :: axes = 'xyz'
    real(dp), parameter :: slack = 1e-9_dp !! relative rounding of positions in the deck
    real(dp), parameter :: same_angle = 1e-6_dp !! [deg]

contains

    !> Warn of plies without a layer of their own or of unequal thickness, and of those whose mirror
    !> images are other plies. The body is whole, not yet cut at planes of symmetry.
    subroutine check_plies(deck, g, case, body)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(body_case_t), intent(in) :: body
        real(dp) :: lo(3), hi(3), layers
        integer :: a, d, i

        if (deck%groups(g)%bad .or. body%n_plies == 0) return
        call body_box(body, lo, hi)
        a = index(axes, body%ply_axis)
        d = case%run%dimension
        i = minloc(hi(:d) - lo(:d), 1)
        if (is_across_longest(hi - lo, a, d)) call warn('its plies lie across '//body%ply_axis// &
            ', its longest side: the laminate of a plate lies across its thickness, '// &
            "ply_axis='"//axes(i:i)//"'")
        layers = 1
        if (a <= case%run%dimension) layers = (hi(a) - lo(a))/(body%spacing*body%aspect(a))
        if (layers < body%n_plies*(1 - 1e-6_dp)) &
            call warn(to_text(body%n_plies)//' plies, but only '//to_text(nint(layers))// &
                      ' layers of particles along '//body%ply_axis//': not every ply is present')
        if (layers > body%n_plies .and. mod(nint(layers), body%n_plies) /= 0) &
            call warn(to_text(nint(layers))//' layers of particles along '//body%ply_axis// &
                      ' for '//to_text(body%n_plies)//' plies: a layer belongs to the ply at '// &
                      'its middle, so plies are not equally thick')
        do i = 1, case%run%dimension
            if (.not. case%run%symmetry(i) .or. lo(i) >= slack*(hi(i) - lo(i))) cycle
            if (.not. are_even(case, body, i, abs(lo(i) + hi(i)) < slack*(hi(i) - lo(i)))) &
                call warn('the plane of symmetry '//axes(i:i)//'=0 cuts plies that are not '// &
                          'their own mirror images; model both sides')
        end do

    contains

        subroutine warn(text)
            character(*), intent(in) :: text

            call add_warning(deck, deck%groups(g)%line, group_label(deck%groups(g))//text)
        end subroutine warn
    end subroutine check_plies

    !> Are the plies of a thin body stacked along its longest side?
    pure logical function is_across_longest(side, a, dimension)
        real(dp), intent(in) :: side(3)
        integer, intent(in) :: a !! normal of the plies
        integer, intent(in) :: dimension
        real(dp), parameter :: thin = 3 !! least ratio of sides
        real(dp), parameter :: equal = 0.999_dp

        is_across_longest = .false.
        if (a > dimension) return
        is_across_longest = side(a) >= equal*maxval(side(:dimension)) .and. &
                            side(a) > thin*minval(side(:dimension))
    end function is_across_longest

    !> Are plies their own images in a plane normal to axis i? Across them their order turns round;
    !> in their plane fibres at 0 and 90 degrees are even, those of a fabric at 45 too.
    pure logical function are_even(case, body, i, whole) result(even)
        type(case_t), intent(in) :: case
        type(body_case_t), intent(in) :: body
        integer, intent(in) :: i
        logical, intent(in) :: whole !! the plane goes through the middle of the body
        real(dp) :: step
        integer :: n

        n = body%n_plies
        even = .true.
        if (index(axes, body%ply_axis) == i) then
            if (whole) even = all(abs(body%ply_angle(:n) - body%ply_angle(n:1:-1)) < same_angle)
        else if (body%material_index > 0) then
            step = even_step(case%materials(body%material_index))
            if (step > 0) &
                even = all(modulo(body%ply_angle(:n) + same_angle, step) < 2*same_angle)
        end if
    end function are_even

    !> Step of the angles of plies that are their own images; 0: all are [deg].
    pure real(dp) function even_step(material) result(step)
        type(material_case_t), intent(in) :: material
        integer :: k

        step = 0
        do k = 1, material%n
            if (material%key(k) == 'woven') step = merge(45, 90, material%value(k) > 0)
        end do
    end function even_step
end module brz_check_plies
