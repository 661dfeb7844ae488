! SPDX-License-Identifier: MIT
!> The coupling halo of processes: gas of others in the halo of the air that each one sees.
module brz_coupling_windows
    use brz_air_state, only: air_t
    use brz_boxes, only: asks_of
    use brz_coupling_part, only: coupling_part_t
    use brz_coupling_state, only: coupling_t
    use brz_cut_share, only: open_share_of_gpus
    use brz_errors, only: error_t
    use brz_fetch, only: fetch
    use brz_lists, only: put_list
    use brz_places, only: message_buffers_t
    use brz_record_rules, only: w => words_of_real
    implicit none
    private
    public :: see_halo, see_beside, open_windows_of_gpus, put_halos

contains

    !> Bring the gas in the halo of this process up to date, before a GPU takes over.
    subroutine see_halo(air)
        type(air_t), intent(inout) :: air

        call fetch(air%part%ranks, air%part%coupling_halo, air%n_var, air%before + 1 - air%g, &
                   air%before + air%n + air%g, air%u)
    end subroutine see_halo

    !> Bring the gas beside the box up to date, as far as stencils and gauges reach. Of cut cells
    !> farther away listed ones alone are read, see brz_cut_share.
    subroutine see_beside(air, c, err)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(in) :: c
        type(error_t), intent(inout) :: err

        if (c%on_gpu) then
            call air%device%halo%reals_of_others(air%grid%apart, air%device%u, err)
        else
            call fetch(air%part%ranks, air%part%halo, air%n_var, air%before + 1 - air%g, &
                       air%before + air%n + air%g, air%u)
        end if
    end subroutine see_beside

    !> Get ready to speak between GPUs with the other processes, whose halos are known. No ghosts
    !> are listed then.
    subroutine open_windows_of_gpus(air, c, err)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err
        integer, parameter :: most = 6 + 11*w + 2 !! words of a ghost, with its volume
        type(coupling_part_t) :: part
        type(message_buffers_t) :: nothing

        part%boxes = c%part%boxes
        part%halos = c%part%halos
        part%near = c%part%near
        part%messages%ranks = air%part%ranks
        part%messages%on_gpu = .true.
        c%part = part
        deallocate (c%ghosts)
        allocate (c%ghosts, source=c%ghost_bodies)
        c%ghosts%on_gpu = .true.
        c%ghosts%wide = 4
        c%ghosts%stride_p = 1
        c%ghosts%stride_t = 1
        call open_share_of_gpus(c%wall%share, c%wall%cells, err)
        allocate (nothing%place(0), nothing%first(0:air%part%ranks%n))
        nothing%first = 1
        call c%part%messages%device%open(air%part%ranks, nothing, nothing, max(most, 1 + 6*w), err)
    end subroutine open_windows_of_gpus

    !> What loop bodies are told of the halos of all processes, of their boxes, and of halos with a
    !> layer around.
    subroutine put_halos(c, err)
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err

        call put_list(c%on_gpu, asks_of(c%part%halos), c%part%halos_at, err)
        call put_list(c%on_gpu, asks_of(c%part%boxes), c%part%boxes_at, err)
        call put_list(c%on_gpu, asks_of(c%part%near), c%part%near_at, err)
    end subroutine put_halos
end module brz_coupling_windows
