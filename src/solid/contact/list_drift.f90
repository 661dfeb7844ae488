! SPDX-License-Identifier: MIT
!> How long neighbour lists (Verlet lists with a skin) and links last, body by body: motion that a
!> whole body shares counts for nothing.
!>
!> The list of body b was built for the places `x_built`. Since then the body as a whole has drifted
!> by D, at the mean velocity that it had then; what counts for a particle is
!> e = |x - x_built - D|. A list reaches a skin further than pairs act, so it lasts while
!> e <= skin/2. Links between bodies a and b were built for a at x_built + S, where S was D_a - D_b
!> at that time. They last while e_a + e_b + |D_a - D_b - S| <= skin, and longer by what the boxes
!> around the two were further apart than links reach. Along the normal of a plane of symmetry
!> nothing drifts: images move the other way. e is known in levels, see brz_skin_level.
!>
!> Where few particles of a body have moved far (an impact on a large plate, fragments), only the
!> lists near these are built anew: they get new places x_built = x - D, all others keep theirs.
!> Each list holds what is within reach of x_built at any time, whoever was renewed when. The order
!> of entries on a GPU is that of cells, so there such a body keeps its cells. A GPU builds links in
!> part, too: those near new places, and those of stale pairs of bodies, of which one is sorted anew
!> or which have drifted too far since S. All others may hold entries out of reach.
module brz_list_drift
    use brz_body, only: body_t
    use brz_formulation_names, only: form_rigid, form_total
    use brz_interaction, only: law_none
    use brz_kept_cells, only: kept_cells_t
    use brz_kinds, only: dp, int64
    use brz_skin_level, only: joining_level, renewed_level, skin_levels
    use brz_solid_mirror, only: signs
    use brz_bodies, only: bodies_t
    use brz_listed_bodies, only: listed_bodies_t
    implicit none
    private
    public :: level_unit, drift_bodies, find_stale, begin_list, begin_links, &
        links_reach, may_link, may_renew, decide_part

    integer, parameter :: most_renewed = 8 !! the share of a body that may is one over this
    integer, parameter :: most_renewals = 32 !! until memory is brought into the order of places

contains

    !> Half the skin in steps of e [m].
    pure real(dp) function level_unit(solid)
        class(listed_bodies_t), intent(in) :: solid

        level_unit = solid%skin/(2*skin_levels)
    end function level_unit

    !> Let the bodies drift over a step.
    pure subroutine drift_bodies(solid, dt)
        class(bodies_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        integer :: b

        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b))
                if (.not. body%inactive) body%drift = body%drift + dt*body%drift_velocity
            end associate
        end do
    end subroutine drift_bodies

    !> Which lists must be built anew, and whether the links must. Many lists, and the links with
    !> them, take little longer than one: bodies that have spent most of what they may move join
    !> others, unless they sleep. Where particles leave the scene, all do.
    pure subroutine find_stale(solid, level, stale, relink)
        class(listed_bodies_t), intent(inout) :: solid !! links%stale is set
        integer, intent(in) :: level(:) !! (bodies) highest level of a particle
        logical, intent(out) :: stale(:) !! (bodies)
        logical, intent(out) :: relink !! else links%stale means nothing
        real(dp) :: beyond(size(solid%bodies)), drift(size(solid%bodies), 3)
        logical :: join(size(solid%bodies)), links_join
        integer :: b

        do b = 1, size(solid%bodies)
            drift(b, :) = solid%bodies(b)%drift
        end do
        call find_spent(solid, level, drift, skin_levels, stale, relink)
        if (any(stale) .or. relink) then
            call find_spent(solid, merge(-1, level, stale .or. solid%bodies%inactive), drift, &
                            joining_level, join, links_join)
            stale = stale .or. join
        end if
        do b = 1, merge(size(solid%bodies), 0, relink)
            call look_beyond(solid, drift, b, beyond)
            solid%links%stale(:, b) = beyond > solid%skin/4
        end do
        if (solid%remove .and. (any(stale) .or. relink)) stale = .true.
    end subroutine find_stale

    !> Which lists, and whether some links, have spent what they may move, or as much of it as a
    !> level says. A body that spends half of what its links may is built anew with them.
    pure subroutine find_spent(solid, level, drift, due, stale, relink)
        class(listed_bodies_t), intent(in) :: solid
        integer, intent(in) :: level(:) !! (bodies) see find_stale; -1: has not moved
        real(dp), intent(in), contiguous :: drift(:, :) !! (bodies, 3) since their lists [m]
        integer, intent(in) :: due !! level at which a list is spent
        logical, intent(out) :: stale(:) !! (bodies)
        logical, intent(out) :: relink
        real(dp) :: beyond(size(solid%bodies)), moved(size(solid%bodies)), most
        integer :: a, b

        stale = level >= due
        relink = .false.
        if (.not. solid%links%present) return
        most = solid%skin*due/skin_levels*(1 + epsilon(most))
        do b = 1, size(solid%bodies)
            moved(b) = merge(0.0_dp, (level(b) + 1)*level_unit(solid), solid%bodies(b)%inactive)
        end do
        do b = 1, merge(0, size(solid%bodies), all_complete(solid, drift, maxval(moved), most))
            call look_beyond(solid, drift, b, beyond(:b))
            do a = 1, b ! the table of laws is large: it is asked last
                if (moved(a) + moved(b) + beyond(a) <= most) cycle ! their links are complete
                if (solid%links%table(a, b)%law == law_none) cycle
                relink = .true.
                if (level(a) >= renewed_level) stale(a) = .true.
                if (level(b) >= renewed_level) stale(b) = .true.
            end do
        end do
        relink = relink .or. any(stale)
    end subroutine find_spent

    !> True where no two bodies can have moved so far that their links have been spent, of whichever
    !> directions: there are many pairs of bodies to look at.
    pure logical function all_complete(solid, drift, moved, most)
        class(listed_bodies_t), intent(in) :: solid
        real(dp), intent(in), contiguous :: drift(:, :) !! (bodies, 3) since their lists [m]
        real(dp), intent(in) :: moved, most !! by particles of a body; of two and their drift [m]
        real(dp) :: drifted

        drifted = sqrt(maxval(drift(:, 1)**2 + drift(:, 2)**2 + drift(:, 3)**2))
        all_complete = 2*(moved + drifted) + solid%links%drifted <= most
    end function all_complete

    !> How far the first bodies have drifted against body b since they were linked, beyond what they
    !> were further apart than links reach [m].
    pure subroutine look_beyond(solid, drift, b, beyond)
        class(listed_bodies_t), intent(in) :: solid
        real(dp), intent(in), contiguous :: drift(:, :) !! (bodies, 3) since their lists [m]
        integer, intent(in) :: b
        real(dp), intent(out), contiguous :: beyond(:) !! (bodies)
        integer :: a

        associate (links => solid%links)
            do a = 1, size(beyond)
                beyond(a) = sqrt((drift(a, 1) - drift(b, 1) - links%drift(1, a, b))**2 &
                                 + (drift(a, 2) - drift(b, 2) - links%drift(2, a, b))**2 &
                                 + (drift(a, 3) - drift(b, 3) - links%drift(3, a, b))**2) &
                            - links%spare(a, b)
            end do
        end associate
    end subroutine look_beyond

    !> Body b is about to get a list for the places of today. Where particles leave the scene it
    !> does not drift: they are looked for whenever a list is built.
    pure subroutine begin_list(solid, b, velocity)
        class(listed_bodies_t), intent(inout) :: solid
        integer, intent(in) :: b
        real(dp), intent(in) :: velocity(3) !! of its mass, where it is not rigid [m/s]

        associate (body => solid%bodies(b))
            body%drift = 0
            body%cells = kept_cells_t(renewals=0)
            body%drift_velocity = velocity
            if (body%formulation == form_rigid) body%drift_velocity = &
                body%rigid%p/max(body%rigid%mass, tiny(velocity))
            where (solid%mirror .or. solid%remove) body%drift_velocity = 0
        end associate
        if (.not. solid%links%present) return
        solid%links%stale(:, b) = .true.
        solid%links%stale(b, :) = .true.
    end subroutine begin_list

    !> True where a part of the list of body b may be built anew, as far as is known before
    !> particles are counted: total-Lagrangian bodies keep their lists, rigid ones have none, and
    !> what is taken out is sorted behind the others.
    pure logical function may_renew(solid, b)
        class(bodies_t), intent(in) :: solid
        integer, intent(in) :: b

        associate (body => solid%bodies(b))
            may_renew = body%cells%renewals >= 0 .and. body%cells%renewals < most_renewals .and. &
                        .not. (body%formulation == form_total .or. body%formulation == form_rigid &
                               .or. solid%remove)
        end associate
    end function may_renew

    !> Whether so few particles of body b have new places that only the lists near these are built
    !> anew; several processes that keep no places build all, with the same entries.
    pure subroutine decide_part(body, kept, moved, in_part)
        type(body_t), intent(inout) :: body
        logical, intent(in) :: kept !! ghosts keep their places, or there are none
        integer(int64), intent(in) :: moved !! particles with new places, of all processes
        logical, intent(out) :: in_part

        in_part = moved*most_renewed < body%number(2) - body%number(1) + 1
        if (.not. in_part) return
        body%cells%renewals = body%cells%renewals + 1
        body%cells%in_part = kept
    end subroutine decide_part

    !> The links are about to be built, for the drifts of now or those that they had before a
    !> restart: note them, and how far the bodies are apart, where that may have changed. Two that
    !> were too far apart for links and are no longer are stale as well.
    pure subroutine begin_links(solid, anew, box, resume)
        class(listed_bodies_t), intent(inout) :: solid
        logical, intent(in) :: anew(:) !! (bodies) that are listed for other places than before
        real(dp), intent(in) :: box(:, :, :) !! (3, 2, bodies) corners of x_built of all [m]
        logical, intent(in) :: resume !! after a restart
        integer :: a, b
        real(dp) :: spare

        associate (links => solid%links)
            do b = 1, size(solid%bodies)
                do a = 1, size(solid%bodies)
                    if (.not. (links%stale(a, b) .or. anew(a) .or. anew(b) .or. resume)) cycle
                    if (links%stale(a, b) .and. .not. resume) &
                        links%drift(:, a, b) = solid%bodies(a)%drift - solid%bodies(b)%drift
                    spare = max(gap(solid, a, b, box) - links_reach(solid, a, b), 0.0_dp)
                    if (links%spare(a, b) > 0 .and. .not. spare > 0) links%stale(a, b) = .true.
                    links%spare(a, b) = spare
                end do
            end do
            links%drifted = sqrt(maxval(sum(links%drift**2, 1)))
        end associate
    end subroutine begin_links

    !> Least distance between the box of body b and that of body a or one of its images [m].
    pure real(dp) function gap(solid, a, b, box)
        class(listed_bodies_t), intent(in) :: solid
        integer, intent(in) :: a, b
        real(dp), intent(in) :: box(:, :, :) !! (3, 2, bodies) [m]
        real(dp) :: lo(3), hi(3), s(3), shift(3)
        integer :: m

        gap = huge(gap)
        shift = solid%links%drift(:, a, b)
        do m = 0, 7
            s = signs(m)
            if (any(s < 0 .and. .not. solid%mirror)) cycle
            lo = min(s*box(:, 1, a), s*box(:, 2, a)) + shift
            hi = max(s*box(:, 1, a), s*box(:, 2, a)) + shift
            gap = min(gap, norm2(max(lo - box(:, 2, b), box(:, 1, b) - hi, 0.0_dp)))
        end do
    end function gap

    !> Longest link between two bodies [m].
    pure real(dp) function links_reach(solid, a, b)
        class(listed_bodies_t), intent(in) :: solid
        integer, intent(in) :: a, b

        links_reach = 2*real(solid%links%table(a, b)%h, dp) + solid%skin
    end function links_reach

    !> True where two bodies may have links now.
    pure logical function may_link(solid, a, b)
        class(listed_bodies_t), intent(in) :: solid
        integer, intent(in) :: a, b

        may_link = .not. solid%links%spare(a, b) > 0
        if (may_link) may_link = solid%links%table(a, b)%law /= law_none ! the table is large
    end function may_link
end module brz_list_drift
