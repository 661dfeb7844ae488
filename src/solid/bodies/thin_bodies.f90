! SPDX-License-Identifier: MIT
!> Bodies of a single layer or row of particles: their sums know nothing of the strain across.
!>
!> Left at zero, it makes them too stiff (a row of steel by 36 %) until they give way sideways.
!> Only the membranes of brz_membrane, and what other bodies are bonded to, are right; in a
!> total-Lagrangian body dx/dX is singular, and there is no stress at all.
module brz_thin_bodies
    use brz_bar_layers, only: layers_across
    use brz_body, only: body_t
    use brz_body_shape, only: shape_t
    use brz_case, only: case_t, interaction_case_t, is_held_whole, label
    use brz_errors, only: error_t, exit_deck, raise
    use brz_formulation_names, only: form_rigid, form_total
    use brz_interaction_setup, only: find_rule
    use brz_kinds, only: dp, real32
    use brz_material, only: class_fluid, material_t
    use brz_text, only: to_text
    implicit none
    private
    public :: is_bonded, judge_bars, judge_thin

contains

    !> True if body b shares its sums with another one (of other shapes than bars, if `no_bars`).
    logical function is_bonded(case, b, no_bars)
        type(case_t), intent(in) :: case
        integer, intent(in) :: b
        logical, intent(in), optional :: no_bars
        type(interaction_case_t) :: rule
        integer :: other

        is_bonded = .true.
        do other = 1, size(case%bodies)
            if (other == b) cycle
            if (present(no_bars)) then
                if (no_bars .and. case%bodies(other)%shape == 'bars') cycle
            end if
            call find_rule(case, b, other, rule)
            if (rule%law == 'bonded' .or. rule%law == 'shared') return
        end do
        is_bonded = .false.
    end function is_bonded

    !> Particles across a bar. One alone is refused where no body around it gives it its sums.
    subroutine judge_bars(case, b, body, err)
        type(case_t), intent(in) :: case
        integer, intent(in) :: b
        type(body_t), intent(inout) :: body
        type(error_t), intent(inout) :: err

        associate (input => case%bodies(b))
            body%across = layers_across(input, input%spacing)
            body%thin = body%across == 1
            if (body%across > 1 .or. is_held_whole(input)) return
            if (body%formulation == form_rigid) return
            if (is_bonded(case, b, no_bars=.true.)) return
            call raise(err, exit_deck, label('body', input%id, input%place)//'one particle '// &
                       'across a bar that no body is bonded to is too stiff (by a third in '// &
                       'steel) and then gives way sideways; two stretch right, three bend '// &
                       'right too: use a spacing of at most '// &
                       to_text(real(input%diameter/1.5_dp, real32))//' m or '// &
                       to_text(real(input%diameter/2.5_dp, real32))//' m')
        end associate
    end subroutine judge_bars

    !> A body of one layer or row that is no membrane: a warning, or the end if nothing stresses it.
    subroutine judge_thin(case, b, shape, material, body, notes, err)
        type(case_t), intent(in) :: case
        integer, intent(in) :: b
        type(shape_t), intent(in) :: shape
        type(material_t), intent(in) :: material
        type(body_t), intent(inout) :: body
        character(:), allocatable, intent(inout) :: notes
        type(error_t), intent(inout) :: err
        character(:), allocatable :: name, remedy
        logical :: thin(3)
        integer :: d

        associate (input => case%bodies(b))
            if (input%shape == 'bars' .or. input%shape == 'particles') return
            d = shape%dimension
            thin = .false.
            thin(:d) = shape%n(:d) == 1 .and. .not. shape%on_plane(:d)
            body%thin = any(thin)
            if (.not. any(thin) .or. all(shape%n(:d) == 1)) return
            if (body%formulation == form_rigid .or. is_held_whole(input) .or. body%layer > 0) return
            if (material%class == class_fluid .or. is_bonded(case, b)) return
            name = label('body', input%id, input%place)
            if (body%formulation == form_total) then
                call raise(err, exit_deck, name//"formulation='total_lagrangian' has no stress "// &
                           'in a single layer or row of particles; use a spacing that lays two '// &
                           "or more, or 'bending' for a single layer")
                return
            end if
        end associate
        remedy = 'lay two or more'
        if (count(thin) == 1) remedy = remedy//", or take formulation='bending', a membrane then"
        notes = notes//name//'warning: a single '//trim(merge('layer', 'row  ', count(thin) == 1)) &
            //' of particles does not see what it strains across: it is too stiff (a row of '// &
            'steel by a third), and then gives way sideways; '//remedy//new_line('a')
    end subroutine judge_thin
end module brz_thin_bodies
