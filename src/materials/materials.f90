! SPDX-License-Identifier: MIT
!> The registry of material models.
!>
!> A new model is one new file: scripts/models.py finds it, and writes the list of the models, the
!> case of each and its kernel into the build folder.
module brz_materials
    use brz_kinds, only: rk
    use brz_case, only: material_case_t
    use brz_errors, only: error_t, raise, exit_deck
    use brz_key, only: key_t
    use brz_material, only: material_t, point_t, n_hist, material_ok, material_not_finite, &
                            material_step_too_large
    use brz_model, only: derived_t, model_t, load_parameters, material_label
    use brz_model_list, only: apply_model, list_models
    use brz_text, only: string_t
    implicit none
    private
    public :: material_keys, material_remarks, make_material, start_point, update_material, &
              update_model, history_names, derived_constants, unloaded_speed

    ! Numbers beyond these are no state of a solid; below them no update can overflow, in real32
    ! either. The strain of one step is the sum of |dv_i/dx_j| dt.
    real(rk), parameter :: most_strain = 1, most_mu = 1e3_rk, most_stress = 1e16_rk, &
                           most_energy = 1e14_rk, most_history = 1e14_rk

contains

    !> Move a material point over one step.
    !>
    !> On entry the point holds the state at step n, on exit the one at n+1: compression by the
    !> exact exponential, Cauchy stress, energy by the trapezoid of the stress work, damage, wave
    !> speeds and the plastic and damage work of this step. A positive status: the point is as it
    !> was. No NaN ever comes out.
    !@cuf attributes(host,device) &
    pure subroutine update_material(material, dt, crack, l, point, status)
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: dt !! time step [s]
        real(rk), intent(in) :: crack !! width of a smeared crack [m]
        real(rk), intent(in) :: l(3, 3) !! velocity gradient dv_i/dx_j at mid-step [1/s]
        type(point_t), intent(inout) :: point
        integer, intent(out) :: status !! see brz_material

        call update_model(int(material%model), material, dt, crack, l, point, status)
    end subroutine update_material

    !> The same where the model is known beforehand: with a constant `model`, a compiler keeps the
    !> code of that model alone.
    !@cuf attributes(host,device) &
    pure subroutine update_model(model, material, dt, crack, l, point, status)
        integer, intent(in) :: model !! code, that of the material
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: dt, crack, l(3, 3) !! [s, m, 1/s]
        type(point_t), intent(inout) :: point
        integer, intent(out) :: status

        call check_input(material, dt, crack, l, point, status)
        if (status == material_ok) call apply_model(model, material, dt, crack, l, point, status)
    end subroutine update_model

    !> Refuse what is not a number or cannot be a state of a solid.
    !@cuf attributes(host,device) &
    pure subroutine check_input(material, dt, crack, l, point, status)
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: dt, crack, l(3, 3)
        type(point_t), intent(in) :: point
        integer, intent(out) :: status
        real(rk) :: rate, stress, history
        integer :: i

        rate = 0
        do i = 1, 3
            rate = rate + abs(l(1, i)) + abs(l(2, i)) + abs(l(3, i))
        end do
        stress = 0
        do i = 1, 6
            stress = stress + abs(point%stress(i))
        end do
        history = 0
        do i = 1, n_hist
            if (i <= material%n_hist) history = history + abs(point%hist(i))
        end do
        status = material_ok
        if (.not. (rate*dt <= most_strain)) status = material_step_too_large
        if (.not. (rate <= huge(rate) .and. dt >= 0 .and. &
                   crack >= 0 .and. crack <= huge(crack) .and. &
                   point%mu > -1 .and. point%mu <= most_mu .and. stress <= most_stress .and. &
                   abs(point%energy) <= most_energy .and. history <= most_history .and. &
                   point%damage >= 0 .and. point%damage <= 1)) &
            status = material_not_finite
    end subroutine check_input

    !> Key table of all models.
    subroutine material_keys(keys)
        type(key_t), allocatable, intent(out) :: keys(:)
        type(model_t), allocatable :: models(:)
        integer :: i, n

        call list_models(models)
        n = 0
        do i = 1, size(models)
            n = n + size(models(i)%keys)
        end do
        allocate (keys(n))
        n = 0
        do i = 1, size(models)
            keys(n + 1:n + size(models(i)%keys)) = models(i)%keys
            n = n + size(models(i)%keys)
        end do
    end subroutine material_keys

    !> Numbers of a material from the deck.
    subroutine make_material(input, material, err)
        type(material_case_t), intent(in) :: input
        type(material_t), intent(out) :: material
        type(error_t), intent(inout) :: err
        type(model_t), allocatable :: models(:)
        character(:), allocatable :: names
        integer :: i

        call clear_material(material)
        call list_models(models)
        names = ''
        do i = 1, size(models)
            if (models(i)%name == input%model) then
                call load_parameters(models(i), input, material, err)
                return
            end if
            names = names//' '//trim(models(i)%name)
        end do
        call raise(err, exit_deck, material_label(input)//"there is no model '"// &
                   trim(input%model)//"'; known:"//names)
    end subroutine make_material

    subroutine clear_material(material)
        type(material_t), intent(out) :: material

        material%model = 0
        material%class = 0
        material%n_hist = 0
        material%density = 0
        material%fails = 0
        material%shear = 0
        material%axial = 0
        material%across = 0
        material%bulk = 0
        material%crack = 0
        material%c_wave = 0
        material%par = 0
    end subroutine clear_material

    !> An unloaded material point; for a ply with its axes at `angle` about the stacking axis.
    !>
    !> Angle 0 is the axis that follows the stacking axis cyclically (x for z, y for x, z for y);
    !> it turns right-handed about the stacking axis.
    subroutine start_point(material, angle, axis, point)
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: angle !! of the ply [rad]
        character(1), intent(in) :: axis !! stacking axis 'x', 'y', 'z'
        type(point_t), intent(out) :: point
        type(model_t), allocatable :: models(:)
        integer :: i

        point%mu = 0
        point%energy = 0
        point%stress = 0
        point%damage = 0
        point%work = 0
        point%hist = 0
        point%c_wave = material%c_wave
        point%c_bulk = unloaded_speed(material)
        call list_models(models)
        do i = 1, size(models)
            if (models(i)%code /= material%model) cycle
            if (associated(models(i)%rest)) call models(i)%rest(material, point)
            if (associated(models(i)%start)) call models(i)%start(material, angle, axis, point)
        end do
    end subroutine start_point

    !> Sound speed of the unloaded material as the artificial viscosity sees it [m/s].
    !@cuf attributes(host,device) &
    pure function unloaded_speed(material) result(c_bulk)
        type(material_t), intent(in) :: material
        real(rk) :: c_bulk

        c_bulk = sqrt(material%bulk/material%density)
    end function unloaded_speed

    !> What follows from the keys of a material, as its model tells it.
    subroutine derived_constants(material, list)
        type(material_t), intent(in) :: material
        type(derived_t), allocatable, intent(out) :: list(:)
        type(model_t), allocatable :: models(:)
        integer :: i

        call list_models(models)
        do i = 1, size(models)
            if (models(i)%code /= material%model) cycle
            if (associated(models(i)%report)) call models(i)%report(material, list)
        end do
        if (.not. allocated(list)) allocate (list(0))
    end subroutine derived_constants

    !> Lines for `--check` and a warning, as the model of a material tells them.
    subroutine material_remarks(material, lines, warning)
        type(material_t), intent(in) :: material
        type(string_t), allocatable, intent(out) :: lines(:)
        character(:), allocatable, intent(out) :: warning !! empty where all is well
        type(model_t), allocatable :: models(:)
        integer :: i

        call list_models(models)
        do i = 1, size(models)
            if (models(i)%code /= material%model) cycle
            if (associated(models(i)%remark)) call models(i)%remark(material, lines, warning)
        end do
        if (.not. allocated(lines)) allocate (lines(0))
        if (.not. allocated(warning)) warning = ''
    end subroutine material_remarks

    !> Names and units of the history of a material; an empty name: not worth a dump.
    subroutine history_names(material, names, units)
        type(material_t), intent(in) :: material
        character(32), intent(out) :: names(n_hist)
        character(12), intent(out) :: units(n_hist)
        type(model_t), allocatable :: models(:)
        integer :: i

        names = ''
        units = '-'
        call list_models(models)
        do i = 1, size(models)
            if (models(i)%code /= material%model) cycle
            names = models(i)%history
            names(material%n_hist + 1:) = ''
            units = models(i)%history_unit
        end do
    end subroutine history_names
end module brz_materials
