! SPDX-License-Identifier: MIT
!> Blast of a sphere of TNT in free air, or of a hemisphere on the ground, by the curves of Kingery
!> and Bulmash.
!>
!> Source: C. N. Kingery, G. Bulmash, ARBRL-TR-02555 (1984), in the form that ConWep uses: with
!> x = log10 of the scaled distance, log10 of a quantity is a polynomial of shift + scale x; spheres
!> in ft, lb, psi, ms, hemispheres in m, kg, kPa, ms. The same tables serve the Python tools
!> (post/data/kb_free_air.csv, post/data/kb_surface.csv).
module brz_kingery_bulmash
    use brz_kinds, only: dp
    implicit none
    private
    public :: blast_t, free_air_blast, friedlander_decay, oblique_shares, surface_blast
    public :: nearest, nearest_ground, farthest

    real(dp), parameter :: lb = 0.45359237_dp, foot = 0.3048_dp, psi = 6894.757293_dp
    real(dp), parameter :: nearest = 0.0589_dp, farthest = 39.6_dp !! scaled distances [m/kg^(1/3)]
    real(dp), parameter :: nearest_ground = 0.0674_dp !! the same of a hemisphere
    integer, parameter :: peak = 1, reflected = 2, arrival = 3, duration = 4, impulse = 5, &
                          reflected_impulse = 6

    !> What a rigid surface meets at one distance.
    type :: blast_t
        real(dp) :: peak = 0, reflected = 0 !! overpressure, incident and of normal reflection [Pa]
        real(dp) :: arrival = 0, duration = 0 !! after the detonation; of the positive phase [s]
        real(dp) :: impulse = 0, reflected_impulse = 0 !! of these overpressures [Pa s]
    end type blast_t

    !> One polynomial.
    type :: curve_t
        integer :: quantity
        real(dp) :: last !! largest x
        real(dp) :: shift, scale
        real(dp) :: c(0:11)
    end type curve_t

    type(curve_t), parameter :: spheres(10) = [ &
        curve_t(peak, 2.0_dp, -0.756579301809_dp, 1.35034249993_dp, &
            [1.77284970457_dp, -1.69012801396_dp, 0.00804973591951_dp, 0.336743114941_dp, &
             -0.00516226351334_dp, -0.0809228619888_dp, -0.00478507266747_dp, &
             0.00793030472242_dp, 0.0007684469735_dp, 0.0_dp, 0.0_dp, 0.0_dp]), &
        curve_t(reflected, 2.0_dp, -0.756579301809_dp, 1.35034249993_dp, &
            [2.39106134946_dp, -2.21400538997_dp, 0.035119031446_dp, 0.657599992109_dp, &
             0.0141818951887_dp, -0.243076636231_dp, -0.0158699803158_dp, 0.0492741184234_dp, &
             0.00227639644004_dp, -0.00397126276058_dp, 0.0_dp, 0.0_dp]), &
        curve_t(arrival, 2.0_dp, -0.80501734056_dp, 1.37407043777_dp, &
            [-0.0423733936826_dp, 1.36456871214_dp, -0.0570035692784_dp, -0.182832224796_dp, &
             0.0118851436014_dp, 0.0432648687627_dp, -0.0007997367834_dp, &
             -0.00436073555033_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]), &
        curve_t(duration, -0.34_dp, 0.0_dp, 0.0_dp, [-0.824_dp, spread(0.0_dp, 1, 11)]), &
        curve_t(duration, 0.350248_dp, 0.209440059933_dp, 5.11588554305_dp, &
            [-0.801052722864_dp, 0.164953518069_dp, 0.127788499497_dp, 0.00291430135946_dp, &
             0.00187957449227_dp, 0.0173413962543_dp, 0.00269739758043_dp, &
             -0.00361976502798_dp, -0.00100926577934_dp, 0.0_dp, 0.0_dp, 0.0_dp]), &
        curve_t(duration, 0.7596678_dp, -5.06778493835_dp, 9.2996288611_dp, &
            [0.115874238335_dp, -0.0297944268969_dp, 0.0306329542941_dp, 0.018340557407_dp, &
             -0.0173964666286_dp, -0.00106321963576_dp, 0.0056206003128_dp, &
             0.0001618217499_dp, -0.0006860188944_dp, 0.0_dp, 0.0_dp, 0.0_dp]), &
        curve_t(duration, 2.0_dp, -4.39590184126_dp, 3.1524725264_dp, &
            [0.50659210403_dp, 0.0967031995552_dp, -0.00801302059667_dp, 0.00482705779732_dp, &
             0.00187587272287_dp, -0.00246738509321_dp, -0.000841116668_dp, 0.0006193291052_dp, &
             0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]), &
        curve_t(reflected_impulse, 2.0_dp, -0.757659920369_dp, 1.37882996018_dp, &
            [1.60579280091_dp, -0.903118886091_dp, 0.101771877942_dp, -0.0242139751146_dp, &
             spread(0.0_dp, 1, 8)]), &
        curve_t(impulse, 0.30103_dp, 1.04504877747_dp, 3.24299066475_dp, &
            [1.43534136453_dp, -0.443749377691_dp, 0.168825414684_dp, 0.0348138030308_dp, &
             -0.010435192824_dp, spread(0.0_dp, 1, 7)]), &
        curve_t(impulse, 2.0_dp, -2.67912519532_dp, 2.30629231803_dp, &
            [0.599008468099_dp, -0.40463292088_dp, -0.0142721946082_dp, 0.00912366316617_dp, &
             -0.0006750681404_dp, -0.00800863718901_dp, 0.00314819515931_dp, &
             0.00152044783382_dp, -0.0007470265899_dp, 0.0_dp, 0.0_dp, 0.0_dp])]

    type(curve_t), parameter :: hemispheres(9) = [ &
        curve_t(peak, 2.0_dp, -0.214362789151_dp, 1.35034249993_dp, &
            [2.78076916577_dp, -1.6958988741_dp, -0.154159376846_dp, 0.514060730593_dp, &
             0.0988534365274_dp, -0.293912623038_dp, -0.0268112345019_dp, 0.109097496421_dp, &
             0.00162846756311_dp, -0.0214631030242_dp, 0.0001456723382_dp, 0.00167847752266_dp]), &
        curve_t(reflected, 2.0_dp, -0.240657322658_dp, 1.36637719229_dp, &
            [3.40283217581_dp, -2.21030870597_dp, -0.218536586295_dp, 0.895319589372_dp, &
             0.24989009775_dp, -0.569249436807_dp, -0.11791682383_dp, 0.224131161411_dp, &
             0.0245620259375_dp, -0.0455116002694_dp, -0.00190930738887_dp, &
             0.00361471193389_dp]), &
        curve_t(arrival, 2.0_dp, -0.202425716178_dp, 1.37784223635_dp, &
            [-0.0591634288046_dp, 1.35706496258_dp, 0.052492798645_dp, -0.196563954086_dp, &
             -0.0601770052288_dp, 0.0696360270891_dp, 0.0215297490092_dp, -0.0161658930785_dp, &
             -0.00232531970294_dp, 0.00147752067524_dp, 0.0_dp, 0.0_dp]), &
        curve_t(duration, 0.004321374_dp, 1.92946154068_dp, 5.25099193925_dp, &
            [-0.614227603559_dp, 0.130143717675_dp, 0.134872511954_dp, 0.0391574276906_dp, &
             -0.00475933664702_dp, -0.00428144598008_dp, spread(0.0_dp, 1, 6)]), &
        curve_t(duration, 0.444044796_dp, -2.12492525216_dp, 9.2996288611_dp, &
            [0.315409245784_dp, -0.0297944268976_dp, 0.030632954288_dp, 0.0183405574086_dp, &
             -0.0173964666211_dp, -0.00106321963633_dp, 0.00562060030977_dp, &
             0.0001618217499_dp, -0.0006860188944_dp, 0.0_dp, 0.0_dp, 0.0_dp]), &
        curve_t(duration, 2.0_dp, -3.53626218091_dp, 3.46349745571_dp, &
            [0.686906642409_dp, 0.0933035304009_dp, -0.0005849420883_dp, -0.00226884995013_dp, &
             -0.00295908591505_dp, 0.00148029868929_dp, spread(0.0_dp, 1, 6)]), &
        curve_t(reflected_impulse, 2.0_dp, -0.246208804814_dp, 1.33422049854_dp, &
            [2.70588058103_dp, -0.949516092853_dp, 0.112136118689_dp, -0.0250659183287_dp, &
             spread(0.0_dp, 1, 8)]), &
        curve_t(impulse, -0.019996628_dp, 2.06761908721_dp, 3.0760329666_dp, &
            [2.52455620925_dp, -0.502992763686_dp, 0.171335645235_dp, 0.0450176963051_dp, &
             -0.0118964626402_dp, spread(0.0_dp, 1, 7)]), &
        curve_t(impulse, 2.0_dp, -1.94708846747_dp, 2.40697745406_dp, &
            [1.67281645863_dp, -0.384519026965_dp, -0.0260816706301_dp, 0.00595798753822_dp, &
             0.0145445261077_dp, -0.00663289334734_dp, -0.00284189327204_dp, &
             0.0013644816227_dp, spread(0.0_dp, 1, 4)])]
    real(dp), parameter :: least_duration = -0.7496_dp !! log10 of 0.178 m/kg^(1/3): constant below

contains

    !> The blast of a mass of TNT at a distance, scaled distances from `nearest` to `farthest`.
    pure function free_air_blast(mass, distance) result(blast)
        real(dp), intent(in) :: mass, distance !! [kg], [m]
        type(blast_t) :: blast
        real(dp) :: x, root

        root = (mass/lb)**(1/3.0_dp)
        x = log10(distance/foot/root)
        blast = blast_of(spheres, [x, x], psi, 1e-3_dp*root)
    end function free_air_blast

    !> The blast of a hemisphere of TNT on the ground, of which only its own mass counts, from
    !> `nearest_ground` to `farthest`. Duration: that of 0.178 m/kg^(1/3) where it is nearer.
    pure function surface_blast(mass, distance) result(blast)
        real(dp), intent(in) :: mass, distance !! [kg], [m]
        type(blast_t) :: blast
        real(dp) :: x, root

        root = mass**(1/3.0_dp)
        x = log10(distance/root)
        blast = blast_of(hemispheres, [x, max(x, least_duration)], 1e3_dp, 1e-3_dp*root)
    end function surface_blast

    !> Shares of the reflected and of the incident wave in what a rigid surface feels, by the cosine
    !> of the angle of incidence: p = p_r c^2 + p_i (1 + c - 2 c^2), and p_i alone where it looks
    !> away (c < 0). Never below p_i where p_r >= p_i, and p_i (1 + c) for sound, where p_r = 2 p_i.
    !>
    !> Source: G. Randers-Pehrson, K. A. Bannister, ARL-TR-1310 (1997), whose printed share of the
    !> incident wave, 1 + c^2 - 2 c, has c and its square exchanged (docs/manual/blast.md).
    pure function oblique_shares(cosine) result(share)
        real(dp), intent(in) :: cosine
        real(dp) :: share(2) !! reflected, incident
        real(dp) :: c

        c = max(cosine, 0.0_dp)
        share = [c*c, 1 + c - 2*c*c]
    end function oblique_shares

    !> All quantities of a table at a place, and at another one for the duration.
    pure function blast_of(curves, x, pressure, time) result(blast)
        type(curve_t), intent(in) :: curves(:)
        real(dp), intent(in) :: x(2)
        real(dp), intent(in) :: pressure, time !! units of the table [Pa], [s]
        type(blast_t) :: blast

        blast%peak = pressure*value_of(curves, peak, x(1))
        blast%reflected = pressure*value_of(curves, reflected, x(1))
        blast%arrival = time*value_of(curves, arrival, x(1))
        blast%duration = time*value_of(curves, duration, x(2))
        blast%impulse = pressure*time*value_of(curves, impulse, x(1))
        blast%reflected_impulse = pressure*time*value_of(curves, reflected_impulse, x(1))
    end function blast_of

    !> Value of a curve in its own unit.
    pure real(dp) function value_of(curves, quantity, x) result(value)
        type(curve_t), intent(in) :: curves(:)
        integer, intent(in) :: quantity
        real(dp), intent(in) :: x
        real(dp) :: u
        integer :: i, k

        do i = 1, size(curves)
            if (curves(i)%quantity /= quantity) cycle
            u = curves(i)%shift + curves(i)%scale*x
            value = curves(i)%c(11)
            do k = 10, 0, -1
                value = value*u + curves(i)%c(k)
            end do
            if (x <= curves(i)%last) exit
        end do
        value = 10**value
    end function value_of

    !> Decay b of a Friedlander wave p (1 - t/T) exp(-b t/T) from its impulse.
    pure real(dp) function friedlander_decay(peak, duration, impulse) result(b)
        real(dp), intent(in) :: peak, duration, impulse !! [Pa], [s], [Pa s]
        real(dp) :: low, high
        integer :: round

        low = -50 ! the impulse over p T falls from large values to 0 as b grows
        high = 1e4_dp
        do round = 1, 200
            b = (low + high)/2
            if (share(b) > impulse/(peak*duration)) then
                low = b
            else
                high = b
            end if
        end do

    contains

        !> Impulse over p T: 1/b - (1 - exp(-b))/b^2.
        pure real(dp) function share(b)
            real(dp), intent(in) :: b

            if (abs(b) < 1e-3_dp) then
                share = 0.5_dp - b/6 + b*b/24 - b**3/120
            else
                share = 1/b - (1 - exp(-b))/(b*b)
            end if
        end function share
    end function friedlander_decay
end module brz_kingery_bulmash
