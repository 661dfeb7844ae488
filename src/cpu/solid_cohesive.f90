! SPDX-License-Identifier: MIT
!> Cohesive interfaces at the present places: openings, damage, forces on the particles.
!>
!> A point that is broken keeps pressing until none of the particles that it sees is held by its
!> interface any more: these then meet by contact.
module brz_solid_cohesive
    use brz_cohesive_law, only: has_damage, has_held, has_spent, load_point
    use brz_cohesive_state, only: cohesive_t
    use brz_kinds, only: dp, int32
    use brz_solid_mirror, only: signs
    use brz_solid_state, only: is_gone, solid_t
    implicit none
    private
    public :: cohesive_pass, place_nodes, cohesive_push

    integer, parameter :: worth_threads = 512 !! fewer points are faster on one thread

contains

    !> Where the particles of the nodes lie, after a sort or a restart.
    subroutine place_nodes(solid)
        type(solid_t), intent(inout) :: solid
        integer :: i

        if (.not. solid%cohesive%present) return
        do i = 1, solid%n
            associate (row => solid%cohesive%row(solid%id(i)))
                if (row > 0) solid%cohesive%place(row) = int(i, int32)
            end associate
        end do
        call join_nodes(solid)
    end subroutine place_nodes

    !> Which interfaces still hold each particle.
    subroutine join_nodes(solid)
        type(solid_t), intent(inout) :: solid
        integer(int32) :: bits
        integer :: k, r

        solid%links%joined = 0
        associate (glue => solid%cohesive)
            !$omp parallel do if(glue%nodes >= worth_threads) schedule(static) private(k, bits)
            do r = 1, glue%nodes
                bits = 0
                do k = glue%back_first(r), glue%back_first(r + 1) - 1
                    if (glue%damage(glue%back(2, k)) < 1) &
                        bits = ior(bits, glue%bit(glue%of(glue%back(2, k))))
                end do
                solid%links%joined(glue%place(r)) = bits
            end do
        end associate
    end subroutine join_nodes

    !> State and forces of all points, and what time step they bear.
    subroutine cohesive_pass(solid)
        type(solid_t), intent(inout) :: solid
        integer :: p, r

        if (.not. solid%cohesive%present) return
        !$omp parallel do if(solid%cohesive%n >= worth_threads) schedule(static)
        do p = 1, solid%cohesive%n
            call open_point(solid, p)
        end do
        call join_nodes(solid)
        !$omp parallel do if(solid%cohesive%n >= worth_threads) schedule(static)
        do r = 1, solid%cohesive%nodes
            call gather(solid%cohesive, r)
        end do
        solid%dt_limit = min(solid%dt_limit, solid%cohesive%dt_limit)
    end subroutine cohesive_pass

    !> Opening, damage and forces of a point.
    subroutine open_point(solid, p)
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: p
        real(dp) :: seen(3, 3), state(3)

        associate (glue => solid%cohesive)
            if (is_released(solid, p)) then ! what it held in pressure is gone for the contact
                glue%pull(:, :, p) = 0
                glue%spent(p) = glue%spent(p) + glue%held(p)
                glue%held(p) = 0
                return
            end if
            call look(solid, p, seen)
            state = [glue%damage(p), glue%spent(p), glue%held(p)]
            call load_point(glue%law(glue%of(p)), glue%area(p), glue%gap(p), seen, state, &
                            glue%pull(:, :, p))
            glue%damage(p) = state(has_damage)
            glue%spent(p) = state(has_spent)
            glue%held(p) = state(has_held)
        end associate
    end subroutine open_point

    !> What a point sees: the far side from the near one, and the tangents.
    pure subroutine look(solid, p, seen)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: p
        real(dp), intent(out) :: seen(3, 3)
        real(dp) :: x(3)
        integer :: c, e

        associate (glue => solid%cohesive)
            seen(:, 1) = 0
            seen(:, 2:3) = glue%rest(:, :, p)
            do e = glue%first(p), glue%first(p + 1) - 1
                x = signs(int(glue%mask(e)))*solid%x(:, glue%place(glue%node(e)))
                do c = 1, 3
                    seen(:, c) = seen(:, c) + glue%weight(c, e)*x
                end do
            end do
        end associate
    end subroutine look

    !> True where none of the particles of a broken point is held by its interface any more, or one
    !> of them is gone.
    pure logical function is_released(solid, p) result(yes)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: p
        integer :: e, i

        yes = .false.
        associate (glue => solid%cohesive)
            if (glue%damage(p) < 1) return
            yes = .true.
            do e = glue%first(p), glue%first(p + 1) - 1
                i = glue%place(glue%node(e))
                if (solid%fixed(i) == is_gone) return
            end do
            do e = glue%first(p), glue%first(p + 1) - 1
                i = glue%place(glue%node(e))
                yes = yes .and. iand(solid%links%joined(i), glue%bit(glue%of(p))) == 0
            end do
        end associate
    end function is_released

    !> Force on the particle of a node.
    pure subroutine gather(glue, r)
        type(cohesive_t), intent(inout) :: glue
        integer, intent(in) :: r
        integer :: e, k, p

        glue%push(:, r) = 0
        do k = glue%back_first(r), glue%back_first(r + 1) - 1
            e = glue%back(1, k)
            p = glue%back(2, k)
            glue%push(:, r) = glue%push(:, r) + signs(int(glue%mask(e))) &
                              *matmul(glue%pull(:, :, p), glue%weight(:, e))
        end do
    end subroutine gather

    !> Force of all interfaces on particle i [N].
    pure function cohesive_push(solid, i) result(f)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: i
        real(dp) :: f(3)

        f = solid%cohesive%push(:, solid%cohesive%row(solid%id(i)))
    end function cohesive_push
end module brz_solid_cohesive
