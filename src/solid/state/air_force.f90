! SPDX-License-Identifier: MIT
!> Forces on particles that not every scene has: loads, and what holds them.
module brz_air_force
    use brz_kinds, only: rk
    use brz_particles, only: particles_t
    implicit none
    private
    public :: air_force, load_of, reaction_force_of

contains

    !> Force of the air on particle i [N].
    pure function air_force(solid, i) result(force)
        class(particles_t), intent(in) :: solid
        integer, intent(in) :: i
        real(rk) :: force(3)

        force = 0
        if (allocated(solid%load)) force = solid%load(:, i)
    end function air_force

    !> The loads of the particles; where there are none something that must not be read.
    function load_of(solid) result(load)
        class(particles_t), intent(in), target :: solid
        real(rk), pointer, contiguous :: load(:, :) !! [N]

        load => solid%a
        if (allocated(solid%load)) load => solid%load
    end function load_of

    !> The same of the forces on what holds particles.
    function reaction_force_of(solid) result(reaction_force)
        class(particles_t), intent(in), target :: solid
        real(rk), pointer, contiguous :: reaction_force(:, :) !! [N]

        reaction_force => solid%a
        if (allocated(solid%reaction_force)) reaction_force => solid%reaction_force
    end function reaction_force_of
end module brz_air_force
