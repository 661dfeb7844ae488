! SPDX-License-Identifier: MIT
!> Progressive damage of an orthotropic ply: failure criteria and growth of damage; axes and orders:
!> ply_stress.f90.
!>
!> Point physics: compiled for the CPU and for the GPU.
module brz_ply_failure
    use brz_kinds, only: rk
    use brz_material, only: n_par
    use brz_ply_stress, only: n_modes, fibre_tension, fibre_compression, matrix_cracking, &
                              matrix_crushing, delamination, p_density, p_e1, p_e2, p_e3, &
                              p_shear_weight, p_woven, p_time, p_limit, p_retain, p_friction, &
                              p_energy, p_reach, p_c11, p_c22, p_c33, p_rubble, p_inverse, &
                              carried_stress
    implicit none
    private
    public :: fail, grow_damage, criterion, total_damage, derive_softening

    ! places in the block of inverse strengths
    integer, parameter :: i_xt = p_inverse + 1, i_xc = p_inverse + 2, i_yt = p_inverse + 3, &
                          i_yc = p_inverse + 4, i_zt = p_inverse + 5, i_s12 = p_inverse + 6, &
                          i_s13 = p_inverse + 7, i_s23 = p_inverse + 8

    real(rk), parameter :: steepest = 1.05_rk !! least strain at the end of softening over the first

contains

    !> Failure criterion of one mode: it fails at 1. A mode without its strength is off (0).
    !@cuf attributes(host,device) &
    pure function criterion(par, mode, s) result(f)
        real(rk), intent(in) :: par(n_par)
        integer, intent(in) :: mode
        real(rk), intent(in) :: s(6) !! [Pa]
        real(rk) :: f, weight, press
        logical :: woven

        woven = par(p_woven) > 0
        weight = par(p_shear_weight)
        f = 0
        select case (mode)
        case (fibre_tension)
            if (par(i_xt) > 0 .and. (s(1) > 0 .or. (woven .and. s(1) >= 0))) &
                f = (s(1)*par(i_xt))**2 + weight*(s(4)*par(i_s12))**2
        case (fibre_compression)
            if (s(1) < 0) f = (s(1)*par(i_xc))**2
        case (matrix_cracking)
            if (.not. woven) weight = 1
            if (par(i_yt) > 0 .and. s(2) >= 0) &
                f = (s(2)*par(i_yt))**2 + weight*(s(4)*par(i_s12))**2
        case (matrix_crushing)
            if (par(i_yc) > 0 .and. s(2) < 0) then
                if (woven) then
                    f = (s(2)*par(i_yc))**2
                else
                    f = (s(2)*par(i_s12)/2)**2 + (s(4)*par(i_s12))**2 &
                        + ((par(i_s12)/(2*par(i_yc)))**2 - 1)*s(2)*par(i_yc)
                end if
            end if
        case (delamination)
            press = par(p_friction)*max(-s(3), 0.0_rk)
            if (par(i_zt) > 0) f = (max(s(3), 0.0_rk)*par(i_zt))**2 &
                                   + (s(5)*par(i_s23)/(1 + press*par(i_s23)))**2 &
                                   + (s(6)*par(i_s13)/(1 + press*par(i_s13)))**2
        end select
    end function criterion

    !> Stress over the strength of a mode: what it would have to be divided by to fail just so.
    !> Where it matters, a criterion is quadratic but for one linear term.
    !@cuf attributes(host,device) &
    pure function load_factor(par, mode, s22, f) result(factor)
        real(rk), intent(in) :: par(n_par)
        integer, intent(in) :: mode
        real(rk), intent(in) :: s22, f !! stress [Pa], criterion of the mode
        real(rk) :: factor, half

        half = 0
        if (mode == matrix_crushing .and. .not. par(p_woven) > 0) &
            half = ((par(i_s12)/(2*par(i_yc)))**2 - 1)*min(s22, 0.0_rk)*par(i_yc)/2
        factor = half + sqrt(max(half*half + f - 2*half, 0.0_rk))
    end function load_factor

    !> Damage at the end of a step, and the stress with it.
    !>
    !> Crushed material that resists a loss of volume stores energy. Crushing stops where it would
    !> store more than it lets go: a ply that is held on all sides does not crush.
    !@cuf attributes(host,device) &
    pure subroutine fail(par, dt, crack, strain, s_old, s, damage)
        real(rk), intent(in) :: par(n_par)
        real(rk), intent(in) :: dt, crack !! time step [s], width of a crack [m]
        real(rk), intent(in) :: strain(6) !! at the end
        real(rk), intent(in) :: s_old(6) !! carried stress at the start [Pa]
        real(rk), intent(inout) :: s(6) !! the same at the end, damage of the start in, new one out
        real(rk), intent(inout) :: damage(n_modes)
        real(rk) :: fibres(2), matrix(2), low, high, part
        integer :: k
        logical :: grown, lets_go
        integer, parameter :: halvings = 2 + digits(1.0_rk)

        fibres(1) = damage(fibre_compression)
        matrix(1) = damage(matrix_crushing)
        call grow_damage(par, dt, crack, s_old, s, damage, grown)
        if (.not. grown) return
        call carried_stress(par, strain, damage, s)
        if (.not. par(p_retain) > 0) return
        fibres(2) = damage(fibre_compression) - fibres(1)
        matrix(2) = damage(matrix_crushing) - matrix(1)
        if (.not. fibres(2) + matrix(2) > 0) return
        low = 0
        high = 1
        do k = 1, halvings
            part = (low + high)/2
            if (k <= 2) part = k - 1 ! before the first bit, with all of it
            damage(fibre_compression) = fibres(1) + part*fibres(2)
            damage(matrix_crushing) = matrix(1) + part*matrix(2)
            call carried_stress(par, strain, damage, s)
            lets_go = release(par, strain, s, fibres(2), matrix(2), damage) >= 0
            if ((k == 1 .and. .not. lets_go) .or. (k == 2 .and. lets_go)) return
            if (lets_go) then
                low = part
            else
                high = part
            end if
        end do
    end subroutine fail

    !> Energy that small increments of crushing let go, less what they store as retained bulk.
    !@cuf attributes(host,device) &
    pure function release(par, strain, s, fibres, matrix, damage) result(energy)
        real(rk), intent(in) :: par(n_par), strain(6)
        real(rk), intent(in) :: s(6) !! carried stress [Pa]
        real(rk), intent(in) :: fibres, matrix !! increments of their damage
        real(rk), intent(in) :: damage(n_modes)
        real(rk) :: energy, f, m, volume !! [J/m3]

        f = 1 - damage(fibre_compression)
        m = 1 - damage(matrix_crushing)
        volume = max(0.0_rk, -(strain(1) + strain(2) + strain(3)))
        energy = fibres/2*((min(s(1), 0.0_rk)/f)**2/par(p_e1) - m*par(p_rubble)*volume**2) &
                 + matrix/2*((min(s(2), 0.0_rk)/m)**2/par(p_e2) - f*par(p_rubble)*volume**2)
    end function release

    !> Damage at the end of a step.
    !>
    !> A mode starts at the instant within the step when its criterion reaches 1 on the straight
    !> line between the stresses; then it tends to 1 with its relaxation time, or follows the
    !> softening line of its fracture energy.
    !@cuf attributes(host,device) &
    pure subroutine grow_damage(par, dt, crack, s_old, s_trial, damage, grown)
        real(rk), intent(in) :: par(n_par)
        real(rk), intent(in) :: dt, crack !! time step [s], width of a crack [m]
        real(rk), intent(in) :: s_old(6) !! stress at the start of the step [Pa]
        real(rk), intent(in) :: s_trial(6) !! stress at its end with the damage of the start [Pa]
        real(rk), intent(inout) :: damage(n_modes)
        logical, intent(out) :: grown
        real(rk) :: before, rest, f
        integer :: mode

        grown = .false.
        do mode = 1, n_modes
            before = damage(mode)
            if (before >= par(p_limit)) cycle
            f = 0
            if (before <= 0 .or. par(p_reach + mode) > 0) f = criterion(par, mode, s_trial)
            if (par(p_reach + mode) > 0) then
                f = load_factor(par, mode, s_trial(2), f)/(1 - before)
                damage(mode) = max(before, softening(par(p_reach + mode), crack, f))
            else
                rest = dt
                if (before <= 0) then
                    if (f < 1) cycle
                    rest = dt*(1 - crossing(par, mode, s_old, s_trial))
                end if
                damage(mode) = 1 - (1 - before)*exp(-rest/relaxation(par, crack, mode))
            end if
            damage(mode) = min(damage(mode), par(p_limit))
            grown = grown .or. damage(mode) > before
        end do
    end subroutine grow_damage

    !> Part of the step after which a criterion reaches 1, by bisection.
    !@cuf attributes(host,device) &
    pure function crossing(par, mode, s_old, s_new) result(x)
        real(rk), intent(in) :: par(n_par)
        integer, intent(in) :: mode
        real(rk), intent(in) :: s_old(6), s_new(6)
        real(rk) :: x, low, high, s(6)
        integer :: i, k
        integer, parameter :: halvings = digits(1.0_rk)

        low = 0
        high = 1
        do k = 1, halvings
            x = (low + high)/2
            do i = 1, 6
                s(i) = s_old(i) + x*(s_new(i) - s_old(i))
            end do
            if (criterion(par, mode, s) < 1) then
                low = x
            else
                high = x
            end if
        end do
        x = low
    end function crossing

    !> Time in which a failed mode lets go: as given, or half of a crack's width at wave speed.
    !> It does not know the time step: what failure costs would grow with it.
    !@cuf attributes(host,device) &
    pure function relaxation(par, crack, mode) result(tau)
        real(rk), intent(in) :: par(n_par), crack
        integer, intent(in) :: mode
        real(rk) :: tau

        tau = par(p_time)
        if (tau > 0) return
        select case (mode)
        case (fibre_tension, fibre_compression); tau = par(p_c11)
        case (matrix_cracking, matrix_crushing); tau = par(p_c22)
        case default; tau = par(p_c33)
        end select
        tau = max(crack/2*sqrt(par(p_density)/tau), tiny(tau))
    end function relaxation

    !> Damage on the line of linear softening that spends the fracture energy over the crack.
    !>
    !> r is the stress over the strength, as it would be without the damage of this mode, and
    !> r_end = 2 Gf E/(X^2 l) where nothing is left. A crack too wide for its energy (r_end near 1)
    !> opens from a lower strength on, r0, and spends the same (Bazant & Oh 1983).
    !@cuf attributes(host,device) &
    pure function softening(reach, crack, r) result(d)
        real(rk), intent(in) :: reach, crack, r
        real(rk) :: d, r_end, r0

        r_end = min(reach/max(crack, tiny(crack)), huge(crack)/2)
        r0 = min(1.0_rk, sqrt(r_end/steepest))
        r_end = r_end/r0**2
        d = 0
        if (r > r0) d = min(1.0_rk, r_end*(r - r0)/(r*(r_end - 1)))
    end function softening

    !> What softening needs: 2 Gf E/X^2 of the modes, and the widest crack that can spend the
    !> energies of all of them without a fall of a strength; 0: any.
    pure subroutine derive_softening(par, widest)
        real(rk), intent(inout) :: par(n_par)
        real(rk), intent(out) :: widest !! [m]
        real(rk) :: moduli(n_modes)
        integer :: mode

        moduli = par([p_e1, p_e1, p_e2, p_e2, p_e3])
        do mode = 1, n_modes
            par(p_reach + mode) = 2*max(par(p_energy + mode), 0.0_rk)*moduli(mode) &
                                  *par(p_inverse + mode)**2
        end do
        associate (reach => par(p_reach + 1:p_reach + n_modes))
            widest = 0
            if (any(reach > 0)) widest = minval(reach, reach > 0)/steepest
        end associate
    end subroutine derive_softening

    !> Damage as pair forces see it: they must not carry what any broken mode has let go.
    !@cuf attributes(host,device) &
    pure function total_damage(damage) result(d)
        real(rk), intent(in) :: damage(n_modes)
        real(rk) :: d

        d = 1 - (1 - damage(1))*(1 - damage(2))*(1 - damage(3))*(1 - damage(4))*(1 - damage(5))
    end function total_damage
end module brz_ply_failure
