! SPDX-License-Identifier: MIT
!> The owner rank of a particle, and which other processes need it as a ghost.
module brz_owner_loop_bodies
    use brz_kinds, only: dp, int32, int64
    use brz_particle_marks, only: is_gone
    use brz_want_rows, only: n_want, want_corners, want_reach
    implicit none
    private
    public :: owner_of, near_region, mark_owner, mark_near, note_outside, put_away

    real(dp), parameter :: nothing = 1e-30_dp, nowhere = 1e15_dp !! [m]

contains

    !> The region in which a place is, from 0; the last one for what is no place.
    !@cuf attributes(host,device) &
    pure integer function owner_of(n, region, x) result(r)
        integer, intent(in) :: n !! regions
        real(dp), intent(in) :: region(3, 2, *) !! corners [m]
        real(dp), intent(in) :: x(3) !! [m]
        integer :: a
        logical :: inside

        do r = 0, n - 2
            inside = .true.
            do a = 1, 3
                inside = inside .and. x(a) >= region(a, 1, r + 1) .and. x(a) < region(a, 2, r + 1)
            end do
            if (inside) return
        end do
        r = n - 1
    end function owner_of

    !> True where a place or one of its images is within reach of a region. Rounding must not hide
    !> a link, whose drifts are added elsewhere.
    !@cuf attributes(host,device) &
    pure logical function near_region(planes, region, reach, x) result(near)
        integer, intent(in) :: planes !! of symmetry, bits 0..2
        real(dp), intent(in) :: region(3, 2) !! corners [m]
        real(dp), intent(in) :: reach, x(3) !! [m]
        real(dp) :: d, d2, y
        integer :: a, m

        near = .false.
        do m = 0, 7
            if (iand(m, planes) /= m) cycle
            d2 = 0
            do a = 1, 3
                y = x(a)
                if (btest(m, a - 1)) y = -y
                d = max(region(a, 1) - y, y - region(a, 2), 0.0_dp)
                d2 = d2 + d*d
            end do
            near = d2 < reach*reach*(1 + 1e-9_dp)
            if (near) return
        end do
    end function near_region

    !> Mark a particle for the process that it belongs to, unless that is this one.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine mark_owner(p, first, wide, row, processes, own, region, home, mark)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: wide !! rows of the places
        integer, intent(in) :: row !! marks of a process
        integer, intent(in) :: processes, own !! how many, this one from 0
        real(dp), intent(in) :: region(3, 2, *) !! corners [m]
        real(dp), intent(in) :: home(wide, *) !! places [m]
        integer(int32), intent(inout) :: mark(*)
        integer :: i, r

        i = first - 1 + p
        r = owner_of(processes, region, home(1:3, i))
        if (r /= own) mark(i + r*int(row, int64)) = 1
    end subroutine mark_owner

    !> Mark a particle for the processes that need it as a ghost.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine mark_near(p, first, wide, row, processes, own, anew, planes, lists, wants, &
                              want, home, built, fixed, sent, mark)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: wide !! rows of the places
        integer, intent(in) :: row !! marks of a process
        integer, intent(in) :: processes, own !! how many, this one from 0
        integer, intent(in) :: anew !! 1: whether it was marked before or not
        integer, intent(in) :: planes !! of symmetry, bits 0..2
        integer, intent(in) :: lists, wants !! ways to be needed: by homes; all
        real(dp), intent(in) :: want(n_want, wants, *) !! of all processes
        real(dp), intent(in) :: home(wide, *), built(wide, *) !! places [m]
        integer(int32), intent(in) :: fixed(*)
        integer(int32), intent(inout) :: sent(*) !! 1: marked before
        integer(int32), intent(inout) :: mark(*)
        real(dp) :: x(3)
        integer :: c, i, k, r
        integer(int64) :: at

        i = first - 1 + p
        do r = 1, processes
            if (r == own + 1) cycle
            at = i + (r - 1)*int(row, int64)
            if (anew == 1) sent(at) = 0
            if (fixed(i) == is_gone .or. sent(at) == 1) cycle
            do k = 1, wants
                do c = 1, 3
                    x(c) = want(c, k, r)
                    if (k <= lists) x(c) = x(c) + home(c, i)
                    if (k > lists) x(c) = x(c) + built(c, i)
                end do
                if (.not. near_region(planes, want(want_corners, k, r), want(want_reach, k, r), &
                                      x)) cycle
                mark(at) = 1
                sent(at) = 1
                exit
            end do
        end do
    end subroutine mark_near

    !> Note whether a particle is outside the region of its process, and by more than it may.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine note_outside(p, first, wide, own, most, region, built, far)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: wide !! rows of the places
        integer, intent(in) :: own !! process, from 0
        real(dp), intent(in) :: most !! what it may be outside [m]
        real(dp), intent(in) :: region(3, 2, *) !! of all processes: corners [m]
        real(dp), intent(in) :: built(wide, *) !! places [m]
        integer(int32), intent(inout) :: far(2) !! 1: some are; by more
        integer :: i

        i = first - 1 + p
        if (near_region(0, region(1, 1, own + 1), nothing, built(1:3, i))) return
        far(1) = 1
        if (.not. near_region(0, region(1, 1, own + 1), most, built(1:3, i))) far(2) = 1
    end subroutine note_outside

    !> Bring what is no particle far away, where old links find nothing.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine put_away(p, first, wide, x)
        integer, intent(in) :: p !! places
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: wide !! rows of the places
        real(dp), intent(inout) :: x(wide, *) !! [m]
        integer :: c

        do c = 1, 3
            x(c, first - 1 + p) = nowhere
        end do
    end subroutine put_away
end module brz_owner_loop_bodies
