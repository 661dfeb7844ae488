! SPDX-License-Identifier: MIT
!> Cohesive interfaces between bodies: points in the gap, what they see of the particles, their
!> state.
!>
!> A point sees a sum of places of particles of either body with fixed weights, a node each. Nodes
!> are numbered for life; only where in the arrays their particle lies changes with every sort.
!> Forces are gathered: the points of a node lie side by side in `back`.
module brz_cohesive_state
    use brz_cohesive_numbers, only: cohesive_law_t
    use brz_kinds, only: dp, int32, int8
    implicit none
    private
    public :: cohesive_t, push_of

    type :: cohesive_t
        logical :: present = .false.
        integer :: n = 0, nodes = 0 !! points; particles that they see
        real(dp) :: dt_limit = huge(1.0_dp) !! largest stable step of the springs [s]
        real(dp) :: farthest = 0 !! largest coordinate of a particle of the unloaded bodies [m]
        ! interfaces
        type(cohesive_law_t), allocatable :: law(:) !! (interfaces)
        integer, allocatable :: body(:, :) !! (2, interfaces) near and far side
        integer, allocatable :: facing(:) !! (interfaces) normal of all faces of the near side, +-1,
                                          !! +-2, +-3; 0 where they differ
        integer(int32), allocatable :: bit(:) !! (interfaces) marks it in `joined` of links_t
        real(dp), allocatable :: limit(:) !! (interfaces) largest stable step of each [s]
        logical, allocatable :: softened(:) !! (interfaces) the usual stiffness was too much
        ! points
        integer(int32), allocatable :: of(:) !! (n) interface
        integer(int32), allocatable :: first(:) !! (n+1) entries of a point
        integer(int32), allocatable :: beside(:, :) !! (2, n) nearest node of either side
        real(dp), allocatable :: area(:) !! (n) [m2]
        real(dp), allocatable :: gap(:) !! (n) unloaded distance of what is seen of both sides [m]
        real(dp), allocatable :: rest(:, :, :) !! (3, 2, n) of the tangents, seen by no particle
        ! entries: a node with its weights
        integer(int32), allocatable :: node(:)
        integer(int8), allocatable :: mask(:) !! mirrored axes, bits 0..2
        integer(int32), allocatable :: entry(:) !! both in one, see brz_link_layout
        real(dp), allocatable :: weight(:, :) !! (3, entries) of the opening; of the tangents [1/m]
        ! nodes
        integer(int32), allocatable :: back_first(:) !! (nodes+1) entries of a node in `back`
        integer(int32), allocatable :: back(:, :) !! (2, entries) entry, its point
        integer(int32), allocatable :: row(:) !! (particles) node of the particle of a number, or 0
        integer(int32), allocatable :: place(:) !! (nodes) where its particle lies now; 0: not
                                                !! on this process
        ! of several processes
        integer(int32), allocatable :: owner(:) !! (nodes) process that has its particle, from 1; 0
                                                !! before it is known
        integer(int32), allocatable :: seen_by(:) !! (n) which have a particle of it, see bit_of
        integer(int32), allocatable :: mine(:) !! (n) 1: this one has, and computes it
        ! state
        real(dp), allocatable :: damage(:) !! (n) 0..1
        real(dp), allocatable :: spent(:) !! (n) energy of the damage so far [J]
        real(dp), allocatable :: held(:) !! (n) energy that comes back [J]
        ! forces at the present places
        real(dp), allocatable :: pull(:, :, :) !! (3, 3, n) by unit weight; 1: [N], 2, 3: [N m]
        real(dp), allocatable :: push(:, :) !! (3, 0:nodes) on the particles; 0 is nil [N]
    end type cohesive_t

contains

    !> Force of all interfaces on the particle of a number [N].
    pure function push_of(cohesive, id) result(f)
        type(cohesive_t), intent(in) :: cohesive
        integer(int32), intent(in) :: id
        real(dp) :: f(3)

        f = cohesive%push(:, cohesive%row(id))
    end function push_of
end module brz_cohesive_state
