! SPDX-License-Identifier: MIT
!> Bodies of a linear pressure (p = K mu) under loads of the order of their modulus, as foam under
!> blast: such material stiffens or crushes, the law does not, and the run ends in an impossible
!> state (docs/manual/materials.md, foam).
module brz_soft_bodies
    use brz_body, only: body_t
    use brz_case, only: case_t, label
    use brz_formulation_names, only: form_rigid
    use brz_kinds, only: dp, real32
    use brz_kingery_bulmash, only: blast_t, farthest, free_air_blast, nearest, nearest_ground, &
                                   surface_blast
    use brz_material, only: material_t
    use brz_body_geometries, only: body_box
    use brz_text, only: to_text
    implicit none
    private
    public :: judge_soft

    ! A cube of E = 20 MPa under 10 MPa (0.6 K) is lost, one of 40 MPa (0.3 K) is not.
    real(dp), parameter :: much = 0.2_dp !! pressure over the bulk modulus
    character(*), parameter :: linear(3) = [character(14) :: 'linear_elastic', 'bilinear_j2', &
                                            'drucker_prager']

contains

    !> Warn of a body that its loads press by a good part of its bulk modulus.
    subroutine judge_soft(case, b, material, body, notes)
        type(case_t), intent(in) :: case
        integer, intent(in) :: b !! body
        type(material_t), intent(in) :: material
        type(body_t), intent(in) :: body
        character(:), allocatable, intent(inout) :: notes
        real(dp) :: peak, share

        associate (input => case%bodies(b))
            if (body%formulation == form_rigid) return
            if (all(linear /= case%materials(input%material_index)%model)) return
            peak = largest_pressure(case, b)
            share = peak/real(material%bulk, dp)
            if (.not. share > much) return
            notes = notes//label('body', input%id, input%place)//'warning: it is loaded by '// &
                'up to '//to_text(real(1e-6_dp*peak, real32))//' MPa, '// &
                to_text(nint(100*share))//' % of its bulk modulus, where p = K mu holds for '// &
                'no material and the run may end in an impossible state; foam needs a law '// &
                'that crushes (hjc by its crush curve) and sides that are fixed: '// &
                'docs/manual/materials.md, foam'//new_line('a')
        end associate
    end subroutine judge_soft

    !> Largest pressure that a body is told to bear, or that charges in the air have at it by the
    !> curves of Kingery and Bulmash [Pa].
    real(dp) function largest_pressure(case, b) result(peak)
        type(case_t), intent(in) :: case
        integer, intent(in) :: b !! body
        integer :: k

        peak = 0
        if (allocated(case%loads)) then
            do k = 1, size(case%loads)
                associate (load => case%loads(k))
                    if (load%body /= b .or. load%on_all) cycle
                    if (load%mass > 0) then
                        peak = max(peak, reflected(load%mass, load%at, load%on_ground))
                    else
                        peak = max(peak, maxval(abs(load%pressure)))
                    end if
                end associate
            end do
        end if
        if (.not. (case%air%present .and. allocated(case%charges))) return
        do k = 1, size(case%charges)
            peak = max(peak, reflected(case%charges(k)%mass, case%charges(k)%at, .false.))
        end do

    contains

        !> Reflected pressure at the nearest point of the box around the body [Pa].
        real(dp) function reflected(mass, at, on_ground)
            real(dp), intent(in) :: mass, at(3) !! [kg], [m]
            logical, intent(in) :: on_ground
            real(dp) :: lo(3), hi(3), scaled
            type(blast_t) :: blast

            call body_box(case%bodies(b), lo, hi)
            scaled = norm2(min(max(at, lo), hi) - at)/mass**(1/3.0_dp)
            reflected = 0
            if (scaled > farthest) return
            if (on_ground) then
                blast = surface_blast(mass, max(scaled, nearest_ground)*mass**(1/3.0_dp))
            else
                blast = free_air_blast(mass, max(scaled, nearest)*mass**(1/3.0_dp))
            end if
            reflected = blast%reflected
        end function reflected
    end function largest_pressure
end module brz_soft_bodies
