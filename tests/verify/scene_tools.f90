! SPDX-License-Identifier: MIT
!> Whole scenes from decks in tests/scenes, step by step, with the audit looked at after every step.
module scene_tools
    use brz_build_case, only: build_case
    use brz_deck, only: deck_t
    use brz_errors, only: error_t, failed
    use brz_key, only: key_t
    use brz_key_table, only: all_keys
    use brz_kinds, only: dp
    use brz_conservation_audit, only: audit_start_t, balance_t, audit_scene
    use brz_ranks, only: ranks_t
    use brz_scanner, only: read_deck
    use brz_simulation, only: simulation_t
    use brz_simulation_setup, only: set_up_simulation
    use brz_text, only: string_t
    use brz_time_step, only: advance
    use shared_steps, only: solid_totals, solid_totals_t
    implicit none
    private
    public :: deck_scene_t, open_scene, open_deck, step_scene, run_scene, body_of

    type :: deck_scene_t
        type(simulation_t) :: sim
        type(error_t) :: err
        type(balance_t) :: audit !! after the last step
        real(dp) :: momentum(3) = 0 !! of the bodies at the start [N s]
        real(dp) :: mass_error = 0, momentum_error = 0 !! of the air, the worst of all steps
        real(dp) :: stray = 0
        !! momentum of the bodies less what the air gave them, the worst of all steps [N s]
        real(dp) :: thrust = tiny(1.0_dp)
        !! mass of the bodies times the root mean square of their velocity, its largest [N s]
    end type deck_scene_t

contains

    !> Set a scene up. `changes` are settings as of --set, 'group.key=value', separated by blanks.
    subroutine open_scene(name, changes, scene, ranks)
        character(*), intent(in) :: name !! of the deck, without folder and ending
        character(*), intent(in) :: changes
        type(deck_scene_t), intent(out) :: scene
        type(ranks_t), intent(in), optional :: ranks !! the processes that share it

        call open_deck('tests/scenes/'//name//'.nml', changes, scene, ranks)
    end subroutine open_scene

    !> Set the scene of a deck up.
    subroutine open_deck(path, changes, scene, ranks)
        character(*), intent(in) :: path, changes
        type(deck_scene_t), intent(out) :: scene
        type(ranks_t), intent(in), optional :: ranks
        type(key_t), allocatable :: keys(:)
        type(deck_t) :: deck
        type(solid_totals_t) :: sums

        if (present(ranks)) scene%sim%ranks = ranks
        call all_keys(keys)
        call read_deck(path, keys, words(changes), deck, scene%err)
        call build_case(deck, keys, scene%sim%case, scene%err)
        if (failed(scene%err)) error stop scene%err%text
        call set_up_simulation(scene%sim, scene%err)
        if (failed(scene%err)) error stop scene%err%text
        if (scene%sim%solid%present) call solid_totals(scene%sim%solid, 0, sums)
        scene%momentum = sums%momentum
        call audit_scene(0.0_dp, scene%sim%backend, scene%sim%air, scene%sim%solid, &
            scene%sim%coupling, scene%sim%start, scene%audit, scene%err)
    end subroutine open_deck

    !> One step, and the diagnostics.
    subroutine step_scene(scene)
        type(deck_scene_t), intent(inout) :: scene
        type(solid_totals_t) :: sums

        associate (sim => scene%sim)
            call advance(sim, scene%err)
            if (failed(scene%err)) error stop scene%err%text
            call audit_scene(sim%clock%time, sim%backend, sim%air, sim%solid, sim%coupling, &
                sim%start, scene%audit, scene%err)
            if (sim%solid%present) call solid_totals(sim%solid, 0, sums)
            scene%mass_error = max(scene%mass_error, abs(scene%audit%mass_error))
            scene%momentum_error = max(scene%momentum_error, scene%audit%momentum_error)
            if (sim%solid%present) scene%stray = max(scene%stray, &
                norm2(sums%momentum - scene%momentum - sim%coupling%diagnostics%impulse))
            scene%thrust = max(scene%thrust, sqrt(2*sums%mass*sums%kinetic))
        end associate
    end subroutine step_scene

    !> Step until a time, or to the end of the deck.
    subroutine run_scene(scene, until)
        type(deck_scene_t), intent(inout) :: scene
        real(dp), intent(in), optional :: until !! [s]
        real(dp) :: t_end

        t_end = scene%sim%case%run%t_end
        if (present(until)) t_end = until
        do while (scene%sim%clock%time < t_end)
            call step_scene(scene)
        end do
    end subroutine run_scene

    !> Totals of the first body.
    type(solid_totals_t) function body_of(scene)
        type(deck_scene_t), intent(in) :: scene

        call solid_totals(scene%sim%solid, 1, body_of)
    end function body_of

    !> Words of a text as settings.
    pure function words(text) result(list)
        character(*), intent(in) :: text
        type(string_t), allocatable :: list(:)
        integer :: at, blank

        allocate (list(0))
        at = 1
        do while (at <= len_trim(text))
            blank = index(text(at:)//' ', ' ')
            if (blank > 1) list = [list, string_t(text(at:at + blank - 2))]
            at = at + blank
        end do
    end function words
end module scene_tools
