! SPDX-License-Identifier: MIT
!> One row of the key table: everything that is known of one key of the deck.
!>
!> A row without key describes its group, or, with an owner, that model.
!> The table feeds the scanner, its error texts, the echo, `--describe` and the reference page.
module brz_key
    use brz_kinds, only: dp
    implicit none
    private
    public :: key_t, kind_integer, kind_real, kind_logical, kind_text, required, none
    public :: level_basic, level_advanced, level_expert

    integer, parameter :: kind_integer = 1, kind_real = 2, kind_logical = 3, kind_text = 4
    !> who needs a key: a first deck; some decks; studies of the method
    integer, parameter :: level_basic = 1, level_advanced = 2, level_expert = 3
    character(*), parameter :: required = '(required)' !! default of a key that must be given
    character(*), parameter :: none = '(none)' !! default of a key that may be absent

    type :: key_t
        character(16) :: group = '' !! group without the ampersand, e.g. 'air'
        character(24) :: key = ''
        integer :: kind = kind_real !! one of the kinds above
        integer :: level = level_advanced !! one of the levels above; what is required is basic
        integer :: n_min = 1, n_max = 1 !! how many values it takes
        character(12) :: unit = '-' !! SI unit, '-' where there is none
        character(32) :: default = none !! as it would stand in a deck, or `required`, or `none`
        real(dp) :: lower = -huge(1.0_dp), upper = huge(1.0_dp) !! range of a number
        logical :: open_lower = .false. !! the lower bound itself is not allowed
        !> outside of it a warning is given
        real(dp) :: likely(2) = [-huge(1.0_dp), huge(1.0_dp)]
        integer :: longest = 32 !! most characters of a text
        logical :: bare = .false. !! a text may stand without quotes
        character(1024) :: choices = '' !! allowed texts, separated by '|'; '' = any
        character(24) :: former = '' !! what the key was called before, which is refused
        character(24) :: alias = '' !! an older name that is read as this one, and told
        character(300) :: meaning = '' !! one sentence
        character(24) :: owner = '' !! &material: the model that has this key, '' = every model
        logical :: failure = .false. !! &material: goes with failure = 'none'
        character(24) :: needs = '' !! key without which this one means nothing, '' = none
    end type key_t
end module brz_key
