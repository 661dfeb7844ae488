! SPDX-License-Identifier: MIT
!> Sums over the neighbours of a particle in pass 1: where each begins.
!>
!> Moments of x_ij (x) x_ij, then v_ij (x) x_ij, then X_ij (x) x_ij, then moments of X_ij (x) X_ij;
!> with a tilt v_ij (x) y_ij in place of the second, and x_ij (x) y_ij after all. In bodies that are
!> total-Lagrangian x and X change places, and with a tilt x_ij (x) y_ij comes last.
module brz_moment_layout
    implicit none
    private
    public :: at_g, at_x, at_s, at_y, at_f, n_moments, n_sums

    integer, parameter :: at_g = 6, at_x = 15, at_s = 24, at_y = 30, n_moments = 39
    integer, parameter :: at_f = 39, n_sums = 48 !! on the CPU
end module brz_moment_layout
