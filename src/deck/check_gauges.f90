! SPDX-License-Identifier: MIT
!> Gauges: what they measure must be there.
module brz_check_gauges
    use brz_case, only: case_t, gauge_case_t
    use brz_check_air, only: box_text, point_text
    use brz_check_bodies, only: body_box, reference_hint
    use brz_check_start, only: is_radial
    use brz_deck, only: complain, deck_t, find_group, may_be_misspelt
    use brz_gauge_quantities, only: find_quantity, quantities
    use brz_get, only: is_usable
    use brz_kinds, only: dp
    implicit none
    private
    public :: check_gauges

contains

    !> Check all gauges and find their bodies.
    subroutine check_gauges(deck, case)
        type(deck_t), intent(inout) :: deck
        type(case_t), intent(inout) :: case
        integer :: g, k

        k = 0
        do g = 1, deck%n
            if (deck%groups(g)%name /= 'gauge') cycle
            k = k + 1
            call find_body(deck, g, case, case%gauges(k))
            if (.not. deck%groups(g)%bad) call check_quantity(deck, g, case, case%gauges(k))
            if (is_radial(case)) cycle
            if (.not. deck%groups(g)%bad) call check_place(deck, g, case, case%gauges(k))
        end do
    end subroutine check_gauges

    subroutine find_body(deck, g, case, gauge)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(gauge_case_t), intent(inout) :: gauge
        integer :: i

        if (.not. is_usable(deck%groups(g), 'body')) return
        do i = 1, size(case%bodies)
            if (case%bodies(i)%id == gauge%body) gauge%body_index = i
            if (gauge%body_index > 0) return
        end do
        call complain(deck, g, 'body', "there is no &body with id='"//trim(gauge%body)//"'"// &
                      reference_hint(trim(gauge%body), case%bodies%id))
    end subroutine find_body

    !> A quantity of the air, of a body, or of both.
    subroutine check_quantity(deck, g, case, gauge)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(gauge_case_t), intent(in) :: gauge
        logical :: of_body, of_air
        integer :: row

        row = find_quantity(trim(gauge%quantity))
        if (row == 0) return ! told where the key was read
        of_body = .not. quantities(row)%of_air
        of_air = .not. quantities(row)%of_body
        if (is_radial(case) .and. index(gauge%quantity, 'velocity') == 1) then
            call complain(deck, g, 'quantity', "quantity='"//trim(gauge%quantity)// &
                          "' needs a direction; along a radius measure the speed")
        else if (of_body .and. gauge%body_index == 0) then
            call complain(deck, g, 'quantity', "quantity='"//trim(gauge%quantity)// &
                          "' is that of a body: add body='...'")
        else if (of_air .and. gauge%body_index > 0) then
            call complain(deck, g, 'quantity', "quantity='"//trim(gauge%quantity)// &
                          "' is that of the air: take body out, or measure a velocity or "// &
                          "displacement")
        else if (gauge%body_index == 0 .and. .not. case%air%present) then
            if (may_be_misspelt(deck)) return
            call complain(deck, g, 'quantity', "quantity='"//trim(gauge%quantity)// &
                          "' needs &air; for a body add body='...'")
        end if
    end subroutine check_quantity

    !> A gauge of the air lies in the air, one of a body in or on the body.
    subroutine check_place(deck, g, case, gauge)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(gauge_case_t), intent(in) :: gauge
        character(:), allocatable :: where
        real(dp) :: lo(3), hi(3), slack(3)
        integer :: d

        if (gauge%body_index > 0) then
            call body_box(case%bodies(gauge%body_index), lo, hi)
            slack = 1.001_dp*case%bodies(gauge%body_index)%spacing
            where = 'the body, which is '
            if (deck%groups(find_group(deck, 'body', trim(gauge%body)))%bad) return
        else
            if (.not. case%air%present) return
            lo = case%air%lo
            hi = case%air%hi
            slack = 1e-9_dp*(hi - lo)
            where = 'the air, which is '
            if (deck%groups(find_group(deck, 'air'))%bad) return
        end if
        d = case%run%dimension
        if (any(gauge%at(:d) < lo(:d) - slack(:d) .or. gauge%at(:d) > hi(:d) + slack(:d))) &
            call complain(deck, g, 'at', 'the gauge at '//point_text(gauge%at)// &
                          ' lies outside '//where// &
                          box_text(lo, hi))
    end subroutine check_place
end module brz_check_gauges
