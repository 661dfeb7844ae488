! SPDX-License-Identifier: MIT
!> Penalty contact and tied contact (bonds) between particles of different bodies. Point physics.
!>
!> Each particle sums the kernel over the particles of other bodies. Where the sum exceeds that of a
!> flat surface one spacing away the bodies press on each other, with the potential energy
!> V kappa e^2/2 of the excess e: central forces, equal and opposite, and a surface of particles
!> is flat to 0.4 % of a spacing (0.7 % where the springs of one body act alone). Damping and
!> friction act along and across the common normal.
!>
!> Source: docs/theory/contact.md
module brz_contact
    use brz_interaction, only: law_bonded, law_shared, interaction_t
    use brz_kernel, only: kernel_slope, kernel_value
    use brz_kinds, only: dp, rk
    implicit none
    private
    public :: spring_share, crossing_share
    public :: contact_normal, contact_push, contact_drag, drag_stiffness, bond_effort, in_core
    public :: spring_loss, core_loss, surface_velocity, add_moment
    public :: add_link, mean_stiffness, link_pressure
    public :: joins, takes_part, shared_volume
    public :: n_link, link_sum, link_stiffness, link_rate, link_normal

    real(rk), parameter :: hard_core = 0.5_rk !! closer than this many spacings a pair is a spring

    real(dp), parameter :: spring_share = 0.5_dp !! of the period of a contact over 2 pi
    real(dp), parameter :: crossing_share = 0.2_dp !! spacings that a pair may approach in a step

    ! kernel sums of a particle over other bodies
    integer, parameter :: link_sum = 1 !! 1 at a flat surface one spacing away
    integer, parameter :: link_stiffness = 2 !! mean of the partners [Pa]
    integer, parameter :: link_rate = 3 !! how fast the sum grows [1/s]
    integer, parameter :: link_normal = 3 !! + 1..3: sum of V F x_ij/touch [1/m]
    integer, parameter :: link_weight = 7 !! as link_sum, without what strain adds
    integer, parameter :: n_link = 7

contains

    !> True where the particles of a pair may take part in each other's sums: they share them, or
    !> their bond is whole.
    !@cuf attributes(host,device) &
    pure function joins(m, whole) result(yes)
        type(interaction_t), intent(in) :: m
        logical, intent(in) :: whole !! at both particles
        logical :: yes

        yes = m%law == law_shared .or. (m%law == law_bonded .and. whole)
    end function joins

    !> True where a pair that shares its sums takes part in them in this step: it approaches, or is
    !> compressed (weighted by stiffness). Both passes see the same velocities and volumes, so the
    !> forces of the second are those that the gradients of the first work with.
    !@cuf attributes(host,device) &
    pure function takes_part(m, mass_i, volume_i, mass_j, volume_j, vr) result(yes)
        type(interaction_t), intent(in) :: m
        real(rk), intent(in) :: mass_i, volume_i, mass_j, volume_j !! [kg], [m3]
        real(rk), intent(in) :: vr !! v_ij.x_ij [m2/s]
        logical :: yes

        yes = vr < 0 .or. m%weight(1)*(m%rest(1)*mass_i/volume_i - 1) &
              + m%weight(2)*(m%rest(2)*mass_j/volume_j - 1) > 64*epsilon(vr)
    end function takes_part

    !> Product of the volumes with which the particles of a pair share pressure and viscosity.
    !>
    !> Each counts with its volume, but with no more than it had unloaded: what is torn counts the
    !> voids between its pieces as its volume, which is many times that of the matter that meets.
    !@cuf attributes(host,device) &
    pure function shared_volume(m, mass_i, volume_i, mass_j, volume_j) result(product)
        type(interaction_t), intent(in) :: m
        real(rk), intent(in) :: mass_i, volume_i, mass_j, volume_j !! [kg], [m3]
        real(rk) :: product !! [m6]

        product = min(volume_i, m%rest(1)*mass_i)*min(volume_j, m%rest(2)*mass_j)
    end function shared_volume

    !> Common normal of a pair, from j to i: that of the surfaces that press, or along the pair
    !> where only hard cores meet.
    !@cuf attributes(host,device) &
    pure subroutine contact_normal(pi, gi, pj, gj, r, n)
        real(rk), intent(in) :: pi, pj !! pressures of contact [Pa]
        real(rk), intent(in) :: gi(3), gj(3) !! sums of V F x_ij over the other bodies
        real(rk), intent(in) :: r(3) !! x_ij [m]
        real(rk), intent(out) :: n(3) !! unit vector, or 0
        real(rk) :: length, wi, wj

        wi = pi/max(sqrt(gi(1)*gi(1) + gi(2)*gi(2) + gi(3)*gi(3)), tiny(length))
        wj = pj/max(sqrt(gj(1)*gj(1) + gj(2)*gj(2) + gj(3)*gj(3)), tiny(length))
        n = wi*gi - wj*gj
        length = sqrt(n(1)*n(1) + n(2)*n(2) + n(3)*n(3))
        if (.not. length > tiny(length)) then
            n = r
            length = max(sqrt(n(1)*n(1) + n(2)*n(2) + n(3)*n(3)), tiny(length))
        end if
        n = n/length
    end subroutine contact_normal

    !> Spring force of a pair, as a factor of x_ij, and the energy of its hard core.
    !@cuf attributes(host,device) &
    pure subroutine contact_push(m, w, pressure, distance, u, energy)
        type(interaction_t), intent(in) :: m
        real(rk), intent(in) :: w !! V_i V_j F_ij, volumes of lattice cells
        real(rk), intent(in) :: pressure !! kappa e/touch of both [Pa]
        real(rk), intent(in) :: distance !! |x_ij| [m]
        real(rk), intent(out) :: u !! force on i over x_ij [N/m]
        real(rk), intent(out) :: energy !! of the core [J]
        real(rk) :: gap

        gap = max(hard_core*m%spacing - distance, 0.0_rk)
        energy = m%core*gap*gap/(2*hard_core*m%spacing)
        u = w*pressure + m%core*gap/(hard_core*m%spacing)/max(distance, 1e-6_rk*m%spacing)
    end subroutine contact_push

    !> Add a particle of another body to the kernel sums.
    !@cuf attributes(host,device) &
    pure subroutine add_link(m, v, r, dv, grown, growth, sums)
        type(interaction_t), intent(in) :: m
        real(rk), intent(in) :: v !! volume of its cell over `touch` and depth
        real(rk), intent(in) :: r(3), dv(3) !! x_ij [m], v_ij [m/s]
        real(rk), intent(in) :: grown !! what the strain of both half layers adds to the sum
        real(rk), intent(in) :: growth !! how fast that grows [1/s]
        real(rk), intent(inout) :: sums(n_link)
        real(rk) :: distance, slope, w

        distance = sqrt(r(1)*r(1) + r(2)*r(2) + r(3)*r(3))
        slope = kernel_slope(m%scale, m%half_over_h, distance)
        w = v*kernel_value(slope, m%h, distance)
        sums(link_weight) = sums(link_weight) + w
        sums(link_sum) = sums(link_sum) + w*(1 + grown)
        sums(link_stiffness) = sums(link_stiffness) + w*m%stiffness
        sums(link_rate) = sums(link_rate) - v*slope*(r(1)*dv(1) + r(2)*dv(2) + r(3)*dv(3)) &
                          + w*growth
        sums(link_normal + 1) = sums(link_normal + 1) + v*slope*r(1)
        sums(link_normal + 2) = sums(link_normal + 2) + v*slope*r(2)
        sums(link_normal + 3) = sums(link_normal + 3) + v*slope*r(3)
    end subroutine add_link

    !> Make the sum of the stiffness the mean of the partners, times a share.
    !@cuf attributes(host,device) &
    pure subroutine mean_stiffness(share, sums)
        real(rk), intent(in) :: share !! of the springs of the particle, see brz_contact_edges
        real(rk), intent(inout) :: sums(n_link)

        if (sums(link_weight) > 0) &
            sums(link_stiffness) = share*sums(link_stiffness)/sums(link_weight)
    end subroutine mean_stiffness

    !> Pressure of contact of a particle [Pa].
    !@cuf attributes(host,device) &
    pure function link_pressure(sums, touch) result(p)
        real(rk), intent(in) :: sums(n_link)
        real(rk), intent(in) :: touch !! sum at which contact begins
        real(rk) :: p

        p = sums(link_stiffness)*max(sums(link_sum) - touch, 0.0_rk)
    end function link_pressure

    !> What the spring of a particle took from the motion over a step and does not hold, per volume:
    !> heat, or where the step gave more than it took, less of it.
    !>
    !> The leapfrog's work over a step is that of the mean of the forces at both ends.
    !@cuf attributes(host,device) &
    pure function spring_loss(last, touch, dt, now, before) result(loss)
        real(rk), intent(in) :: last, touch !! sum at which contact began, and begins from now on
        real(rk), intent(in) :: dt !! step just made [s]
        real(rk), intent(in) :: now(n_link), before(n_link) !! sums after it and before it
        real(rk) :: loss !! [J/m3]
        real(rk) :: p, p0

        p = link_pressure(now, touch)
        p0 = link_pressure(before, last)
        loss = dt/2*(p*now(link_rate) + p0*before(link_rate))
        if (p > 0) loss = loss - p*p/(2*now(link_stiffness))
        if (p0 > 0) loss = loss + p0*p0/(2*before(link_stiffness))
    end function spring_loss

    !> The same of the hard core of a pair [J]. What a pair that is set free holds at once is taken
    !> from the heat of what held it apart.
    !@cuf attributes(host,device) &
    pure function core_loss(m, fresh, dt, r, dv) result(loss)
        type(interaction_t), intent(in) :: m
        logical, intent(in) :: fresh !! set free in this step
        real(rk), intent(in) :: dt !! step just made [s]
        real(rk), intent(in) :: r(3), dv(3) !! x_ij [m], v_ij [m/s]
        real(rk) :: loss
        real(rk) :: u, u0, energy, energy0, past(3)

        past(1) = r(1) - dt*dv(1)
        past(2) = r(2) - dt*dv(2)
        past(3) = r(3) - dt*dv(3)
        call contact_push(m, 0.0_rk, 0.0_rk, sqrt(r(1)*r(1) + r(2)*r(2) + r(3)*r(3)), u, energy)
        call contact_push(m, 0.0_rk, 0.0_rk, &
                          sqrt(past(1)*past(1) + past(2)*past(2) + past(3)*past(3)), u0, energy0)
        if (fresh) then
            u0 = 0
            energy0 = 0
        end if
        loss = -dt/2*(u*(r(1)*dv(1) + r(2)*dv(2) + r(3)*dv(3)) &
                      + u0*(past(1)*dv(1) + past(2)*dv(2) + past(3)*dv(3))) - (energy - energy0)
    end function core_loss

    !> True for a pair that is so close that its hard core acts.
    !@cuf attributes(host,device) &
    pure function in_core(m, distance) result(inside)
        type(interaction_t), intent(in) :: m
        real(rk), intent(in) :: distance !! |x_ij| [m]
        logical :: inside

        inside = distance < hard_core*m%spacing
    end function in_core

    !> Velocity of the surface of i past that of j. Particles of rigid bodies turn with them; so
    !> drag acts where the surfaces meet, and its arm is that of the surface.
    !@cuf attributes(host,device) &
    pure subroutine surface_velocity(m, r, dv, spin_i, spin_j, v)
        type(interaction_t), intent(in) :: m
        real(rk), intent(in) :: r(3), dv(3) !! x_ij [m], v_ij [m/s]
        real(rk), intent(in) :: spin_i(3), spin_j(3) !! of their bodies [1/s]
        real(rk), intent(out) :: v(3) !! [m/s]
        real(rk) :: w(3)

        w = m%arm(1)*spin_i + m%arm(2)*spin_j
        v(1) = dv(1) - (w(2)*r(3) - w(3)*r(2))
        v(2) = dv(2) - (w(3)*r(1) - w(1)*r(3))
        v(3) = dv(3) - (w(1)*r(2) - w(2)*r(1))
    end subroutine surface_velocity

    !> Moment about particle i of a force that acts at the common surface.
    !@cuf attributes(host,device) &
    pure subroutine add_moment(m, r, f, moment)
        type(interaction_t), intent(in) :: m
        real(rk), intent(in) :: r(3), f(3) !! x_ij [m], force on i [N]
        real(rk), intent(inout) :: moment(3) !! [N m]

        moment(1) = moment(1) - m%arm(1)*(r(2)*f(3) - r(3)*f(2))
        moment(2) = moment(2) - m%arm(1)*(r(3)*f(1) - r(1)*f(3))
        moment(3) = moment(3) - m%arm(1)*(r(1)*f(2) - r(2)*f(1))
    end subroutine add_moment

    !> Damping on approach, and Coulomb's friction, of a pair that is pressed together.
    !>
    !> Below Coulomb's limit friction is viscous: a pair at rest under shear creeps at
    !> traction/stick.
    !@cuf attributes(host,device) &
    pure subroutine contact_drag(m, area, push, dv, n, f, heat)
        type(interaction_t), intent(in) :: m
        real(rk), intent(in) :: area !! of the pair [m2]
        real(rk), intent(in) :: push !! normal force of the spring [N]
        real(rk), intent(in) :: dv(3), n(3) !! v_ij, normal from j to i
        real(rk), intent(out) :: f(3) !! on i [N]
        real(rk), intent(out) :: heat(2) !! power of damping and of friction [W]
        real(rk) :: vn, damp, vt(3), speed, drag

        vn = min(dv(1)*n(1) + dv(2)*n(2) + dv(3)*n(3), 0.0_rk)
        damp = -m%impedance*area*vn
        f = damp*n
        heat(1) = -damp*vn
        vt = dv - (dv(1)*n(1) + dv(2)*n(2) + dv(3)*n(3))*n
        speed = sqrt(vt(1)*vt(1) + vt(2)*vt(2) + vt(3)*vt(3))
        drag = min(m%friction*(max(push, 0.0_rk) + damp), m%stick*area*speed)
        f = f - drag/max(speed, tiny(speed))*vt
        heat(2) = drag*speed
    end subroutine contact_drag

    !> How fast a viscous force on approach grows with the speed, at most: it is of first and second
    !> order in it, so twice the force over the speed.
    !@cuf attributes(host,device) &
    pure function drag_stiffness(u, r2, vr) result(d)
        real(rk), intent(in) :: u !! force over x_ij [N/m]
        real(rk), intent(in) :: r2, vr !! |x_ij|^2 [m2], v_ij.x_ij [m2/s]
        real(rk) :: d !! [N s/m]

        d = 0
        if (vr < 0) d = -2*u*r2/vr
    end function drag_stiffness

    !> Traction of a stress on a bond over its strength: 1 breaks it.
    !@cuf attributes(host,device) &
    pure function bond_effort(m, s, n) result(effort)
        type(interaction_t), intent(in) :: m
        real(rk), intent(in) :: s(6) !! stress xx, yy, zz, xy, yz, xz [Pa]
        real(rk), intent(in) :: n(3) !! unit normal of the bond
        real(rk) :: effort
        real(rk) :: t(3), tension, shear

        t(1) = s(1)*n(1) + s(4)*n(2) + s(6)*n(3)
        t(2) = s(4)*n(1) + s(2)*n(2) + s(5)*n(3)
        t(3) = s(6)*n(1) + s(5)*n(2) + s(3)*n(3)
        tension = t(1)*n(1) + t(2)*n(2) + t(3)*n(3)
        shear = sqrt(max(t(1)*t(1) + t(2)*t(2) + t(3)*t(3) - tension*tension, 0.0_rk))
        tension = max(tension, 0.0_rk)/m%tensile
        shear = shear/m%shear
        effort = max(tension, shear)
        if (m%quadratic) effort = sqrt(tension*tension + shear*shear)
    end function bond_effort
end module brz_contact
