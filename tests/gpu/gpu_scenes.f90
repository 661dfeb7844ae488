! SPDX-License-Identifier: MIT
!> Solids from the text of a deck, for tests of the GPU, which may run far from the sources.
module gpu_scenes
    use, intrinsic :: iso_c_binding, only: c_int
    use brz_body_setup, only: set_up_solid
    use brz_build_case, only: build_case
    use brz_case, only: case_t
    use brz_deck, only: deck_t
    use brz_errors, only: error_t, failed
    use brz_key, only: key_t
    use brz_key_table, only: all_keys
    use brz_kinds, only: rk
    use brz_scanner, only: read_deck
    use brz_particles, only: particles_t
    use brz_solid_state, only: solid_t
    use brz_solid_start, only: start_solid
    use brz_text, only: string_t, to_text
    implicit none
    private
    public :: make_solid

    interface
        integer(c_int) function c_getpid() bind(c, name='getpid')
            import :: c_int
        end function c_getpid
    end interface

contains

    !> The solids of a deck at their start. Groups end with ' /'; &run may be left out.
    subroutine make_solid(text, solid, speed, inactive)
        character(*), intent(in) :: text
        type(solid_t), intent(out) :: solid
        real(rk), intent(in), optional :: speed !! of a random velocity for every particle [m/s]
        logical, intent(in), optional :: inactive !! leave out what a large scene takes long for
        character(:), allocatable :: path
        type(key_t), allocatable :: keys(:)
        type(deck_t) :: deck
        type(case_t) :: case
        type(error_t) :: err
        integer :: unit, at, next

        path = 'gpu_scene_'//to_text(int(c_getpid()))//'.nml' ! runs beside each other
        open (newunit=unit, file=path, status='replace', action='write')
        if (index(text, '&run') == 0) write (unit, '(a)') '&run t_end=1 /'
        at = 1
        do while (at <= len_trim(text))
            next = at + index(text(at:), ' /')
            write (unit, '(a)') text(at:next)
            at = next + 1
        end do
        close (unit)
        call all_keys(keys)
        call read_deck(path, keys, [string_t ::], deck, err)
        call build_case(deck, keys, case, err)
        if (.not. failed(err)) call set_up_solid(case, solid, err)
        if (.not. failed(err) .and. present(speed)) call stir(solid, speed)
        if (present(inactive)) then
            solid%x_built = solid%x
            solid%volume = solid%mass/solid%materials(1)%density
        else if (.not. failed(err)) then
            call start_solid(solid, err)
        end if
        if (failed(err)) then
            print '(a)', err%text
            error stop 1
        end if
        open (newunit=unit, file=path, status='old')
        close (unit, status='delete')
    end subroutine make_solid
    !> Give every particle a velocity of its own.
    subroutine stir(solid, speed)
        class(particles_t), intent(inout) :: solid
        real(rk), intent(in) :: speed !! [m/s]
        integer, allocatable :: seed(:)
        real(rk) :: x(3)
        integer :: i, n

        call random_seed(size=n)
        allocate (seed(n))
        seed = [(17*i, i=1, n)]
        call random_seed(put=seed)
        do i = 1, solid%n
            call random_number(x)
            if (solid%fixed(i) == 0) solid%v(:, i) = solid%v(:, i) + speed*(2*x - 1)
        end do
    end subroutine stir
end module gpu_scenes
