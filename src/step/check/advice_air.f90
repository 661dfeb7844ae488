! SPDX-License-Identifier: MIT
!> Advice on what the air makes of the rest: a body that gives way too little to be seen by it, and
!> products of an explosive from which nothing comes as far as bodies and gauges.
module brz_advice_air
    use brz_advice_text, only: length_text, millimetres, say_advice, say_more, time_text
    use brz_body, only: body_t
    use brz_case, only: body_case_t, case_t, is_from_file
    use brz_formulation_names, only: form_rigid
    use brz_body_geometries, only: body_box
    use brz_early, only: early_t
    use brz_kinds, only: dp, real32
    use brz_kingery_bulmash, only: blast_t, farthest, free_air_blast, nearest
    use brz_material, only: class_elastic, class_metal, material_t
    use brz_scene_size, only: count_text
    use brz_bodies, only: bodies_t
    use brz_text, only: to_text
    use brz_work, only: cell_seconds, particle_seconds, work_t
    implicit none
    private
    public :: advise_still, advise_one_gas, giving_way

    real(dp), parameter :: ambient = 101325, density = 1.225_dp, sound = 340 !! undisturbed air
    real(dp), parameter :: amplify = 2 !! motion of a plate over that of a free one, at most
    real(dp), parameter :: unseen = 0.01_dp !! share of the impulse
    real(dp), parameter :: still = 0.1_dp !! of a cell that a face may move
    real(dp), parameter :: worth = 0.05_dp !! share of the seconds that is worth a line
    real(dp), parameter :: sixth = 0.12_dp !! of the time of a cell of two gases, that of the second

contains

    !> A single box before a sphere of TNT: may the air take it for a wall that stands?
    subroutine advise_still(case, solid, work)
        type(case_t), intent(in) :: case
        class(bodies_t), intent(in) :: solid !! its body and materials
        type(work_t), intent(in) :: work
        real(dp) :: at(3), lo(3), hi(3), thick, move, share, saved

        if (.not. case%coupling%present .or. size(case%charges) /= 1 .or. &
            size(case%gas) + size(case%inflows) > 0 .or. size(case%bodies) /= 1) return
        if (case%run%dimension < 3 .or. any(case%air%bc == 'wall') .or. &
            any(case%air%bc == 'periodic') .or. .not. allocated(solid%bodies)) return
        at = case%charges(1)%at
        if (case%charges(1)%shape /= 'sphere' .or. case%charges(1)%explosive /= 'tnt') return
        if (.not. is_plain(case%bodies(1), solid%bodies(1))) return
        call body_box(case%bodies(1), lo, hi)
        if (any(solid%mirror .and. (abs(at) > 0 .or. lo > 0))) return ! images of both
        thick = minval(hi - lo)
        associate (material => solid%materials(solid%bodies(1)%material))
            call giving_way(case%charges(1)%mass, norm2(min(max(at, lo), hi) - at), &
                            thick*material%density, material, case%run%t_end, move, share)
        end associate
        saved = particle_seconds(work, 1)
        if (share > unseen .or. saved < worth*(cell_seconds(work) + saved)) return
        if (move > still*minval((case%air%hi - case%air%lo)/case%air%cells)) return
        call say_advice("'"//trim(case%bodies(1)%id)//"' gives way by "// &
                        millimetres(move)//' at most and takes off '// &
                        to_text(real(anint(1e4_dp*share)/100, real32))//' % of the impulse on it:')
        call say_more("if what counts is the air, formulation='rigid', fix='all' is a wall to "// &
                      'it and saves '//time_text(saved)//' of one core')
        call say_more('('//count_text(work%of_body(1))//' particles in '// &
                      count_text(work%steps*work%substeps)//' steps); it has then no stress')
    end subroutine advise_still

    !> Is it a box at rest, of what cannot break?
    pure logical function is_plain(input, body)
        type(body_case_t), intent(in) :: input
        type(body_t), intent(in) :: body

        is_plain = input%shape == 'box' .and. body%formulation /= form_rigid .and. &
                   .not. is_from_file(input) .and. input%n_motion == 0 .and. &
                   input%start_file == '' .and. .not. any(abs(input%velocity) > 0) .and. &
                   .not. any(abs(input%spin) > 0)
        if (allocated(input%regions)) is_plain = is_plain .and. size(input%regions) == 0
    end function is_plain

    !> How far the nearest face of a body moves until the end of a run, and the share of the impulse
    !> on it that this takes off; huge where neither can be said.
    !>
    !> A face has at most `amplify` times the velocity that the impulse i gives to a free plate of
    !> the same mass per area m (edges that are held take from it; waves that meet in the middle add
    !> less than that) and that of a wave into it, p/(rho c): v = 2 i/m + p/(rho c). A wall that
    !> retreats with v lacks the pressure rho_a c_a v of the gas before it (Taylor 1941: acoustics):
    !> that behind the reflected shock while the pulse acts, about i/p, and undisturbed air later.
    !> p and i are the normally reflected ones of the curves of Kingery and Bulmash at the nearest
    !> point; the state behind the shock follows from p by the relations of a perfect gas. Only for
    !> what neither breaks nor crumbles, nor yields under p.
    subroutine giving_way(mass, distance, areal, material, t_end, move, share)
        real(dp), intent(in) :: mass, distance !! of the charge [kg], [m]
        real(dp), intent(in) :: areal !! mass per area of the body [kg/m2]
        type(material_t), intent(in) :: material
        real(dp), intent(in) :: t_end !! [s]
        real(dp), intent(out) :: move, share !! [m], [-]
        type(blast_t) :: blast
        real(dp) :: scaled, v, pulse, left, incident, rho, c

        move = huge(move)
        share = huge(share)
        scaled = distance/mass**(1/3.0_dp)
        if (scaled < nearest .or. scaled > farthest .or. material%fails /= 0) return
        if (material%class /= class_elastic .and. material%class /= class_metal) return
        blast = free_air_blast(mass, distance)
        if (material%class == class_metal .and. &
            blast%reflected > 3*material%shear*material%yields) return
        left = max(t_end - blast%arrival, 0.0_dp)
        v = amplify*blast%reflected_impulse/areal &
            + blast%reflected/real(material%density*material%c_wave, dp)
        pulse = min(blast%reflected_impulse/blast%reflected, left)
        incident = 1 + blast%peak/ambient
        associate (ratio => 1 + blast%reflected/ambient)
            rho = density*(1 + 6*incident)/(6 + incident)
            rho = rho*(incident + 6*ratio)/(6*incident + ratio)
            c = sqrt(1.4_dp*ambient*ratio/rho)
        end associate
        move = v*left
        share = v*(rho*c*pulse + density*sound*(left - pulse))/blast%reflected_impulse
    end subroutine giving_way

    !> Products of a blast along its radius from which nothing can come to a body or a gauge: sound
    !> from their surface runs with the largest u + c between it and the front as the blast is put
    !> into the box, which only falls from then on (a blast without a body decays, and a shock that
    !> comes back from one is met by gas that is slower, with c behind it below u + c before it).
    subroutine advise_one_gas(case, early, work)
        type(case_t), intent(in) :: case
        type(early_t), intent(in) :: early
        type(work_t), intent(in) :: work
        real(dp) :: lo(3), hi(3), near, reach
        integer :: b, g

        if (.not. (early%present .and. early%products .and. early%dimensions == 1)) return
        if (size(case%charges) /= 1 .or. any(case%gas%file /= '')) return
        if (case%charges(1)%eos /= 'jwl') return ! gamma would change the blast itself
        near = huge(near)
        associate (at => case%charges(1)%at, measured => case%air%cells > 1)
            do b = 1, size(case%bodies)
                if (is_from_file(case%bodies(b))) return
                call body_box(case%bodies(b), lo, hi)
                near = min(near, norm2(pack(min(max(at, lo), hi) - at, measured)))
            end do
            do g = 1, size(case%gauges)
                if (case%gauges(g)%body_index == 0) &
                    near = min(near, norm2(pack(case%gauges(g)%at - at, measured)))
            end do
            reach = early%contact + early%fastest*max(case%run%t_end - early%time, 0.0_dp)
            if (near > huge(near)/2 .or. reach >= near) return
            call say_advice("nothing comes from the products of '"//trim(case%charges(1)%id)// &
                            "' to bodies and gauges within the run: up to")
            call say_more(length_text(reach)//' from the charge, of '//length_text(near)// &
                          '. gamma = '//to_text(real(case%air%gamma, real32))//' in &charge '// &
                          'computes one gas in place of two')
            call say_more('and saves '//time_text(sixth*cell_seconds(work))// &
                          ' of one core, and the memory of a sixth number of '// &
                          count_text(work%cells)//' cells')
        end associate
    end subroutine advise_one_gas
end module brz_advice_air
