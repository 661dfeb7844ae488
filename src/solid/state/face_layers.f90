! SPDX-License-Identifier: MIT
!> The layers of particles under the faces of a body, over which a load is spread.
module brz_face_layers
    use brz_kinds, only: rk
    implicit none
    private
    public :: layers_t

    !> The lattice of a body under the faces of the air, whose load is spread over depth.
    type :: layers_t
        real(rk) :: apart(3) = 0 !! distance of layers [m]
        real(rk) :: across(3) = 0 !! particles of a layer per face of the air
        real(rk) :: range(3) = 0 !! where the weights have fallen to 0, in layers
        real(rk) :: whole(3) = 0 !! weight of a column that is as deep, in that of a layer
        real(rk) :: more(3, 3) = 0 !! see spread_shares; of each direction
        real(rk) :: share = 0 !! face_share of the body, for which the stress is kept
    end type layers_t
end module brz_face_layers
