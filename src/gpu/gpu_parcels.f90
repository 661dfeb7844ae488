! SPDX-License-Identifier: MIT
!> What particles need of those of other processes, between GPUs: as brz_gpu_fetch, for lists of
!> places that change whenever neighbours are looked for anew.
module brz_gpu_parcels
    use brz_buffers, only: buffer_t, integers_t
    use brz_device, only: allocate_buffer, device_t, free_buffers, put_buffer
    use brz_errors, only: error_t
    use brz_gpu_peers, only: peers_t
    use brz_kinds, only: int64
    use brz_mail, only: mail_t, make_room
    use brz_place_launches, only: place_kernels_t
    use brz_ranks, only: ranks_t, several
    use brz_solid_part, only: part_t
    implicit none
    private
    public :: gpu_parcels_t, words_of

    type :: gpu_parcels_t
        type(ranks_t) :: ranks
        integer, allocatable :: out_first(:), in_first(:) !! (0:processes)
        type(mail_t) :: mail
        type(integers_t) :: out, in !! places of particles, and of their ghosts
        type(integers_t) :: words !! of parcels to others
        type(integers_t) :: came !! of parcels from others
        type(peers_t) :: peers
        type(place_kernels_t) :: kernels
    contains
        procedure :: open, close, refresh
    end type gpu_parcels_t

contains

    !> Get ready for the ghosts of now.
    subroutine open (self, device, ranks, part, most, err)
        class(gpu_parcels_t), intent(inout) :: self
        type(device_t), intent(in) :: device
        type(ranks_t), intent(in) :: ranks
        type(part_t), intent(in) :: part
        integer, intent(in) :: most !! words of 4 B of a particle in a message
        type(error_t), intent(inout) :: err
        integer(int64) :: n

        self%ranks = ranks
        if (.not. several(ranks)) return
        self%out_first = part%out%first
        self%in_first = part%in%first
        call self%kernels%open(device, err)
        call put_buffer(part%out%place, self%out, 4*size(part%out%place, kind=int64), err)
        call put_buffer(part%in%place, self%in, 4*size(part%in%place, kind=int64), err)
        n = max(size(part%out%place), size(part%in%place))
        call allocate_buffer(self%words, 4*most*n, err)
        call lengths(self, most) ! later ones are no longer
        call self%peers%open(ranks, int(self%out_first, int64), int(self%in_first, int64), &
                             4*most, err)
    end subroutine open

    subroutine close (self)
        class(gpu_parcels_t), intent(inout) :: self

        call free_buffers(self%out, self%in, self%words)
        call self%peers%close(self%ranks)
    end subroutine close

    !> An array of particles as rows of words of 4 B.
    pure type(integers_t) function words_of(array) result(words)
        class(buffer_t), intent(in) :: array

        words%address = array%address
        words%bytes = array%bytes
    end function words_of

    !> Room for messages of so many words of each particle, an even number.
    subroutine lengths(self, words)
        class(gpu_parcels_t), intent(inout) :: self
        integer, intent(in) :: words

        associate (n => self%ranks%n, out => self%out_first, in => self%in_first)
            call make_room(self%ranks, 4_int64*words*(out(1:n) - out(0:n - 1)), &
                           4_int64*words*(in(1:n) - in(0:n - 1)), self%mail)
        end associate
    end subroutine lengths

    !> Bring the rows of ghosts in some arrays up to date.
    subroutine refresh(self, arrays, words, err)
        class(gpu_parcels_t), intent(inout) :: self
        type(integers_t), intent(in) :: arrays(:)
        integer, intent(in) :: words(:) !! of a row of each array; together an even number
        type(error_t), intent(inout) :: err
        integer :: k, n

        n = self%ranks%n
        call lengths(self, sum(words))
        do k = 1, size(arrays)
            if (self%out_first(n) > 1) call self%kernels%pick_words(self%out_first(n) - 1, &
                words(k), sum(words), sum(words(:k - 1)), self%out, arrays(k), self%words, err)
        end do
        call self%peers%swap(self%ranks, self%mail, 4*sum(words), self%words, self%came, err)
        do k = 1, size(arrays)
            if (self%in_first(n) > 1) call self%kernels%put_words(self%in_first(n) - 1, words(k), &
                sum(words), sum(words(:k - 1)), self%in, self%came, arrays(k), err)
        end do
    end subroutine refresh
end module brz_gpu_parcels
