! SPDX-License-Identifier: MIT
!> Regions of a body whose velocity is prescribed, each by a motion of its own.
module brz_region_setup
    use brz_body, only: body_t
    use brz_body_start, only: in_box
    use brz_case, only: body_case_t, region_case_t
    use brz_errors, only: error_t, exit_deck, raise
    use brz_kinds, only: dp, int32, rk
    use brz_motion, only: motion_t, velocity_of
    use brz_particle_marks, only: is_free
    use brz_particles, only: particles_t
    use brz_support, only: driven_by, kept_along
    use brz_text, only: to_text
    implicit none
    private
    public :: set_up_regions

contains

    !> Mark the particles of all regions, which no support holds, and give them their velocity.
    subroutine set_up_regions(input, solid, body, err)
        type(body_case_t), intent(in) :: input
        class(particles_t), intent(inout) :: solid
        type(body_t), intent(inout) :: body
        type(error_t), intent(inout) :: err
        integer :: m

        if (.not. allocated(input%regions)) return
        allocate (body%regions(size(input%regions)))
        if (.not. allocated(solid%reaction_force)) allocate (solid%reaction_force(3, solid%n), &
            source=0.0_rk)
        do m = 1, size(input%regions)
            call set_up_region(input%regions, m, solid, body, err)
        end do
    end subroutine set_up_regions

    subroutine set_up_region(regions, m, solid, body, err)
        type(region_case_t), intent(in) :: regions(:)
        integer, intent(in) :: m
        class(particles_t), intent(inout) :: solid
        type(body_t), intent(inout) :: body
        type(error_t), intent(inout) :: err
        character(:), allocatable :: other
        real(dp) :: v(3)
        integer(int32) :: mark
        integer :: d, f, i

        associate (input => regions(m), motion => body%regions(m))
            motion%id = input%id
            motion%n = size(input%time)
            motion%time = input%time
            motion%v = input%velocity
            motion%along = input%along
            mark = driven_by(m)
            do d = 1, 3
                if (input%along(d)) mark = ior(mark, kept_along(d))
            end do
            v = velocity_of(motion, 0.0_dp)
            do i = body%first, body%last
                if (.not. any([(in_box(solid%x(:, i), input%box(:, f), solid%dimension), &
                                f=1, input%n_boxes)])) cycle
                if (solid%fixed(i) /= is_free) then
                    other = 'a support (fix, fix_box, roller_box) of the body'
                    do f = 1, m - 1
                        if (solid%fixed(i)/driven_by(1) == f) &
                            other = "&motion id='"//trim(regions(f)%id)//"'"
                    end do
                    call raise(err, exit_deck, input%place//"&motion id='"//trim(input%id)// &
                        "': its particle at "//to_text(solid%x(1, i))//', '// &
                        to_text(solid%x(2, i))//', '//to_text(solid%x(3, i))//' belongs to '// &
                        other//', too; make one of the regions smaller')
                    return
                end if
                solid%fixed(i) = mark
                motion%mass = motion%mass + solid%mass(i)
                where (motion%along) solid%v(:, i) = real(v, rk)
            end do
            if (.not. motion%mass > 0) call raise(err, exit_deck, input%place//"&motion id='"// &
                trim(input%id)//"': no particle of the body lies in its box; move it, or make "// &
                'it as thick as the spacing')
        end associate
    end subroutine set_up_region
end module brz_region_setup
