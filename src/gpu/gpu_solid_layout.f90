! SPDX-License-Identifier: MIT
!> How the particles lie in the memory of the GPU: names shared by its kernels and the host.
!>
!> What neighbours read is gathered row by row, in rows of 16 B and multiples of it:
!>     place(4, n)      x, y, z, smoothing length where it varies [m]; built: likewise; reference:
!>                      with the tilt of the gradient where bodies have tilts [1/m]
!>     near, far(4, n)  place and reference as pairs read them, in mixed precision packed into 16 B
!>     motion(4, n)     velocity [m/s], volume [m3]
!>     row(n_pair, n)   what pass 2 needs, slots of brz_solid_state
!>     k_axes(6, n)     hourglass stiffness along axes [Pa]; in pass 1 the tilt [1/m] in slot 1
!>     held(n_control, n)  the tensile control, where bodies have it, slots of brz_solid_state; in
!>                      pass 1 the sums S of brz_tensile_control in 1..6, then F in control_affine
!>                      and what is named below
!> What only the particle itself reads lies column by column: state(n, ...), tag(n, ...), and
!> diag(n, ...), whose sums over a body are its energy account. There n is a few places more than
!> there are, so that every column begins on a whole row of memory, see whole_lanes.
module brz_gpu_solid_layout
    use brz_body_numbers, only: body_numbers_t
    use brz_force_layout, only: at_drag, at_friction, at_heat, at_stiff, at_work, n_terms
    use brz_kinds, only: dp, int64, rk
    use brz_link_layout, only: mask_unit, slice_width
    use brz_material, only: material_t
    use brz_row_loop_bodies, only: row_rules_t
    use brz_solid_columns, only: at_accel, at_bulk, at_damage, at_energy, at_hist, at_mass, at_mu, &
        at_stress, at_wave, n_linked_tag, n_tag, tag_bond, tag_face, tag_unsupported, tag_fault, &
        tag_fixed, tag_id, tag_joined, tag_ply, tag_support, tag_touch, tag_weight
    implicit none
    private
    public :: body_gpu_t, grid_gpu_t, list_offsets_t
    public :: at_mu, at_energy, at_stress, at_damage, at_wave, at_bulk, at_mass, at_accel, at_hist
    public :: tag_id, tag_ply, tag_support, tag_fixed, tag_unsupported, tag_fault, &
              tag_bond, tag_joined, tag_touch, tag_weight, tag_face, n_tag, n_linked_tag
    public :: diag_viscous, diag_friction, diag_stiff, diag_ahead, diag_plastic, diag_damage, &
              diag_clamped, &
              diag_force, diag_early, diag_contact_early, diag_contact, diag_contact_heat, &
              diag_rub, diag_load, n_diag
    public :: at_heat, at_friction, at_drag, at_stiff, at_work, n_terms
    public :: pass_tension, pass_deviation, pass_trace
    public :: flag_bad, flag_tension, n_flag, slice_width, mask_unit

    ! columns of `diag`, since the GPU took over [J, N s]; the place of a particle, not the
    ! particle, keeps them
    integer, parameter :: diag_viscous = 1, diag_friction = 2
    integer, parameter :: diag_stiff = 3 !! held by the hourglass or artificial force, with ahead;
                                        !! by the tensile control now
    integer, parameter :: diag_ahead = 4 !! the part of the half step to come
    integer, parameter :: diag_plastic = 5, diag_damage = 6
    integer, parameter :: diag_force = 6 !! + 1..3: impulse on fixed particles
    integer, parameter :: diag_contact = 10 !! energy that contact holds now
    integer, parameter :: diag_contact_heat = 11, diag_rub = 12 !! heat of contact, of friction
    integer, parameter :: diag_load = 13 !! work of the load
    integer, parameter :: diag_clamped = 14 !! steps at the edge of the material's range
    integer, parameter :: diag_early = 15 !! heat of the half step to come, see energy_account_t
    integer, parameter :: diag_contact_early = 16 !! the same of contact
    integer, parameter :: n_diag = 16

    integer, parameter :: flag_bad = 1 !! a particle has an impossible state
    integer, parameter :: flag_tension = 2 !! the tensile control acts on a particle
    integer, parameter :: n_flag = 2 !! behind them, body by body, a flag for each level of motion
                                     !! that some particle has reached, see brz_list_drift

    ! `held` in pass 1: 1 beside S if the particle was in tension, else 0; then what it deviates,
    ! and the trace of M
    integer, parameter :: pass_tension = 7, pass_deviation = 11, pass_trace = 10

    ! Lists: entry k of particle t of a body, both from 1, is entry
    ! (slice((t - 1)/w + 1) + k - 1)*w + mod(t - 1, w) + 1, w = slice_width: threads side by side
    ! read side by side. An entry is the neighbour plus mask_unit times its mirrored axes.

    !> One body, as kernels see it.
    type, extends(body_numbers_t) :: body_gpu_t
        integer :: dimension
        type(row_rules_t) :: rules
        type(material_t) :: material
        integer :: directional !! 1: yes
        integer :: axes !! place before the axes of ply 0 among those of all bodies
        integer :: variable !! 1: the smoothing length follows the density
        integer :: springs !! 1: back from any expansion
        integer :: control_due !! column of `state` with what the tensile control owes, see
                               !! brz_solid_state
        integer :: in_air !! 1: the air loads the bodies
        integer :: face_stress !! column of `state` before that of the load on its faces, 0: none
        integer :: reaction_force !! column of `state` before the force on what holds a particle, 0:
                                  !! none
        integer :: keep_force !! 1: impulses on fixed particles add up; 0: those of one step
        real(rk) :: scale, half_over_h !! of the kernel
        real(rk) :: depth !! of directions that are not modelled [m or m2]
        real(rk) :: spares !! 1: the viscosity spares smooth flow, see jump_speed
        integer :: curved !! 1: the normal of a particle is radial, see brz_body
        real(dp) :: middle(3) !! on the axis of such a wall [m]
        real(rk) :: width(3) !! of the lattice, see brz_wide_lattice
        integer :: layer_of_ply !! 1: yes
        real(rk) :: reach !! of faces in contact, see strain_face [m]
    end type body_gpu_t

    !> Where the lists of a body lie: numbers of 4 B behind the array that a launch is given, so
    !> that one launch reaches the lists of many bodies.
    type :: list_offsets_t
        integer(int64) :: slice = 0, list = 0, pairs = 0
    end type list_offsets_t

    !> Cells over one body.
    type :: grid_gpu_t
        integer :: first, last !! particles
        integer :: cells(3), stride !! cells by axis; length of a table of codes
        integer :: mirror(3) !! 1: symmetry plane
        real(dp) :: lo(3), size, reach !! low corner, side of a cell, length of a pair [m]
    end type grid_gpu_t
end module brz_gpu_solid_layout
