! SPDX-License-Identifier: MIT
!> When a particle has lost so many intact neighbours that its hourglass force ends.
module brz_intact_share
    use brz_kinds, only: rk
    implicit none
    private
    public :: intact_share

    real(rk), parameter :: intact_share = 0.5_rk !! fewer intact neighbours end the stiff
                                                 !! hourglass force
end module brz_intact_share
