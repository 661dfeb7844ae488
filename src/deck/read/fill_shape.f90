! SPDX-License-Identifier: MIT
!> The shape of a body and its lattice, from the keys of its group.
module brz_fill_shape
    use brz_case, only: body_case_t
    use brz_deck, only: deck_t
    use brz_get, only: get, get_box, get_path
    use brz_body_geometry, only: body_geometry_t
    use brz_body_geometries, only: geometry_of
    implicit none
    private
    public :: fill_shape

contains

    subroutine fill_shape(deck, g, body)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(body_case_t), intent(inout) :: body
        character(len(body%shape)) :: lattice
        type(body_geometry_t) :: geometry
        integer :: k, n

        lattice = ''
        associate (group => deck%groups(g))
            call get(group, 'shape', body%shape)
            call get_box(group, body%lo, body%hi)
            call get(group, 'centre', body%centre)
            call get(group, 'radius', body%radius)
            call get(group, 'length', body%length)
            call get(group, 'inner_radius', body%inner_radius)
            call get(group, 'axis', body%axis)
            call get(group, 'diameter', body%diameter)
            call get(group, 'bars', body%bars)
            call get(group, 'cuts', body%cuts, n)
            call get_path(deck, g, 'file', body%file)
            call get(group, 'scale', body%scale)
            call get(group, 'move', body%move)
            call get(group, 'spacing', body%spacing)
            call get(group, 'lattice', lattice)
            body%layered = lattice == 'layered'
            call get(group, 'aspect', body%aspect)
            geometry = geometry_of(body)
            if (.not. allocated(geometry%keys)) return
            do k = 1, size(geometry%keys)
                call get(group, trim(geometry%keys(k)%key), body%own(k))
            end do
        end associate
    end subroutine fill_shape
end module brz_fill_shape
