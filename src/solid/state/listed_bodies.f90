! SPDX-License-Identifier: MIT
!> Bodies with lists of the neighbours of their particles: within a body, and links between bodies.
module brz_listed_bodies
    use brz_bodies, only: bodies_t
    use brz_kinds, only: dp, int32, int64, int8
    use brz_links, only: links_t
    use brz_search_arrays, only: search_t
    implicit none
    private
    public :: listed_bodies_t

    type, extends(bodies_t) :: listed_bodies_t
        real(dp) :: skin = 0 !! of the neighbour list [m]
        integer, allocatable :: moved(:, :) !! (lost_level, bodies) 1: some particle has moved so
                                            !! far since its list was built
        type(search_t) :: search
        ! neighbours of a group: entries first(g)..first(g+1)-1 of `list`, its members among them;
        ! mirror images, only where there are planes: entries image_first(g)..image_first(g+1)-1
        integer(int64), allocatable :: first(:), image_first(:) !! (groups and an end for each body)
        integer(int32), allocatable :: list(:) !! particles within reach of a member
        integer(int32), allocatable :: image(:) !! particles whose image is within reach of one
        integer(int8), allocatable :: mask(:) !! mirrored axes of an image, bits 0..2
        type(links_t) :: links !! between different bodies
    end type listed_bodies_t
end module brz_listed_bodies
