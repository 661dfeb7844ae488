! SPDX-License-Identifier: MIT
!> Cell stores of solid cells: level them, keep them in their band, hand what is beyond it to the
!> deferred sources of the gas beside. One loop body is one solid cell or one wall face. (With cut
!> cells it would be flux redistribution.)
!>
!> A surface that is oblique to the grid, or moves obliquely, lets gas in through the faces of one
!> direction and out through those of another: the fluxes cancel over a few cells of surface, but
!> not in each. What a single cell store cannot hold would have to go back into the gas, as noise.
module brz_cell_store_loop_bodies
    use brz_cell_shells, only: cell_at, shells_t, touching
    use brz_column_rules, only: direction_of, image_row, sign_of
    use brz_coupling_box, only: box_t, is_own, is_turned, look_beside, place_at, place_beside
    use brz_kinds, only: dp, int32, int64, int8, rk
    use brz_cell_store_rules, only: stored_excess, stored_ratio
    use brz_scheme, only: max_var
    implicit none
    private
    public :: copy_stored, level_stored, record_level, judge_stored, take_excess, first_excess, &
              open_excess, give_excess, total_stored
    public :: faces_at

contains

    !> Wall faces of a solid cell.
    !@cuf attributes(host,device) &
    pure function faces_at(c, face_of) result(faces)
        integer, intent(in) :: c !! place in the list
        integer, intent(in) :: face_of(6, *)
        integer :: faces, row

        faces = 0
        do row = 1, 6
            if (face_of(row, c) > 0) faces = faces + 1
        end do
    end function faces_at

    !> Copy the cell stores.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine copy_stored(c, box, cell, u, stored)
        integer, intent(in) :: c !! solid cells
        type(box_t), intent(in) :: box
        integer(int32), intent(in) :: cell(*)
        real(rk), intent(in) :: u(*)
        real(rk), intent(inout) :: stored(max_var, *)
        integer(int64) :: at
        integer :: k

        at = place_at(box, cell(c))
        do k = 1, box%n_var
            stored(k, c) = u(at + (k - 1)*box%grid%apart)
        end do
    end subroutine copy_stored

    !> The solid cell at an offset of another, or its image, if it has wall faces on a common side:
    !> the two exchange parts of their cell stores. 0: there is none.
    !@cuf attributes(host,device) &
    pure subroutine find_partner(c, box, ijk, offset, solid, cell_of, face_of, b, turned)
        integer, intent(in) :: c !! place of the other in the list
        type(box_t), intent(in) :: box
        integer, intent(in) :: ijk(3), offset(3) !! the other, from it
        integer(int8), intent(in) :: solid(*)
        integer, intent(in) :: cell_of(*), face_of(6, *)
        integer, intent(out) :: b !! place in the list
        logical, intent(out) :: turned(3) !! directions in which it is an image
        integer(int64) :: at
        integer :: row
        logical :: common

        b = 0
        call look_beside(box, ijk, offset, at, turned)
        if (at == 0) return
        if (solid(at) == 0) return
        b = cell_of(at)
        common = .false.
        do row = 1, 6
            common = common .or. (face_of(row, c) > 0 .and. face_of(image_row(row, turned), b) > 0)
        end do
        if (.not. common) b = 0
    end subroutine find_partner

    !> Exchange a part of the difference with each neighbour that has faces of a common direction:
    !> what one takes the other gives, to the bit. Images are neighbours, too.
    !@loop_body if(n >= worth_threads) schedule(dynamic, 64)
    !@cuf attributes(host,device) &
    pure subroutine level_stored(c, box, shells, part, cell, solid, cell_of, face_of, stored, u)
        integer, intent(in) :: c !! solid cells
        type(box_t), intent(in) :: box
        type(shells_t), intent(in) :: shells !@buffer
        real(rk), intent(in) :: part !! of a difference
        integer(int32), intent(in) :: cell(*)
        integer(int8), intent(in) :: solid(*)
        integer, intent(in) :: cell_of(*), face_of(6, *)
        real(rk), intent(in) :: stored(max_var, *)
        real(rk), intent(inout) :: u(*)
        real(rk) :: gain(max_var)
        integer(int64) :: at
        integer :: b, k, o, ijk(3), offset(3)
        logical :: turned(3)

        if (faces_at(c, face_of) == 0) return
        ijk = cell_at(box%n, cell(c))
        do k = 1, max_var
            gain(k) = 0
        end do
        do o = 1, shells%first(touching + 1) - 1
            do k = 1, 3
                offset(k) = shells%offset(k, o)
            end do
            if (max(abs(offset(1)), abs(offset(2)), abs(offset(3))) > 1) cycle
            call find_partner(c, box, ijk, offset, solid, cell_of, face_of, b, turned)
            if (b == 0) cycle
            do k = 1, max_var
                if (k <= box%n_var) gain(k) = gain(k) + (merge(-stored(k, b), stored(k, b), &
                                                               is_turned(turned, k)) - stored(k, c))
            end do
        end do
        at = place_at(box, cell(c))
        do k = 1, max_var
            if (k <= box%n_var) u(at + (k - 1)*box%grid%apart) = stored(k, c) + part*gain(k)
        end do
    end subroutine level_stored

    !> Momentum that images behind planes of symmetry get from the cell stores.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine record_level(c, box, shells, part, cell, solid, cell_of, face_of, stored, &
    images)
        integer, intent(in) :: c !! solid cells
        type(box_t), intent(in) :: box
        type(shells_t), intent(in) :: shells !@buffer
        real(rk), intent(in) :: part !! of a difference
        integer(int32), intent(in) :: cell(*)
        integer(int8), intent(in) :: solid(*)
        integer, intent(in) :: cell_of(*), face_of(6, *)
        real(rk), intent(in) :: stored(max_var, *) !! before
        real(dp), intent(inout) :: images(3) !@sum of what they took [N s]
        integer :: b, d, k, o, ijk(3), offset(3)
        logical :: at_plane, turned(3)

        ijk = cell_at(box%n, cell(c))
        at_plane = .false.
        do d = 1, 3
            at_plane = at_plane .or. (ijk(d) == 1 .and. box%mirrors(1, d)) &
                       .or. (ijk(d) == box%n(d) .and. box%mirrors(2, d))
        end do
        if (.not. at_plane) return
        if (faces_at(c, face_of) == 0) return
        if (.not. is_own(box, cell(c))) return
        do o = 1, shells%first(touching + 1) - 1
            do k = 1, 3
                offset(k) = shells%offset(k, o)
            end do
            if (max(abs(offset(1)), abs(offset(2)), abs(offset(3))) > 1) cycle
            call find_partner(c, box, ijk, offset, solid, cell_of, face_of, b, turned)
            if (b == 0) cycle
            do d = 1, 3
                if (turned(d)) images(d) = images(d) + part*box%area(d)*box%dx(d) &
                    *(real(stored(1 + d, c), dp) + stored(1 + d, b))
            end do
        end do
    end subroutine record_level

    !> Part of each cell store that lies beyond its band, which is -1..2 of the gas beside it.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine judge_stored(c, box, cell, gas, face_of, u, excess, low, high, over)
        integer, intent(in) :: c !! solid cells
        type(box_t), intent(in) :: box
        integer(int32), intent(in) :: cell(*), gas(*)
        integer, intent(in) :: face_of(6, *)
        real(rk), intent(in) :: u(*)
        real(rk), intent(inout) :: excess(*)
        real(rk), intent(inout) :: low !@least cell store in its band, over the gas beside
        real(rk), intent(inout) :: high !@most of them
        integer, intent(inout) :: over !@count cell stores beyond their band
        real(rk) :: energy, q(5), ratio, rho
        integer(int64) :: at
        integer :: f, faces, k, row

        rho = 0
        energy = 0
        faces = 0
        do row = 1, 6
            f = face_of(row, c)
            if (f == 0) cycle
            at = place_at(box, gas(f))
            rho = rho + u(at)
            energy = energy + u(at + 4*box%grid%apart)
            faces = faces + 1
        end do
        excess(c) = 0
        if (faces == 0) return
        at = place_at(box, cell(c))
        do k = 1, 5
            q(k) = u(at + (k - 1)*box%grid%apart)
        end do
        ratio = stored_ratio(q, rho/faces, energy/faces)
        excess(c) = stored_excess(ratio)
        ratio = ratio*(1 - excess(c))
        if (excess(c) > 0) over = over + 1
        if (.not. is_own(box, cell(c))) return
        low = min(low, ratio)
        high = max(high, ratio)
    end subroutine judge_stored

    !> Take the excess out of the cell stores: `share` holds what each face of a cell hands over.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine take_excess(c, box, cell, face_of, excess, u, share)
        integer, intent(in) :: c !! solid cells
        type(box_t), intent(in) :: box
        integer(int32), intent(in) :: cell(*)
        integer, intent(in) :: face_of(6, *)
        real(rk), intent(in) :: excess(*)
        real(rk), intent(inout) :: u(*), share(max_var, *)
        real(rk) :: q
        integer(int64) :: at
        integer :: faces, k

        if (.not. excess(c) > 0) return
        faces = faces_at(c, face_of)
        at = place_at(box, cell(c))
        do k = 1, box%n_var
            q = excess(c)*u(at + (k - 1)*box%grid%apart)
            u(at + (k - 1)*box%grid%apart) = u(at + (k - 1)*box%grid%apart) - q
            share(k, c) = q/faces
        end do
    end subroutine take_excess

    !> The next face of a gas cell, in the order of the list, whose cell store has an excess; or 0.
    !@cuf attributes(host,device) &
    pure function next_excess(box, after, number, solid, cell_of, face_of, excess) result(next)
        type(box_t), intent(in) :: box
        integer, intent(in) :: after !! face
        integer(int32), intent(in) :: number !! gas cell
        integer(int8), intent(in) :: solid(*)
        integer, intent(in) :: cell_of(*), face_of(6, *)
        real(rk), intent(in) :: excess(*)
        integer :: next, b, d, f, row, ijk(3), offset(3)
        integer(int64) :: at

        next = 0
        ijk = cell_at(box%n, number)
        do row = 1, 6
            if (box%n(direction_of(row)) == 1) cycle
            do d = 1, 3
                offset(d) = merge(sign_of(row), 0, d == direction_of(row))
            end do
            at = place_beside(box, ijk, offset)
            if (at == 0) cycle
            if (solid(at) == 0) cycle
            b = cell_of(at)
            f = face_of(row, b)
            if (f <= after .or. .not. excess(b) > 0) cycle
            if (next == 0 .or. f < next) next = f
        end do
    end function next_excess

    !> flag(f) = 1 at the first of the faces that hand an excess to a gas cell without a deferred
    !> source.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine first_excess(f, box, gas, owner, solid, cell_of, face_of, excess, slot, flag)
        integer, intent(in) :: f !! faces
        type(box_t), intent(in) :: box
        integer(int32), intent(in) :: gas(*), owner(*)
        integer(int8), intent(in) :: solid(*)
        integer, intent(in) :: cell_of(*), face_of(6, *)
        real(rk), intent(in) :: excess(*)
        integer(int32), intent(in) :: slot(*)
        integer(int32), intent(inout) :: flag(*)

        flag(f) = 0
        if (.not. excess(owner(f)) > 0) return
        if (slot(gas(f)) > 0) return
        if (next_excess(box, 0, gas(f), solid, cell_of, face_of, excess) == f) flag(f) = 1
    end subroutine first_excess

    !> Open deferred sources; `start` holds how many are opened before each face.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine open_excess(f, n_var, so_many, start, gas, slot, deferred_cell, deferred)
        integer, intent(in) :: f !! faces
        integer, intent(in) :: n_var, so_many !! variables, deferred sources so far
        integer(int32), intent(in) :: start(*), gas(*)
        integer(int32), intent(inout) :: slot(*), deferred_cell(*)
        real(rk), intent(inout) :: deferred(n_var, *)
        integer :: e, k

        if (start(f + 1) == start(f)) return
        e = so_many + start(f + 1)
        slot(gas(f)) = e
        deferred_cell(e) = gas(f)
        do k = 1, n_var
            deferred(k, e) = 0
        end do
    end subroutine open_excess

    !> Each gas cell gathers what the cell stores around it have handed over, in the order of the
    !> faces.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine give_excess(f, box, n_var, gas, owner, solid, cell_of, face_of, excess, share, &
                                slot, deferred)
        integer, intent(in) :: f !! faces
        type(box_t), intent(in) :: box
        integer, intent(in) :: n_var !! variables
        integer(int32), intent(in) :: gas(*), owner(*)
        integer(int8), intent(in) :: solid(*)
        integer, intent(in) :: cell_of(*), face_of(6, *)
        real(rk), intent(in) :: excess(*), share(max_var, *)
        integer(int32), intent(in) :: slot(*)
        real(rk), intent(inout) :: deferred(n_var, *)
        integer :: e, k, next

        if (.not. excess(owner(f)) > 0) return
        next = next_excess(box, 0, gas(f), solid, cell_of, face_of, excess)
        if (next /= f) return
        e = slot(gas(f))
        do while (next > 0)
            do k = 1, n_var
                deferred(k, e) = deferred(k, e) + share(k, owner(next))
            end do
            next = next_excess(box, next, gas(f), solid, cell_of, face_of, excess)
        end do
    end subroutine give_excess

    !> Sum of the cell stores of this process.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine total_stored(c, box, cell, u, total)
        integer, intent(in) :: c !! solid cells
        type(box_t), intent(in) :: box
        integer(int32), intent(in) :: cell(*)
        real(rk), intent(in) :: u(*)
        real(dp), intent(inout) :: total(6) !@exact per cell volume
        integer(int64) :: at
        integer :: k

        if (.not. is_own(box, cell(c))) return
        at = place_at(box, cell(c))
        do k = 1, 6
            if (k <= box%n_var) total(k) = total(k) + u(at + (k - 1)*box%grid%apart)
        end do
    end subroutine total_stored
end module brz_cell_store_loop_bodies
