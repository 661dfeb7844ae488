! SPDX-License-Identifier: MIT
!> Surfaces of triangles from STL files, binary or text, that must be watertight.
module brz_stl
    use, intrinsic :: iso_fortran_env, only: int32, real32
    use brz_errors, only: error_t, exit_deck, failed, raise
    use brz_files, only: read_text_file
    use brz_kinds, only: dp, int64
    use brz_row_order, only: order_rows
    use brz_text, only: to_text
    implicit none
    private
    public :: mesh_t, read_stl, is_inside, nearest_on

    integer, parameter :: head_bytes = 84, triangle_bytes = 50 !! of a binary file

    !> A closed surface whose triangles all turn the same way, normals outward.
    type :: mesh_t
        real(dp), allocatable :: corner(:, :, :) !! (3, 3, triangles) coordinates of three corners
        real(dp) :: lo(3) = 0, hi(3) = 0 !! corners of the box around it [m]
        real(dp) :: volume = 0 !! [m3]
    end type mesh_t

contains

    !> Read a surface and check it. Raises exit_deck where it is no closed surface; with `is_patch`
    !> it may be open, and its volume is not measured.
    subroutine read_stl(path, mesh, err, is_patch)
        character(*), intent(in) :: path
        type(mesh_t), intent(out) :: mesh
        type(error_t), intent(inout) :: err
        logical, intent(in), optional :: is_patch
        character(:), allocatable :: bytes
        integer :: n

        call read_text_file(path, bytes, err)
        if (failed(err)) return
        n = 0
        if (len(bytes) >= head_bytes) n = transfer(bytes(81:84), n)
        if (n > 0 .and. len(bytes) - head_bytes == int(triangle_bytes, int64)*n) then
            call from_binary(bytes, n, mesh)
        else
            call from_text(path, bytes, mesh, err)
        end if
        if (present(is_patch)) then
            if (is_patch) return
        end if
        if (.not. failed(err)) call check_edges(path, mesh, err)
        if (failed(err)) return
        call measure(mesh)
        if (.not. abs(mesh%volume) > 0) &
            call raise(err, exit_deck, path//': the surface encloses no volume')
    end subroutine read_stl

    subroutine from_binary(bytes, n, mesh)
        character(*), intent(in) :: bytes
        integer, intent(in) :: n !! triangles
        type(mesh_t), intent(inout) :: mesh
        real(real32) :: numbers(12)
        integer :: at, t

        allocate (mesh%corner(3, 3, n))
        do t = 1, n
            at = head_bytes + triangle_bytes*(t - 1)
            numbers = transfer(bytes(at + 1:at + 48), numbers)
            mesh%corner(:, :, t) = real(reshape(numbers(4:12), [3, 3]), dp)
        end do
    end subroutine from_binary

    !> The corners stand behind the word 'vertex'.
    subroutine from_text(path, text, mesh, err)
        character(*), intent(in) :: path, text
        type(mesh_t), intent(inout) :: mesh
        type(error_t), intent(inout) :: err
        real(dp), allocatable :: x(:, :)
        integer :: at, i, io, n, pass, length

        do pass = 1, 2
            at = 1
            n = 0
            do
                i = index(text(at:), 'vertex ')
                if (i == 0) exit
                at = at + i + 6
                n = n + 1
                if (pass == 1) cycle
                length = scan(text(at:)//new_line('a'), new_line('a'))
                read (text(at:min(at + length - 1, len(text))), *, iostat=io) x(:, n)
                if (io /= 0) call raise(err, exit_deck, path//': corner '//to_text(n)// &
                                        ' is no three numbers')
            end do
            if (pass == 1) allocate (x(3, n))
        end do
        if (n == 0 .or. modulo(n, 3) /= 0) call raise(err, exit_deck, path//': is no STL file: '// &
            'neither its length is that of a binary one, nor does it hold triangles as text')
        if (.not. failed(err)) mesh%corner = reshape(x, [3, 3, n/3])
    end subroutine from_text

    !> Every edge must belong to two triangles, which run along it in opposite directions.
    subroutine check_edges(path, mesh, err)
        character(*), intent(in) :: path
        type(mesh_t), intent(in) :: mesh
        type(error_t), intent(inout) :: err
        real(dp), allocatable :: edge(:, :)
        integer, allocatable :: id(:, :), order(:)
        integer :: c, n, t, a, b

        call weld(mesh, id)
        n = 0
        allocate (edge(3, size(id)))
        do t = 1, size(id, 2)
            if (id(1, t) == id(2, t) .or. id(2, t) == id(3, t) .or. id(1, t) == id(3, t)) cycle
            do c = 1, 3
                a = id(c, t)
                b = id(modulo(c, 3) + 1, t)
                n = n + 1
                edge(:, n) = [min(a, b), max(a, b), merge(1, 2, a < b)]
            end do
        end do
        allocate (order(n))
        call order_rows(edge(:, :n), order)
        edge = edge(:, order)
        do c = 1, n, 2
            if (c == n) exit
            if (any(abs(edge(1:2, c) - edge(1:2, c + 1)) > 0)) exit
            if (edge(3, c) > 1 .or. edge(3, c + 1) < 2) exit
        end do
        if (c <= n) call raise(err, exit_deck, path//': the surface is not watertight: an edge '// &
            'of its triangles has no partner that runs the other way; close its holes and turn '// &
            'all triangles alike')
    end subroutine check_edges

    !> Numbers of the corners, the same for equal places.
    subroutine weld(mesh, id)
        type(mesh_t), intent(in) :: mesh
        integer, allocatable, intent(out) :: id(:, :) !! (3, triangles)
        real(dp), allocatable :: x(:, :)
        integer, allocatable :: order(:), number(:)
        integer :: i, n

        n = 3*size(mesh%corner, 3)
        x = reshape(mesh%corner, [3, n])
        allocate (order(n), number(n))
        call order_rows(x, order)
        number(order(1)) = 1
        do i = 2, n
            number(order(i)) = number(order(i - 1))
            if (any(abs(x(:, order(i)) - x(:, order(i - 1))) > 0)) &
                number(order(i)) = number(order(i)) + 1
        end do
        id = reshape(number, [3, n/3])
    end subroutine weld

    !> Box and volume; a surface that is inside out is turned.
    subroutine measure(mesh)
        type(mesh_t), intent(inout) :: mesh
        real(dp) :: a(3), b(3), c(3)
        integer :: t

        do t = 1, 3
            mesh%lo(t) = minval(mesh%corner(t, :, :))
            mesh%hi(t) = maxval(mesh%corner(t, :, :))
        end do
        mesh%volume = 0
        do t = 1, size(mesh%corner, 3)
            a = mesh%corner(:, 1, t) - mesh%lo
            b = mesh%corner(:, 2, t) - mesh%lo
            c = mesh%corner(:, 3, t) - mesh%lo
            mesh%volume = mesh%volume + (a(1)*(b(2)*c(3) - b(3)*c(2)) &
                + a(2)*(b(3)*c(1) - b(1)*c(3)) + a(3)*(b(1)*c(2) - b(2)*c(1)))/6
        end do
        if (mesh%volume < 0) then
            mesh%corner = mesh%corner(:, [1, 3, 2], :)
            mesh%volume = -mesh%volume
        end if
    end subroutine measure

    !> The place of a triangle that is nearest to a point: on its face, an edge, or a corner.
    pure function nearest_on(c, x) result(place)
        real(dp), intent(in) :: c(3, 3) !! corners
        real(dp), intent(in) :: x(3)
        real(dp) :: place(3), side(3), other(3), to(3), share(2), g(3), part
        integer :: k

        side = c(:, 2) - c(:, 1)
        other = c(:, 3) - c(:, 1)
        to = x - c(:, 1)
        g = [dot_product(side, side), dot_product(side, other), dot_product(other, other)]
        part = g(1)*g(3) - g(2)**2
        share = [g(3)*dot_product(side, to) - g(2)*dot_product(other, to), &
                 g(1)*dot_product(other, to) - g(2)*dot_product(side, to)]
        if (part > 0 .and. all(share >= 0) .and. sum(share) <= part) then
            place = c(:, 1) + (share(1)*side + share(2)*other)/part
            return
        end if
        place = c(:, 1)
        do k = 1, 3
            side = c(:, modulo(k, 3) + 1) - c(:, k)
            part = dot_product(side, x - c(:, k))/max(dot_product(side, side), tiny(part))
            other = c(:, k) + max(0.0_dp, min(1.0_dp, part))*side
            if (norm2(other - x) < norm2(place - x)) place = other
        end do
    end function nearest_on

    !> Which points of a lattice lie inside: along every column in z the surface is crossed in and
    !> out. A column that meets an edge exactly counts as moved by a trace in x, and by still less
    !> in y, so that it crosses one of the two triangles, never both or none.
    subroutine is_inside(mesh, start, spacing, inside, once)
        type(mesh_t), intent(in) :: mesh
        real(dp), intent(in) :: start(3), spacing(3) !! low corner and distances of the lattice [m]
        logical, intent(out) :: inside(:, :, :)
        logical, intent(out), optional :: once !! no point lies in two parts, or in one inside out
        integer, allocatable :: winding(:, :, :)
        integer :: i, j, k, t, first(2), last(2), side, n(3)
        real(dp) :: p(2), z

        n = shape(inside)
        allocate (winding(n(1), n(2), n(3)), source=0)
        do t = 1, size(mesh%corner, 3)
            associate (c => mesh%corner(:, :, t))
                first = max(1, floor((minval(c(1:2, :), 2) - start(1:2))/spacing(1:2)))
                last = min(n(1:2), ceiling((maxval(c(1:2, :), 2) - start(1:2))/spacing(1:2)) + 1)
                do j = first(2), last(2)
                    do i = first(1), last(1)
                        p = start(1:2) + ([i, j] - 0.5_dp)*spacing(1:2)
                        call cross_column(c, p, side, z)
                        if (side == 0) cycle
                        k = max(1, floor((z - start(3))/spacing(3) + 0.5_dp) + 1)
                        if (k <= n(3)) winding(i, j, k) = winding(i, j, k) + side
                    end do
                end do
            end associate
        end do
        do k = 2, n(3)
            winding(:, :, k) = winding(:, :, k) + winding(:, :, k - 1)
        end do
        inside = winding /= 0
        if (present(once)) once = all(winding == 0 .or. winding == 1)
    end subroutine is_inside

    !> Does a column cross a triangle: -1 out of the body upwards, 1 into it, 0 not; and where.
    pure subroutine cross_column(c, p, side, z)
        real(dp), intent(in) :: c(3, 3) !! corners
        real(dp), intent(in) :: p(2) !! of the column
        integer, intent(out) :: side
        real(dp), intent(out) :: z
        real(dp) :: w(3)
        integer :: s(3)

        call edge_side(c(1:2, 2), c(1:2, 3), p, w(1), s(1))
        call edge_side(c(1:2, 3), c(1:2, 1), p, w(2), s(2))
        call edge_side(c(1:2, 1), c(1:2, 2), p, w(3), s(3))
        side = 0
        z = 0
        if (s(1) /= s(2) .or. s(2) /= s(3) .or. s(1) == 0) return
        side = -s(1)
        z = sum(c(3, :))/3
        if (abs(sum(w)) > 0) z = dot_product(w, c(3, :))/sum(w)
    end subroutine cross_column

    !> Side of an edge on which a point lies, computed alike for both triangles of the edge.
    pure subroutine edge_side(a, b, p, w, side)
        real(dp), intent(in) :: a(2), b(2), p(2)
        real(dp), intent(out) :: w !! twice the area of a, b, p
        integer, intent(out) :: side !! 1 left of a-b, -1 right, 0: the edge is a point
        real(dp) :: lo(2), hi(2), d(2)
        logical :: turned

        turned = a(1) > b(1) .or. (.not. a(1) < b(1) .and. a(2) > b(2))
        lo = merge(b, a, turned)
        hi = merge(a, b, turned)
        d = hi - lo
        w = d(1)*(p(2) - lo(2)) - d(2)*(p(1) - lo(1))
        side = 0
        if (w > 0) side = 1
        if (w < 0) side = -1
        if (side == 0) side = nint(sign(1.0_dp, -d(2)))*merge(1, 0, abs(d(2)) > 0)
        if (side == 0 .and. d(1) > 0) side = 1
        if (turned) then
            w = -w
            side = -side
        end if
    end subroutine edge_side
end module brz_stl
