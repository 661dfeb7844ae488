! SPDX-License-Identifier: MIT
!> Geometry of the air, of boxes of gas and of charges.
module brz_check_air
    use brz_case, only: case_t, charge_case_t, gas_case_t
    use brz_check_ground, only: check_closed, check_ground
    use brz_check_start, only: check_geometry, check_start, is_radial
    use brz_deck, only: add_warning, complain, deck_t, entry_line, find_group, group_label, &
                        may_be_misspelt
    use brz_get, only: is_given, is_usable, need_file
    use brz_kinds, only: dp, real32
    use brz_text, only: to_text
    implicit none
    private
    public :: check_air, check_gas, check_charges, check_corners, point_text, box_text
    public :: charge_half_sides

    real(dp), parameter :: least_cells = 3, good_cells = 8 !! cells across the radius of a charge
    character(*), parameter :: axes = 'xyz'

contains

    subroutine check_air(deck, case)
        type(deck_t), intent(inout) :: deck
        type(case_t), intent(in) :: case
        integer :: g, i

        g = find_group(deck, 'air')
        if (g == 0) return
        call check_geometry(deck, case)
        if (is_radial(case)) return
        call check_corners(deck, g, case%air%lo, case%air%hi)
        if (case%air%reconstruction == 'weno5z' .and. case%air%integrator == 'ssprk2') &
            call complain(deck, g, 'integrator', "fifth order is unstable with two stages; use "// &
                          "integrator='ssprk3', or reconstruction='muscl'")
        if (case%air%reconstruction == 'weno5z' .and. case%air%flux == 'hllc' .and. &
            has_shocks(case)) call add_warning(deck, deck%groups(g)%line, &
                group_label(deck%groups(g))//'weno5z with hllc rings behind shocks: '// &
                'where one is reflected by 3 to 6 % of density and pressure, and hardly less '// &
                "with finer cells; take reconstruction='muscl', or flux='steger_warming'")
        if (.not. is_usable(deck%groups(g), 'cells')) return
        if (product(real(case%air%cells, dp)) > real(huge(1), dp)) &
            call complain(deck, g, 'cells', to_text(product(real(case%air%cells, dp)))// &
                          ' cells are more than '//to_text(huge(1))// &
                          ', the most that can be counted')
        do i = case%run%dimension + 1, 3
            if (case%air%cells(i) == 1) cycle
            call complain(deck, g, 'cells', 'dimension='//to_text(case%run%dimension)// &
                          ' of &run asks for 1 cell along '//axes(i:i)//', found '// &
                          to_text(case%air%cells(i)))
        end do
        if (deck%groups(g)%bad) return
        do i = 1, 3
            if (.not. case%run%symmetry(i)) cycle
            if (abs(case%air%lo(i)) <= 1e-9_dp*(case%air%hi(i) - case%air%lo(i))) cycle
            call complain(deck, g, 'box', 'with symmetry along '//axes(i:i)// &
                          ' the box must start at '// &
                          axes(i:i)//'=0, found '//to_text(case%air%lo(i)))
        end do
    end subroutine check_air

    !> Are there shocks, or will there be: a charge, a wave that comes in, gas of twice the
    !> pressure or faster than sound?
    pure logical function has_shocks(case) result(shocks)
        type(case_t), intent(in) :: case
        real(dp), parameter :: strong = 2 !! ratio of pressures
        real(dp) :: ratio
        integer :: i

        shocks = .false.
        if (allocated(case%charges)) shocks = size(case%charges) > 0
        if (allocated(case%inflows)) shocks = shocks .or. size(case%inflows) > 0
        if (.not. allocated(case%gas)) return
        do i = 1, size(case%gas)
            if (.not. (case%gas(i)%density > 0 .and. case%gas(i)%pressure > 0)) cycle ! a file
            associate (gas => case%gas(i))
                ratio = gas%pressure/case%air%pressure
                shocks = shocks .or. max(ratio, 1/ratio) > strong .or. norm2(gas%velocity)**2 > &
                         case%air%gamma*gas%pressure/gas%density
            end associate
        end do
    end function has_shocks

    subroutine check_gas(deck, case)
        type(deck_t), intent(inout) :: deck
        type(case_t), intent(in) :: case
        integer :: g, k

        k = 0
        do g = 1, deck%n
            if (deck%groups(g)%name /= 'gas') cycle
            k = k + 1
            if (.not. case%air%present) then
                if (.not. may_be_misspelt(deck)) &
                    call complain(deck, g, 'id', 'a box of gas needs &air')
                cycle
            end if
            if (is_radial(case)) cycle
            call check_kind(deck, g, case, case%gas(k))
            if (case%gas(k)%file /= '') cycle
            call check_corners(deck, g, case%gas(k)%lo, case%gas(k)%hi)
            if (deck%groups(g)%bad .or. air_bad(deck)) cycle
            if (any(case%gas(k)%hi <= case%air%lo .or. case%gas(k)%lo >= case%air%hi)) then
                call complain(deck, g, 'box', 'the box lies outside the air, '//air_text(case))
            else
                call judge_box(deck, g, case, case%gas(k))
            end if
        end do
    end subroutine check_gas

    !> A box of gas has all of its state, gas from a file none of it.
    subroutine check_kind(deck, g, case, gas)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(gas_case_t), intent(in) :: gas
        character(8), parameter :: of_box(4) = [character(8) :: 'box', 'density', 'pressure', &
                                                'velocity']
        integer :: i
        logical :: given

        do i = 1, 4
            given = is_given(deck%groups(g), trim(of_box(i)))
            if (gas%file /= '' .and. given) call complain(deck, g, trim(of_box(i)), 'a file '// &
                'has all of the state; take '//trim(of_box(i))//' out')
            if (gas%file == '' .and. i < 4 .and. .not. given) call complain(deck, g, &
                trim(of_box(i)), "key '"//trim(of_box(i))//"' is missing; a box of gas needs "// &
                'box, density and pressure, or a file')
        end do
        if (gas%file == '') then
            if (is_given(deck%groups(g), 'move') .or. is_given(deck%groups(g), 'at')) &
                call complain(deck, g, 'id', 'move and at belong to a file; take them out')
            return
        end if
        call need_file(deck, g, 'file', gas%file)
        if (any(case%charges%start /= '3d')) call complain(deck, g, 'file', 'a charge that '// &
            "starts in one or two dimensions knows no gas from a file; use start='3d'")
    end subroutine check_kind

    !> A box of gas is whole cells: those whose middle lies in it. Say where that is not the box.
    subroutine judge_box(deck, g, case, gas)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(gas_case_t), intent(in) :: gas
        real(dp), dimension(3) :: dx, low, high, first, last
        logical :: inside
        integer :: i

        inside = .false.
        dx = (case%air%hi - case%air%lo)/case%air%cells
        low = max((gas%lo - case%air%lo)/dx, 0.0_dp)
        high = min((gas%hi - case%air%lo)/dx, real(case%air%cells, dp))
        first = real(ceiling(low - 0.5_dp), dp)
        last = real(floor(high + 0.5_dp), dp)
        do i = 1, 3
            if (case%air%cells(i) == 1) cycle
            if (last(i) > first(i)) then
                inside = inside .or. max(abs(low(i) - first(i)), abs(high(i) - last(i))) > 1e-6_dp
                cycle
            end if
            call add_warning(deck, entry_line(deck%groups(g), 'box'), &
                             group_label(deck%groups(g))//'the box changes nothing: it holds '// &
                             'the middle of no cell along '//axes(i:i)//', where they are '// &
                             to_text(real(dx(i), real32))//' m long; make it larger or the '// &
                             'cells smaller')
            return
        end do
        if (inside) call add_warning(deck, entry_line(deck%groups(g), 'box'), &
            group_label(deck%groups(g))//'the box ends inside cells; in effect it is '// &
            box_text(anint(1e9_dp*(case%air%lo + first*dx))/1e9_dp, &
                     anint(1e9_dp*(case%air%lo + last*dx))/1e9_dp)// &
            ' (the cells whose middle it holds); end it on their faces')
    end subroutine judge_box

    subroutine check_charges(deck, case)
        type(deck_t), intent(inout) :: deck
        type(case_t), intent(in) :: case
        real(dp) :: half(3)
        integer :: g, k

        k = 0
        do g = 1, deck%n
            if (deck%groups(g)%name /= 'charge') cycle
            k = k + 1
            if (.not. case%air%present) then
                if (.not. may_be_misspelt(deck)) &
                    call complain(deck, g, 'id', 'a charge needs &air around it')
                cycle
            end if
            if (deck%groups(g)%bad .or. air_bad(deck)) cycle
            call check_start(deck, g, case, case%charges(k))
            call charge_half_sides(case%charges(k), spread(.true., 1, 3), 1.0_dp, half)
            call check_ground(deck, g, case, case%charges(k), half)
            if (is_radial(case)) cycle
            if (any(case%charges(k)%at < case%air%lo .or. case%charges(k)%at > case%air%hi)) then
                call complain(deck, g, 'at', 'its centre '//point_text(case%charges(k)%at)// &
                              ' lies outside the air, '//air_text(case))
            else if (case%charges(k)%start == '3d') then
                call check_charge_size(deck, g, case, case%charges(k))
                call check_overlap(deck, g, case, k)
            end if
        end do
        if (case%air%present .and. k > 0) call check_closed(deck, case)
    end subroutine check_charges

    !> Enough cells across the charge, and all of it inside the air.
    subroutine check_charge_size(deck, g, case, charge)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(charge_case_t), intent(in) :: charge
        real(dp) :: half(3), dx(3), n
        logical :: active(3)
        integer :: i

        active = case%air%cells > 1
        dx = (case%air%hi - case%air%lo)/case%air%cells
        call charge_half_sides(charge, active, product(dx, mask=.not. active), half)
        n = minval(half/dx, mask=active)
        if (n < least_cells) then
            call complain(deck, g, 'mass', 'only '//cells_text(n)// &
                          ' cells lie across its radius of '// &
                          cells_text(1000*minval(half, mask=active))// &
                          ' mm; at least 3 are needed, 8 are good: use '// &
                          "smaller cells or a larger mass, or start='1d'")
        else if (n < good_cells) then
            call add_warning(deck, deck%groups(g)%line, group_label(deck%groups(g))//'only '// &
                             cells_text(n)//' cells lie across its radius; 8 or more are good '// &
                             "(start='1d' needs none)")
        end if
        do i = 1, 3
            if (.not. active(i)) cycle
            if (charge%at(i) + half(i) <= case%air%hi(i) .and. &
                (case%run%symmetry(i) .or. charge%at(i) - half(i) >= case%air%lo(i))) cycle
            call add_warning(deck, deck%groups(g)%line, group_label(deck%groups(g))// &
                             'it reaches beyond the air along '//axes(i:i)//'; that part is lost')
        end do
    end subroutine check_charge_size

    !> Charges that overlap: a cell holds the gas of one of them, and the rest is gone.
    subroutine check_overlap(deck, g, case, k)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        integer, intent(in) :: k !! the charge of group g, compared with those before it
        real(dp), parameter :: slack = 1e-6_dp !! relative
        real(dp) :: half(3), other(3), apart(3), dx(3)
        logical :: active(3), overlap
        integer :: j

        active = case%air%cells > 1
        dx = (case%air%hi - case%air%lo)/case%air%cells
        call charge_half_sides(case%charges(k), active, product(dx, mask=.not. active), half)
        do j = 1, k - 1
            call charge_half_sides(case%charges(j), active, product(dx, mask=.not. active), other)
            apart = merge(abs(case%charges(k)%at - case%charges(j)%at), 0.0_dp, active)
            overlap = all(apart < (half + other)*(1 - slack) .or. .not. active)
            if (all(case%charges([j, k])%shape == 'sphere')) &
                overlap = norm2(apart) < minval(half + other, mask=active)*(1 - slack)
            if (.not. overlap) cycle
            if (any(case%charges([j, k])%shape == 'cylinder')) then ! corners may be apart
                call add_warning(deck, deck%groups(g)%line, group_label(deck%groups(g))// &
                                 "the boxes around it and '"//trim(case%charges(j)%id)// &
                                 "' overlap: what lies in both counts once")
            else
                call complain(deck, g, 'at', "it overlaps the charge '"// &
                              trim(case%charges(j)%id)//"', and what lies in both would count "// &
                              'once: move one of them, or give one charge the mass of both')
            end if
        end do
    end subroutine check_overlap

    !> Half the extent of a charge along x, y, z [m]; a prism in two dimensions, a slab in one.
    pure subroutine charge_half_sides(charge, active, depth, half)
        type(charge_case_t), intent(in) :: charge
        logical, intent(in) :: active(3) !! directions that are modelled
        real(dp), intent(in) :: depth !! product of the sides of the air in the others [m, m2]
        real(dp), intent(out) :: half(3)
        real(dp), parameter :: pi = acos(-1.0_dp)
        logical :: round(3)
        real(dp) :: unit

        half = 1
        if (charge%shape == 'cylinder') half(index(axes, charge%axis)) = charge%aspect
        if (charge%shape == 'box') half = charge%sides
        round = active .and. charge%shape /= 'box'
        if (charge%shape == 'cylinder') round(index(axes, charge%axis)) = .false.
        unit = product(2*half, mask=active)
        if (count(round) == 2) unit = unit*pi/4
        if (count(round) == 3) unit = unit*pi/6
        if (count(active) > 0) &
            half = half*(charge%mass/charge%density/(depth*unit))**(1.0_dp/count(active))
    end subroutine charge_half_sides

    !> The upper corner of a box must lie beyond the lower one.
    subroutine check_corners(deck, g, lo, hi)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        real(dp), intent(in) :: lo(3), hi(3)
        integer :: i

        if (.not. is_usable(deck%groups(g), 'box')) return
        do i = 1, 3
            if (hi(i) > lo(i)) cycle
            call complain(deck, g, 'box', 'the box ends at '//axes(i:i)//'='//to_text(hi(i))// &
                          ', which is not beyond its start '//to_text(lo(i))// &
                          '; write x0,x1, y0,y1, z0,z1')
        end do
    end subroutine check_corners

    logical function air_bad(deck)
        type(deck_t), intent(in) :: deck

        air_bad = deck%groups(find_group(deck, 'air'))%bad
    end function air_bad

    pure function air_text(case) result(text)
        type(case_t), intent(in) :: case
        character(:), allocatable :: text

        text = 'which is '//box_text(case%air%lo, case%air%hi)
    end function air_text

    !> 'x 0.0..1.0, y 0.0..1.0, z 0.0..2.0'.
    pure function box_text(lo, hi) result(text)
        real(dp), intent(in) :: lo(3), hi(3)
        character(:), allocatable :: text
        integer :: i

        text = ''
        do i = 1, 3
            if (i > 1) text = text//', '
            text = text//axes(i:i)//' '//to_text(lo(i))//'..'//to_text(hi(i))
        end do
    end function box_text

    !> '(0.0, 0.0, 0.4)'.
    pure function point_text(x) result(text)
        real(dp), intent(in) :: x(3)
        character(:), allocatable :: text

        text = '('//to_text(x(1))//', '//to_text(x(2))//', '//to_text(x(3))//')'
    end function point_text

    !> A number with one decimal.
    pure function cells_text(n) result(text)
        real(dp), intent(in) :: n
        character(:), allocatable :: text
        character(24) :: buffer

        write (buffer, '(f20.1)') min(n, 1e15_dp)
        text = trim(adjustl(buffer))
    end function cells_text
end module brz_check_air
