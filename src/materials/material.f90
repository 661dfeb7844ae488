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
   public :: material_t, n_par, n_hist

   integer, parameter :: n_par = 48 !! parameters of a material, derived ones included
   integer, parameter :: n_hist = 24 !! most history variables of a material point

   type, bind(c) :: material_t
      integer(c_int) :: model !! code of the model, see the registry
      integer(c_int) :: n_hist !! history variables that the model uses
      real(rk) :: density !! unloaded [kg/m3]
      real(rk) :: shear !! shear modulus for the hourglass force [Pa]
      real(rk) :: bulk !! bulk modulus for contact [Pa]
      real(rk) :: c_wave !! fastest wave of the unloaded material, for the first time step [m/s]
      real(rk) :: par(n_par) !! slots named by the model
   end type material_t
end module brz_material
