! SPDX-License-Identifier: MIT
!> Traction-separation law of a cohesive zone: traction over opening, bilinear, one damage for all
!> modes. Point physics, in real64 at any precision: there are few points, and their damage comes
!> close to 1.
!>
!> Up to the onset an opening `d` has the traction `K d`. The onset is that of the quadratic
!> criterion; from there the traction falls on a straight line to zero, so that the work per area is
!> the fracture energy of the present mode, by Benzeggagh and Kenane or by a power law. Damage
!> never falls, and unloading goes straight back to the origin. Pressure does no damage and always
!> meets the full stiffness.
!>
!> Source: Camanho and Davila, NASA/TM-2002-211737; docs/theory/cohesive.md
module brz_cohesive_law
    use brz_cohesive_numbers, only: cohesive_law_t, mixed_bk
    use brz_kinds, only: dp
    implicit none
    private
    public :: load_point, separate, mode_of, slide_range
    public :: has_damage, has_spent, has_held

    ! the state of a point: damage 0..1, energy of the damage so far, energy that comes back [J]
    integer, parameter :: has_damage = 1, has_spent = 2, has_held = 3

contains

    !> Openings, stretched, at which the traction of a mode begins to fall and has fallen to zero.
    !@cuf attributes(host,device) &
    pure subroutine mode_of(law, share, along, first, last)
        type(cohesive_law_t), intent(in) :: law
        real(dp), intent(in) :: share !! of shear in the square of the stretched opening, 0..1
        real(dp), intent(in) :: along !! by how much its shear is stretched, law%stretch(2) or so
        real(dp), intent(out) :: first, last !! [m]
        real(dp) :: energy, open

        open = 1 - share
        if (law%mixed == mixed_bk) then
            energy = law%energy(1) + (law%energy(2) - law%energy(1))*share**law%exponent
        else
            energy = ((open/law%energy(1))**law%exponent &
                      + (share/law%energy(2))**law%exponent)**(-1/law%exponent)
        end if
        first = 1/(law%stiffness*sqrt(open*(law%stretch(1)/law%strength(1))**2 &
                                      + share*(along/law%strength(2))**2))
        last = max(2*energy/(law%stiffness*first), (1 + 1e-9_dp)*first)
    end subroutine mode_of

    !> State and forces of a point, from what it sees of the particles.
    !@cuf attributes(host,device) &
    pure subroutine load_point(law, area, gap, seen, state, pull)
        type(cohesive_law_t), intent(in) :: law
        real(dp), intent(in) :: area !! [m2]
        real(dp), intent(in) :: gap !! unloaded distance of what is seen of both sides [m]
        real(dp), intent(in) :: seen(3, 3) !! the far side from the near one [m]; two tangents
        real(dp), intent(inout) :: state(3) !! slots has_damage, ...
        real(dp), intent(out) :: pull(3, 3) !! by unit weight; 1: [N], 2, 3: [N m]
        real(dp) :: opening(3), normal(3), tangent(3), traction(3), held, size, spent
        integer :: c

        normal(1) = seen(2, 2)*seen(3, 3) - seen(3, 2)*seen(2, 3)
        normal(2) = seen(3, 2)*seen(1, 3) - seen(1, 2)*seen(3, 3)
        normal(3) = seen(1, 2)*seen(2, 3) - seen(2, 2)*seen(1, 3)
        size = sqrt(normal(1)*normal(1) + normal(2)*normal(2) + normal(3)*normal(3))
        do c = 1, 3
            normal(c) = normal(c)/max(size, tiny(1.0_dp))
            opening(c) = seen(c, 1) - gap*normal(c)
        end do
        spent = 0
        tangent(1) = seen(1, 2)
        tangent(2) = seen(2, 2)
        tangent(3) = seen(3, 2)
        call separate(law, opening, normal, tangent, state(has_damage), spent, traction, held)
        state(has_spent) = state(has_spent) + area*spent
        state(has_held) = area*held
        do c = 1, 3
            pull(c, 1) = -area*traction(c)
            pull(c, 2) = 0
            pull(c, 3) = 0
        end do
        call turn(area, seen, traction, normal, pull)
    end subroutine load_point

    !> Forces by which the traction turns the sides: the normal turns with the tangents, and what
    !> lies between the sides with it. With z = seen(:, 1) they have the moment z x traction.
    !@cuf attributes(host,device) &
    pure subroutine turn(area, seen, traction, normal, pull)
        real(dp), intent(in) :: area !! [m2]
        real(dp), intent(in) :: seen(3, 3), traction(3), normal(3)
        real(dp), intent(inout) :: pull(3, 3)
        real(dp) :: g11, g12, g22, p1, p2, det, apart, push, w
        integer :: c

        g11 = 0
        g12 = 0
        g22 = 0
        p1 = 0
        p2 = 0
        apart = seen(1, 1)*normal(1) + seen(2, 1)*normal(2) + seen(3, 1)*normal(3)
        push = traction(1)*normal(1) + traction(2)*normal(2) + traction(3)*normal(3)
        do c = 1, 3
            w = apart*traction(c) - push*seen(c, 1)
            g11 = g11 + seen(c, 2)*seen(c, 2)
            g12 = g12 + seen(c, 2)*seen(c, 3)
            g22 = g22 + seen(c, 3)*seen(c, 3)
            p1 = p1 + w*seen(c, 2)
            p2 = p2 + w*seen(c, 3)
        end do
        det = max(g11*g22 - g12*g12, tiny(1.0_dp))
        do c = 1, 3
            pull(c, 2) = -area*(g22*p1 - g12*p2)/det*normal(c)
            pull(c, 3) = -area*(g11*p2 - g12*p1)/det*normal(c)
        end do
    end subroutine turn

    !> Traction of an opening, and what the interface holds and has spent.
    !@cuf attributes(host,device) &
    pure subroutine separate(law, opening, normal, tangent, damage, spent, traction, held)
        type(cohesive_law_t), intent(in) :: law
        real(dp), intent(in) :: opening(3) !! of the far side from the near one [m]
        real(dp), intent(in) :: normal(3) !! unit vector from the near to the far side
        real(dp), intent(in) :: tangent(3) !! the first one, at a right angle to the normal
        real(dp), intent(inout) :: damage !! 0..1; never falls
        real(dp), intent(inout) :: spent !! energy of damage so far [J/m2]
        real(dp), intent(out) :: traction(3) !! on the near side [Pa]
        real(dp), intent(out) :: held !! energy that comes back [J/m2]
        real(dp) :: across, apart, slide(3), pull(3), pull2, shear2, size2, first, last, from, &
            to, left

        across = opening(1)*normal(1) + opening(2)*normal(2) + opening(3)*normal(3)
        slide = opening - across*normal
        call stretch_slide(law, normal, tangent, slide)
        pull = slide
        call stretch_slide(law, normal, tangent, pull)
        across = law%stretch(1)*across
        shear2 = slide(1)*slide(1) + slide(2)*slide(2) + slide(3)*slide(3)
        pull2 = pull(1)*pull(1) + pull(2)*pull(2) + pull(3)*pull(3)
        apart = max(across, 0.0_dp)
        size2 = apart*apart + shear2
        if (size2 > 0 .and. damage < 1) then
            call mode_of(law, shear2/size2, sqrt(pull2/max(shear2, tiny(1.0_dp))), first, last)
            from = first*last/(first + (1 - damage)*(last - first))
            to = min(sqrt(size2), last)
            if (to > from) then ! K d^2/2 dD is linear in d
                spent = spent + law%stiffness*first*last/(2*(last - first))*(to - from)
                damage = max(damage, min(last*(to - first)/(to*(last - first)), 1.0_dp))
                if (to >= last) damage = 1
            end if
        end if
        left = (1 - damage)*law%stiffness
        traction = (left*apart + law%stiffness*min(across, 0.0_dp))*law%stretch(1)*normal &
                   + left*pull
        held = (left*size2 + law%stiffness*min(across, 0.0_dp)**2)/2
    end subroutine separate

    !> Stretch what lies along the interface: differently along and across the fibres of plies.
    !@cuf attributes(host,device) &
    pure subroutine stretch_slide(law, normal, tangent, slide)
        type(cohesive_law_t), intent(in) :: law
        real(dp), intent(in) :: normal(3), tangent(3) !! see separate
        real(dp), intent(inout) :: slide(3) !! at a right angle to the normal [m]
        real(dp) :: t(3), u(3), p, q, size
        integer :: c

        size = max(sqrt(tangent(1)*tangent(1) + tangent(2)*tangent(2) + tangent(3)*tangent(3)), &
                   tiny(1.0_dp))
        do c = 1, 3
            t(c) = tangent(c)/size
        end do
        u(1) = normal(2)*t(3) - normal(3)*t(2)
        u(2) = normal(3)*t(1) - normal(1)*t(3)
        u(3) = normal(1)*t(2) - normal(2)*t(1)
        p = slide(1)*t(1) + slide(2)*t(2) + slide(3)*t(3)
        q = slide(1)*u(1) + slide(2)*u(2) + slide(3)*u(3)
        do c = 1, 3
            slide(c) = law%stretch(2)*slide(c) + (law%skew(1)*p + law%skew(2)*q)*t(c) &
                       + (law%skew(2)*p - law%skew(1)*q)*u(c)
        end do
    end subroutine stretch_slide

    !> The least and the largest stretch along the interface.
    pure function slide_range(law) result(range)
        type(cohesive_law_t), intent(in) :: law
        real(dp) :: range(2)

        range = law%stretch(2) + norm2(law%skew)*[-1, 1]
    end function slide_range
end module brz_cohesive_law
