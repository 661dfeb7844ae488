! SPDX-License-Identifier: MIT
!> The particles of the solids, sorted body by body and by cell within a body: what each of them is,
!> and what holds for all.
!>
!> The state of the solids is built on it in layers: `bodies_t`, `listed_bodies_t` (with lists of
!> neighbours), `interacting_bodies_t`, `solid_t`. A procedure says by the type of its argument how
!> much of the state it needs; each layer is what those before it are, too.
!>
!> Time levels: x, stress and history live at the step, v half a step before (leapfrog). The
!> velocity at the step is v + dt_last/2 a. A kick is v += (dt_last + dt)/2 a + dt load/mass.
module brz_particles
    use brz_kinds, only: dp, int16, int32, int64, int8, real32, rk
    use brz_ranks, only: ranks_t
    implicit none
    private
    public :: particles_t

    type :: particles_t
        logical :: present = .false.
        logical :: on_gpu = .false. !! they are computed there; the arrays below are fetched
        type(ranks_t) :: ranks !! the processes that share the particles
        integer :: n = 0 !! particles, with the ghosts of those of other processes
        integer :: wide = 3 !! rows of x and v; on a GPU there are four
        integer :: stride_d = 1, stride_p = 3 !! distances in `load` of directions, of particles
        integer :: stride_t = 6 !! distance of particles in `face_stress`
        integer :: stride_w = 1 !! likewise in `volume`
        integer :: n_hist = 0 !! history variables kept per particle
        integer :: dimension = 3 !! 3, or 2 (plane strain), or 1
        logical :: mirror(3) = .false. !! symmetry plane through the origin normal to each axis
        real(dp) :: depth = 1 !! extent of directions that are not modelled, multiplied [m or m2]
        real(dp) :: time = 0 !! since the start, of the steps taken [s]
        real(dp) :: dt_last = 0 !! last time step [s]
        integer(int64) :: steps = 0
        integer(int64) :: rebuilds = 0 !! of lists of neighbours, where particles change places
        integer(int64) :: laid = 0 !! how often those of several processes got others
        real(dp), allocatable :: x(:, :) !! (3, n) position [m]
        real(dp), allocatable :: x_ref(:, :) !! (3, n) position in the unloaded body [m]
        real(dp), allocatable :: x_built(:, :) !! (3, n) position when the list was built [m]
        real(rk), allocatable :: v(:, :) !! (3, n) velocity, half a step before [m/s]
        real(rk), allocatable :: a(:, :) !! (3, n) acceleration by internal forces [m/s2]
        real(rk), allocatable :: load(:, :) !! (3, n) force of the air, set by the coupling; only
                                            !! where there is air [N]
        real(rk), allocatable :: face_stress(:, :) !! (6, n) stress of the load on its faces, see
                                                   !! brz_face_stress; only with loads [Pa]
        real(rk), allocatable :: v_before(:, :) !! (3, n) velocity at the last step of the air; only
                                                !! where there is air, on several processes [m/s]
        real(rk), allocatable :: reaction_force(:, :) !! (3, n) force on what holds a particle at
                                                      !! the step; only where a gauge asks for it
                                                      !! [N]
        real(dp), allocatable :: work(:) !! (n) of the loads in a kick; heat of drag; else 0 [J]
        real(rk), allocatable :: mass(:) !! (n) [kg]
        real(rk), allocatable :: mu(:) !! (n) compression rho/rho0 - 1 [-]
        real(rk), allocatable :: energy(:) !! (n) specific internal energy [J/kg]
        real(rk), allocatable :: stress(:, :) !! (6, n) Cauchy stress, tension positive [Pa]
        real(rk), allocatable :: hist(:, :) !! (n_hist, n) history of the material model
        real(rk), allocatable :: damage(:) !! (n) damage as pair forces see it, 0..1
        real(rk), allocatable :: volume(:) !! (n) as pass 1 sees it [m3]
        real(rk), allocatable :: h(:) !! (n) smoothing length; only where a body varies it [m]
        real(real32), allocatable :: k_axes(:, :) !! (6, n) hourglass stiffness xx, yy, zz, xy, yz,
                                                  !! xz; only where a body has one along axes [Pa]
        real(real32), allocatable :: tilt(:) !! (n) of the gradient in the outermost layers of
                                             !! plies and plates, see brz_one_sided_arm; only where
                                             !! a body has a normal [1/m]
        real(rk), allocatable :: pair(:, :) !! (n_pair, n) written by pass 1 for pass 2
        real(rk), allocatable :: control(:, :) !! (n_control, n) the tensile control, where a body
                                               !! has it; by pass 1
        real(rk), allocatable :: control_due(:) !! (n) where `control` is: energy of the tensile
                                                !! control, and its work in the half step to come;
                                                !! the rest became heat [J]
        integer(int32), allocatable :: id(:) !! (n) number of the particle, kept for life
        integer(int16), allocatable :: ply(:) !! (n) ply, from 1; 0 without plies
        integer(int32), allocatable :: fixed(:) !! (n) is_free, is_fixed, is_gone, or marks of
                                                !! brz_support
        integer(int8), allocatable :: unsupported(:) !! (n) 1: hourglass support lost for good
        integer(int16), allocatable :: support(:) !! (n) neighbours in the unloaded body
    end type particles_t
end module brz_particles
