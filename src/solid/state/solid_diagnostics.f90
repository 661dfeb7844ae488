! SPDX-License-Identifier: MIT
!> Accumulated diagnostics of bodies that several processes share: each process records
!> what its particles do.
module brz_solid_diagnostics
    use brz_energy_account, only: energy_account_t
    use brz_exact_sum, only: exact_sums
    use brz_formulation_names, only: form_rigid
    use brz_kinds, only: dp
    use brz_skin_level, only: lost_level
    use brz_ranks, only: several
    use brz_bodies, only: bodies_t
    use brz_listed_bodies, only: listed_bodies_t
    use brz_threads, only: worth_threads
    implicit none
    private
    public :: diagnostics_t, open_all_diagnostics, close_all_diagnostics, &
        keep_diagnostics_of_first, begin_kick
    public :: record_drag, record_work

    type(energy_account_t), parameter :: empty = energy_account_t()
    integer, parameter :: n_account = size(transfer(empty, [0.0_dp])) !! all components are real(dp)

    !> What this process has recorded itself.
    type :: diagnostics_t
        real(dp), allocatable :: own(:, :) !! (6 + energy account, bodies) reaction, drive, energy
                                           !! account
    end type diagnostics_t

contains

    !> Show the diagnostics of all processes together in `solid%bodies`, until they are closed.
    subroutine open_all_diagnostics(solid, diagnostics)
        class(bodies_t), intent(inout) :: solid
        type(diagnostics_t), intent(out) :: diagnostics
        real(dp) :: total((6 + n_account)*size(solid%bodies))
        real(dp) :: terms(6 + n_account, size(solid%bodies))
        integer :: b

        if (.not. several(solid%ranks)) return
        allocate (diagnostics%own(6 + n_account, size(solid%bodies)))
        call look(solid, diagnostics%own)
        terms = diagnostics%own
        do b = 1, size(solid%bodies) ! all processes know the force that drives a rigid body
            if (solid%bodies(b)%formulation == form_rigid .and. solid%ranks%rank > 0) &
                terms(4:6, b) = 0
        end do
        call exact_sums(solid%ranks, reshape(terms, [size(total), 1]), total)
        call write_down(solid, reshape(total, shape(diagnostics%own)))
    end subroutine open_all_diagnostics

    !> Room for what loop bodies record of particles; it is kept from one step to the next.
    subroutine begin_kick(solid)
        class(listed_bodies_t), intent(inout) :: solid
        integer :: n

        n = 0
        if (allocated(solid%load) .or. solid%links%present) n = size(solid%v, 2)
        if (allocated(solid%work)) then
            if (size(solid%work) < n) deallocate (solid%work)
        end if
        if (.not. allocated(solid%work)) allocate (solid%work(n), source=0.0_dp)
        if (.not. allocated(solid%moved)) allocate (solid%moved(lost_level, size(solid%bodies)))
        solid%moved = 0
    end subroutine begin_kick

    !> Record the work of the loads in a kick, block by block.
    subroutine record_work(solid)
        class(listed_bodies_t), intent(inout) :: solid
        integer :: i, k

        if (.not. allocated(solid%load)) return
        !$omp parallel do if(solid%n >= worth_threads) schedule(static) private(i)
        do k = 1, size(solid%block, 2)
            solid%search%sums(1, k) = 0
            do i = solid%block(2, k), solid%block(3, k)
                solid%search%sums(1, k) = solid%search%sums(1, k) + solid%work(i)
                solid%work(i) = 0
            end do
        end do
        do k = 1, size(solid%block, 2)
            associate (account => solid%bodies(solid%block(1, k))%account)
                account%load = account%load + solid%search%sums(1, k)
            end associate
        end do
    end subroutine record_work

    !> Record the heat of drag on body b, particle by particle.
    subroutine record_drag(solid, b)
        class(bodies_t), intent(inout) :: solid
        integer, intent(in) :: b
        integer :: i

        associate (body => solid%bodies(b))
            do i = body%first, body%last
                body%account%contact_heat = body%account%contact_heat + solid%work(i)
                solid%work(i) = 0
            end do
        end associate
    end subroutine record_drag

    !> Go back to those of this process alone.
    subroutine close_all_diagnostics(solid, diagnostics)
        class(bodies_t), intent(inout) :: solid
        type(diagnostics_t), intent(in) :: diagnostics

        if (allocated(diagnostics%own)) call write_down(solid, diagnostics%own)
    end subroutine close_all_diagnostics

    !> After a restart, which gives all processes the diagnostics of all: the first one keeps them.
    subroutine keep_diagnostics_of_first(solid)
        class(bodies_t), intent(inout) :: solid
        real(dp) :: nothing(6 + n_account, size(solid%bodies))
        integer :: b

        if (solid%ranks%rank == 0) return
        nothing = 0
        do b = 1, size(solid%bodies)
            if (solid%bodies(b)%formulation == form_rigid) &
                nothing(4:6, b) = solid%bodies(b)%motion%force
        end do
        call write_down(solid, nothing)
    end subroutine keep_diagnostics_of_first

    pure subroutine look(solid, diagnostics)
        class(bodies_t), intent(in) :: solid
        real(dp), intent(out) :: diagnostics(:, :) !! (6 + energy account, bodies)
        integer :: b

        do b = 1, size(solid%bodies)
            diagnostics(1:3, b) = solid%bodies(b)%reaction
            diagnostics(4:6, b) = solid%bodies(b)%motion%force
            diagnostics(7:, b) = transfer(solid%bodies(b)%account, diagnostics(7:, b))
        end do
    end subroutine look

    pure subroutine write_down(solid, diagnostics)
        class(bodies_t), intent(inout) :: solid
        real(dp), intent(in) :: diagnostics(:, :) !! (6 + energy account, bodies)
        integer :: b

        do b = 1, size(solid%bodies)
            solid%bodies(b)%reaction = diagnostics(1:3, b)
            solid%bodies(b)%motion%force = diagnostics(4:6, b)
            solid%bodies(b)%account = transfer(diagnostics(7:, b), empty)
        end do
    end subroutine write_down
end module brz_solid_diagnostics
