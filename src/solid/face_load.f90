! SPDX-License-Identifier: MIT
!> Pressures on faces of bodies and forces on whole bodies, in scenes without air.
!>
!> A face is the outermost layer of a lattice, seen along an axis. Each of its particles carries a
!> facet: the vectors to its neighbours in the layer span its area and show its normal, so that the
!> load follows the face as it stretches, bends and turns.
!>
!> Source: docs/blast.md, loads without air
module brz_face_load
    use brz_kingery_bulmash, only: friedlander_impulse
    use brz_kinds, only: dp, int64
    implicit none
    private
    public :: loads_t, facets_t, impulse_on, find_places

    !> The facets of one &load.
    type :: facets_t
        integer :: n = 0
        integer, allocatable :: id(:) !! (n) of the particle
        integer, allocatable :: beside(:, :) !! (4, n) ids of the neighbours along the first axis of
                                             !! the face, up and down, then along the second; 0: the
                                             !! particle itself
        integer, allocatable :: mirror(:, :) !! (4, n) axis in which a neighbour is mirrored, or 0
        real(dp), allocatable :: width(:, :) !! (2, n) of the facet over the distance of these two
        real(dp), allocatable :: most(:, :) !! (2, n) largest width: beyond it the face is torn [m]
        integer, allocatable :: side(:) !! (n) -1, 1: low, high face
        real(dp), allocatable :: time(:), pressure(:) !! history of the overpressure [s, Pa], or
        integer :: body = 0 !! not 0: no facets, but a push on all of a body, times this history
        real(dp) :: push(3) = 0 !! [m/s2]
        logical :: blast = .false. !! a blast, which differs from facet to facet:
        real(dp), allocatable :: wave(:, :) !! (6, n) arrival, duration [s]; peaks of the reflected
                                            !! and of the incident part [Pa], their decays
    end type facets_t

    type :: loads_t
        type(facets_t), allocatable :: of(:) !! in the order of the deck
        integer, allocatable :: place(:) !! (particles) place of the particle with an id; negative:
                                         !! of its ghost; 0: it is elsewhere
        integer(int64) :: rebuilds = -1 !! of the lists, when `place` was filled
        real(dp) :: step = huge(1.0_dp) !! that resolves the loads [s]
    end type loads_t

contains

    !> Impulse per area on facet k from the start to a time [Pa s].
    pure real(dp) function impulse_on(facets, k, time) result(impulse)
        type(facets_t), intent(in) :: facets
        integer, intent(in) :: k
        real(dp), intent(in) :: time !! [s]
        real(dp) :: part
        integer :: i

        if (facets%blast) then
            associate (w => facets%wave(:, k))
                impulse = friedlander_impulse(w(3), w(2), w(5), time - w(1)) &
                          + friedlander_impulse(w(4), w(2), w(6), time - w(1))
            end associate
        else if (size(facets%time) == 0) then
            impulse = facets%pressure(1)*time
        else
            impulse = 0
            do i = 1, size(facets%time) - 1
                associate (t => facets%time(i:i + 1), p => facets%pressure(i:i + 1))
                    part = min(max(time - t(1), 0.0_dp), t(2) - t(1))
                    impulse = impulse + part*(p(1) + part/(t(2) - t(1))*(p(2) - p(1))/2)
                end associate
            end do
        end if
    end function impulse_on

    !> Find the particles by their ids, after the lists were sorted.
    pure subroutine find_places(loads, id)
        type(loads_t), intent(inout) :: loads
        integer, intent(in) :: id(:) !! of the particles, in their order
        integer :: i

        do i = 1, size(id)
            loads%place(id(i)) = i
        end do
    end subroutine find_places
end module brz_face_load
