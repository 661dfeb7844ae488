! SPDX-License-Identifier: MIT
!> The end of a step: particles with an impossible state, in words, and what all processes know.
module brz_solid_faults
    use brz_errors, only: error_t, exit_numerical, raise
    use brz_kinds, only: dp, int64, rk
    use brz_skin_level, only: lost_level
    use brz_ranks, only: reduce_errors, several
    use brz_bodies, only: bodies_t
    use brz_listed_bodies, only: listed_bodies_t
    use brz_text, only: to_text
    implicit none
    private
    public :: report_bad, report_lost, agree_on_step

    real(rk), parameter :: large = 0.1_rk !! stress over the bulk modulus beyond that of most solids

contains

    !> Raise an error for the first particle with an impossible state.
    subroutine report_bad(solid, err)
        class(listed_bodies_t), intent(in) :: solid
        type(error_t), intent(inout) :: err
        character(600) :: text
        character(:), allocatable :: remedy
        integer :: i, k

        if (all(solid%search%bad == 0)) return
        k = findloc(solid%search%bad > 0, .true., 1)
        i = solid%search%bad(k)
        associate (material => solid%materials(solid%bodies(solid%block(1, k))%material))
            remedy = '; try a smaller cfl or another formulation for this body'
            if (maxval(abs(solid%stress(:3, i))) > large*material%bulk) remedy = remedy// &
                '. Its stress is a good part of its bulk modulus: if this is foam, take a law '// &
                'that crushes and hold its sides (docs/manual/materials.md, foam)'
        end associate
        write (text, '(a, i0, 3a, 3(es11.3), a, 3(es11.3), a, es11.3, a, 6(es11.3), a, i0, a)') &
            'particle ', solid%id(i), " of body '", trim(solid%bodies(solid%block(1, k))%id), &
            "' has an impossible state: at", solid%x(:, i), ' m, velocity', solid%v(:, i), &
            ' m/s, compression', solid%mu(i), ', stress', solid%stress(:, i), ' Pa, solid step ', &
            solid%steps, remedy
        call raise(err, exit_numerical, trim(text))
    end subroutine report_bad

    !> Raise an error for a body with a particle whose place is no number; in all processes, as all
    !> know the levels.
    subroutine report_lost(solid, level, err)
        class(bodies_t), intent(in) :: solid
        integer(int64), intent(in) :: level(:) !! (bodies) of motion, see brz_skin_level
        type(error_t), intent(inout) :: err
        integer :: b

        b = findloc(level == lost_level, .true., 1)
        if (b > 0) call raise(err, exit_numerical, "a particle of body '"// &
            trim(solid%bodies(b)%id)//"' has a place that is no number in solid step "// &
            to_text(solid%steps)//'; try a smaller cfl or another formulation for this body, '// &
            'and look at what loads it')
    end subroutine report_lost

    !> All processes have the same limits of the time step, and an error that one of them has.
    subroutine agree_on_step(solid, err)
        class(bodies_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        real(dp) :: limit(0:size(solid%bodies))

        if (.not. several(solid%ranks)) return
        limit(0) = solid%dt_limit
        limit(1:) = solid%bodies%dt_limit
        call reduce_errors(solid%ranks, err, limit)
        solid%dt_limit = limit(0)
        solid%bodies%dt_limit = limit(1:)
    end subroutine agree_on_step
end module brz_solid_faults
