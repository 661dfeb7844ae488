! SPDX-License-Identifier: MIT
!> The whole key table: the groups of the deck and the keys of all material models.
module brz_key_table
    use brz_core_keys, only: core_keys
    use brz_key, only: key_t
    use brz_materials, only: material_keys
    implicit none
    private
    public :: all_keys

contains

    !> All rows.
    subroutine all_keys(keys)
        type(key_t), allocatable, intent(out) :: keys(:)
        type(key_t), allocatable :: core(:), models(:)

        call core_keys(core)
        call material_keys(models)
        allocate (keys(size(core) + size(models)))
        keys(:size(core)) = core
        keys(size(core) + 1:) = models
    end subroutine all_keys
end module brz_key_table
