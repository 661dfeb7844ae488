! SPDX-License-Identifier: MIT
!> Advice on single bodies: one that need not be deformable, one that is finer than its cracks need,
!> one with a thin round wall, one of two layers.
module brz_advice_bodies
    use brz_advice_text, only: millimetres, point_text, say_advice, say_more, time_text
    use brz_case, only: case_t, is_from_file, is_held_whole
    use brz_formulation_names, only: form_corrected_hourglass, form_rigid
    use brz_body_geometries, only: body_box
    use brz_kinds, only: dp, real32
    use brz_material, only: class_elastic, class_fluid, class_metal
    use brz_scene_size, only: count_text
    use brz_bodies, only: bodies_t
    use brz_text, only: to_text
    use brz_thin_bodies, only: is_bonded
    use brz_work, only: particle_seconds, work_t
    implicit none
    private
    public :: advise_rigid, advise_aspect, advise_cracks, advise_layers, advise_walls

    character(*), parameter :: axes = 'xyz'
    real(dp), parameter :: margin = 4 !! of the spacing at full strength over one that is advised
    real(dp), parameter :: wide = 3 !! particles over the spacing, as advised
    real(dp), parameter :: rows = 6 !! that are left across the thinnest side

contains

    !> A body every particle of which is held needs no stress.
    subroutine advise_rigid(case, work)
        type(case_t), intent(in) :: case
        type(work_t), intent(in) :: work
        real(dp) :: lo(3), hi(3)
        integer :: b, d, k

        d = case%run%dimension
        do b = 1, size(case%bodies)
            associate (body => case%bodies(b))
                if (body%formulation == 'rigid' .or. is_from_file(body)) cycle
                call body_box(body, lo, hi)
                do k = 1, body%n_fix_boxes
                    if (all(body%fix_box(1:2*d:2, k) <= lo(:d)) .and. &
                        all(body%fix_box(2:2*d:2, k) >= hi(:d))) then
                        call say_advice("'"//trim(body%id)//"' is fixed everywhere: with "// &
                            "formulation='rigid', fix='all' it stands as still")
                        call say_more('and saves '//time_text(particle_seconds(work, b))// &
                                      ' of one core ('//count_text(work%of_body(b))// &
                                      ' particles)')
                        exit
                    end if
                end do
            end associate
        end do
    end subroutine advise_rigid

    !> A thin plate alone that never breaks: wide particles bend as cubes do
    !> (docs/evidence/validation.md).
    subroutine advise_aspect(case, solid, work)
        type(case_t), intent(in) :: case
        class(bodies_t), intent(in) :: solid
        type(work_t), intent(in) :: work
        real(dp) :: lo(3), hi(3), side(3)
        integer :: a, layers
        real(dp), parameter :: thin = 10 !! least width over the thickness

        if (.not. allocated(solid%bodies)) return
        if (case%run%dimension < 3 .or. case%air%present .or. size(case%bodies) /= 1) return
        associate (input => case%bodies(1), body => solid%bodies(1), &
                   material => solid%materials(solid%bodies(1)%material))
            if (input%shape /= 'box' .or. any(input%aspect > 1) .or. input%n_plies > 0 .or. &
                material%fails /= 0 .or. body%formulation == form_rigid) return
            if (all(material%class /= [class_elastic, class_metal])) return
            call body_box(input, lo, hi)
            side = hi - lo
            a = minloc(side, 1)
            layers = nint(side(a)/input%spacing)
            side(a) = huge(side)
            if (layers < 3 .or. layers > 6 .or. minval(side) < thin*(hi(a) - lo(a))) return
            side = wide
            side(a) = 1
            call say_advice("'"//trim(input%id)//"' is a thin plate alone that never breaks: "// &
                            'aspect = '//point_text(side)//" (formulation =")
            call say_more("'total_lagrangian') bends it with 1/"//to_text(nint(wide**2))// &
                          ' of the particles, within 4 % up to deflections of')
            call say_more('several thicknesses, and saves '// &
                          time_text((1 - 1/wide**2)*particle_seconds(work, 1))//' of one core')
        end associate
    end subroutine advise_aspect

    !> A body with a fracture energy, of a spacing far below the largest at full strength, and of
    !> many rows: notched strips spend the same energy under the same load at twice the spacing
    !> (tests/python/test_cracks.py).
    subroutine advise_cracks(case, solid, work)
        type(case_t), intent(in) :: case
        class(bodies_t), intent(in) :: solid
        type(work_t), intent(in) :: work
        real(dp) :: lo(3), hi(3), most, most_of_cracks, thin
        integer :: b, d, times

        if (.not. allocated(solid%bodies)) return
        d = case%run%dimension
        do b = 1, size(case%bodies)
            associate (input => case%bodies(b), body => solid%bodies(b), &
                       material => solid%materials(solid%bodies(b)%material))
                if (.not. (material%crack > 0 .and. body%crack > 0)) cycle
                if (body%formulation == form_rigid .or. is_from_file(input)) cycle
                call body_box(input, lo, hi)
                thin = minval(hi(:d) - lo(:d))
                if (input%shape == 'cylinder' .and. input%inner_radius > 0) &
                    thin = min(thin, input%radius - input%inner_radius)
                most_of_cracks = body%spacing*material%crack/body%crack/margin
                most = min(most_of_cracks, thin/max(rows, real(input%n_plies, dp)))
                times = int(most/body%spacing + 1e-6_dp)
                if (times < 2) cycle
                call say_advice("the cracks of '"//trim(input%id)//"' cost the same up to a "// &
                                'spacing of '//millimetres(margin*most_of_cracks)//', it has '// &
                                millimetres(body%spacing)//': where cracks')
                call say_more('decide, '//millimetres(times*body%spacing)//' would do: '// &
                              time_text((1 - 1.0_dp/times**(d + 1))*particle_seconds(work, b))// &
                              ' of one core less')
                call say_more('('//count_text((1 - 1.0_dp/times**d)*work%of_body(b))// &
                              ' particles less, and longer steps: 1/'//to_text(times**(d + 1))// &
                              ' of the work of the body)')
            end associate
        end do
    end subroutine advise_cracks

    !> A pipe of metal of few layers: no gradient of it is tilted, and it bends too softly
    !> (docs/theory/plates.md).
    subroutine advise_walls(case, solid)
        type(case_t), intent(in) :: case
        class(bodies_t), intent(in) :: solid
        integer :: b, layers
        integer, parameter :: many = 8

        if (.not. allocated(solid%bodies)) return
        do b = 1, size(case%bodies)
            associate (input => case%bodies(b), body => solid%bodies(b))
                if (input%shape /= 'cylinder' .or. .not. input%inner_radius > 0) cycle
                if (input%layered) cycle
                layers = nint((input%radius - input%inner_radius)/input%spacing)
                if (layers > many .or. body%formulation /= form_corrected_hourglass .or. &
                    any(body%normal > 0)) cycle
                if (solid%materials(body%material)%class /= class_metal) cycle
                call say_advice("the wall of '"//trim(input%id)//"' has "//to_text(layers)// &
                                ' layers round an axis and bends too softly (a period 60 % too')
                call say_more("long with 3, 20 % with 5): lattice='layered' lays it round the axis")
            end associate
        end do
    end subroutine advise_walls

    !> A box of two layers that is three times as long: no layer lies within that could show the
    !> others how they bend. A cantilever of aluminium bends 2.7 times too far, with three 1.01.
    !> One of four layers that yields locks where it folds: a plastic hinge carries 1.39 of its load
    !> and rising, with 3, 5 and 6 layers 1.16 to 1.23.
    subroutine advise_layers(case, solid)
        type(case_t), intent(in) :: case
        class(bodies_t), intent(in) :: solid
        real(dp) :: lo(3), hi(3), side(3)
        integer :: a, b, d

        if (.not. allocated(solid%bodies)) return
        d = case%run%dimension
        do b = 1, size(case%bodies)
            associate (input => case%bodies(b), body => solid%bodies(b))
                if (input%shape /= 'box' .or. body%formulation /= form_corrected_hourglass) cycle
                if (solid%materials(body%material)%class == class_fluid) cycle
                if (is_held_whole(input) .or. is_bonded(case, b)) cycle
                call body_box(input, lo, hi)
                side = hi - lo
                where (case%run%symmetry .and. .not. lo > 0) side = 2*hi
                a = minloc(side(:d), 1)
                if (maxval(side(:d)) < 3*side(a)) cycle
                if (nint(side(a)/input%spacing) == 4 .and. &
                    solid%materials(body%material)%class == class_metal) then
                    call say_advice("'"//trim(input%id)//"' has four layers across "// &
                                    axes(a:a)//', which lock where it folds: a plastic hinge')
                    call say_more('carries 1.39 of its load and rising; 3, 5 or 6 layers '// &
                                  '1.16 to 1.23 (docs/theory/plates.md)')
                end if
                if (nint(side(a)/input%spacing) /= 2) cycle
                call say_advice("'"//trim(input%id)//"' has two layers across "//axes(a:a)// &
                                ' and bends 2.7 times too far:')
                call say_more('three bend right, with a spacing of '// &
                              millimetres(side(a)/3))
            end associate
        end do
    end subroutine advise_layers
end module brz_advice_bodies
