! SPDX-License-Identifier: MIT
!> What `--check` says would be cheaper with the same answer, or what an answer would cost: planes
!> of symmetry, a start in fewer dimensions, a load by curves in place of air, a body that need not
!> be deformable, one gas in place of two, a box of air that is too small or larger than the blast
!> comes in the run's time.
module brz_advice
    use brz_advice_air, only: advise_one_gas, advise_still
    use brz_advice_bodies, only: advise_aspect, advise_cracks, advise_layers, advise_rigid, &
        advise_walls
    use brz_advice_start, only: advise_start
    use brz_advice_text, only: length_text, point_text, say_advice, say_more, time_text
    use brz_case, only: body_case_t, case_t, charge_case_t, is_from_file
    use brz_body_geometries, only: body_box
    use brz_early, only: early_t
    use brz_kinds, only: dp, real32
    use brz_kingery_bulmash, only: blast_t, farthest, free_air_blast
    use brz_mirror_planes, only: mirror_planes
    use brz_scene_size, only: count_text
    use brz_bodies, only: bodies_t
    use brz_text, only: to_text
    use brz_work, only: core_seconds, work_t
    implicit none
    private
    public :: print_advice

    real(dp), parameter :: nearest_load = 0.4_dp !! scaled distance of a load by curves [m/kg^(1/3)]
    real(dp), parameter :: sound = 340, ambient = 101325 !! undisturbed air [m/s], [Pa]
    real(dp), parameter :: square_on = 0.866_dp !! cosine of 30 degrees
    real(dp), parameter :: some = 0.02_dp !! share of a box that is worth a line

contains

    !> All advice for a scene, a line each.
    subroutine print_advice(case, solid, work, early)
        type(case_t), intent(in) :: case
        class(bodies_t), intent(in) :: solid !! its bodies and materials
        type(work_t), intent(in) :: work
        type(early_t), intent(in) :: early !! a blast before the run, if it is known

        call advise_planes(case, work)
        call advise_start(case, core_seconds(work))
        call advise_load(case, work)
        call advise_rigid(case, work)
        call advise_still(case, solid, work)
        call advise_one_gas(case, early, work)
        call advise_cracks(case, solid, work)
        call advise_walls(case, solid)
        call advise_layers(case, solid)
        call advise_aspect(case, solid, work)
        call advise_box(case, work)
    end subroutine print_advice

    !> A scene that is its own mirror image.
    subroutine advise_planes(case, work)
        type(case_t), intent(in) :: case
        type(work_t), intent(in) :: work
        character(7), parameter :: parts(3) = ['half   ', 'quarter', 'eighth ']
        character(:), allocatable :: keys, names
        logical :: plane(3)
        real(dp) :: less
        integer :: a

        plane = mirror_planes(case)
        if (.not. any(plane)) return
        keys = ''
        names = ''
        do a = 1, 3
            if (.not. plane(a)) cycle
            if (keys /= '') keys = keys//', '
            if (names /= '') names = names//', '
            keys = keys//"'"//'xyz' (a:a)//"'"
            names = names//'xyz' (a:a)//' = 0'
        end do
        less = 1 - 0.5_dp**count(plane)
        call say_advice('the scene is its own mirror image in '//names//': with symmetry = '//keys)
        call say_more('in &run'//trim(merge(' and the box of &air from 0', &
                                            '                           ', case%air%present))// &
                      ' it is run as a '//trim(parts(count(plane)))//': '// &
                      count_text(less*(work%cells + work%particles))// &
                      ' cells and particles less, '//time_text(less*core_seconds(work))// &
                      ' of one core')
    end subroutine advise_planes

    !> A sphere of TNT in front of one face of a box: the curves may do in place of the air.
    subroutine advise_load(case, work)
        type(case_t), intent(in) :: case
        type(work_t), intent(in) :: work
        character(:), allocatable :: face
        type(work_t) :: without
        real(dp) :: distance, scaled
        integer :: target

        if (.not. case%coupling%present .or. size(case%charges) /= 1 .or. &
            size(case%gas) + size(case%inflows) > 0) return
        if (case%run%dimension < 3 .or. any(case%air%bc == 'wall')) return
        associate (charge => case%charges(1))
            if (charge%shape /= 'sphere' .or. charge%explosive /= 'tnt') return
            call find_face(case, charge%at, target, face, distance)
            if (target == 0) return
            scaled = distance/charge%mass**(1/3.0_dp)
            if (scaled < nearest_load .or. scaled > farthest) return
            without = work
            without%cells = 0
            call say_advice("if what counts is the first pulse on face "//face//" of '"// &
                            trim(case%bodies(target)%id)//"', a load by the curves of")
            call say_more("Kingery and Bulmash does in place of &air and &charge: &load id='"// &
                          trim(charge%id)//"', body='"//trim(case%bodies(target)%id)//"',")
            call say_more("faces='"//face//"', "//mass_keys(charge)//', at='// &
                          point_text(charge%at)//' / saves '// &
                          time_text(core_seconds(work) - core_seconds(without))//' of one core')
        end associate
    end subroutine advise_load

    !> The mass of a charge as the keys of a deck.
    function mass_keys(charge) result(text)
        type(charge_case_t), intent(in) :: charge
        character(:), allocatable :: text

        text = 'mass='//to_text(real(charge%mass, real32))
        if (charge%on_ground) text = 'mass='//to_text(real(charge%mass/2, real32))// &
            ", burst='surface'"
    end function mass_keys

    !> The box in front of one face of which a point lies, with all other bodies behind that face,
    !> and all at rest; 0 where there is none.
    subroutine find_face(case, at, target, face, distance)
        type(case_t), intent(in) :: case
        real(dp), intent(in) :: at(3) !! [m]
        integer, intent(out) :: target
        character(:), allocatable, intent(out) :: face
        real(dp), intent(out) :: distance !! from the face [m]
        real(dp) :: lo(3), hi(3), gap(3)
        integer :: a, b

        target = 0
        face = ''
        distance = huge(distance)
        if (any([(is_open(case%bodies(b)), b=1, size(case%bodies))])) return
        do b = 1, size(case%bodies)
            call body_box(case%bodies(b), lo, hi)
            gap = max(lo - at, at - hi)
            if (maxval(gap) >= distance) cycle
            distance = maxval(gap)
            target = b
        end do
        if (target == 0) return
        call body_box(case%bodies(target), lo, hi)
        gap = max(lo - at, at - hi)
        a = maxloc(gap, 1)
        if (case%bodies(target)%shape /= 'box' .or. gap(a) <= 0 .or. count(gap > 0) > 1 .or. &
            case%bodies(target)%formulation == 'rigid') target = 0
        face = 'xyz' (a:a)//merge('-', '+', at(a) < lo(a))
        do b = 1, size(case%bodies)
            if (target == 0 .or. b == target) cycle
            call body_box(case%bodies(b), lo, hi)
            if (max(lo(a) - at(a), at(a) - hi(a)) < distance) target = 0
        end do
    end subroutine find_face

    !> Does a body move at the start, or has it a shape that the deck does not tell?
    pure logical function is_open(body)
        type(body_case_t), intent(in) :: body

        is_open = is_from_file(body) .or. body%n_motion > 0 .or. body%start_file /= '' .or. &
                  any(abs(body%velocity) > 0) .or. any(abs(body%spin) > 0)
    end function is_open

    !> Open sides that disturb the positive phase at the nearest body, or that nothing reaches.
    subroutine advise_box(case, work)
        type(case_t), intent(in) :: case
        type(work_t), intent(in) :: work
        integer :: a, side

        if (.not. case%air%present .or. size(case%charges) /= 1 .or. case%run%dimension < 3) return
        if (case%charges(1)%explosive /= 'tnt') return
        call judge_sides(case)
        do a = 1, 3
            do side = 1, 2
                if (case%air%bc(side, a) == 'outflow') &
                    call judge_reach(case, work, a, side, case%charges(1)%at)
            end do
        end do
    end subroutine advise_box

    !> What is nearest to a charge in a body [m]; the charge itself where that is not known.
    function nearest_point(case, at) result(there)
        type(case_t), intent(in) :: case
        real(dp), intent(in) :: at(3) !! [m]
        real(dp) :: there(3), lo(3), hi(3), nearest
        integer :: b

        there = at
        nearest = huge(nearest)
        do b = 1, size(case%bodies)
            if (is_from_file(case%bodies(b))) cycle
            call body_box(case%bodies(b), lo, hi)
            if (norm2(min(max(at, lo), hi) - at) >= nearest) cycle
            there = min(max(at, lo), hi)
            nearest = norm2(there - at)
        end do
    end function nearest_point

    !> What an open side sends back arrives as if from the mirror image of the charge behind it, at
    !> the speed of sound behind the front or more (docs/theory/air.md).
    subroutine judge_sides(case)
        type(case_t), intent(in) :: case
        character(:), allocatable :: names
        type(blast_t) :: blast
        real(dp) :: across, c, distance, first, later, place, scaled, there(3)
        integer :: a, side

        associate (at => case%charges(1)%at, mass => case%charges(1)%mass)
            there = nearest_point(case, at)
            distance = norm2(there - at)
            scaled = distance/mass**(1/3.0_dp)
            if (.not. (scaled > nearest_load .and. scaled < farthest)) return
            blast = free_air_blast(mass, distance)
            if (blast%arrival > case%run%t_end) then
                call say_advice('the blast reaches the nearest body '//length_text(distance)// &
                                ' away after '//time_text(blast%arrival)//', and the run '// &
                                'ends at '//time_text(case%run%t_end))
                return
            end if
            associate (ratio => 1 + blast%peak/ambient)
                c = sound*sqrt(ratio*(6 + ratio)/(1 + 6*ratio))
            end associate
            names = ''
            first = huge(first)
            do a = 1, 3
                do side = 1, 2
                    if (case%air%bc(side, a) /= 'outflow') cycle
                    if (abs(there(a) - at(a)) > square_on*distance) cycle
                    place = merge(case%air%lo(a), case%air%hi(a), side == 1)
                    across = min(abs(place - at(a)), abs(place - there(a)))
                    later = sqrt(distance**2 + 4*across**2) - distance
                    if (later >= c*blast%duration .or. &
                        blast%arrival + later/c > case%run%t_end) cycle
                    names = names//' '//'xyz' (a:a)//merge('-', '+', side == 1)
                    first = min(first, blast%arrival + later/c)
                end do
            end do
        end associate
        if (names == '') return
        call say_advice('what the open sides'//names//' send back reaches the nearest body '// &
                        'from '//time_text(first)//' on,')
        call say_more('within the positive phase (until '// &
                      time_text(blast%arrival + blast%duration)//'); sides '// &
                      length_text(sqrt((distance + c*blast%duration)**2 - distance**2)/2)// &
                      ' away keep it free (docs/manual/blast.md, size of the box)')
    end subroutine judge_sides

    !> Cells beyond the front at the end of the run: they cost memory alone.
    subroutine judge_reach(case, work, a, side, at)
        type(case_t), intent(in) :: case
        type(work_t), intent(in) :: work
        integer, intent(in) :: a, side
        real(dp), intent(in) :: at(3)
        type(blast_t) :: blast
        real(dp) :: far, low, high, place, root, share
        integer :: round

        root = case%charges(1)%mass**(1/3.0_dp)
        place = merge(case%air%lo(a), case%air%hi(a), side == 1)
        far = abs(place - at(a))
        if (far > farthest*root .or. far < nearest_load*root) return
        blast = free_air_blast(case%charges(1)%mass, far)
        if (blast%arrival <= case%run%t_end) return
        low = nearest_load*root
        high = far
        do round = 1, 50
            blast = free_air_blast(case%charges(1)%mass, (low + high)/2)
            if (blast%arrival > case%run%t_end) then
                high = (low + high)/2
            else
                low = (low + high)/2
            end if
        end do
        share = (far - high)/(case%air%hi(a) - case%air%lo(a))
        if (share < some) return
        call say_advice('the blast does not reach side '//'xyz' (a:a)// &
                        merge('-', '+', side == 1)//' of the air: '// &
                        length_text(far - high)//' less there saves the memory of '// &
                        count_text(share*work%cells)//' cells')
    end subroutine judge_reach
end module brz_advice
