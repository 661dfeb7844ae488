! SPDX-License-Identifier: MIT
!> What a run tells once, when a history row first shows it: particles that have left the region,
!> cells of gas that were held.
module brz_watch
    use, intrinsic :: iso_fortran_env, only: error_unit
    use brz_errors, only: error_t, exit_numerical, raise
    use brz_kinds, only: dp
    use brz_simulation, only: simulation_t
    use brz_text, only: to_text
    implicit none
    private
    public :: watch_region, watch_limited

contains

    !> Particles that have left the region: told once, and by the key `leave` the end of the run.
    subroutine watch_region(sim, mass, told, err)
        type(simulation_t), intent(inout) :: sim
        real(dp), intent(in) :: mass !! outside [kg]
        logical, intent(inout) :: told
        type(error_t), intent(inout) :: err
        character(:), allocatable :: text

        if (told .or. .not. mass > 0) return
        told = .true.
        text = to_text(mass)//' kg of particles have left the region of &solid at t = '// &
               to_text(sim%clock%time)//' s'
        if (sim%case%solid%leave == 'stop') then
            sim%intact = .true.
            call raise(err, exit_numerical, text)
        else if (sim%case%solid%leave == 'remove') then
            if (sim%clock%cycle == 0) then
                text = text//'; what is outside from the start stays, and later ones are taken out'
            else
                text = text//'; they are taken out'
            end if
            write (error_unit, '(a)') text//' (removed[kg] in energy.csv)'
        else
            write (error_unit, '(a)') text//'; they fly on and feel no air (outside[kg] in '// &
                'energy.csv)'
        end if
    end subroutine watch_region

    !> Cells of gas that even fluxes of first order would have emptied: told once.
    subroutine watch_limited(sim, cells, told)
        type(simulation_t), intent(in) :: sim
        real(dp), intent(in) :: cells !! held so far
        logical, intent(inout) :: told

        if (told .or. .not. cells > 0) return
        told = .true.
        write (error_unit, '(a)') 'warning: until t = '//to_text(sim%clock%time)//' s '// &
            to_text(nint(cells))//' cells of gas were limited for a stage, as no flux would '// &
            'have left density and pressure positive (limited_cells[-] in energy.csv); nothing '// &
            'is lost, but the gas is coarse there: a smaller cfl may help'
    end subroutine watch_limited
end module brz_watch
