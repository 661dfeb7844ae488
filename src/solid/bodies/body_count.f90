! SPDX-License-Identifier: MIT
!> How many particles bodies will have, from their shapes alone: boxes and bars exactly, round
!> bodies and surfaces by their volume.
module brz_body_count
    use brz_bar_layers, only: bar_count, bar_span, span_t
    use brz_body_points, only: cell_volume, cuts, points_t
    use brz_body_shape, only: axis_of, inside, overlap
    use brz_case, only: body_case_t
    use brz_kinds, only: dp
    implicit none
    private
    public :: count_particles

    integer, parameter :: samples = 40 !! along an axis, where no volume is known

contains

    !> Particles of all bodies, about.
    function count_particles(bodies, points) result(n)
        type(body_case_t), intent(in) :: bodies(:)
        type(points_t), intent(in) :: points(:) !! shapes and lattices, no particles yet
        real(dp) :: n(size(bodies)), whole(size(bodies)), share
        integer :: b, c

        do b = 1, size(bodies)
            whole(b) = uncut(bodies(b), points(b))
        end do
        n = whole
        do b = 1, size(bodies)
            do c = 1, size(bodies)
                if (.not. cuts(bodies(c), bodies(b))) cycle
                share = overlap(points(c)%shape, points(b)%shape) &
                        /max(tiny(share), overlap(points(c)%shape, points(c)%shape))
                n(b) = n(b) - share*whole(c)*cell_volume(points(c)%shape) &
                       /cell_volume(points(b)%shape)
            end do
        end do
        n = max(n, 0.0_dp)
    end function count_particles

    !> Particles of a body that nothing cuts.
    real(dp) function uncut(body, points) result(n)
        type(body_case_t), intent(in) :: body
        type(points_t), intent(in) :: points
        integer :: a, k, layers
        type(span_t) :: span

        associate (s => points%shape)
            select case (body%shape)
            case ('particles')
                n = size(points%x, 2)
            case ('box')
                n = product(real(s%n(:s%dimension), dp))
            case ('bars')
                n = anint((s%hi(axis_of(body)) - s%lo(axis_of(body)))/s%spacing(axis_of(body)))
                do a = 1, 3
                    if (a == axis_of(body)) cycle
                    layers = 0
                    do k = 1, bar_count(body, a)
                        span = bar_span(body, a, k, s%start(a), s%spacing(a), s%on_plane(a))
                        layers = layers + span%last - span%first + 1
                    end do
                    n = n*layers
                end do
            case default
                n = points%exact/cell_volume(s)
                if (.not. points%exact > 0) n = sampled(body, points)
            end select
        end associate
    end function uncut

    !> The share of the box around a body that lies in it, on a coarse lattice, as particles.
    real(dp) function sampled(body, points) result(n)
        type(body_case_t), intent(in) :: body
        type(points_t), intent(in) :: points
        integer :: i, j, k, m(3)

        m = 1
        associate (s => points%shape)
            m(:s%dimension) = samples
            n = 0
            do k = 1, m(3)
                do j = 1, m(2)
                    do i = 1, m(1)
                        if (inside(body, s, s%lo + ([i, j, k] - 0.5_dp)/m*(s%hi - s%lo), &
                                   0.0_dp)) n = n + 1
                    end do
                end do
            end do
            n = n/product(m)*product((s%hi(:s%dimension) - s%lo(:s%dimension)) &
                                     /s%spacing(:s%dimension))
        end associate
    end function sampled
end module brz_body_count
