! SPDX-License-Identifier: MIT
!> Stress, failure criteria and growth of damage of an orthotropic ply, in its own axes.
!>
!> Stress and strain are in the order 11, 22, 33, 12, 23, 13 with ENGINEERING shear strains; 1 is
!> the fibre, 3 the normal of the ply. Damage has one number per mode, 0..1.
!> Point physics: compiled for the CPU and for the GPU.
module brz_ply_failure
    use brz_kinds, only: rk
    use brz_material, only: n_par
    implicit none
    private
    public :: ply_stress, carried_stress, retain_bulk, fail, grow_damage, criterion, total_damage

    integer, parameter, public :: n_modes = 5
    integer, parameter, public :: fibre_tension = 1, fibre_compression = 2, matrix_cracking = 3, &
                                  matrix_crushing = 4, delamination = 5

    ! Slots of `material%par`. First the keys of the deck ...
    integer, parameter, public :: p_density = 1, p_e1 = 2, p_e2 = 3, p_e3 = 4, p_nu12 = 5, &
                                  p_nu13 = 6, p_nu23 = 7, p_g12 = 8, p_g13 = 9, p_g23 = 10, &
                                  p_xt = 11, p_xc = 12, p_yt = 13, p_yc = 14, p_zt = 15, &
                                  p_s12 = 16, p_s13 = 17, p_s23 = 18, p_shear_weight = 19, &
                                  p_woven = 20, p_axes = 21, p_degradation = 22, p_time = 23, &
                                  p_limit = 24, p_retain = 25, p_pressure = 26, p_slope = 27, &
                                  p_gamma = 28, p_friction = 29
    integer, parameter, public :: p_energy = 29 !! + mode: fracture energy [J/m2]
    integer, parameter, public :: n_keys = p_energy + n_modes
    ! ... then what is derived from them.
    integer, parameter, public :: p_c11 = 35, p_c22 = 36, p_c33 = 37, p_c12 = 38, p_c23 = 39, &
                                  p_c13 = 40 !! stiffness [Pa]
    integer, parameter, public :: p_bulk = 41 !! mean of the nine normal stiffnesses [Pa]
    integer, parameter, public :: p_rubble = 42 !! bulk modulus at uniform pressure [Pa]
    integer, parameter, public :: p_inverse = 42 !! + 1..8: 1/strength, 0 where there is none
    integer, parameter, public :: p_eos = 51 !! first slot of the equation of state

    ! Values of the options, the places of their words in the deck.
    integer, parameter, public :: by_compliance = 1, by_zeroing = 2

    ! places in the block of inverse strengths
    integer, parameter :: i_xt = p_inverse + 1, i_xc = p_inverse + 2, i_yt = p_inverse + 3, &
                          i_yc = p_inverse + 4, i_zt = p_inverse + 5, i_s12 = p_inverse + 6, &
                          i_s13 = p_inverse + 7, i_s23 = p_inverse + 8

contains

    !> Stress of a ply at a given strain and damage.
    !>
    !> At constant damage this is the gradient of an energy (degradation 'compliance'): no closed
    !> path of strain creates energy, and a crack closes without a jump.
    !@cuf attributes(host,device) &
    pure subroutine ply_stress(par, strain, damage, stress)
        real(rk), intent(in) :: par(n_par)
        real(rk), intent(in) :: strain(6), damage(n_modes)
        real(rk), intent(out) :: stress(6) !! [Pa]

        call carried_stress(par, strain, damage, stress)
        call retain_bulk(par, strain, damage, stress)
    end subroutine ply_stress

    !> What fibres and matrix carry: the stress without what crushed material retains.
    !@cuf attributes(host,device) &
    pure subroutine carried_stress(par, strain, damage, stress)
        real(rk), intent(in) :: par(n_par)
        real(rk), intent(in) :: strain(6), damage(n_modes)
        real(rk), intent(out) :: stress(6) !! [Pa]
        real(rk) :: pull(3), push(3), shear(3)

        call intact_stress(par, strain, stress)
        if (damage(1) + damage(2) + damage(3) + damage(4) + damage(5) <= 0) return
        call intact_parts(par, damage, pull, push, shear)
        if (int(par(p_degradation)) == by_compliance) then
            call soften_compliance(par, strain, pull, push, stress)
        else
            stress(1) = stress(1)*merge(pull(1), push(1), stress(1) > 0)
            stress(2) = stress(2)*merge(pull(2), push(2), stress(2) > 0)
            stress(3) = stress(3)*merge(pull(3), push(3), stress(3) > 0)
        end if
        stress(4) = stress(4)*shear(1)
        stress(5) = stress(5)*shear(2)
        stress(6) = stress(6)*shear(3)
    end subroutine carried_stress

    !> Add the pressure with which crushed material still resists a loss of volume.
    !@cuf attributes(host,device) &
    pure subroutine retain_bulk(par, strain, damage, stress)
        real(rk), intent(in) :: par(n_par)
        real(rk), intent(in) :: strain(6), damage(n_modes)
        real(rk), intent(inout) :: stress(6) !! [Pa]
        real(rk) :: pressure

        if (.not. par(p_retain) > 0) return
        pressure = (1 - (1 - damage(fibre_compression))*(1 - damage(matrix_crushing))) &
                   *par(p_rubble)*max(0.0_rk, -(strain(1) + strain(2) + strain(3)))
        stress(1) = stress(1) - pressure
        stress(2) = stress(2) - pressure
        stress(3) = stress(3) - pressure
    end subroutine retain_bulk

    !> Stress of the undamaged ply.
    !@cuf attributes(host,device) &
    pure subroutine intact_stress(par, strain, stress)
        real(rk), intent(in) :: par(n_par), strain(6)
        real(rk), intent(out) :: stress(6)

        stress(1) = par(p_c11)*strain(1) + par(p_c12)*strain(2) + par(p_c13)*strain(3)
        stress(2) = par(p_c12)*strain(1) + par(p_c22)*strain(2) + par(p_c23)*strain(3)
        stress(3) = par(p_c13)*strain(1) + par(p_c23)*strain(2) + par(p_c33)*strain(3)
        stress(4) = par(p_g12)*strain(4)
        stress(5) = par(p_g23)*strain(5)
        stress(6) = par(p_g13)*strain(6)
    end subroutine intact_stress

    !> How much of each stress component is left: in tension, in compression, in shear.
    !>
    !> These are products of (1 - damage), which real32 keeps apart from zero. In a unidirectional
    !> ply broken fibres take everything in tension along; in a fabric 'matrix cracking' and
    !> 'crushing' are the failure of the second fibre direction.
    !@cuf attributes(host,device) &
    pure subroutine intact_parts(par, damage, pull, push, shear)
        real(rk), intent(in) :: par(n_par), damage(n_modes)
        real(rk), intent(out) :: pull(3), push(3) !! 11, 22, 33
        real(rk), intent(out) :: shear(3) !! 12, 23, 13
        real(rk) :: ft, fc, mt, mc, dl

        ft = 1 - damage(fibre_tension)
        fc = 1 - damage(fibre_compression)
        mt = 1 - damage(matrix_cracking)
        mc = 1 - damage(matrix_crushing)
        dl = 1 - damage(delamination)
        pull(1) = ft
        push(1) = fc
        push(2) = mc
        push(3) = 1
        shear(3) = ft*fc*dl
        if (par(p_woven) > 0) then
            pull(2) = mt
            pull(3) = ft*mt*dl
            shear(1) = ft*fc*mt*mc
            shear(2) = mt*mc*dl
        else
            pull(2) = ft*mt
            pull(3) = ft*dl
            shear(1) = ft*fc*mt
            shear(2) = shear(3)
        end if
    end subroutine intact_parts

    !> Normal stresses from the compliance S_ii/part_i, where the part depends on the sign.
    !>
    !> Which part counts depends on the sign of the result: a few passes settle it, since the
    !> relation is that of a convex energy.
    !@cuf attributes(host,device) &
    pure subroutine soften_compliance(par, strain, pull, push, stress)
        real(rk), intent(in) :: par(n_par), strain(6), pull(3), push(3)
        real(rk), intent(inout) :: stress(6) !! undamaged in, the first three softened out
        real(rk) :: a11, a22, a33, b12, b13, b23, c11, c22, c33, c12, c13, c23, scale
        integer :: pass
        integer, parameter :: most = 8
        logical :: open1, open2, open3

        b12 = -par(p_nu12)
        b13 = -par(p_nu13)
        b23 = -par(p_nu23)*par(p_e1)/par(p_e2)
        do pass = 1, most
            open1 = stress(1) > 0
            open2 = stress(2) > 0
            open3 = stress(3) > 0
            a11 = 1/merge(pull(1), push(1), open1)
            a22 = par(p_e1)/(par(p_e2)*merge(pull(2), push(2), open2))
            a33 = par(p_e1)/(par(p_e3)*merge(pull(3), push(3), open3))
            c11 = a22*a33 - b23*b23
            c22 = a11*a33 - b13*b13
            c33 = a11*a22 - b12*b12
            c12 = b13*b23 - b12*a33
            c13 = b12*b23 - b13*a22
            c23 = b12*b13 - b23*a11
            scale = par(p_e1)/(a11*c11 + b12*c12 + b13*c13)
            stress(1) = scale*(c11*strain(1) + c12*strain(2) + c13*strain(3))
            stress(2) = scale*(c12*strain(1) + c22*strain(2) + c23*strain(3))
            stress(3) = scale*(c13*strain(1) + c23*strain(2) + c33*strain(3))
            if ((open1 .eqv. stress(1) > 0) .and. (open2 .eqv. stress(2) > 0) .and. &
                (open3 .eqv. stress(3) > 0)) return
        end do
    end subroutine soften_compliance

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

    !> Damage at the end of a step, and the stress with it.
    !>
    !> Crushed material that resists a loss of volume stores energy. Crushing stops where it would
    !> store more than it lets go: a ply that is held on all sides does not crush.
    !@cuf attributes(host,device) &
    pure subroutine fail(par, dt, h, strain, s_old, s, damage)
        real(rk), intent(in) :: par(n_par)
        real(rk), intent(in) :: dt, h !! time step [s], smoothing length [m]
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
        call grow_damage(par, dt, h, s_old, s, damage, grown)
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
    pure subroutine grow_damage(par, dt, h, s_old, s_trial, damage, grown)
        real(rk), intent(in) :: par(n_par)
        real(rk), intent(in) :: dt, h !! time step [s], smoothing length [m]
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
            if (before <= 0 .or. par(p_energy + mode) > 0) f = criterion(par, mode, s_trial)
            if (par(p_energy + mode) > 0) then
                f = sqrt(max(f, 0.0_rk))/(1 - before)
                damage(mode) = max(before, softening(par, h, mode, f))
            else
                rest = dt
                if (before <= 0) then
                    if (f < 1) cycle
                    rest = dt*(1 - crossing(par, mode, s_old, s_trial))
                end if
                damage(mode) = 1 - (1 - before)*exp(-rest/relaxation(par, dt, h, mode))
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

    !> Time in which a failed mode lets go: as given, or one smoothing length at wave speed.
    !@cuf attributes(host,device) &
    pure function relaxation(par, dt, h, mode) result(tau)
        real(rk), intent(in) :: par(n_par), dt, h
        integer, intent(in) :: mode
        real(rk) :: tau

        tau = par(p_time)
        if (tau > 0) return
        select case (mode)
        case (fibre_tension, fibre_compression); tau = par(p_c11)
        case (matrix_cracking, matrix_crushing); tau = par(p_c22)
        case default; tau = par(p_c33)
        end select
        tau = max(10*dt, h*sqrt(par(p_density)/tau), tiny(tau))
    end function relaxation

    !> Damage on the line of linear softening that spends the fracture energy over h.
    !>
    !> r is the stress over the strength, as it would be without the damage of this mode, and
    !> r_end = 2 Gf E/(X^2 h) where nothing is left. Where h is too large for the energy (r_end
    !> near 1) more than Gf is spent.
    !@cuf attributes(host,device) &
    pure function softening(par, h, mode, r) result(d)
        real(rk), intent(in) :: par(n_par), h
        integer, intent(in) :: mode
        real(rk), intent(in) :: r
        real(rk) :: d, r_end
        real(rk), parameter :: steepest = 1.05_rk

        d = 0
        if (r <= 1) return
        select case (mode)
        case (fibre_tension); r_end = par(p_e1)*par(i_xt)**2
        case (fibre_compression); r_end = par(p_e1)*par(i_xc)**2
        case (matrix_cracking); r_end = par(p_e2)*par(i_yt)**2
        case (matrix_crushing); r_end = par(p_e2)*par(i_yc)**2
        case default; r_end = par(p_e3)*par(i_zt)**2
        end select
        r_end = max(steepest, 2*par(p_energy + mode)*r_end/max(h, tiny(h)))
        d = min(1.0_rk, r_end*(r - 1)/(r*(r_end - 1)))
    end function softening

    !> Damage as pair forces see it: they must not carry what any broken mode has let go.
    !@cuf attributes(host,device) &
    pure function total_damage(damage) result(d)
        real(rk), intent(in) :: damage(n_modes)
        real(rk) :: d

        d = 1 - (1 - damage(1))*(1 - damage(2))*(1 - damage(3))*(1 - damage(4))*(1 - damage(5))
    end function total_damage
end module brz_ply_failure
