! SPDX-License-Identifier: MIT
!> Shape and size of a charge: from its mass to its half sides, and what part of a cell it fills.
!>
!> In two dimensions a charge is a prism as deep as the box, in one dimension a slab.
module brz_charge_shape
    use brz_kinds, only: dp
    use brz_case, only: charge_case_t, label
    use brz_errors, only: error_t, exit_deck, raise
    implicit none
    private
    public :: charge_shape_t, make_shape, filled_part

    integer, parameter :: shape_round = 1, shape_cylinder = 2, shape_box = 3
    integer, parameter :: n_sub = 10 !! points per direction inside a cell that the surface cuts

    type :: charge_shape_t
        integer :: kind = shape_round
        integer :: axis = 3 !! of a cylinder
        logical :: active(3) = .true. !! directions that are modelled
        real(dp) :: at(3) = 0 !! centre [m]
        real(dp) :: half(3) = 0 !! half sides or radii; huge where the direction is not modelled [m]
    end type charge_shape_t

contains

    !> Size a charge by its mass and density.
    subroutine make_shape(charge, active, depth, shape, err)
        type(charge_case_t), intent(in) :: charge
        logical, intent(in) :: active(3) !! directions that are modelled
        real(dp), intent(in) :: depth !! product of the sides of the box in the others [m, m2]
        type(charge_shape_t), intent(out) :: shape
        type(error_t), intent(inout) :: err
        real(dp) :: rel(3), size

        shape%at = charge%at
        shape%active = active
        shape%axis = index('xyz', charge%axis)
        rel = 1
        select case (charge%shape)
        case ('sphere')
            shape%kind = shape_round
        case ('cylinder')
            shape%kind = shape_cylinder
            rel(shape%axis) = charge%aspect
        case ('box')
            shape%kind = shape_box
            rel = charge%sides
        case default
            call raise(err, exit_deck, label('charge', charge%id, charge%place)//"unknown shape '" &
                //trim(charge%shape)//"'; use 'sphere', 'cylinder' or 'box'")
            return
        end select
        size = (charge%mass/charge%density/(depth*unit_volume(shape, rel)))**(1.0_dp/count(active))
        shape%half = merge(rel*size, huge(1.0_dp), active)
    end subroutine make_shape

    !> Volume (area, length) of a shape whose half sides are rel.
    pure real(dp) function unit_volume(shape, rel)
        type(charge_shape_t), intent(in) :: shape
        real(dp), intent(in) :: rel(3) !! half sides
        real(dp), parameter :: pi = acos(-1.0_dp)
        logical :: round(3)

        round = round_axes(shape)
        unit_volume = product(merge(2*rel, 1.0_dp, shape%active))
        if (count(round) == 2) unit_volume = unit_volume*pi/4
        if (count(round) == 3) unit_volume = unit_volume*pi/6
    end function unit_volume

    !> Axes in which the section is a circle or a ball.
    pure function round_axes(shape) result(round)
        type(charge_shape_t), intent(in) :: shape
        logical :: round(3)

        round = shape%active .and. shape%kind /= shape_box
        if (shape%kind == shape_cylinder) round(shape%axis) = .false.
    end function round_axes

    !> Part of a cell that the shape fills, by points inside it; 0 or 1 away from the surface.
    pure real(dp) function filled_part(shape, centre, side)
        type(charge_shape_t), intent(in) :: shape
        real(dp), intent(in) :: centre(3) !! of the cell [m]
        real(dp), intent(in) :: side(3) !! of the cell [m]
        real(dp) :: near(3), far(3), x(3)
        integer :: m(3), i, j, k, hits

        near = max(abs(centre - shape%at) - side/2, 0.0_dp)
        far = abs(centre - shape%at) + side/2
        filled_part = 0
        if (.not. inside(shape, near)) return
        filled_part = 1
        if (inside(shape, far)) return
        m = merge(n_sub, 1, shape%active)
        hits = 0
        do k = 1, m(3)
            do j = 1, m(2)
                do i = 1, m(1)
                    x = centre - shape%at + side*((2*[i, j, k] - 1)/(2.0_dp*m) - 0.5_dp)
                    if (inside(shape, abs(x))) hits = hits + 1
                end do
            end do
        end do
        filled_part = hits/real(product(m), dp)
    end function filled_part

    !> True for a point in the shape, given by its distances from the centre along the axes.
    pure logical function inside(shape, x)
        type(charge_shape_t), intent(in) :: shape
        real(dp), intent(in) :: x(3) !! distances from the centre [m]
        logical :: round(3)

        round = round_axes(shape)
        inside = all(round .or. .not. shape%active .or. x <= shape%half)
        if (inside) inside = sum((x/shape%half)**2, mask=round) <= 1
    end function inside
end module brz_charge_shape
