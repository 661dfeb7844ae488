! SPDX-License-Identifier: MIT
!> Cohesive interfaces at the present places: openings, damage, forces on the particles.
!>
!> A point that is broken keeps pressing until none of the particles that it sees is held by its
!> interface any more: these then meet by contact.
module brz_solid_cohesive
    use brz_cohesive_law, only: separate
    use brz_cohesive_points, only: mirror_signs
    use brz_cohesive_state, only: cohesive_t
    use brz_kinds, only: dp, int32
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
        real(dp) :: open (3), t(3, 2), normal(3), traction(3), held, spent

        associate (glue => solid%cohesive)
            glue%pull(:, :, p) = 0
            if (is_released(solid, p)) then ! what it held in pressure is gone for the contact
                glue%spent(p) = glue%spent(p) + glue%held(p)
                glue%held(p) = 0
                return
            end if
            call look(solid, p, open, t)
            normal = [t(2, 1)*t(3, 2) - t(3, 1)*t(2, 2), t(3, 1)*t(1, 2) - t(1, 1)*t(3, 2), &
                      t(1, 1)*t(2, 2) - t(2, 1)*t(1, 2)]
            normal = normal/max(norm2(normal), tiny(1.0_dp))
            open = open - glue%gap(p)*normal
            spent = 0
            call separate(glue%law(glue%of(p)), open, normal, glue%damage(p), spent, traction, held)
            glue%spent(p) = glue%spent(p) + glue%area(p)*spent
            glue%held(p) = glue%area(p)*held
            glue%pull(:, 1, p) = -glue%area(p)*traction
            if (abs(glue%gap(p)) > 0) call turn(glue%gap(p)*glue%area(p), t, traction, normal, &
                                                glue%pull(:, :, p))
        end associate
    end subroutine open_point

    !> Forces by which an opening across a gap turns its sides: the normal turns with the tangents.
    pure subroutine turn(arm, t, traction, normal, pull)
        real(dp), intent(in) :: arm !! gap times area [m3]
        real(dp), intent(in) :: t(3, 2), traction(3), normal(3)
        real(dp), intent(inout) :: pull(3, 3)
        real(dp) :: g11, g12, g22, p1, p2, det

        g11 = dot_product(t(:, 1), t(:, 1))
        g12 = dot_product(t(:, 1), t(:, 2))
        g22 = dot_product(t(:, 2), t(:, 2))
        det = max(g11*g22 - g12*g12, tiny(1.0_dp))
        p1 = dot_product(traction, t(:, 1))
        p2 = dot_product(traction, t(:, 2))
        pull(:, 2) = -arm*(g22*p1 - g12*p2)/det*normal
        pull(:, 3) = -arm*(g11*p2 - g12*p1)/det*normal
    end subroutine turn

    !> What a point sees: the far side from the near one, and the tangents.
    pure subroutine look(solid, p, open, t)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: p
        real(dp), intent(out) :: open (3), t(3, 2)
        real(dp) :: x(3)
        integer :: e

        associate (glue => solid%cohesive)
            open = 0
            t = glue%rest(:, :, p)
            do e = glue%first(p), glue%first(p + 1) - 1
                x = mirror_signs(int(glue%mask(e)))*solid%x(:, glue%place(glue%node(e)))
                open = open + glue%weight(1, e)*x
                t(:, 1) = t(:, 1) + glue%weight(2, e)*x
                t(:, 2) = t(:, 2) + glue%weight(3, e)*x
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
            glue%push(:, r) = glue%push(:, r) + mirror_signs(int(glue%mask(e))) &
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
