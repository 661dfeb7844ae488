! SPDX-License-Identifier: MIT
!> Ghost exchange of particles: fields on their way between processes, and the ghosts that they
!> fill.
!>
!> A ghost is what a process knows of a particle of another one. It has a place in the arrays behind
!> the particles of its body, and is never computed: what others need of it comes by message.
module brz_solid_ghosts
    use, intrinsic :: iso_c_binding, only: c_loc
    use brz_listed_bodies, only: listed_bodies_t
    use brz_hold_layout, only: control_stiffness
    use brz_kinds, only: rk
    use brz_link_layout, only: n_press
    use brz_message_exchange, only: message_exchange_t
    use brz_message_buffers, only: send_rows
    use brz_places, only: message_buffers_t
    use brz_ranks, only: ranks_t, several
    use brz_rows, only: rows_t
    use brz_solid_fields, only: field_t, fields_of, fields_t, is_double, is_single, memory_of
    use brz_solid_part, only: solid_part_t
    implicit none
    private
    public :: refresh_motion, refresh_rows, refresh_press, refresh_bonds, refresh_joined
    public :: send_ghosts
    public :: send_particles
    public :: all_of_it, of_a_checkpoint

    integer, parameter :: all_of_it = 1 !! the particle goes for good
    integer, parameter :: for_a_ghost = 2 !! what a ghost ever needs
    integer, parameter :: of_motion = 3 !! what pass 1 reads, and changes in a step
    integer, parameter :: of_rows = 4 !! what pass 1 writes and pass 2 reads
    integer, parameter :: of_a_checkpoint = 5 !! what a checkpoint holds
    integer, parameter :: of_linked_rows = 6 !! as of_rows, where bodies meet
    integer, parameter :: of_bonds = 7 !! which of them are whole
    integer, parameter :: of_interfaces = 8 !! which hold it

contains

    !> Fill the ghosts that are laid anew.
    subroutine send_ghosts(solid, part)
        class(listed_bodies_t), intent(inout) :: solid
        type(solid_part_t), intent(inout) :: part

        call refresh(solid, part, for_a_ghost)
    end subroutine send_ghosts

    !> Bring places, velocities, volumes and smoothing lengths of ghosts up to date.
    subroutine refresh_motion(solid, part)
        class(listed_bodies_t), intent(inout) :: solid
        type(solid_part_t), intent(inout) :: part

        if (several(solid%ranks)) call refresh(solid, part, of_motion)
    end subroutine refresh_motion

    !> Bring what pass 1 has left of ghosts up to date; what of a body is held counts on both sides.
    subroutine refresh_rows(solid, part)
        class(listed_bodies_t), intent(inout) :: solid
        type(solid_part_t), intent(inout) :: part
        integer :: b

        if (.not. several(solid%ranks)) return
        call refresh(solid, part, merge(of_linked_rows, of_rows, solid%links%present))
        if (.not. allocated(solid%control)) return
        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b))
                if (.not. body%tensile_control > 0) cycle ! what lies in its rows means nothing
                body%in_tension = body%in_tension .or. any(solid%control(control_stiffness, &
                                                            body%last + 1:body%rim) > 0)
            end associate
        end do
    end subroutine refresh_rows

    !> Bring the bonds of ghosts up to date.
    subroutine refresh_bonds(solid, part)
        class(listed_bodies_t), intent(inout) :: solid
        type(solid_part_t), intent(inout) :: part

        if (several(solid%ranks) .and. solid%links%bonds) call refresh(solid, part, of_bonds)
    end subroutine refresh_bonds

    !> Bring up to date which cohesive interfaces hold ghosts.
    subroutine refresh_joined(solid, part)
        class(listed_bodies_t), intent(inout) :: solid
        type(solid_part_t), intent(inout) :: part

        if (several(solid%ranks)) call refresh(solid, part, of_interfaces)
    end subroutine refresh_joined

    !> Bring the pressures of contact of ghosts up to date: those of rows, not of places. Row 0, of
    !> what has no links, is nil.
    subroutine refresh_press(solid, part)
        class(listed_bodies_t), intent(inout), target :: solid
        type(solid_part_t), intent(inout) :: part
        type(fields_t) :: fields
        type(message_buffers_t) :: out, in

        if (.not. several(solid%ranks)) return
        fields%n = 1
        fields%particles = size(solid%links%press, 2)
        fields%of(1) = field_t('press', merge(is_double, is_single, storage_size(1.0_rk) == 64), &
                               n_press, values=c_loc(solid%links%press))
        associate (n => solid%ranks%n)
            out = message_buffers_t(solid%links%row(part%out%place(:part%out%first(n) - 1)) + 1, &
                            part%out%first)
            in = message_buffers_t(solid%links%row(part%in%place(:part%in%first(n) - 1)) + 1, &
                part%in%first)
        end associate
        call send_particles(solid%ranks, of_linked_rows, fields, out, fields, in, &
            part%exchange)
    end subroutine refresh_press

    subroutine refresh(solid, part, what)
        class(listed_bodies_t), intent(inout), target :: solid
        type(solid_part_t), intent(inout) :: part
        integer, intent(in) :: what
        type(fields_t) :: fields

        call fields_of(solid, fields)
        call send_particles(solid%ranks, what, fields, part%out, fields, part%in, part%exchange)
    end subroutine refresh

    !> Send fields of particles to other processes. `from` and `to` have the same fields of those
    !> that are sent.
    subroutine send_particles(ranks, what, from, out, to, in, exchange)
        type(ranks_t), intent(in) :: ranks
        integer, intent(in) :: what !! all_of_it, ...
        type(fields_t), intent(in) :: from, to
        type(message_buffers_t), intent(in) :: out, in
        type(message_exchange_t), intent(inout) :: exchange
        type(rows_t) :: rows(from%n), rows_to(to%n)
        integer :: n, n_to

        call find_rows(from, what, n, rows)
        call find_rows(to, what, n_to, rows_to)
        call send_rows(ranks, out, in, rows(:n), rows_to(:n_to), exchange)
    end subroutine send_particles

    !> The fields of a message as rows.
    pure subroutine find_rows(fields, what, n, rows)
        type(fields_t), intent(in) :: fields
        integer, intent(in) :: what
        integer, intent(out) :: n
        type(rows_t), intent(out) :: rows(:)
        integer :: k

        n = 0
        do k = 1, fields%n
            if (.not. is_sent(fields%of(k), what)) cycle
            n = n + 1
            rows(n) = rows_t(fields%of(k)%values, memory_of(fields%of(k)))
        end do
    end subroutine find_rows

    !> True for the fields of a message.
    elemental logical function is_sent(field, what)
        type(field_t), intent(in) :: field
        integer, intent(in) :: what

        is_sent = .false.
        if (field%rows == 0) return
        select case (what)
        case (all_of_it)
            is_sent = field%sorted
        case (for_a_ghost)
            is_sent = field%sorted .and. .not. any(field%name == [character(16) :: 'a', 'energy', &
                'hist', 'support', 'owed', 'load', 'face_stress', 'v_before', 'joined'])
        case (of_motion)
            is_sent = any(field%name == [character(16) :: 'x', 'v', 'volume', 'h'])
        case (of_a_checkpoint)
            is_sent = field%kept .or. field%name == 'v_before'
        case (of_rows)
            is_sent = any(field%name == [character(16) :: 'pair', 'k_axes', 'held'])
        case (of_bonds)
            is_sent = field%name == 'bond'
        case (of_interfaces)
            is_sent = field%name == 'joined'
        case default
            is_sent = any(field%name == [character(16) :: 'pair', 'k_axes', 'held', 'stress', &
                                         'press', 'contact_face'])
        end select
    end function is_sent
end module brz_solid_ghosts
