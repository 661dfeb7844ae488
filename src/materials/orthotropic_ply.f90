! SPDX-License-Identifier: MIT
!> Orthotropic ply of a fibre composite with failure by modes.
!>
!> Deck:    &material model='orthotropic_ply'
!> Method:  strain summed up in axes that turn with the material, stress from the total strain,
!>          five failure modes (ply_failure.f90), optional equation of state for impact
!> Source:  criteria of Chang & Chang and of Hou et al. 2000; volumetric split of Anderson 1994
!> History: axes (3, see ply_axes.f90), strain (6), damage by mode (5)
module brz_orthotropic_ply
    use brz_kinds, only: dp, rk
    use brz_algebra, only: rotate_voigt
    use brz_kinematics, only: volume_step
    use brz_material, only: class_elastic, fails_by_degrees, material_t, point_t, material_ok, &
                            material_clamped, material_step_too_large, n_hist, n_par
    use brz_mie_gruneisen, only: hugoniot_excess, warming_range, pressure_step, hugoniot_limit, &
                                 eos_density, eos_c0, eos_s1, eos_gamma, eos_mu_max, n_eos
    use brz_model, only: derived_t, model_t
    use brz_ply_axes, only: axes_matrix, axes_of_matrix, axes_spin, turn_ply
    use brz_ply_failure, only: derive_softening, fail, total_damage
    use brz_ply_keys, only: ply_keys
    use brz_ply_stress, only: carried_stress, retain_bulk, wave_stiffness, n_modes, fibre_tension, &
                              fibre_compression, matrix_cracking, matrix_crushing, &
                              delamination, p_density, p_e1, p_e2, p_e3, p_nu12, p_nu13, &
                              p_nu23, p_g12, p_g13, p_g23, p_xt, p_xc, p_yt, p_yc, p_zt, &
                              p_woven, p_axes, p_limit, p_pressure, p_slope, p_gamma, p_energy, &
                              p_c11, p_c22, p_c33, p_c12, p_c23, p_c13, p_bulk, p_rubble, &
                              p_inverse, p_eos
    implicit none
    private
    public :: orthotropic_ply, describe_orthotropic_ply, update_orthotropic_ply, ply_axes

    integer, parameter :: orthotropic_ply = 3, orthotropic_ply_history = 14 !! code of the model
    character(*), parameter :: name = 'orthotropic_ply'
    integer, parameter :: pressure_anderson = 2
    ! history: last slot before the axes, the strain, the damage
    integer, parameter :: h_axes = 0, h_strain = 3, h_damage = 9
    real(rk), parameter :: wild = 1 !! strain beyond which the axes only spin
    real(rk), parameter :: torn = -1/3.0_rk !! compression of a ply that is debris

contains

    subroutine describe_orthotropic_ply(model)
        type(model_t), intent(inout) :: model

        model%code = orthotropic_ply
        model%class = class_elastic
        model%name = name
        call ply_keys(name, model%keys)
        model%n_hist = orthotropic_ply_history
        model%history(h_damage + fibre_tension) = 'damage_fibre_tension'
        model%history(h_damage + fibre_compression) = 'damage_fibre_compression'
        model%history(h_damage + matrix_cracking) = 'damage_matrix_cracking'
        model%history(h_damage + matrix_crushing) = 'damage_matrix_crushing'
        model%history(h_damage + delamination) = 'damage_delamination'
        model%derive => derive
        model%report => report
        model%start => start
    end subroutine describe_orthotropic_ply

    !> Stiffness, moduli and inverse strengths.
    subroutine derive(material, given, fault)
        type(material_t), intent(inout) :: material
        logical, intent(in) :: given(:)
        character(:), allocatable, intent(out) :: fault
        integer :: i

        call derive_stiffness(material%par, fault)
        if (allocated(fault)) return
        if (any(given(p_energy + 1:p_energy + n_modes) .and. &
                .not. given([p_xt, p_xc, p_yt, p_yc, p_zt]))) then
            fault = 'a fracture energy needs the strength of its mode (xt, xc, yt, yc, zt)'
            return
        end if
        do i = 1, 8
            if (given(p_xt + i - 1)) material%par(p_inverse + i) = 1/material%par(p_xt + i - 1)
        end do
        call derive_softening(material%par, material%crack)
        material%density = material%par(p_density)
        material%bulk = material%par(p_bulk)
        material%fails = merge(fails_by_degrees, 0, any(given(p_xt:p_xt + 7)))
        ! as stiff as an isotropic plate (nu = 0.3) of the stiffer in-plane modulus
        material%shear = max(material%par(p_e1), material%par(p_e2))/2.6_rk
        material%axial = [material%par(p_e1), material%par(p_e2), material%par(p_e3)]
        material%across = min(material%par(p_g13), material%par(p_g23))
        material%c_wave = sqrt(maxval(material%par(p_c11:p_c33))/material%density)
        material%par(p_eos:p_eos + n_eos - 1) = 0
        material%par(p_eos + eos_density - 1) = material%density
        material%par(p_eos + eos_c0 - 1) = sqrt(material%bulk/material%density)
        material%par(p_eos + eos_s1 - 1) = material%par(p_slope)
        material%par(p_eos + eos_gamma - 1) = material%par(p_gamma)
        material%par(p_eos + eos_mu_max - 1) = &
            hugoniot_limit(material%par(p_eos:p_eos + n_eos - 1))
    end subroutine derive

    !> The six normal stiffnesses and the two bulk moduli; refuses what is not positive definite.
    subroutine derive_stiffness(par, fault)
        real(rk), intent(inout) :: par(:)
        character(:), allocatable, intent(inout) :: fault
        real(dp) :: e1, e2, e3, nu12, nu13, nu23, nu21, nu31, nu32, dl

        e1 = par(p_e1)
        e2 = par(p_e2)
        e3 = par(p_e3)
        nu12 = par(p_nu12)
        nu13 = par(p_nu13)
        nu23 = par(p_nu23)
        nu21 = nu12*e2/e1
        nu31 = nu13*e3/e1
        nu32 = nu23*e3/e2
        dl = 1 - nu12*nu21 - nu23*nu32 - nu13*nu31 - 2*nu21*nu32*nu13
        if (nu12*nu21 >= 1) then
            fault = 'nu12 must be below sqrt(e1/e2): the stiffness is not positive definite'
        else if (nu13*nu31 >= 1) then
            fault = 'nu13 must be below sqrt(e1/e3): the stiffness is not positive definite'
        else if (nu23*nu32 >= 1) then
            fault = 'nu23 must be below sqrt(e2/e3): the stiffness is not positive definite'
        else if (dl <= 0) then
            fault = 'nu12, nu13, nu23 are too large together: the stiffness is not '// &
                    'positive definite'
        end if
        if (allocated(fault)) return
        par(p_c11) = real(e1*(1 - nu23*nu32)/dl, rk)
        par(p_c22) = real(e2*(1 - nu13*nu31)/dl, rk)
        par(p_c33) = real(e3*(1 - nu12*nu21)/dl, rk)
        par(p_c12) = real(e1*(nu21 + nu31*nu23)/dl, rk)
        par(p_c13) = real(e1*(nu31 + nu21*nu32)/dl, rk)
        par(p_c23) = real(e2*(nu32 + nu12*nu31)/dl, rk)
        par(p_bulk) = (par(p_c11) + par(p_c22) + par(p_c33) &
                       + 2*(par(p_c12) + par(p_c13) + par(p_c23)))/9
        par(p_rubble) = real(1/(1/e1 + 1/e2 + 1/e3 - 2*(nu12/e1 + nu13/e1 + nu23/e2)), rk)
    end subroutine derive_stiffness

    !> Stiffness, and the waves along and between the axes.
    subroutine report(material, list)
        type(material_t), intent(in) :: material
        type(derived_t), allocatable, intent(out) :: list(:)
        character(3), parameter :: names(6) = ['C11', 'C22', 'C33', 'C12', 'C23', 'C13']
        character(4), parameter :: waves(6) = ['c_11', 'c_22', 'c_33', 'c_12', 'c_13', 'c_23']
        integer :: i

        allocate (list(13))
        do i = 1, 6
            list(i) = derived_t(names(i), 'Pa', material%par(p_c11 + i - 1))
        end do
        list(7) = derived_t("K'", 'Pa', material%par(p_bulk))
        do i = 1, 3
            list(7 + i) = derived_t(waves(i), 'm/s', sqrt(material%par(p_c11 + i - 1) &
                                                          /material%density))
            list(10 + i) = derived_t(waves(3 + i), 'm/s', sqrt(material%par(p_g12 + i - 1) &
                                                               /material%density))
        end do
    end subroutine report

    !> Axes of an unloaded ply: 3 along the stacking axis, 1 turned by `angle` about it.
    subroutine start(material, angle, axis, point)
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: angle !! [rad]
        character(1), intent(in) :: axis
        type(point_t), intent(inout) :: point
        real(rk) :: r(3, 3), axes(3)
        integer :: i, j, k

        k = index('xyz', axis)
        i = modulo(k, 3) + 1
        j = modulo(k + 1, 3) + 1
        r = 0
        r(i, 1) = cos(angle)
        r(j, 1) = sin(angle)
        r(i, 2) = -sin(angle)
        r(j, 2) = cos(angle)
        r(k, 3) = 1
        point%hist(1:material%n_hist) = 0
        call axes_of_matrix(r, axes)
        point%hist(h_axes + 1:h_axes + 3) = axes
    end subroutine start

    !> One step of one material point; see `update_material` for the contract.
    !>
    !> What opens a ply adds volume that carries nothing: where it takes up more than unloaded, the
    !> law gives the force on the area that it had, so that the stress is less by rho/rho0, stays
    !> the gradient of an energy, and waves along whole fibres are no faster.
    !@cuf attributes(host,device) &
    pure subroutine update_orthotropic_ply(material, dt, crack, l, point, status)
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: dt, crack !! time step [s], width of a crack [m]
        real(rk), intent(in) :: l(3, 3) !! dv_i/dx_j at mid-step [1/s]
        type(point_t), intent(inout) :: point
        integer, intent(out) :: status
        real(rk) :: axes(3), last(3, 3), e0(6), e1(6), d(6), s0(6), s1(6), carried(6)
        real(rk) :: damage(n_modes), mu, dv, v_mid, v_carries, work, loss
        integer :: i

        call load_history(point%hist, material%par(p_limit), axes, e0, damage)
        call turn_ply(kind_of_axes(material%par, e0, damage), l, dt, e0, axes, d, last)
        do i = 1, 3
            e1(i) = e0(i) + d(i)*dt
            e1(i + 3) = e0(i + 3) + 2*d(i + 3)*dt
        end do
        call carried_stress(material%par, e0, damage, s0)
        call carried_stress(material%par, e1, damage, s1)
        carried = s0
        call retain_bulk(material%par, e0, damage, s0)
        call fail(material%par, dt, crack, e1, carried, s1, damage)
        call retain_bulk(material%par, e1, damage, s1)
        mu = point%mu
        call volume_step(material%density, l, dt, mu, dv, v_mid)
        v_carries = min(v_mid, 1/material%density)
        if (debris(material, point%mu)) call clear(s0)
        if (debris(material, mu)) call tear(material%par, s1, damage)
        work = 0
        loss = 0
        do i = 1, 6
            work = work + (s0(i) + s1(i))/2*(e1(i) - e0(i))
            loss = loss + (s0(i)*e1(i) - s1(i)*e0(i))/2
        end do
        point%damage = total_damage(damage)
        if (.not. point%damage > 0) loss = 0
        if (debris(material, mu)) call forget(mu, e1)
        do i = 1, 6
            s1(i) = s1(i)*min(1 + mu, 1.0_rk) ! of the area that carries
        end do
        call add_excess(material, mu, dv, work*v_carries, &
                        wave_stiffness(material%par, mu, damage), s1, point, status)
        if (status > 0) return
        call rotate_voigt(last, s1)
        do i = 1, 6
            point%stress(i) = s1(i)
        end do
        point%work(1) = 0
        point%work(2) = loss*v_carries
        call store_history(axes, e1, damage, point%hist)
    end subroutine update_orthotropic_ply

    !> A ply that can fail and takes up half as much volume again is debris: no stress is left, and
    !> what it had stored is recorded as damage.
    !@cuf attributes(host,device) &
    pure function debris(material, mu) result(yes)
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: mu !! compression
        logical :: yes

        yes = mu < torn .and. material%fails == 1
    end function debris

    !@cuf attributes(host,device) &
    pure subroutine clear(s)
        real(rk), intent(out) :: s(6)
        integer :: i

        do i = 1, 6
            s(i) = 0
        end do
    end subroutine clear

    !@cuf attributes(host,device) &
    pure subroutine tear(par, s, damage)
        real(rk), intent(in) :: par(n_par)
        real(rk), intent(out) :: s(6)
        real(rk), intent(inout) :: damage(n_modes)
        integer :: i

        call clear(s)
        do i = 1, n_modes
            damage(i) = par(p_limit)
        end do
    end subroutine tear

    !> Of the strain of debris the change of volume alone is kept, as an opening of the ply: only
    !> what is closed again resists.
    !@cuf attributes(host,device) &
    pure subroutine forget(mu, strain)
        real(rk), intent(in) :: mu
        real(rk), intent(out) :: strain(6)
        integer :: i

        do i = 1, 6
            strain(i) = 0
        end do
        strain(3) = -log(1 + mu)
    end subroutine forget

    !> New compression, energy and wave speeds; the excess of a shock pressure over the linear law.
    !>
    !> The excess p_EOS(mu, e) - K' ln(1 + mu) acts in compression only.
    !@cuf attributes(host,device) &
    pure subroutine add_excess(material, mu, dv, work, stiffness, s, point, status)
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: mu !! compression at the end of the step
        real(rk), intent(in) :: dv, work !! change of volume [m3/kg], stress work [J/kg]
        real(rk), intent(in) :: stiffness !! of its fastest wave [Pa]
        real(rk), intent(inout) :: s(6) !! stress in the axes of the ply [Pa]
        type(point_t), intent(inout) :: point
        integer, intent(out) :: status
        real(rk) :: a, b, slope, b_slope, p_old, p, energy, unloaded, warm
        logical :: clamped, ok

        status = material_ok
        energy = point%energy + work
        slope = 0
        if (int(material%par(p_pressure)) == pressure_anderson) then
            unloaded = max(material%par(p_c11), material%par(p_c22), material%par(p_c33))
            warm = warming_range(material%par(p_eos), material%density*point%energy, unloaded)
            call hugoniot_excess(material%par(p_eos), point%mu, warm, a, b, slope, b_slope, clamped)
            p_old = a + b*material%density*point%energy
            call hugoniot_excess(material%par(p_eos), mu, warm, a, b, slope, b_slope, clamped)
            call pressure_step(a, b*material%density, -huge(a), dv, p_old, energy, p, ok)
            if (clamped) status = material_clamped
            if (.not. ok) status = material_step_too_large
            if (.not. ok) return
            s(1) = s(1) - p
            s(2) = s(2) - p
            s(3) = s(3) - p
            slope = slope + b_slope*material%density*energy &
                    + b*max(-s(1), -s(2), -s(3), 0.0_rk)/(1 + mu)**2
        end if
        point%mu = mu
        point%energy = energy
        point%c_wave = sqrt((stiffness + max(slope, 0.0_rk))/material%density)
        point%c_bulk = sqrt((material%par(p_bulk) + max(slope, 0.0_rk))/material%density)
    end subroutine add_excess

    !> How the axes turn: as the deck says; with the spin where fibres are broken, or where the
    !> strain is wild.
    !@cuf attributes(host,device) &
    pure function kind_of_axes(par, strain, damage) result(kind)
        real(rk), intent(in) :: par(n_par), strain(6), damage(n_modes)
        integer :: kind, i
        logical :: spin

        spin = damage(fibre_tension) > 0 .or. damage(fibre_compression) > 0
        if (par(p_woven) > 0) &
            spin = spin .or. damage(matrix_cracking) > 0 .or. damage(matrix_crushing) > 0
        do i = 1, 6
            spin = spin .or. .not. abs(strain(i)) <= wild
        end do
        kind = int(par(p_axes))
        if (spin) kind = axes_spin
    end function kind_of_axes

    !@cuf attributes(host,device) &
    pure subroutine load_history(hist, limit, axes, strain, damage)
        real(rk), intent(in) :: hist(n_hist), limit !! history, largest damage
        real(rk), intent(out) :: axes(3), strain(6), damage(n_modes)
        integer :: i

        do i = 1, 3
            axes(i) = hist(h_axes + i)
        end do
        do i = 1, 6
            strain(i) = hist(h_strain + i)
        end do
        do i = 1, n_modes
            damage(i) = min(max(hist(h_damage + i), 0.0_rk), limit)
        end do
    end subroutine load_history

    !@cuf attributes(host,device) &
    pure subroutine store_history(axes, strain, damage, hist)
        real(rk), intent(in) :: axes(3), strain(6), damage(n_modes)
        real(rk), intent(inout) :: hist(n_hist)
        integer :: i

        do i = 1, 3
            hist(h_axes + i) = axes(i)
        end do
        do i = 1, 6
            hist(h_strain + i) = strain(i)
        end do
        do i = 1, n_modes
            hist(h_damage + i) = damage(i)
        end do
    end subroutine store_history

    !> Axes of the ply of a point: the columns are fibre, across, normal.
    !@cuf attributes(host,device) &
    pure subroutine ply_axes(hist, r)
        real(rk), intent(in) :: hist(n_hist)
        real(rk), intent(out) :: r(3, 3)
        real(rk) :: axes(3)
        integer :: i

        do i = 1, 3
            axes(i) = hist(h_axes + i)
        end do
        call axes_matrix(axes, r)
    end subroutine ply_axes
end module brz_orthotropic_ply
