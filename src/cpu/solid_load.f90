! SPDX-License-Identifier: MIT
!> Forces of the pressures on faces and of pushes on bodies, in scenes without air.
module brz_solid_load
    use brz_face_load, only: mean_pressures, pushes
    use brz_facet_loops, only: each_begin_load, each_load_carrier, each_place_particle, &
                               each_see_carrier, each_sum_load
    use brz_kinds, only: dp
    use brz_ranks, only: several
    use brz_solid_state, only: form_rigid, solid_t
    implicit none
    private
    public :: load_faces

contains

    !> Set the loads of all particles, of rigid bodies, and of the driven particles of others, to
    !> the mean pressures of the coming step: their impulses are exact.
    subroutine load_faces(solid, dt)
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        real(dp) :: a(3, size(solid%bodies))
        integer :: b

        if (.not. allocated(solid%loads%of)) return
        if (solid%loads%rebuilds /= solid%rebuilds) then ! lists were sorted
            if (several(solid%ranks)) then
                call place_all(solid)
            else
                call each_place_particle(solid%n, 1, 1, solid%id, solid%loads%place)
            end if
            solid%loads%rebuilds = int(solid%rebuilds)
        end if
        a = pushes(solid%loads, size(solid%bodies), solid%time, dt)
        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b))
                call each_begin_load(body%last - body%first + 1, body%first, 1, 3, a(1, b), &
                    a(2, b), a(3, b), solid%mass, solid%fixed, solid%load)
            end associate
        end do
        associate (f => solid%loads%facets)
            call each_load_carrier(f%carriers, 3, 1, 3, solid%time, dt, f%first, f%id, f%load, &
                f%beside, f%mirror, f%width, f%most, f%side, f%wave, &
                mean_pressures(solid%loads, solid%time, dt), solid%loads%place, solid%x, &
                solid%fixed, solid%load)
        end associate
        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b))
                if (body%formulation == form_rigid .or. body%motion%n > 0) &
                    call each_sum_load(body%last - body%first + 1, solid%ranks, body%first, &
                        merge(0, 1, body%formulation == form_rigid), 3, 1, 3, body%rigid%x(1), &
                        body%rigid%x(2), body%rigid%x(3), solid%x, solid%fixed, solid%load, &
                        body%rigid%load)
            end associate
        end do
    end subroutine load_faces

    !> Where particles and ghosts lie. A particle whose facets this process does not see as a whole
    !> is noted: the run must end.
    subroutine place_all(solid)
        type(solid_t), intent(inout) :: solid
        real(dp) :: lost
        integer :: b

        lost = 0
        associate (place => solid%loads%place, f => solid%loads%facets)
            place = 0
            do b = 1, size(solid%bodies)
                associate (body => solid%bodies(b))
                    call each_place_particle(body%last - body%first + 1, body%first, 1, solid%id, &
                                             place)
                    call each_place_particle(body%rim - body%last, body%last + 1, -1, solid%id, &
                                             place)
                end associate
            end do
            call each_see_carrier(f%carriers, f%first, f%id, f%beside, place, solid%fixed, lost)
        end associate
        if (lost > 0) solid%loads%lost = nint(lost)
    end subroutine place_all
end module brz_solid_load
