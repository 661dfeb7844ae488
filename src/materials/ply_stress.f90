! SPDX-License-Identifier: MIT
!> Stress of an orthotropic ply at a given strain and damage, in its own axes.
!>
!> Stress and strain are in the order 11, 22, 33, 12, 23, 13 with ENGINEERING shear strains; 1 is
!> the fibre, 3 the normal of the ply. Damage has one number per mode, 0..1.
!> Point physics: compiled for the CPU and for the GPU.
module brz_ply_stress
    use brz_kinds, only: rk
    use brz_material, only: n_par
    implicit none
    private
    public :: ply_stress, carried_stress, retain_bulk, wave_stiffness

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
    integer, parameter, public :: p_reach = 58 !! + mode: 2 Gf E/X^2 [m], 0: no fracture energy

    ! Values of the options, the places of their words in the deck.
    integer, parameter, public :: by_compliance = 1, by_zeroing = 2

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

    !> Stiffness that the fastest wave in a ply meets, for the density of the unloaded one [Pa]:
    !> where it is spread out, its stress and its density are less alike.
    !@cuf attributes(host,device) &
    pure function wave_stiffness(par, mu, damage) result(stiffness)
        real(rk), intent(in) :: par(n_par)
        real(rk), intent(in) :: mu, damage(n_modes)
        real(rk) :: stiffness
        real(rk) :: crushed

        crushed = 1 - (1 - damage(fibre_compression))*(1 - damage(matrix_crushing))
        stiffness = max(par(p_c11), par(p_c22), par(p_c33)) + crushed*par(p_rubble)
        stiffness = stiffness/max(1 + mu, 1.0_rk)
    end function wave_stiffness

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
end module brz_ply_stress
