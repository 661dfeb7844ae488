! SPDX-License-Identifier: MIT
!> The fields of the particles: one table. Allocation, sorting, checkpoints, the way to a GPU and
!> back, and tests walk it, so that a new field is one line.
module brz_solid_fields
    use, intrinsic :: iso_c_binding, only: c_f_pointer, c_loc, c_null_ptr, c_ptr
    use brz_bond_marks, only: bond_none
    use brz_face_layout, only: face_edge, n_face
    use brz_formulation_names, only: form_total
    use brz_hold_layout, only: n_control
    use brz_kinds, only: int16, int32, int64, int8, real32, real64, rk
    use brz_pair_layout, only: n_pair
    use brz_resize, only: resize
    use brz_solid_columns, only: at_accel, at_damage, at_energy, at_hist, at_mass, at_mu, &
        at_stress, tag_bond, tag_unsupported, tag_fixed, tag_id, tag_joined, tag_ply, tag_support, &
        tag_face, tag_touch, tag_weight
    use brz_listed_bodies, only: listed_bodies_t
    implicit none
    private
    public :: field_t, fields_t, fields_of, make_fields, resize_fields, memory_of, column_of_field
    public :: numbers_of
    public :: is_double, is_single, is_integer, is_short
    public :: nowhere, in_place, in_reference, in_built, in_motion, in_state, in_tag

    integer, parameter :: is_double = 1, is_single = 2, is_integer = 3, is_short = 4, is_byte = 5
    integer, parameter :: bytes_of(5) = [8, 4, 4, 2, 1]
    integer, parameter :: most_fields = 40

    ! where a field lies on a GPU: rows of four numbers, columns
    integer, parameter :: nowhere = 0, in_place = 1, in_reference = 2, in_built = 3, in_motion = 4
    integer, parameter :: in_state = 5, in_tag = 6
    integer, parameter :: next = 0 !! the first column of `state` that is free

    !> One field, an array (n) or (rows, n).
    type :: field_t
        character(16) :: name = '' !! also in a checkpoint
        integer :: kind = is_double !! is_double, ...
        integer :: rows = 1 !! numbers of a particle
        logical :: flat = .false. !! an array (n)
        integer :: lies = nowhere, at = 0 !! on a GPU: where, and its first row or column there
        logical :: sorted = .true. !! goes with its particle
        logical :: kept = .true. !! in a checkpoint
        type(c_ptr) :: values = c_null_ptr
    end type field_t

    type :: fields_t
        integer :: n = 0
        integer :: particles = 0
        integer :: columns = at_hist !! of `state`
        logical :: make = .false. !! allocate what is wanted
        logical :: kept_alone = .false. !! but only what a checkpoint holds
        integer :: room = 0 !! particles that arrays get room for, 0: they keep theirs
        type(field_t) :: of(most_fields)
    end type fields_t

    !> Note a field, if it is there.
    interface see
        module procedure see_doubles, see_singles, see_double, see_single, see_integer, see_short, &
            see_byte
    end interface see

contains

    !> The fields that are there. Valid until one of them is allocated anew.
    subroutine fields_of(solid, fields)
        class(listed_bodies_t), intent(inout), target :: solid
        type(fields_t), intent(out) :: fields

        call walk(solid, fields)
    end subroutine fields_of

    !> Allocate what solid%n particles with solid%n_hist history variables need; bodies must be
    !> known. Numbers are 0, weights of contact 1.
    subroutine make_fields(solid, kept_alone)
        class(listed_bodies_t), intent(inout), target :: solid
        logical, intent(in), optional :: kept_alone !! only what a checkpoint holds
        type(fields_t) :: fields

        fields%make = .true.
        if (present(kept_alone)) fields%kept_alone = kept_alone
        call walk(solid, fields)
        allocate (solid%h(merge(solid%n, 0, any(solid%bodies%variable))))
        solid%h = 0
        if (.not. solid%links%present) return
        solid%links%touch = 1
        solid%links%face(face_edge, :) = 1
        solid%links%weight = 1
        solid%links%bond = bond_none
    end subroutine make_fields

    !> Give the arrays room for so many particles, with what they hold of the first ones.
    subroutine resize_fields(solid, room)
        class(listed_bodies_t), intent(inout), target :: solid
        integer, intent(in) :: room
        type(fields_t) :: fields

        fields%room = room
        call walk(solid, fields)
    end subroutine resize_fields

    !> The table. Arguments of a line: name, array, rows, if it is to be allocated, where it lies.
    subroutine walk(s, t)
        class(listed_bodies_t), intent(inout), target :: s
        type(fields_t), intent(inout) :: t
        logical :: tilted, control, linked
        integer :: b

        linked = s%links%present
        control = any(s%bodies%tensile_control > 0)
        tilted = any([(any(s%bodies(b)%normal > 0), b=1, size(s%bodies))])
        t%particles = s%n
        t%columns = at_hist + s%n_hist
        call see(t, 'x', s%x, 3, .true., in_place, 1)
        call see(t, 'x_ref', s%x_ref, 3, .true., in_reference, 1)
        call see(t, 'x_built', s%x_built, 3, .true., in_built, 1)
        call see(t, 'v', s%v, 3, .true., in_motion, 1)
        call see(t, 'a', s%a, 3, .true., in_state, at_accel + 1)
        call see(t, 'mass', s%mass, .true., in_state, at_mass)
        call see(t, 'mu', s%mu, .true., in_state, at_mu)
        call see(t, 'energy', s%energy, .true., in_state, at_energy)
        call see(t, 'stress', s%stress, 6, .true., in_state, at_stress + 1)
        call see(t, 'hist', s%hist, s%n_hist, .true., in_state, at_hist + 1)
        call see(t, 'damage', s%damage, .true., in_state, at_damage)
        if (any(s%bodies%formulation == form_total)) then ! it is that of the set-up
            call see(t, 'volume', s%volume, .true., in_motion, 4)
        else
            call see(t, 'volume', s%volume, .true., in_motion, 4, derived=.true.)
        end if
        call see(t, 'h', s%h, .false., in_place, 4, derived=.true.)
        call see(t, 'tilt', s%tilt, tilted, in_reference, 4)
        call see(t, 'id', s%id, .true., in_tag, tag_id)
        call see(t, 'ply', s%ply, .true., in_tag, tag_ply)
        call see(t, 'support', s%support, .true., in_tag, tag_support)
        call see(t, 'fixed', s%fixed, .true., in_tag, tag_fixed)
        call see(t, 'limp', s%unsupported, .true., in_tag, tag_unsupported)
        call see(t, 'touch', s%links%touch, linked, in_tag, tag_touch)
        call see(t, 'contact_weight', s%links%weight, linked, in_tag, tag_weight)
        call see(t, 'bond', s%links%bond, linked, in_tag, tag_bond)
        call see(t, 'joined', s%links%joined, .false., in_tag, tag_joined, derived=.true.)
        call see(t, 'contact_face', s%links%face, n_face, linked, in_tag, tag_face)
        call see(t, 'owed', s%control_due, control, in_state, next)
        call see(t, 'load', s%load, 3, .false., in_state, next)
        if (allocated(s%loads%of)) then ! each step finds it anew
            call see(t, 'face_stress', s%face_stress, 6, .false., in_state, next, derived=.true.)
        else
            call see(t, 'face_stress', s%face_stress, 6, .false., in_state, next)
        end if
        call see(t, 'v_before', s%v_before, 3, .false., in_state, next, derived=.true.)
        call see(t, 'grip', s%reaction_force, 3, .false., in_state, next, derived=.true.)
        call see(t, 'pair', s%pair, n_pair, .true., nowhere, 0, derived=.true.)
        call see(t, 'k_axes', s%k_axes, 6, any(s%bodies%directional), nowhere, 0, derived=.true.)
        call see(t, 'held', s%control, n_control, control, nowhere, 0, derived=.true.)
    end subroutine walk

    !> True where a field is to be allocated.
    pure logical function makes(t, wanted, derived)
        type(fields_t), intent(in) :: t
        logical, intent(in) :: wanted
        logical, intent(in), optional :: derived !! not part of a checkpoint

        makes = t%make .and. wanted .and. .not. (t%kept_alone .and. present(derived))
    end function makes

    !> Add a line to the table.
    subroutine note(t, field, values, derived)
        type(fields_t), intent(inout) :: t
        type(field_t), intent(in) :: field
        type(c_ptr), intent(in) :: values
        logical, intent(in), optional :: derived !! not part of a checkpoint

        t%n = t%n + 1
        t%of(t%n) = field
        t%of(t%n)%values = values
        if (present(derived)) t%of(t%n)%kept = .false.
        if (field%lies == nowhere) t%of(t%n)%sorted = .false.
        if (field%lies /= in_state .or. field%at /= next) return
        t%of(t%n)%at = t%columns + 1
        t%columns = t%columns + field%rows
    end subroutine note

    subroutine see_doubles(t, name, a, rows, wanted, lies, at, derived)
        type(fields_t), intent(inout) :: t
        character(*), intent(in) :: name
        real(real64), allocatable, target, intent(inout) :: a(:, :)
        integer, intent(in) :: rows, lies, at
        logical, intent(in) :: wanted
        logical, intent(in), optional :: derived

        if (makes(t, wanted, derived)) then
            allocate (a(rows, t%particles))
            call clear(c_loc(a), int(8*rows, int64)*t%particles)
        end if
        if (.not. allocated(a)) return
        if (t%room > 0) call resize(a, t%room)
        call note(t, field_t(name, is_double, rows, .false., lies, at), c_loc(a), derived)
    end subroutine see_doubles

    subroutine see_singles(t, name, a, rows, wanted, lies, at, derived)
        type(fields_t), intent(inout) :: t
        character(*), intent(in) :: name
        real(real32), allocatable, target, intent(inout) :: a(:, :)
        integer, intent(in) :: rows, lies, at
        logical, intent(in) :: wanted
        logical, intent(in), optional :: derived

        if (makes(t, wanted, derived)) then
            allocate (a(rows, t%particles))
            call clear(c_loc(a), int(4*rows, int64)*t%particles)
        end if
        if (.not. allocated(a)) return
        if (t%room > 0) call resize(a, t%room)
        call note(t, field_t(name, is_single, rows, .false., lies, at), c_loc(a), derived)
    end subroutine see_singles

    subroutine see_double(t, name, a, wanted, lies, at, derived)
        type(fields_t), intent(inout) :: t
        character(*), intent(in) :: name
        real(real64), allocatable, target, intent(inout) :: a(:)
        integer, intent(in) :: lies, at
        logical, intent(in) :: wanted
        logical, intent(in), optional :: derived

        if (makes(t, wanted, derived)) then
            allocate (a(t%particles))
            call clear(c_loc(a), int(8, int64)*t%particles)
        end if
        if (.not. allocated(a)) return
        if (t%room > 0) call resize(a, t%room)
        if (size(a) > 0) call note(t, field_t(name, is_double, 1, .true., lies, at), c_loc(a), &
                                   derived)
    end subroutine see_double

    subroutine see_single(t, name, a, wanted, lies, at, derived)
        type(fields_t), intent(inout) :: t
        character(*), intent(in) :: name
        real(real32), allocatable, target, intent(inout) :: a(:)
        integer, intent(in) :: lies, at
        logical, intent(in) :: wanted
        logical, intent(in), optional :: derived

        if (makes(t, wanted, derived)) then
            allocate (a(t%particles))
            call clear(c_loc(a), int(4, int64)*t%particles)
        end if
        if (.not. allocated(a)) return
        if (t%room > 0) call resize(a, t%room)
        if (size(a) > 0) call note(t, field_t(name, is_single, 1, .true., lies, at), c_loc(a), &
                                   derived)
    end subroutine see_single

    subroutine see_integer(t, name, a, wanted, lies, at, derived)
        type(fields_t), intent(inout) :: t
        character(*), intent(in) :: name
        integer(int32), allocatable, target, intent(inout) :: a(:)
        integer, intent(in) :: lies, at
        logical, intent(in) :: wanted
        logical, intent(in), optional :: derived

        if (makes(t, wanted, derived)) then
            allocate (a(t%particles))
            call clear(c_loc(a), int(4, int64)*t%particles)
        end if
        if (.not. allocated(a)) return
        if (t%room > 0) call resize(a, t%room)
        call note(t, field_t(name, is_integer, 1, .true., lies, at), c_loc(a), derived)
    end subroutine see_integer

    subroutine see_short(t, name, a, wanted, lies, at, derived)
        type(fields_t), intent(inout) :: t
        character(*), intent(in) :: name
        integer(int16), allocatable, target, intent(inout) :: a(:)
        integer, intent(in) :: lies, at
        logical, intent(in) :: wanted
        logical, intent(in), optional :: derived

        if (makes(t, wanted, derived)) then
            allocate (a(t%particles))
            call clear(c_loc(a), int(2, int64)*t%particles)
        end if
        if (.not. allocated(a)) return
        if (t%room > 0) call resize(a, t%room)
        call note(t, field_t(name, is_short, 1, .true., lies, at), c_loc(a), derived)
    end subroutine see_short

    subroutine see_byte(t, name, a, wanted, lies, at, derived)
        type(fields_t), intent(inout) :: t
        character(*), intent(in) :: name
        integer(int8), allocatable, target, intent(inout) :: a(:)
        integer, intent(in) :: lies, at
        logical, intent(in) :: wanted
        logical, intent(in), optional :: derived

        if (makes(t, wanted, derived)) then
            allocate (a(t%particles))
            call clear(c_loc(a), int(1, int64)*t%particles)
        end if
        if (.not. allocated(a)) return
        if (t%room > 0) call resize(a, t%room)
        call note(t, field_t(name, is_byte, 1, .true., lies, at), c_loc(a), derived)
    end subroutine see_byte

    !> Fill new memory with zeros, each thread the part that it will work on.
    subroutine clear(memory, bytes)
        type(c_ptr), intent(in) :: memory
        integer(int64), intent(in) :: bytes
        integer(int64), parameter :: piece = 2_int64**20
        integer(int8), pointer :: byte(:)
        integer(int64) :: k

        call c_f_pointer(memory, byte, [bytes])
        !$omp parallel do if(bytes > piece) schedule(static)
        do k = 1, bytes, piece
            byte(k:min(k + piece - 1, bytes)) = 0_int8
        end do
    end subroutine clear

    !> Bytes of a field for each particle.
    elemental integer function memory_of(field) result(bytes)
        type(field_t), intent(in) :: field

        bytes = field%rows*bytes_of(field%kind)
    end function memory_of

    !> First column of a field on a GPU, 0: it is not there.
    pure integer function column_of_field(fields, name) result(column)
        type(fields_t), intent(in) :: fields
        character(*), intent(in) :: name
        integer :: k

        column = 0
        do k = 1, fields%n
            if (fields%of(k)%name == name) column = fields%of(k)%at
        end do
    end function column_of_field

    !> A field as real64, whatever its kind: (rows, n).
    function numbers_of(field, n) result(x)
        type(field_t), intent(in) :: field
        integer, intent(in) :: n
        real(real64), allocatable :: x(:, :)
        real(real64), pointer :: double(:, :)
        real(real32), pointer :: single(:, :)
        integer(int32), pointer :: number(:, :)
        integer(int16), pointer :: short(:, :)
        integer(int8), pointer :: byte(:, :)

        allocate (x(field%rows, n))
        select case (field%kind)
        case (is_double)
            call c_f_pointer(field%values, double, [field%rows, n])
            x = double
        case (is_single)
            call c_f_pointer(field%values, single, [field%rows, n])
            x = single
        case (is_integer)
            call c_f_pointer(field%values, number, [field%rows, n])
            x = number
        case (is_short)
            call c_f_pointer(field%values, short, [field%rows, n])
            x = short
        case default
            call c_f_pointer(field%values, byte, [field%rows, n])
            x = byte
        end select
    end function numbers_of
end module brz_solid_fields
