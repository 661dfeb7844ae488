! SPDX-License-Identifier: MIT
!> Cohesive interfaces at the present places, a point or a node at a time: openings, damage, forces
!> on the particles.
!>
!> A point that is broken keeps pressing until none of the particles that it sees is held by its
!> interface any more: these then meet by contact. Forces are gathered in the order of `back`.
!>
!> Of several processes each computes the points that see one of its particles. All others of such
!> a point are particles or ghosts there, so all that compute it do so from the same numbers.
module brz_cohesive_loop_bodies
    use brz_bond_marks, only: loose_by
    use brz_cohesive_law, only: has_damage, has_held, has_spent, load_point
    use brz_cohesive_numbers, only: cohesive_law_t
    use brz_kinds, only: dp, int32, int64, rk
    use brz_link_layout, only: mask_unit
    use brz_particle_marks, only: is_gone
    implicit none
    private
    public :: place_node, open_point, join_node, gather_node, add_pull
    public :: own_node, see_point, mark_glued

    integer, parameter :: bits = 30 !! processes of which each has one of its own

contains

    !> Where the particles of the nodes lie.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine place_node(p, first, id, row, place_of)
        integer, intent(in) :: p !! particles and ghosts of a body
        integer, intent(in) :: first !! the first of them
        integer(int32), intent(in) :: id(*), row(*) !! row: node of the particle of a number, or 0
        integer(int32), intent(inout) :: place_of(*)
        integer :: i

        i = first - 1 + p
        if (row(id(i)) > 0) place_of(row(id(i))) = i
    end subroutine place_node

    !> This process has the particles of a body.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine own_node(p, first, own, id, row, owner)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: own !! number of this process, from 1
        integer(int32), intent(in) :: id(*), row(*) !! row: node of the particle of a number, or 0
        integer(int32), intent(inout) :: owner(*)
        integer :: r

        r = row(id(first - 1 + p))
        if (r > 0) owner(r) = own
    end subroutine own_node

    !> Which processes have particles of a point, and whether this one does.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine see_point(p, own, first, entry, owner, seen_by, mine)
        integer, intent(in) :: p !! points
        integer, intent(in) :: own !! number of this process, from 1
        integer(int32), intent(in) :: first(*), entry(*), owner(*)
        integer(int32), intent(inout) :: seen_by(*), mine(*)
        integer :: e, r

        seen_by(p) = 0
        mine(p) = 0
        do e = first(p), first(p + 1) - 1
            r = owner(iand(entry(e), mask_unit - 1))
            seen_by(p) = ibset(seen_by(p), bit_of(r))
            if (r == own) mine(p) = 1
        end do
    end subroutine see_point

    !> Bit of a process in `seen_by`; of very many several share one, and get more ghosts than they
    !> need.
    !@cuf attributes(host,device) &
    pure integer function bit_of(r)
        integer, intent(in) :: r !! from 1

        bit_of = modulo(r - 1, bits)
    end function bit_of

    !> Mark a particle that a process needs as a ghost for points that it computes.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine mark_glued(p, first, places, process, id, row, back_first, back, seen_by, &
                               sent, mark)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: places !! marks of a process
        integer, intent(in) :: process !! from 0
        integer(int32), intent(in) :: id(*), row(*), back_first(*), back(2, *), seen_by(*)
        integer(int32), intent(inout) :: sent(*) !! 1: marked before
        integer(int32), intent(inout) :: mark(*)
        integer(int64) :: at
        integer :: i, k, r

        i = first - 1 + p
        r = row(id(i))
        at = i + process*int(places, int64)
        if (r == 0 .or. sent(at) == 1) return
        do k = back_first(r), back_first(r + 1) - 1
            if (.not. btest(seen_by(back(2, k)), bit_of(process + 1))) cycle
            mark(at) = 1
            sent(at) = 1
            return
        end do
    end subroutine mark_glued

    !> State and forces of a point.
    !@loop_body if(n >= worth_threads/4) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine open_point(p, wide, mine, law, bit, of, first, entry, weight, area, gap, &
                               rest, place_of, x, fixed, joined, damage, spent, held, pull)
        integer, intent(in) :: p !! points
        integer, intent(in) :: wide !! rows of x
        integer(int32), intent(in) :: mine(*) !! 1: this process computes it
        type(cohesive_law_t), intent(in) :: law(*)
        integer(int32), intent(in) :: bit(*), of(*), first(*), entry(*)
        real(dp), intent(in) :: weight(3, *), area(*), gap(*), rest(3, 2, *)
        integer(int32), intent(in) :: place_of(*)
        real(dp), intent(in) :: x(wide, *)
        integer(int32), intent(in) :: fixed(*), joined(*)
        real(dp), intent(inout) :: damage(*), spent(*), held(*)
        real(dp), intent(inout) :: pull(3, 3, *)
        real(dp) :: seen(3, 3), f(3, 3), own(3), y, kept
        logical :: released
        integer :: c, e, i, t

        if (mine(p) == 0) return
        released = .false.
        if (damage(p) >= 1) released = is_released(first(p), first(p + 1) - 1, bit(of(p)), &
                                                      entry, place_of, fixed, joined)
        kept = held(p)
        if (released .and. .not. kept > 0) then
            do c = 1, 3
                do t = 1, 3
                    pull(t, c, p) = 0
                end do
            end do
            return
        end if
        do t = 1, 3
            seen(t, 1) = 0
            seen(t, 2) = rest(t, 1, p)
            seen(t, 3) = rest(t, 2, p)
        end do
        do e = first(p), first(p + 1) - 1
            i = place_of(iand(entry(e), mask_unit - 1))
            do t = 1, 3
                y = x(t, i)
                if (btest(entry(e), 27 + t)) y = -y
                do c = 1, 3
                    seen(t, c) = seen(t, c) + weight(c, e)*y
                end do
            end do
        end do
        own(has_damage) = damage(p)
        own(has_spent) = spent(p)
        own(has_held) = held(p)
        call load_point(law(of(p)), area(p), gap(p), seen, own, f)
        if (released) then
            ! K d^2/2 of the step before and the work of half of K d in this step: K d d'/2
            own(has_spent) = own(has_spent) + sqrt(kept*own(has_held))
            own(has_held) = 0
            do c = 1, 3
                do t = 1, 3
                    f(t, c) = 0
                end do
            end do
        end if
        damage(p) = own(has_damage)
        spent(p) = own(has_spent)
        held(p) = own(has_held)
        do c = 1, 3
            do t = 1, 3
                pull(t, c, p) = f(t, c)
            end do
        end do
    end subroutine open_point

    !> True where none of the particles of a broken point is held by its interface any more, or one
    !> of them is gone.
    !@cuf attributes(host,device) &
    pure function is_released(first, last, bit, entry, place_of, fixed, joined) result(yes)
        integer, intent(in) :: first, last !! entries of the point
        integer(int32), intent(in) :: bit, entry(*), place_of(*), fixed(*), joined(*)
        logical :: yes
        integer :: e, i

        yes = .true.
        do e = first, last
            i = place_of(iand(entry(e), mask_unit - 1))
            if (fixed(i) == is_gone) then
                yes = .true.
                return
            end if
            if (iand(joined(i), bit) /= 0) yes = .false.
        end do
    end function is_released

    !> Which interfaces still hold the particle of a node, and which let go of it in this step.
    !@loop_body if(n >= worth_threads/4) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine join_node(r, bit, of, back_first, back, damage, place_of, joined)
        integer, intent(in) :: r !! nodes
        integer(int32), intent(in) :: bit(*), of(*), back_first(*), back(2, *)
        real(dp), intent(in) :: damage(*)
        integer(int32), intent(in) :: place_of(*)
        integer(int32), intent(inout) :: joined(*)
        integer(int32) :: held_by, before
        integer :: k

        if (place_of(r) == 0) return
        held_by = 0
        do k = back_first(r), back_first(r + 1) - 1
            if (damage(back(2, k)) < 1) held_by = ior(held_by, bit(of(back(2, k))))
        end do
        before = iand(joined(place_of(r)), ibset(0_int32, loose_by) - 1)
        joined(place_of(r)) = ior(held_by, ishft(iand(before, not(held_by)), loose_by))
    end subroutine join_node

    !> Force on the particle of a node.
    !@loop_body if(n >= worth_threads/4) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine gather_node(r, place_of, back_first, back, entry, weight, pull, push)
        integer, intent(in) :: r !! nodes
        integer(int32), intent(in) :: place_of(*), back_first(*), back(2, *), entry(*)
        real(dp), intent(in) :: weight(3, *), pull(3, 3, *)
        real(dp), intent(inout) :: push(3, *) !! [N]
        real(dp) :: total(3), f
        integer :: c, e, k, t

        if (place_of(r) == 0) return
        do t = 1, 3
            total(t) = 0
        end do
        do k = back_first(r), back_first(r + 1) - 1
            e = back(1, k)
            do t = 1, 3
                f = 0
                do c = 1, 3
                    f = f + pull(t, c, back(2, k))*weight(c, e)
                end do
                if (btest(entry(e), 27 + t)) f = -f
                total(t) = total(t) + f
            end do
        end do
        do t = 1, 3
            push(t, r) = total(t)
        end do
    end subroutine gather_node

    !> Add the force on a node to those on its particle.
    !@loop_body if(n >= worth_threads/4) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine add_pull(r, particles, place_of, push, force)
        integer, intent(in) :: r !! nodes
        integer, intent(in) :: particles
        integer(int32), intent(in) :: place_of(*)
        real(dp), intent(in) :: push(3, *) !! [N]
        real(rk), intent(inout) :: force(particles, *) !! its first three columns [N]
        integer :: t

        if (place_of(r) == 0) return
        do t = 1, 3
            force(place_of(r), t) = force(place_of(r), t) + real(push(t, r), rk)
        end do
    end subroutine add_pull
end module brz_cohesive_loop_bodies
