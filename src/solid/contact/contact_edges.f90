! SPDX-License-Identifier: MIT
!> Contact at the edges of flat faces, where boxes stand on each other.
!>
!> Under uniform stress the columns of particles near the edge of a face bear unequal shares of the
!> force on it (brz_edge_shares); springs of contact that are stiffer by these shares strain them
!> equally. Where the face of one box lies within that of another only its own springs act, twice as
!> stiff: those of the particles around its edge would push that edge outwards.
!>
!> Source: docs/theory/contact.md, faces in contact
module brz_contact_edges
    use brz_body, only: body_t
    use brz_edge_shares, only: edge_shares, n_edge, share_of
    use brz_face_layout, only: face_edge
    use brz_interaction, only: law_bonded, law_contact
    use brz_kinds, only: dp, real32
    use brz_particles, only: particles_t
    use brz_listed_bodies, only: listed_bodies_t
    implicit none
    private
    public :: find_contact_edges

contains

    !> Shares of the springs of all particles, and whose springs act between two boxes.
    subroutine find_contact_edges(boxes, solid)
        logical, intent(in) :: boxes(:) !! (bodies) is a whole box of cubic particles
        class(listed_bodies_t), intent(inout) :: solid
        real(dp) :: corner(3, 2, size(boxes))
        integer :: a, b

        if (.not. solid%links%present) return
        do b = 1, size(boxes)
            associate (body => solid%bodies(b), table => solid%links%table(:, b))
                if (boxes(b) .and. body%face_share > 0 .and. .not. any(table%law == law_bonded) &
                    .and. any(table%law == law_contact .and. table%steep > 0)) &
                    call weigh_edges(solid, body)
            end associate
        end do
        do b = 1, size(boxes)
            if (boxes(b)) corner(:, :, b) = corners(solid, solid%bodies(b))
        end do
        do b = 1, size(boxes)
            do a = 1, size(boxes)
                if (.not. (boxes(a) .and. boxes(b)) .or. a == b) cycle
                if (.not. stands_on(solid, a, b, corner(:, :, a), corner(:, :, b))) cycle
                solid%links%table(a, b)%stiffness = 2*solid%links%table(a, b)%stiffness
                solid%links%table(b, a)%stiffness = 0
            end do
        end do
    end subroutine find_contact_edges

    !> Shares of the springs of the particles of a box, which lie layer by layer.
    subroutine weigh_edges(solid, body)
        class(listed_bodies_t), intent(inout) :: solid
        type(body_t), intent(in) :: body
        real(dp) :: shares(n_edge), share(3), low(3), high(3)
        integer :: a, i, n, columns(2, 3)

        shares = edge_shares(solid%dimension, real(body%h/body%spacing, dp))
        n = solid%dimension
        low = minval(solid%x_ref(:, body%first:body%last), 2)
        high = maxval(solid%x_ref(:, body%first:body%last), 2)
        do i = body%first, body%last
            columns = n_edge + 1
            columns(1, :n) = 1 + nint((solid%x_ref(:n, i) - low(:n))/body%spacing)
            columns(2, :n) = 1 + nint((high(:n) - solid%x_ref(:n, i))/body%spacing)
            where (solid%mirror .and. low < body%spacing) & ! its image goes on
                columns(1, :) = 2*columns(1, :) + columns(2, :) - 1
            if (.not. any(columns(:, :n) == 1)) cycle
            share = 1
            do a = 1, n
                share(a) = share_of(shares, columns(1, a), columns(2, a))
            end do
            a = minloc(sum(columns, 1), 1, any(columns == 1, 1)) ! across the face that it is in
            share(a) = 1
            solid%links%face(face_edge, i) = real(product(share), real32)
        end do
    end subroutine weigh_edges

    !> True where box a stands on box b: along the axis that parts them most its face lies within
    !> that of b.
    pure logical function stands_on(solid, a, b, p, q)
        class(listed_bodies_t), intent(in) :: solid
        integer, intent(in) :: a, b
        real(dp), intent(in) :: p(3, 2), q(3, 2) !! their corners [m]
        real(dp) :: apart(3), slack
        integer :: across, n

        n = solid%dimension
        stands_on = n > 1 .and. solid%links%table(a, b)%law == law_contact .and. &
                    solid%links%table(a, b)%steep > 0
        if (.not. stands_on) return
        slack = solid%bodies(b)%spacing/2
        apart = max(q(:, 1) - p(:, 2), p(:, 1) - q(:, 2))
        across = maxloc(apart(:n), 1)
        if (apart(across) < -slack) stands_on = .false. ! one is in the other
        apart = min(p(:, 1) - q(:, 1), q(:, 2) - p(:, 2)) ! how far b goes on beyond a
        where (solid%mirror .and. p(:, 1) < slack) apart = q(:, 2) - p(:, 2)
        apart(across) = 2*slack
        stands_on = stands_on .and. all(apart(:n) > slack)
    end function stands_on

    !> Corners of a box.
    pure function corners(solid, body) result(x)
        class(particles_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        real(dp) :: x(3, 2) !! low, high [m]

        x(:, 1) = minval(solid%x(:3, body%first:body%last), 2) - body%spacing/2
        x(:, 2) = maxval(solid%x(:3, body%first:body%last), 2) + body%spacing/2
    end function corners
end module brz_contact_edges
