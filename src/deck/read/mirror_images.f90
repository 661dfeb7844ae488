! SPDX-License-Identifier: MIT
!> Bodies that a plane of symmetry makes by itself.
!>
!> A deck may describe the whole scene and be run as a half or a quarter of it. A body that lies
!> wholly beyond a plane of symmetry and is the mirror image of another body of the deck is left
!> out then, with its gauges and interactions, since the plane stands for it.
module brz_mirror_images
    use brz_deck, only: add_warning, deck_t, entry_t, find_entry, group_label, group_t, move_group
    use brz_case, only: name_len
    use brz_get, only: get
    use brz_kinds, only: dp
    implicit none
    private
    public :: leave_out_images

contains

    !> Take the bodies out of the deck that are mirror images of others, with a warning for each.
    subroutine leave_out_images(deck, mirror)
        type(deck_t), intent(inout) :: deck
        logical, intent(in) :: mirror(3) !! planes of symmetry through the origin, normal to x, y, z
        integer :: g, original

        if (.not. any(mirror)) return
        do g = deck%n, 1, -1
            if (deck%groups(g)%name /= 'body' .or. deck%groups(g)%bad) cycle
            original = original_of(deck, mirror, g)
            if (original == 0) cycle
            call add_warning(deck, deck%groups(g)%line, group_label(deck%groups(g))// &
                             "is left out: the symmetry makes it from '"// &
                             deck%groups(original)%id//"'")
            call take_out(deck, g)
        end do
    end subroutine leave_out_images

    !> The body within the planes that a body beyond them is the image of; 0: none.
    integer function original_of(deck, mirror, g) result(original)
        type(deck_t), intent(in) :: deck
        logical, intent(in) :: mirror(3)
        integer, intent(in) :: g !! group of the body
        logical :: flip(3), hidden(3)

        original = 0
        flip = beyond(deck%groups(g))
        flip = flip .and. mirror
        if (.not. any(flip)) return
        do original = 1, deck%n
            if (deck%groups(original)%name /= 'body' .or. original == g) cycle
            hidden = beyond(deck%groups(original))
            if (any(hidden .and. mirror)) cycle
            if (is_image(deck%groups(g), deck%groups(original), flip)) return
        end do
        original = 0
    end function original_of

    !> For each axis: does a body lie wholly below the origin? Never, where its shape is in a file.
    function beyond(group)
        type(group_t), intent(in) :: group
        logical :: beyond(3)
        character(name_len) :: shape, axis
        real(dp) :: centre(3), half(3), length, box(6)

        shape = ''
        axis = 'z'
        centre = 0
        half = 0
        box = 1
        call get(group, 'shape', shape)
        call get(group, 'axis', axis)
        call get(group, 'centre', centre)
        call get(group, 'radius', half(1))
        half = half(1)
        if (shape == 'cylinder') then
            length = 0
            call get(group, 'length', length)
            half(index('xyz', trim(axis))) = length/2
        end if
        select case (shape)
        case ('sphere', 'cylinder')
            beyond = centre + half <= 0
        case default
            call get(group, 'box', box)
            beyond = box(2:6:2) <= 0
        end select
    end function beyond

    !> True if one body is the other, mirrored along some axes: every key but the id.
    pure logical function is_image(image, original, flip)
        type(group_t), intent(in) :: image, original
        logical, intent(in) :: flip(3) !! axes along which it is mirrored
        integer :: e, o

        is_image = image%n == original%n
        do e = 1, image%n
            if (.not. is_image) return
            if (image%entries(e)%key == 'id') cycle
            o = find_entry(original, trim(image%entries(e)%key))
            is_image = o > 0
            if (is_image) is_image = same(image%entries(e), original%entries(o), flip)
        end do
    end function is_image

    !> True if a key of the image says, mirrored, what that of the original says.
    pure logical function same(image, original, flip)
        type(entry_t), intent(in) :: image, original
        logical, intent(in) :: flip(3)
        real(dp) :: sign(3)
        integer :: i, d, low

        same = image%n == original%n .and. .not. (image%bad .or. original%bad)
        if (.not. same) return
        sign = merge(-1, 1, flip)
        do i = 1, image%n
            same = image%word(i)%s == original%word(i)%s
            if (.not. same) return
            d = mod(i - 1, 3) + 1
            select case (image%key)
            case ('centre', 'velocity', 'motion_velocity', 'spin_centre')
                same = near(image%number(i), sign(d)*original%number(i))
            case ('spin') ! an axial vector
                same = near(image%number(i), product(sign)*sign(d)*original%number(i))
            case ('box', 'fix_box', 'roller_box')
                d = mod((i - 1)/2, 3) + 1
                low = i - mod(i - 1, 2)
                if (flip(d)) then
                    same = near(image%number(i), -original%number(2*low + 1 - i))
                else
                    same = near(image%number(i), original%number(i))
                end if
            case ('fix', 'plies', 'move') ! faces and angles have images of their own
                same = image%default .and. original%default
            case default
                same = near(image%number(i), original%number(i))
            end select
            if (.not. same) return
        end do
    end function same

    !> Equal but for the last digits that a deck may lack.
    pure logical function near(a, b)
        real(dp), intent(in) :: a, b

        near = abs(a - b) <= 1e-12_dp*max(abs(a), abs(b))
    end function near

    !> Take a body out of the deck, with the gauges and interactions that name it.
    subroutine take_out(deck, g)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        character(:), allocatable :: id
        integer :: k, n
        logical :: out

        id = deck%groups(g)%id
        n = 0
        do k = 1, deck%n
            out = k == g
            if (any(deck%groups(k)%name == [character(6) :: 'gauge', 'load', 'motion'])) &
                out = names(deck%groups(k), 'body', id)
            if (deck%groups(k)%name == 'interaction') out = names(deck%groups(k), 'bodies', id)
            if (out) cycle
            n = n + 1
            if (n < k) call move_group(deck%groups(k), deck%groups(n))
        end do
        deck%n = n
    end subroutine take_out

    !> True if a key of a group names a body.
    pure logical function names(group, key, id)
        type(group_t), intent(in) :: group
        character(*), intent(in) :: key, id
        integer :: e, i

        names = .false.
        e = find_entry(group, key)
        if (e == 0) return
        do i = 1, size(group%entries(e)%word)
            names = names .or. group%entries(e)%word(i)%s == id
        end do
    end function names
end module brz_mirror_images
