! SPDX-License-Identifier: MIT
!> Pressures on faces of bodies and forces on whole bodies, in scenes without air.
!>
!> A loaded segment is what a particle of a face carries, see brz_face_load.
module brz_loads
    use brz_kinds, only: dp, int32
    implicit none
    private
    public :: loaded_segments_t, load_history_t, loads_t

    !> Loaded segments, those of a particle one after the other.
    type :: loaded_segments_t
        integer :: n = 0
        integer :: carriers = 0 !! particles that carry some
        integer(int32), allocatable :: first(:) !! (driven bodies + 1) first loaded segment of each
        integer(int32), allocatable :: owner(:) !! (driven bodies) process that has it, from 1
        integer(int32), allocatable :: id(:) !! (n) of the particle
        integer(int32), allocatable :: load(:) !! (n) in the order of the deck
        integer(int32), allocatable :: beside(:, :) !! (4, n) ids of the neighbours along the first
                                             !! axis of the face, up and down, then along the
                                             !! second; 0: the particle itself
        integer(int32), allocatable :: mirror(:, :) !! (4, n) axis of a mirrored neighbour, or 0
        real(dp), allocatable :: width(:, :) !! (2, n) of the loaded segment over the distance of
                                             !! these two
        real(dp), allocatable :: most(:, :) !! (2, n) largest width: beyond it the face is torn [m]
        integer(int32), allocatable :: side(:) !! (n) axis of the face, negative: its low side
        real(dp), allocatable :: wave(:, :) !! (6, n) of a blast: arrival, duration [s]; peaks of
                                            !! the reflected and of the incident part [Pa], their
                                            !! decays; duration 0: none
    end type loaded_segments_t

    !> The history of one &load.
    type :: load_history_t
        real(dp), allocatable :: time(:), pressure(:) !! overpressure, or factors of `push` [s, Pa]
        integer :: body = 0 !! not 0: a push on all of a body
        real(dp) :: push(3) = 0 !! [m/s2]
        logical :: blast = .false. !! its loaded segments have waves, and there is no history
    end type load_history_t

    type :: loads_t
        type(load_history_t), allocatable :: of(:) !! in the order of the deck
        type(loaded_segments_t) :: segments !! of all of them
        real(dp), allocatable :: mean(:) !! pressures of the step, in the order of the deck [Pa]
        integer(int32), allocatable :: place(:) !! (particles) where the particle of a number lies;
                                                !! negative: its ghost does; 0: elsewhere
        integer :: rebuilds = -1 !! of the lists, when `place` was filled
        real(dp) :: step = huge(1.0_dp) !! that resolves the loads [s]
    end type loads_t
end module brz_loads
