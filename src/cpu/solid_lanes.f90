! SPDX-License-Identifier: MIT
!> Eight particles side by side, each in a lane of its own: what the loops over neighbours share.
!>
!> The particles of a group are consecutive, so they are near each other and share one list: all
!> that is within reach of any of them. A loop takes one neighbour after the other and computes its
!> pairs with all eight at once. What it reads of the neighbour is one number for all lanes, what it
!> reads of the group and what it sums are whole vectors.
module brz_solid_lanes
    use brz_body, only: body_t
    use brz_force_layout, only: n_terms
    use brz_gradient, only: limiter_slope
    use brz_hold_layout, only: n_control
    use brz_kernel, only: kernel_scale
    use brz_kinds, only: dp, int32, int64, rk
    use brz_pair_layout, only: n_pair
    use brz_particle_groups, only: lanes
    use brz_solid_arrays, only: group_of
    use brz_solid_mirror, only: signs
    use brz_listed_bodies, only: listed_bodies_t
    use brz_one_sided_arm, only: radial_normal
    implicit none
    private
    public :: centre_t, lane_group_t, place_body, place_group
    public :: lane_kernel_t, body_kernel, pair_kernels
    public :: images_t, place_images, most_images, in_turn

    integer, parameter :: most_images = 64 !! that are laid down at a time
    integer :: k_turn
    integer(int32), parameter :: in_turn(most_images) = [(k_turn, k_turn=1, most_images)]

    !> A particle whose pairs are summed over, and the kernel.
    type :: centre_t
        integer :: i = 0 !! particle; of a group the first
        real(rk) :: scale = 0, half_over_h = 0 !! see brz_kernel
        real(rk) :: h = 0 !! smoothing length [m]
        real(rk) :: normal(3) = 0 !! of the layers, see brz_one_sided_arm; 0: no tilts
        real(rk) :: lift = 0 !! over the tilt, likewise
        logical :: curved = .false. !! that of a particle is radial, see brz_body
        real(dp) :: middle(3) = 0 !! on the axis of such a wall [m]
    end type centre_t

    !> The particles of a group. Where they are fewer than lanes, the last one is in all others.
    type, extends(centre_t) :: lane_group_t
        integer :: last = 0 !! its last particle
        integer :: formulation = 0 !! of their body
        logical :: directional = .false. !! hourglass stiffness along axes
        real(rk) :: width(3) = 1 !! unloaded place over x_ref
        logical :: jumps = .false. !! the viscosity sees jumps alone, see jump_speed
        logical :: variable = .false. !! smoothing lengths follow the density
        integer :: dimension = 3
        real(rk) :: factor = 0 !! of the kernel's scale, see pair_kernels
        real(rk) :: size(lanes) = 0 !! smoothing lengths, where they are variable [m]
        integer :: count = 0 !! entries of its list
        integer(int64) :: list = 1 !! the first of them
        real(dp) :: x(lanes, 3) = 0, x_ref(lanes, 3) = 0 !! [m]
        real(rk) :: v(lanes, 3) = 0 !! [m/s]
        real(rk) :: normals(lanes, 3) = 0 !! of its members, in a curved wall
        real(rk), allocatable :: there(:, :) !! the same of their neighbours, for pass 2
        real(rk) :: tilt(lanes) = 0 !! for pass 1 [1/m]
        logical :: in_tension(lanes) = .false. !! for pass 1: was in tension
        logical :: control = .false. !! for pass 2: some pair has the tensile control
        real(rk) :: row(lanes, n_pair) = 0 !! for pass 2, see brz_pair_layout
        real(rk) :: own(lanes, n_control) = 0 !! the same, the tensile control
        real(rk) :: k_axes(lanes, 6) = 0 !! the same, where a body has a stiffness along axes
        real(rk) :: sums(lanes, n_terms) = 0 !! what pass 2 sums up
    end type lane_group_t

    !> Kernel of the pairs of a neighbour with the members of a group.
    type :: lane_kernel_t
        real(rk) :: scale(lanes), half_over_h(lanes) !! see brz_kernel
        real(rk) :: h(lanes) !! smoothing length [m]
    end type lane_kernel_t

    !> Mirror images of some particles, laid down as particles of their own.
    type :: images_t
        real(dp) :: x(3, most_images) = 0, x_ref(3, most_images) = 0 !! [m]
        real(rk) :: v(3, most_images) = 0 !! [m/s]
        real(rk) :: volume(most_images) = 0 !! [m3]
        real(rk) :: h(most_images) = 0 !! smoothing length, where it is variable [m]
    end type images_t

contains

    !> The group of a body that begins with particle `first`: its members, their places and
    !> velocities, its list.
    pure subroutine place_group(solid, body, first, p)
        class(listed_bodies_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        integer, intent(in) :: first
        type(lane_group_t), intent(inout) :: p
        integer :: g, i, l

        g = group_of(body, first)
        p%i = first
        p%last = min(first + lanes - 1, body%last)
        p%list = solid%first(g)
        p%count = int(solid%first(g + 1) - solid%first(g))
        do l = 1, lanes
            i = min(first + l - 1, p%last)
            p%x(l, :) = solid%x(:, i)
            p%x_ref(l, :) = solid%x_ref(:, i)
            p%v(l, :) = solid%v(:, i)
            if (p%curved) call radial_normal(p%normal, p%middle, solid%x_ref(:, i), p%normals(l, :))
            if (body%variable) p%size(l) = solid%h(i)
        end do
    end subroutine place_group

    !> A body and its kernel, before its groups are placed.
    pure subroutine place_body(solid, body, p)
        class(listed_bodies_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        type(lane_group_t), intent(inout) :: p

        p%scale = kernel_scale(body%h, solid%dimension)/real(solid%depth, rk)
        p%half_over_h = 1/(2*body%h)
        p%h = body%h
        p%normal = body%normal
        p%lift = body%lift
        p%curved = body%curved
        p%middle = body%round%centre
        p%formulation = body%formulation
        p%directional = body%directional
        p%width = real(1/body%stretch, rk)
        p%jumps = body%limiter == limiter_slope
        p%variable = body%variable
        p%dimension = solid%dimension
        p%factor = p%scale/p%half_over_h**(solid%dimension + 2)
    end subroutine place_body

    !> Kernel of a body of constant smoothing length.
    pure subroutine body_kernel(p, q)
        type(lane_group_t), intent(in) :: p
        type(lane_kernel_t), intent(out) :: q

        q%scale = p%scale
        q%half_over_h = p%half_over_h
        q%h = p%h
    end subroutine body_kernel

    !> Kernel of the pairs of a neighbour in a body of variable smoothing length, as pair_kernel has
    !> it, in vector code.
    pure subroutine pair_kernels(p, h, q)
        type(lane_group_t), intent(in) :: p
        real(rk), intent(in) :: h !! of the neighbour [m]
        type(lane_kernel_t), intent(inout) :: q
        integer :: l, t

        !GCC$ unroll 1
        do l = 1, lanes
            q%h(l) = (p%size(l) + h)/2
            q%half_over_h(l) = 1/(p%size(l) + h)
            q%scale(l) = p%factor*q%half_over_h(l)*q%half_over_h(l)*q%half_over_h(l)
        end do
        do t = 2, p%dimension
            !GCC$ unroll 1
            do l = 1, lanes
                q%scale(l) = q%scale(l)*q%half_over_h(l)
            end do
        end do
    end subroutine pair_kernels

    !> Lay down the images of the entries k..last: what pass 1 reads of them.
    pure subroutine place_images(solid, k, last, images)
        class(listed_bodies_t), intent(in) :: solid
        integer(int64), intent(in) :: k, last
        type(images_t), intent(inout) :: images
        real(rk) :: s(3)
        integer(int64) :: e
        integer :: j, n

        do e = k, last
            n = int(e - k) + 1
            j = solid%image(e)
            s = signs(int(solid%mask(e)))
            images%x(:, n) = s*solid%x(:, j)
            images%x_ref(:, n) = s*solid%x_ref(:, j)
            images%v(:, n) = s*solid%v(:, j)
            images%volume(n) = solid%volume(j)
            if (size(solid%h) > 0) images%h(n) = solid%h(j)
        end do
    end subroutine place_images
end module brz_solid_lanes
