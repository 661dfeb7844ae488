! SPDX-License-Identifier: MIT
!> The shapes of bodies.
module brz_outlines
    use brz_case, only: body_case_t
    use brz_key, only: key_t
    use brz_kinds, only: dp
    use brz_outline, only: outline_t
    use brz_text, only: split, string_t
    implicit none
    private
    public :: outline_of, body_box, keys_of_shapes, own_keys, shape_choices

contains

    !> All shapes, a line for each. Of bars and of what is in files brz_body_points knows more.
    pure subroutine list_outlines(every)
        type(outline_t), allocatable, intent(out) :: every(:)

        allocate (every(0))
        call add(every, outline_t('box', needs='box', fits='all'))
        block; use brz_sphere_outline, only: sphere; call add(every, sphere()); end block
        block; use brz_cylinder_outline, only: cylinder; call add(every, cylinder()); end block
        call add(every, outline_t('bars', needs='box axis diameter', takes='bars', fits='axis'))
        call add(every, outline_t('stl', needs='file', takes='scale move'))
        call add(every, outline_t('particles', needs='file', takes='scale move'))
    end subroutine list_outlines

    pure subroutine add(every, outline)
        type(outline_t), allocatable, intent(inout) :: every(:)
        type(outline_t), intent(in) :: outline
        type(outline_t), allocatable :: more(:)

        allocate (more(size(every) + 1))
        more(:size(every)) = every
        more(size(more)) = outline
        call move_alloc(more, every)
    end subroutine add

    !> The shape of a body.
    pure function outline_of(body) result(outline)
        type(body_case_t), intent(in) :: body
        type(outline_t) :: outline
        type(outline_t), allocatable :: every(:)

        call list_outlines(every)
        outline = every(max(1, findloc(every%name, body%shape, 1)))
    end function outline_of

    !> Corners of the smallest box around a body [m].
    pure subroutine body_box(body, lo, hi)
        type(body_case_t), intent(in) :: body
        real(dp), intent(out) :: lo(3), hi(3)
        type(outline_t) :: outline

        outline = outline_of(body)
        call outline%corners(body, lo, hi)
    end subroutine body_box

    !> All keys that some shapes have and others have not.
    pure function keys_of_shapes() result(keys)
        character(24), allocatable :: keys(:)
        type(string_t), allocatable :: parts(:)
        type(outline_t), allocatable :: every(:)
        integer :: i, k

        call list_outlines(every)
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
    pure function own_keys() result(keys)
        type(key_t), allocatable :: keys(:)
        type(outline_t), allocatable :: every(:)
        integer :: k

        call list_outlines(every)
        allocate (keys(0))
        do k = 1, size(every)
            if (allocated(every(k)%keys)) keys = [keys, every(k)%keys]
        end do
    end function own_keys

    !> All of them, separated as choices of a key are.
    pure function shape_choices() result(text)
        character(:), allocatable :: text
        type(outline_t), allocatable :: every(:)
        integer :: k

        call list_outlines(every)
        text = trim(every(1)%name)
        do k = 2, size(every)
            text = text//'|'//trim(every(k)%name)
        end do
    end function shape_choices
end module brz_outlines
