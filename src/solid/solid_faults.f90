! SPDX-License-Identifier: MIT
!> Particles with an impossible state, in words.
module brz_solid_faults
    use brz_errors, only: error_t, exit_numerical, raise
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: report_bad

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
end module brz_solid_faults
