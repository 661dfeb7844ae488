! SPDX-License-Identifier: MIT
!> The shapes of bodies.
module brz_body_geometries
    use brz_case, only: body_case_t
    use brz_key, only: key_t
    use brz_kinds, only: dp
    use brz_body_geometry, only: body_geometry_t
    use brz_text, only: split, string_t
    implicit none
    private
    public :: geometry_of, body_box, keys_of_shapes, own_keys, shape_choices, lay_geometries

    type(body_geometry_t), allocatable :: every(:) !! the table, once it is laid

contains

    !> Lay the table of all shapes, a line for each. Of bars and of what is in files brz_body_points
    !> knows more.
    subroutine lay_geometries(more)
        type(body_geometry_t), intent(in), optional :: more !! another shape, for a test

        every = [body_geometry_t('box', needs='box', fits='all')]
        block; use brz_sphere_geometry, only: sphere; every = [every, sphere()]; end block
        block; use brz_cylinder_geometry, only: cylinder; every = [every, cylinder()]; end block
        every = [every, body_geometry_t('bars', needs='box axis diameter', takes='bars', &
            fits='axis')]
        every = [every, body_geometry_t('stl', needs='file', takes='scale move')]
        every = [every, body_geometry_t('particles', needs='file', takes='scale move')]
        if (present(more)) every = [every, more]
    end subroutine lay_geometries

    !> The shape of a body.
    function geometry_of(body) result(geometry)
        type(body_case_t), intent(in) :: body
        type(body_geometry_t) :: geometry

        if (.not. allocated(every)) call lay_geometries()
        geometry = every(max(1, findloc(every%name, body%shape, 1)))
    end function geometry_of

    !> Corners of the smallest box around a body [m].
    subroutine body_box(body, lo, hi)
        type(body_case_t), intent(in) :: body
        real(dp), intent(out) :: lo(3), hi(3)
        type(body_geometry_t) :: geometry

        geometry = geometry_of(body)
        call geometry%corners(body, lo, hi)
    end subroutine body_box

    !> All keys that some shapes have and others have not.
    function keys_of_shapes() result(keys)
        character(24), allocatable :: keys(:)
        type(string_t), allocatable :: parts(:)
        integer :: i, k

        if (.not. allocated(every)) call lay_geometries()
        allocate (keys(0))
        do k = 1, size(every)
            call split(trim(every(k)%needs)//' '//trim(every(k)%takes), ' ', parts)
            do i = 1, size(parts)
                if (parts(i)%s == '' .or. any(keys == parts(i)%s)) cycle
                keys = [character(24) :: keys, parts(i)%s]
            end do
        end do
    end function keys_of_shapes

    !> Rows of the key table that shapes have of their own.
    function own_keys() result(keys)
        type(key_t), allocatable :: keys(:)
        integer :: k

        if (.not. allocated(every)) call lay_geometries()
        allocate (keys(0))
        do k = 1, size(every)
            if (allocated(every(k)%keys)) keys = [keys, every(k)%keys]
        end do
    end function own_keys

    !> All of them, separated as choices of a key are.
    function shape_choices() result(text)
        character(:), allocatable :: text
        integer :: k

        if (.not. allocated(every)) call lay_geometries()
        text = trim(every(1)%name)
        do k = 2, size(every)
            text = text//'|'//trim(every(k)%name)
        end do
    end function shape_choices
end module brz_body_geometries
