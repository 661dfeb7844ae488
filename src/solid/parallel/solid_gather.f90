! SPDX-License-Identifier: MIT
!> The particles of all processes in one: for dumps and checkpoints, which the first one writes as
!> if it were alone.
module brz_solid_gather
    use brz_cohesive_loops, only: each_place_node
    use brz_cohesive_part, only: share_points
    use brz_errors, only: failed
    use brz_kinds, only: int64, rk
    use brz_message_exchange, only: message_exchange_t, tell_counts
    use brz_pair_layout, only: n_pair
    use brz_places, only: message_buffers_t
    use brz_solid_diagnostics, only: diagnostics_t, close_all_diagnostics, open_all_diagnostics
    use brz_solid_fields, only: fields_of, fields_t, make_fields
    use brz_solid_ghosts, only: of_a_checkpoint, send_particles
    use brz_solid_sort, only: sort_body
    use brz_listed_bodies, only: listed_bodies_t
    use brz_interacting_bodies, only: interacting_bodies_t
    implicit none
    private
    public :: begin_gather, end_gather

contains

    !> What must be known of all processes before their particles are gathered.
    subroutine begin_gather(solid, whole, in)
        class(interacting_bodies_t), intent(inout) :: solid
        class(interacting_bodies_t), intent(out) :: whole !! without particles yet
        integer(int64), allocatable, intent(out) :: in(:, :) !! (bodies, processes) that come
        integer(int64) :: out(size(solid%bodies), solid%ranks%n)

        call share_points(solid)
        call outline(solid, whole)
        allocate (in(size(solid%bodies), solid%ranks%n))
        out = 0
        out(:, 1) = solid%bodies%last - solid%bodies%first + 1
        call tell_counts(solid%ranks, out, in)
    end subroutine begin_gather

    !> All that a checkpoint holds, in the first process, with `sorted` in the order in which one
    !> process would have it; no particles in all others. It comes by messages, then all must call;
    !> or in copies of the processes by files: see message_exchange_t.
    subroutine end_gather(solid, whole, in, sorted, exchange)
        class(listed_bodies_t), intent(inout), target :: solid
        class(interacting_bodies_t), intent(inout), target :: whole !! as begin_gather left it
        integer(int64), intent(in) :: in(:, :) !! likewise
        logical, intent(in) :: sorted
        type(message_exchange_t), intent(inout) :: exchange
        integer :: next(size(solid%bodies))
        type(message_buffers_t) :: leaving, coming
        type(fields_t) :: from, to
        integer :: b, i, r

        call make_fields(whole, kept_alone=.true.)
        if (allocated(solid%load)) allocate (whole%load(3, whole%n), source=0.0_rk)
        if (allocated(solid%face_stress) .and. .not. allocated(solid%loads%of)) &
            allocate (whole%face_stress(6, whole%n), source=0.0_rk)
        if (allocated(solid%v_before)) allocate (whole%v_before(3, whole%n), source=0.0_rk)
        leaving%place = [((i, i=solid%bodies(b)%first, solid%bodies(b)%last), &
                          b=1, size(solid%bodies))]
        allocate (leaving%first(0:solid%ranks%n), coming%first(0:solid%ranks%n))
        leaving%first = 1 + size(leaving%place)
        leaving%first(0) = 1
        allocate (coming%place(sum(in)))
        next = whole%bodies%first
        coming%first(0) = 1
        do r = 1, solid%ranks%n
            associate (at => coming%first(r))
                at = coming%first(r - 1)
                do b = 1, size(solid%bodies)
                    do i = 1, int(in(b, r))
                        coming%place(at) = next(b)
                        at = at + 1
                        next(b) = next(b) + 1
                    end do
                end do
            end associate
        end do
        call fields_of(solid, from)
        call fields_of(whole, to)
        call send_particles(solid%ranks, of_a_checkpoint, from, leaving, to, coming, exchange)
        if (solid%ranks%rank > 0 .or. failed(exchange%fault)) return
        if (sorted) call sort(whole)
        if (whole%cohesive%present) call each_place_node(whole%n, 1, whole%id, whole%cohesive%row, &
                                                         whole%cohesive%place)
    end subroutine end_gather

    !> Put the particles in the order that one process would have.
    subroutine sort(whole)
        class(listed_bodies_t), intent(inout) :: whole
        integer :: b

        allocate (whole%pair(n_pair, whole%n), whole%search%order(whole%n)) ! to sort by
        do b = 1, size(whole%bodies)
            call sort_body(whole, b)
        end do
        deallocate (whole%pair)
    end subroutine sort

    !> What a scene of bodies has besides its particles; diagnostics of all processes together.
    subroutine outline(solid, whole)
        class(interacting_bodies_t), intent(inout) :: solid
        class(interacting_bodies_t), intent(inout) :: whole
        type(diagnostics_t) :: diagnostics
        integer :: b

        whole%present = .true.
        whole%links%present = solid%links%present
        if (whole%links%present) whole%links%drift = solid%links%drift
        whole%n_hist = solid%n_hist
        whole%dimension = solid%dimension
        whole%mirror = solid%mirror
        whole%depth = solid%depth
        whole%time = solid%time
        whole%dt_last = solid%dt_last
        whole%dt_limit = solid%dt_limit
        whole%skin = solid%skin
        whole%remove = solid%remove
        whole%region = solid%region
        whole%steps = solid%steps
        whole%rebuilds = solid%rebuilds
        call open_all_diagnostics(solid, diagnostics)
        whole%bodies = solid%bodies
        call close_all_diagnostics(solid, diagnostics)
        whole%materials = solid%materials
        if (allocated(solid%between)) whole%between = solid%between
        if (solid%ranks%rank == 0) whole%cohesive = solid%cohesive
        do b = 1, size(whole%bodies)
            associate (body => whole%bodies(b))
                body%first = body%number(1)
                body%last = merge(body%number(2), body%first - 1, solid%ranks%rank == 0)
                body%rim = body%last
                whole%n = max(whole%n, body%last)
            end associate
        end do
        if (solid%ranks%rank > 0) whole%n = 0
    end subroutine outline
end module brz_solid_gather
