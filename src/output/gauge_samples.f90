! SPDX-License-Identifier: MIT
!> What gauges see at their places, and the means of it.
!>
!> A process has the values at the places that are its own, and 0 elsewhere. All processes form the
!> same means, in the order of the places, so the bits do not depend on how many they are.
module brz_gauge_samples
    use brz_kinds, only: dp
    use brz_ranks, only: bits_of_all, ranks_t, several
    implicit none
    private
    public :: samples_t, add_sample, means_of

    type :: samples_t
        integer :: n = 0
        integer, allocatable :: gauge(:) !! (room) whose value it is
        real(dp), allocatable :: seen(:, :) !! (2, room) value, weight in the mean
    end type samples_t

contains

    !> Add the value at a place of a gauge.
    pure subroutine add_sample(samples, gauge, value, weight)
        type(samples_t), intent(inout) :: samples
        integer, intent(in) :: gauge
        real(dp), intent(in) :: value, weight
        integer, allocatable :: of(:)
        real(dp), allocatable :: seen(:, :)

        if (.not. allocated(samples%gauge)) allocate (samples%gauge(16), samples%seen(2, 16))
        associate (n => samples%n)
            if (n == size(samples%gauge)) then
                allocate (of(2*n), seen(2, 2*n))
                of(:n) = samples%gauge
                seen(:, :n) = samples%seen
                call move_alloc(of, samples%gauge)
                call move_alloc(seen, samples%seen)
            end if
            n = n + 1
            samples%gauge(n) = gauge
            samples%seen(:, n) = [value, weight]
        end associate
    end subroutine add_sample

    !> Means of all gauges. Where no place of a gauge has a weight, as in solid, all count alike.
    subroutine means_of(samples, ranks, means)
        type(samples_t), intent(in) :: samples
        type(ranks_t), intent(in) :: ranks
        real(dp), intent(out) :: means(:) !! of each gauge
        real(dp) :: seen(2*samples%n), weight(size(means)), alike(size(means))
        integer :: number(size(means)), g, k

        if (samples%n == 0) return
        seen = reshape(samples%seen(:, :samples%n), [2*samples%n])
        if (several(ranks)) call bits_of_all(ranks, seen)
        means = 0
        weight = 0
        alike = 0
        number = 0
        do k = 1, samples%n
            g = samples%gauge(k)
            associate (value => seen(2*k - 1), share => seen(2*k))
                means(g) = means(g) + share*value
                weight(g) = weight(g) + share
                alike(g) = alike(g) + value
                number(g) = number(g) + 1
            end associate
        end do
        where (number == 1 .or. .not. weight > 0)
            means = alike
            weight = number
        end where
        means = means/weight
    end subroutine means_of
end module brz_gauge_samples
