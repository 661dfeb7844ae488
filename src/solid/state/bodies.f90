! SPDX-License-Identifier: MIT
!> Bodies: what the particles make up, of which materials, and what loads them.
module brz_bodies
    use brz_body, only: body_t
    use brz_kinds, only: dp
    use brz_loads, only: loads_t
    use brz_material, only: material_t
    use brz_particles, only: particles_t
    implicit none
    private
    public :: bodies_t

    type, extends(particles_t) :: bodies_t
        type(body_t), allocatable :: bodies(:)
        type(material_t), allocatable :: materials(:)
        type(loads_t) :: loads !! pressures on faces, in scenes without air
        integer, allocatable :: block(:, :) !! (3, blocks) body, first and last particle of a block
        real(dp) :: dt_limit = 0 !! the smallest of the bodies' and that of contact, part of a
                                 !! checkpoint [s]
        logical :: impulses = .false. !! a gauge asks for those of the load
        logical :: remove = .false. !! what leaves the region is taken out
        !> Corners of the region whose leaving is watched [m].
        real(dp) :: region(3, 2) = reshape([-huge(1.0_dp), -huge(1.0_dp), -huge(1.0_dp), &
                                            huge(1.0_dp), huge(1.0_dp), huge(1.0_dp)], [3, 2])
        character(:), allocatable :: notes !! warnings of the set-up, line by line
    end type bodies_t
end module brz_bodies
