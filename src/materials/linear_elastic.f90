! SPDX-License-Identifier: MIT
!> Isotropic linear elasticity, hypoelastic, exact in rotation.
!>
!> Deck:    &material model='linear_elastic'
!> Method:  p = K mu in total form; deviator S_new = Q (Q S Q^T + 2 G dt dev d) Q^T with Q the
!>          rotation of half a step; see docs/theory/materials.md
!> History: none
module brz_linear_elastic
    use brz_kinds, only: dp, rk
    use brz_algebra, only: double_dot, rotate_voigt, rotation_exp, to_voigt
    use brz_key, only: key_t, none, required
    use brz_kinematics, only: volume_step
    use brz_material, only: class_elastic, material_t, point_t, material_ok
    use brz_model, only: model_t, real_key, usual
    implicit none
    private
    public :: linear_elastic, describe_linear_elastic, update_linear_elastic

    integer, parameter :: linear_elastic = 1 !! code of the model
    integer, parameter :: p_density = 1, p_young = 2, p_poisson = 3, p_bulk = 4, p_shear = 5
    character(*), parameter :: name = 'linear_elastic'

contains

    subroutine describe_linear_elastic(model)
        type(model_t), intent(inout) :: model

        model%code = linear_elastic
        model%class = class_elastic
        model%name = name
        allocate (model%keys(5))
        model%keys(p_density) = usual(real_key(name, 'density', 'kg/m3', required, &
                                         'unloaded density', 0.0_dp, open_lower=.true.), &
                                             10.0_dp, 25000.0_dp)
        model%keys(p_young) = usual(real_key(name, 'youngs_modulus', 'Pa', none, &
            "Young's modulus, together with poisson_ratio", 0.0_dp, open_lower=.true.), &
            1e6_dp, 1e12_dp)
        model%keys(p_poisson) = real_key(name, 'poisson_ratio', '-', none, &
            "Poisson's ratio, together with youngs_modulus", -1.0_dp, 0.4999_dp, open_lower=.true.)
        model%keys(p_bulk) = usual(real_key(name, 'bulk_modulus', 'Pa', none, &
            'bulk modulus, together with shear_modulus', 0.0_dp, open_lower=.true.), &
            1e6_dp, 1e12_dp)
        model%keys(p_shear) = usual(real_key(name, 'shear_modulus', 'Pa', none, &
            'shear modulus, together with bulk_modulus', 0.0_dp), 1e5_dp, 1e12_dp)
        model%derive => derive
    end subroutine describe_linear_elastic

    !> Bulk and shear modulus from whichever pair is given.
    subroutine derive(material, given, fault)
        type(material_t), intent(inout) :: material
        logical, intent(in) :: given(:)
        character(:), allocatable, intent(out) :: fault
        real(rk) :: e, nu
        logical :: young, bulk

        young = given(p_young) .and. given(p_poisson)
        bulk = given(p_bulk) .and. given(p_shear)
        if ((young .eqv. bulk) .or. count(given(p_young:p_shear)) /= 2) then
            fault = 'give youngs_modulus and poisson_ratio, or bulk_modulus and shear_modulus'
            return
        end if
        if (young) then
            e = material%par(p_young)
            nu = material%par(p_poisson)
            material%par(p_bulk) = e/(3*(1 - 2*nu))
            material%par(p_shear) = e/(2*(1 + nu))
        end if
        material%density = material%par(p_density)
        material%bulk = material%par(p_bulk)
        material%shear = material%par(p_shear)
        material%c_wave = sqrt((material%bulk + 4*material%shear/3)/material%density)
    end subroutine derive

    !> One step of one material point; see `update_material` for the contract.
    !@cuf attributes(host,device) &
    pure subroutine update_linear_elastic(material, dt, l, point, status)
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: dt !! [s]
        real(rk), intent(in) :: l(3, 3) !! dv_i/dx_j at mid-step [1/s]
        type(point_t), intent(inout) :: point
        integer, intent(out) :: status
        real(rk) :: q(3, 3), d(6), s(6), p_old, p_new, g, dv, v_mid, mean, work
        integer :: i

        g = material%par(p_shear)
        p_old = material%par(p_bulk)*point%mu
        call volume_step(material%density, l, dt, point%mu, dv, v_mid)
        p_new = material%par(p_bulk)*point%mu
        call rotation_exp(l, dt/2, q)
        call to_voigt(l, d)
        mean = (d(1) + d(2) + d(3))/3
        do i = 1, 6
            s(i) = point%stress(i)
        end do
        do i = 1, 3
            d(i) = d(i) - mean
            s(i) = s(i) + p_old
        end do
        call rotate_voigt(q, s)
        do i = 1, 6
            s(i) = s(i) + g*dt*d(i)
        end do
        work = double_dot(s, d)*dt*v_mid
        do i = 1, 6
            s(i) = s(i) + g*dt*d(i)
        end do
        call rotate_voigt(q, s)
        do i = 1, 3
            s(i) = s(i) - p_new
        end do
        do i = 1, 6
            point%stress(i) = s(i)
        end do
        point%energy = point%energy + work - (p_old + p_new)/2*dv
        point%damage = 0
        point%work(1) = 0
        point%work(2) = 0
        call wave_speeds(material, point)
        status = material_ok
    end subroutine update_linear_elastic

    !> Wave speeds; the density counts at least half, since debris carries no waves.
    !@cuf attributes(host,device) &
    pure subroutine wave_speeds(material, point)
        type(material_t), intent(in) :: material
        type(point_t), intent(inout) :: point
        real(rk) :: k, g

        k = material%par(p_bulk)/material%density
        g = material%par(p_shear)/(material%density*max(1 + point%mu, 0.5_rk))
        point%c_bulk = sqrt(k)
        point%c_wave = sqrt(k + 4*g/3)
    end subroutine wave_speeds
end module brz_linear_elastic
