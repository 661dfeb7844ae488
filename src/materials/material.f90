! SPDX-License-Identifier: MIT
!> A material as the point physics sees it: a model and its numbers.
!>
!> The type is plain data without default initialisation, so that the same bytes serve the CPU and
!> the GPU. `par` is filled by the model's own file, which names its slots.
module brz_material
    use, intrinsic :: iso_c_binding, only: c_int
    use brz_kinds, only: rk
    implicit none
    private
    public :: material_t, point_t, n_par, n_hist, strength_left, secant_share, &
              fails_by_degrees, fails_at_once
    public :: class_elastic, class_metal, class_crumbling, class_fluid
    public :: material_ok, material_clamped, material_not_finite, material_step_too_large, &
              material_unknown

    integer, parameter :: n_par = 64 !! parameters of a material, derived ones included
    integer, parameter :: n_hist = 24 !! most history variables of a material point

    ! Status of an update. Negative: done, but a limit acted. Positive: refused, point unchanged.
    integer, parameter :: material_ok = 0
    integer, parameter :: material_clamped = -1 !! outside the range of the model, held at its edge
    integer, parameter :: material_not_finite = 1 !! NaN, infinity or an absurd number came in
    integer, parameter :: material_step_too_large = 2 !! strain increment beyond the limit
    integer, parameter :: material_unknown = 3 !! no such model

    ! How a material fails: it may not (0), by and by as damage grows, or all at once at damage 1.
    integer, parameter :: fails_by_degrees = 1, fails_at_once = 2

    ! What a material does when it is strained far: it springs back until it breaks, it flows and
    ! stays together, it crumbles, or it has no shape at all.
    integer, parameter :: class_elastic = 1, class_metal = 2, class_crumbling = 3, class_fluid = 4

    type, bind(c) :: material_t
        integer(c_int) :: model !! code of the model, see the registry
        integer(c_int) :: class !! of the model, class_elastic, ...
        integer(c_int) :: n_hist !! history variables that the model uses
        integer(c_int) :: fails !! how it may lose its strength for good, 0: never
        real(rk) :: density !! unloaded [kg/m3]
        real(rk) :: shear !! shear modulus for the hourglass force [Pa]
        real(rk) :: axial(3) !! Young's modulus along each axis of a ply; 0: no axes [Pa]
        real(rk) :: across !! the lesser shear modulus between plies; 0: no axes [Pa]
        real(rk) :: bulk !! bulk modulus for contact [Pa]
        real(rk) :: yields !! yield stress over 3G if the first history is a plastic strain, or 0
        real(rk) :: crack !! widest crack that opens at full strength, 0: any [m]
        real(rk) :: c_wave !! fastest wave of the unloaded material, for the first time step [m/s]
        real(rk) :: par(n_par) !! slots named by the model
    end type material_t

    !> One material point. A caller copies in what it keeps, calls the update, and copies out.
    type, bind(c) :: point_t
        real(rk) :: mu !! compression rho/rho0 - 1 [-]
        real(rk) :: energy !! specific internal energy; the update adds the stress work [J/kg]
        real(rk) :: stress(6) !! Cauchy stress xx, yy, zz, xy, yz, xz, tension positive [Pa]
        real(rk) :: damage !! damage as pair forces see it, 0..1
        real(rk) :: c_wave !! fastest wave, for the time step [m/s]
        real(rk) :: c_bulk !! sound speed in the artificial viscosity [m/s]
        real(rk) :: work(2) !! plastic work and work spent in damage during the step [J/kg]
        real(rk) :: hist(n_hist) !! history, slots named by the model
    end type point_t

contains

    !> Share of the strength, 0..1, that damage leaves to a material.
    !@cuf attributes(host,device) &
    pure function strength_left(fails, damage) result(left)
        integer, intent(in) :: fails !! how the material fails
        real(rk), intent(in) :: damage
        real(rk) :: left

        left = 1 - damage
        if (fails == fails_at_once .and. damage < 1) left = 1
    end function strength_left

    !> Shear stress of a metal over that of its whole strain were it elastic: G_s/G of the theory of
    !> deformation, y/(y + eps_p) without hardening.
    !>
    !> Source: Hencky 1924
    !@cuf attributes(host,device) &
    pure function secant_share(yields, plastic) result(share)
        real(rk), intent(in) :: yields !! y, of a material_t that may yield: > 0
        real(rk), intent(in) :: plastic !! eps_p, the first of its history
        real(rk) :: share

        share = yields/(yields + plastic)
    end function secant_share
end module brz_material
