! SPDX-License-Identifier: MIT
!> The end of a step: particles with an impossible state, in words, and what all processes know.
module brz_solid_faults
    use brz_errors, only: error_t, exit_numerical, raise
    use brz_kinds, only: dp
    use brz_ranks, only: agree, several
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: report_bad, agree_on_step

contains

    !> Raise an error for the first particle with an impossible state.
    subroutine report_bad(solid, err)
        type(solid_t), intent(in) :: solid
        type(error_t), intent(inout) :: err
        character(400) :: text
        integer :: i, k

        if (all(solid%search%bad == 0)) return
        k = findloc(solid%search%bad > 0, .true., 1)
        i = solid%search%bad(k)
        write (text, '(a, i0, 3a, 3(es11.3), a, 3(es11.3), a, es11.3, a, 6(es11.3), a, i0, a)') &
            'particle ', solid%id(i), " of body '", trim(solid%bodies(solid%block(1, k))%id), &
            "' has an impossible state: at", solid%x(:, i), ' m, velocity', solid%v(:, i), &
            ' m/s, compression', solid%mu(i), ', stress', solid%stress(:, i), ' Pa, solid step ', &
            solid%steps, '; try a smaller cfl or another formulation for this body'
        call raise(err, exit_numerical, trim(text))
    end subroutine report_bad

    !> All processes have the same limits of the time step, and an error that one of them has.
    subroutine agree_on_step(solid, err)
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        real(dp) :: limit(0:size(solid%bodies))

        if (.not. several(solid%ranks)) return
        limit(0) = solid%dt_limit
        limit(1:) = solid%bodies%dt_limit
        call agree(solid%ranks, err, limit)
        solid%dt_limit = limit(0)
        solid%bodies%dt_limit = limit(1:)
    end subroutine agree_on_step
end module brz_solid_faults
