! SPDX-License-Identifier: MIT
!> Plates and bars: thin bodies that bend, and yield or crack.
!>
!> Sums of thin bodies miss the bending stiffness of each layer about its own middle, 1/n^2 of that
!> of n layers, and the outermost layers see the strain of a place a quarter of a spacing deeper.
!> With tilted gradients (brz_one_sided_arm) they see that of a place a little further out instead:
!> then the stress alone has the bending stiffness of the whole section, and yields by its law.
!>
!> Source: docs/theory/plates.md
module brz_plate
    use brz_body, only: body_t
    use brz_body_shape, only: axis_of, shape_t, whole_sides
    use brz_case, only: body_case_t, label
    use brz_errors, only: error_t, exit_deck, raise
    use brz_formulation, only: fast
    use brz_formulation_names, only: form_bending, form_total
    use brz_kinds, only: dp, rk
    use brz_one_sided_arm, only: face_lift
    implicit none
    private
    public :: settle_plate

    integer, parameter :: least_layers = 3 !! within, one that damps waves of two spacings
    integer, parameter :: most_layers = 12 !! a thicker one lacks less than a hundredth
    real(dp), parameter :: flat = 1/3.0_dp !! thickness over every other side, at most
    !> How much further out the outermost layers see the strain, over the spacing of the layers.
    !> Exact for n layers is sqrt((n - 1)^2/4 + n/24) - (n - 1)/2, 0.061 to 0.050 for n = 3 to 6;
    !> so the stiffness is right within 1.1 % from three on.
    real(dp), parameter :: further_out = 0.055_dp
    real(dp), parameter :: tilt_unit = 1e-3_dp !! of the tilts of a bar, over the spacing

contains

    !> Normal of a body that is a plate, or the directions across a bar, and how its faces see the
    !> strain.
    subroutine settle_plate(input, speed, shape, body, err)
        type(body_case_t), intent(in) :: input
        real(dp), intent(in) :: speed !! largest of two bodies towards each other [m/s]
        type(shape_t), intent(in) :: shape
        type(body_t), intent(inout) :: body
        type(error_t), intent(inout) :: err

        if (input%layered) then
            call settle_wall(input, speed, shape, body, err)
        else
            call settle_flat(input, speed, shape, body, err)
        end if
        if (body%formulation == form_bending) return
        if (count(body%normal > 0) == 1 .or. body%curved) body%lift = &
            face_lift(shape%dimension, real(body%h/body%spacing, rk), &
                      real(body%outward/body%spacing, rk))
    end subroutine settle_plate

    !> Boxes and discs.
    subroutine settle_flat(input, speed, shape, body, err)
        type(body_case_t), intent(in) :: input
        real(dp), intent(in) :: speed !! see settle_plate
        type(shape_t), intent(in) :: shape
        type(body_t), intent(inout) :: body
        type(error_t), intent(inout) :: err
        integer :: a, along
        logical :: bends

        along = 0
        bends = body%tensile_control > 0 .or. body%formulation == form_total
        a = index('xyz', trim(input%plate_axis))
        if (a > 0) then
            if (a > shape%dimension .or. .not. bends) then
                call raise(err, exit_deck, label('body', input%id, input%place)// &
                           'plate_axis names a direction that is modelled, in a body with '// &
                           "formulation='corrected_hourglass' and a tensile_control, or in "// &
                           "'total_lagrangian'; leave it out")
                return
            end if
        else if (input%plate_axis == 'auto') then
            if (body%tensile_control > 0 .and. speed <= fast) then
                a = thin_axis(input, shape)
                along = bar_axis(input, shape)
            end if
            if (body%formulation == form_total .and. body%directional .and. &
                .not. any(body%normal > 0)) a = thin_axis(input, shape)
        end if
        if (a == 0 .and. along > 0) then
            body%normal = real(tilt_unit/maxval(shape%spacing), rk)
            body%normal(along) = 0
            body%outward = real(further_out*sum(shape%spacing, body%normal > 0)/2, rk)
        end if
        if (a == 0) return
        body%normal(a) = 1
        body%outward = real(further_out*shape%spacing(a)*body%stretch(a), rk)
    end subroutine settle_flat

    !> A wall round an axis: radial normals.
    subroutine settle_wall(input, speed, shape, body, err)
        type(body_case_t), intent(in) :: input
        real(dp), intent(in) :: speed !! see settle_plate
        type(shape_t), intent(in) :: shape
        type(body_t), intent(inout) :: body
        type(error_t), intent(inout) :: err
        integer :: a

        if (.not. body%tensile_control > 0) call raise(err, exit_deck, &
            label('body', input%id, input%place)//"lattice='layered' is for bodies in "// &
            "formulation='corrected_hourglass' with a tensile_control, whose faces have tilted "// &
            'gradients; leave it out')
        if (input%plate_axis == 'none' .or. speed > fast) return
        a = mod(axis_of(input), 3) + 1
        body%curved = .true.
        body%normal = 1
        body%normal(axis_of(input)) = 0
        body%outward = real(further_out*shape%spacing(a), rk)
    end subroutine settle_wall

    !> Direction of a bar with square edges, thin in both others: a box, or `bars`; 0: it is none.
    pure integer function bar_axis(input, shape) result(along)
        type(body_case_t), intent(in) :: input
        type(shape_t), intent(in) :: shape
        real(dp) :: side(3)
        integer :: a, layers

        along = 0
        if (shape%dimension < 3 .or. all(input%shape /= ['box ', 'bars'])) return
        side = whole_sides(shape)
        along = maxloc(side, dim=1)
        if (input%shape == 'bars') then
            along = index('xyz', input%axis)
            side(modulo([along, along + 1], 3) + 1) = input%diameter
        end if
        do a = 1, 3
            if (a == along) cycle
            layers = nint(side(a)/shape%spacing(a))
            if (side(a) > (1 + 1e-9_dp)*flat*side(along) .or. layers < least_layers .or. &
                layers > most_layers) along = 0
            if (along == 0) return
        end do
    end function bar_axis

    !> Direction in which a box or a disc is thin; 0 where it is no plate. With a hole the side of a
    !> disc is its width from hole to edge: a narrow ring, or a tube, is none.
    pure integer function thin_axis(input, shape) result(thin)
        type(body_case_t), intent(in) :: input
        type(shape_t), intent(in) :: shape
        real(dp) :: side(3)
        integer :: a

        thin = 0
        if (shape%dimension == 1) return
        if (input%shape /= 'box' .and. input%shape /= 'cylinder') return
        side = whole_sides(shape)
        if (input%inner_radius > 0) then
            do a = 1, shape%dimension
                if (a /= axis_of(input)) side(a) = input%radius - input%inner_radius
            end do
        end if
        thin = minloc(side(:shape%dimension), dim=1)
        do a = 1, shape%dimension
            if (a /= thin .and. side(thin) > (1 + 1e-9_dp)*flat*side(a)) thin = 0
            if (thin == 0) return
        end do
        a = nint(side(thin)/shape%spacing(thin))
        if (a < least_layers .or. a > most_layers) thin = 0
    end function thin_axis
end module brz_plate
