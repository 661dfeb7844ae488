! SPDX-License-Identifier: MIT
!> Problems of whole bodies: rings that collide.
module solid_bodies
    use brz_body_setup, only: set_up_solid
    use brz_case, only: body_case_t, interaction_case_t
    use brz_errors, only: failed
    use brz_kinds, only: dp, rk
    use brz_solid_state, only: solid_t
    use brz_solid_totals, only: solid_totals, solid_totals_t
    use solid_scenes, only: advance, begin, choose, finish, form_t, metal, scene_t, seen_t
    implicit none
    private
    public :: rings_t, rings, pieces

    real(dp), parameter :: pi = acos(-1.0_dp)

    type :: rings_t
        integer :: pieces = 0
        real(dp) :: rebound = 0 !! velocity of the centre of the ring after over that before
        real(dp) :: momentum = 0 !! change over that of one ring
        real(dp) :: energy = 0 !! error of the total over the energy at the start
        real(dp) :: apart = 0 !! least distance of the rings at the end, in spacings
    end type rings_t

contains

    !> Two rubber rings of radii 3 and 4 (Gray, Monaghan & Swift 2001: G/K = 0.22) that meet, each
    !> with `speed` over the bulk sound speed; the halves above their axis, until they have parted.
    subroutine rings(form, speed, across, found, seen)
        type(form_t), intent(in) :: form
        real(dp), intent(in) :: speed
        integer, intent(in) :: across !! particles across a ring
        type(rings_t), intent(out) :: found
        type(seen_t), intent(out) :: seen
        type(scene_t) :: s
        type(solid_totals_t) :: t0, t1, left
        integer :: b

        call metal(s%case, 'linear_elastic', [character(24) :: 'density', 'bulk_modulus', &
                                              'shear_modulus'], [1.0_dp, 1.0_dp, 0.22_dp])
        s%case%run%dimension = 2
        s%case%run%symmetry(2) = .true.
        deallocate (s%case%bodies)
        allocate (s%case%bodies(2), s%case%interactions(0))
        do b = 1, 2
            associate (body => s%case%bodies(b))
                body%id = achar(iachar('a') + b - 1)
                body%material_index = 1
                body%shape = 'cylinder'
                body%centre = [real(8*b - 12, dp) + 0.5_dp*(2*b - 3), 0.0_dp, 0.5_dp]
                body%radius = 4
                body%inner_radius = 3
                body%length = 1
                body%spacing = 1.0_dp/across
                body%velocity(1) = -(2*b - 3)*speed
            end associate
        end do
        call choose(s%case, form)
        call set_up_solid(s%case, s%solid, s%err)
        call begin(s)
        call solid_totals(s%solid, 0, t0)
        call solid_totals(s%solid, 1, left)
        call advance(s, 0.5_dp/speed + 160)
        call finish(s, seen)
        call solid_totals(s%solid, 0, t1)
        found%momentum = norm2(t1%momentum(1:1) - t0%momentum(1:1))/abs(left%momentum(1))
        found%rebound = -left%momentum(1)
        call solid_totals(s%solid, 1, left)
        found%rebound = left%momentum(1)/found%rebound
        found%energy = seen%energy
        found%pieces = pieces(s%solid, 1.6_dp)
        found%apart = across*(minval(s%solid%x(1, :), mask=owner(s%solid) == 2) &
                              - maxval(s%solid%x(1, :), mask=owner(s%solid) == 1))
    end subroutine rings

    !> Body of each particle.
    pure function owner(solid) result(body)
        type(solid_t), intent(in) :: solid
        integer :: body(solid%n), b

        do b = 1, size(solid%bodies)
            body(solid%bodies(b)%first:solid%bodies(b)%last) = b
        end do
    end function owner

    !> Heaps of particles of one body that hang together by distances below `reach` spacings.
    integer function pieces(solid, reach) result(n)
        type(solid_t), intent(in) :: solid
        real(dp), intent(in) :: reach
        integer :: heap(solid%n), queue(solid%n), b, i, j, head, tail

        n = 0
        heap = 0
        do b = 1, size(solid%bodies)
            do i = solid%bodies(b)%first, solid%bodies(b)%last
                if (heap(i) > 0) cycle
                n = n + 1
                heap(i) = n
                queue(1) = i
                head = 1
                tail = 1
                do while (head <= tail)
                    do j = solid%bodies(b)%first, solid%bodies(b)%last
                        if (heap(j) > 0) cycle
                        if (norm2(solid%x(:, j) - solid%x(:, queue(head))) &
                            > reach*solid%bodies(b)%spacing) cycle
                        heap(j) = n
                        tail = tail + 1
                        queue(tail) = j
                    end do
                    head = head + 1
                end do
            end do
        end do
    end function pieces
end module solid_bodies
