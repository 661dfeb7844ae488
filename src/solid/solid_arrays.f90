! SPDX-License-Identifier: MIT
!> Allocation of the arrays of the particles, for a fresh start and for a restart alike.
module brz_solid_arrays
    use brz_kinds, only: dp, int64, real32, rk
    use brz_solid_state, only: bond_none, lanes, n_held, n_pair, solid_t
    implicit none
    private
    public :: allocate_solid, bytes_per_particle

    integer, parameter :: block_size = 16*lanes !! most particles of a block: whole groups
    integer, parameter :: n_sum = 8 !! sums that a pass may keep per block

contains

    !> Allocate for solid%n particles with solid%n_hist history variables; bodies must be known.
    subroutine allocate_solid(solid)
        type(solid_t), intent(inout) :: solid

        associate (n => solid%n)
            allocate (solid%x(3, n), solid%x_ref(3, n), solid%x_built(3, n), source=0.0_dp)
            allocate (solid%v(3, n), solid%a(3, n), solid%mass(n), solid%mu(n), solid%energy(n), &
                      solid%stress(6, n), solid%hist(solid%n_hist, n), solid%damage(n), &
                      solid%volume(n), solid%pair(n_pair, n))
            allocate (solid%id(n), solid%ply(n), solid%support(n), solid%fixed(n), solid%cut(n))
            allocate (solid%h(merge(n, 0, any(solid%bodies%variable))), source=0.0_rk)
            if (any(solid%bodies%directional)) allocate (solid%hold(6, n), source=0.0_real32)
            if (any_tilted(solid)) allocate (solid%tilt(n), source=0.0_real32)
            if (any(solid%bodies%tension_hold > 0)) allocate (solid%held(n_held, n), &
                                                              solid%owed(n), source=0.0_rk)
            allocate (solid%search%order(n))
        end associate
        call number_groups(solid)
        call clear(solid)
        call cut_blocks(solid)
        if (solid%links%present) call allocate_links(solid)
    end subroutine allocate_solid

    !> True where the outermost layers of some body have tilted gradients.
    pure logical function any_tilted(solid)
        type(solid_t), intent(in) :: solid
        integer :: b

        any_tilted = any([(any(solid%bodies(b)%normal > 0), b=1, size(solid%bodies))])
    end function any_tilted

    !> Number the groups of particles, body by body; behind those of each stands one of no members,
    !> where its lists end.
    subroutine number_groups(solid)
        type(solid_t), intent(inout) :: solid
        integer :: b, n

        n = 0
        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b))
                body%group = n + 1
                n = n + (body%last - body%first + lanes)/lanes + 1
            end associate
        end do
        allocate (solid%first(n), source=1_int64)
        if (any(solid%mirror)) allocate (solid%image_first(n), source=1_int64)
    end subroutine number_groups

    !> What particles need to meet those of other bodies.
    subroutine allocate_links(solid)
        type(solid_t), intent(inout) :: solid

        associate (n => solid%n, links => solid%links)
            allocate (links%row(n), links%touch(n), links%weight(n), links%bond(n))
            allocate (links%first(0:1), links%press(5, 0:0), links%push(9, 0:0))
            allocate (links%met(size(solid%bodies), size(solid%bodies)), source=.false.)
            allocate (links%spare(size(solid%bodies), size(solid%bodies)), source=0.0_dp)
            links%ends = solid%bodies%last
            links%first = 1
            links%row = 0
            links%touch = 1
            links%weight = 1
            links%bond = bond_none
            links%press = 0
            links%push = 0
        end associate
    end subroutine allocate_links

    subroutine clear(solid)
        type(solid_t), intent(inout) :: solid

        solid%v = 0
        solid%a = 0
        solid%mass = 0
        solid%mu = 0
        solid%energy = 0
        solid%stress = 0
        solid%hist = 0
        solid%damage = 0
        solid%volume = 0
        solid%pair = 0
        solid%id = 0
        solid%ply = 0
        solid%support = 0
        solid%fixed = 0
        solid%cut = 0
    end subroutine clear

    !> Cut the bodies into blocks of particles: the unit of work and of every sum, so that sums do
    !> not depend on the number of threads.
    subroutine cut_blocks(solid)
        type(solid_t), intent(inout) :: solid
        integer :: b, i, n

        n = sum((solid%bodies%last - solid%bodies%first + block_size)/block_size)
        allocate (solid%block(3, n), solid%search%sums(n_sum, n), solid%search%limit(n), &
                  solid%search%drawn(n), solid%search%bad(n))
        solid%search%drawn = .false.
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
        type(solid_t), intent(in) :: solid

        associate (s => solid)
            bytes = wide(size(s%x) + size(s%x_ref) + size(s%x_built) + size(s%first)) &
                    + working(size(s%v) + size(s%a) + size(s%mass) + size(s%mu) + size(s%energy)) &
                    + working(size(s%stress) + size(s%hist) + size(s%damage)) &
                    + working(size(s%volume) + size(s%pair)) &
                    + 4.0_dp*(size(s%id) + size(s%search%order)) &
                    + 2.0_dp*(size(s%ply) + size(s%support)) &
                    + 1.0_dp*(size(s%fixed) + size(s%cut))
            if (allocated(s%image_first)) bytes = bytes + wide(size(s%image_first))
            if (allocated(s%load)) bytes = bytes + working(size(s%load))
            bytes = bytes + working(size(s%h))
            if (allocated(s%hold)) bytes = bytes + 4.0_dp*size(s%hold)
            if (allocated(s%tilt)) bytes = bytes + 4.0_dp*size(s%tilt)
            if (allocated(s%held)) bytes = bytes + working(size(s%held) + size(s%owed))
            if (s%links%present) bytes = bytes + 4.0_dp*(size(s%links%row) + size(s%links%touch) &
                                                           + size(s%links%weight)) &
                + size(s%links%bond) + wide(size(s%links%first)) &
                + working(size(s%links%press) + size(s%links%push))
        end associate
        bytes = bytes/solid%n
    end function bytes_per_particle

    pure real(dp) function wide(n)
        integer, intent(in) :: n

        wide = n*(storage_size(1.0_dp)/8.0_dp)
    end function wide

    pure real(dp) function working(n)
        integer, intent(in) :: n

        working = n*(storage_size(1.0_rk)/8.0_dp)
    end function working
end module brz_solid_arrays
