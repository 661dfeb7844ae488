! SPDX-License-Identifier: MIT
!> Allocation of the arrays of the particles, for a fresh start and for a restart alike.
module brz_solid_arrays
    use brz_body, only: body_t
    use brz_face_layout, only: n_face
    use brz_kinds, only: dp, int64, rk
    use brz_link_layout, only: link_layout_t, link_unit, n_press
    use brz_particle_groups, only: lanes
    use brz_solid_fields, only: fields_of, fields_t, make_fields, memory_of
    use brz_listed_bodies, only: listed_bodies_t
    implicit none
    private
    public :: allocate_solid, bytes_per_particle, number_groups, cut_blocks, group_of

    integer, parameter :: block_size = 16*lanes !! most particles of a block: whole groups
    integer, parameter :: n_sum = 8 !! sums that a pass may keep per block

contains

    !> Allocate for solid%n particles with solid%n_hist history variables; bodies must be known.
    subroutine allocate_solid(solid)
        class(listed_bodies_t), intent(inout) :: solid

        call make_fields(solid)
        allocate (solid%search%order(solid%n))
        call number_groups(solid)
        call cut_blocks(solid)
        if (solid%links%present) call allocate_links(solid)
    end subroutine allocate_solid

    !> Number the groups of particles, body by body; behind those of each stands one of no members,
    !> where its lists end.
    subroutine number_groups(solid)
        class(listed_bodies_t), intent(inout) :: solid
        integer :: b, n

        n = 0
        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b))
                body%group = n + 1
                n = n + (body%last - body%first + lanes)/lanes + 1
            end associate
        end do
        call renew(solid%first)
        if (any(solid%mirror)) call renew(solid%image_first)

    contains

        !> No list has an entry.
        subroutine renew(first)
            integer(int64), allocatable, intent(inout) :: first(:)

            if (allocated(first)) then
                if (size(first) /= n) deallocate (first)
            end if
            if (.not. allocated(first)) allocate (first(n))
            first = 1
        end subroutine renew
    end subroutine number_groups

    !> Group of particle i of a body.
    pure integer function group_of(body, i)
        type(body_t), intent(in) :: body
        integer, intent(in) :: i

        group_of = body%group + (i - body%first)/lanes
    end function group_of

    !> What particles need to meet those of other bodies.
    subroutine allocate_links(solid)
        class(listed_bodies_t), intent(inout) :: solid

        associate (n => solid%n, links => solid%links)
            allocate (links%row(n), links%slice(0:1), links%count(0:1), links%press(n_press, 0:1), &
                      links%push(9, 0:1))
            allocate (links%met(size(solid%bodies), size(solid%bodies)), source=.false.)
            allocate (links%stale(size(solid%bodies), size(solid%bodies)), source=.true.)
            allocate (links%drift(3, size(solid%bodies), size(solid%bodies)), source=0.0_dp)
            allocate (links%spare(size(solid%bodies), size(solid%bodies)), source=0.0_dp)
            allocate (links%box(3, 2, size(solid%bodies)), source=0.0_dp)
            links%ends = solid%bodies%last
            links%lay = link_layout_t(size(solid%bodies), solid%dimension, &
                                      merge(1, 0, allocated(solid%control)), 3, 1, 6, n_face, 1, &
                                      1, 1, link_unit, real(solid%depth, rk))
            links%slice = 0
            links%count = 0
            links%row = 0
            links%press = 0
            links%push = 0
        end associate
    end subroutine allocate_links

    !> Cut the bodies into blocks of particles: the unit of work and of every sum, so that sums do
    !> not depend on the number of threads.
    subroutine cut_blocks(solid)
        class(listed_bodies_t), intent(inout) :: solid
        integer :: b, i, n

        n = sum((solid%bodies%last - solid%bodies%first + block_size)/block_size)
        if (allocated(solid%block)) then
            if (size(solid%block, 2) /= n) deallocate (solid%block, solid%search%sums, &
                solid%search%limit, solid%search%in_tension, solid%search%bad)
        end if
        if (.not. allocated(solid%block)) &
            allocate (solid%block(3, n), solid%search%sums(n_sum, n), solid%search%limit(n), &
                  solid%search%in_tension(n), solid%search%bad(n))
        solid%search%in_tension = .false.
        n = 0
        do b = 1, size(solid%bodies)
            do i = solid%bodies(b)%first, solid%bodies(b)%last, block_size
                n = n + 1
                solid%block(:, n) = [b, i, min(i + block_size - 1, solid%bodies(b)%last)]
            end do
        end do
    end subroutine cut_blocks

    !> Memory per particle without neighbour lists [B].
    real(dp) function bytes_per_particle(solid) result(bytes)
        class(listed_bodies_t), intent(inout) :: solid
        type(fields_t) :: fields

        call fields_of(solid, fields)
        bytes = sum(real(memory_of(fields%of(:fields%n)), dp)) + 4
        associate (s => solid)
            bytes = bytes + 8*real(size(s%first), dp)/s%n
            if (allocated(s%image_first)) bytes = bytes + 8*real(size(s%image_first), dp)/s%n
            if (s%links%present) bytes = bytes + 4 + real(8*size(s%links%slice) &
                + (size(s%links%press) + size(s%links%push))*(storage_size(1.0_rk)/8), dp)/s%n
        end associate
    end function bytes_per_particle
end module brz_solid_arrays
