# SPDX-License-Identifier: MIT
# Rules for .pf files. With PFUNIT_DIR set, genuine pFUnit 4 is used, else the stand-in here.
ifdef PFUNIT_DIR
PFUNIT_MK := $(lastword $(sort $(wildcard $(PFUNIT_DIR)/PFUNIT-*/include/PFUNIT.mk)))
ifeq ($(PFUNIT_MK),)
$(error $(PFUNIT_DIR) holds no PFUNIT-*/include/PFUNIT.mk: PFUNIT_DIR is the folder in which pFUnit 4 is installed)
endif
include $(PFUNIT_MK)
PF_HOME   := $(patsubst %/include/PFUNIT.mk,%,$(PFUNIT_MK))
PF_PROC   := $(PF_HOME)/bin/funitproc
PF_DRIVER := $(PF_HOME)/include/driver.F90
PF_FLAGS   = $(PFUNIT_EXTRA_FFLAGS)
PF_LIBS    = $(PFUNIT_LIBRARIES)
PF_XML    := -x -o
else
PF_PROC   := tests/pfstub/pfproc.py
PF_DRIVER := tests/pfstub/driver.F90
PF_MODULES = $(addprefix $(B)/obj/tests/pfstub/,pf_core.o funit.o pf_mpi.o pf_run.o pf_report.o)
PF_PLAIN   = -std=f2018 -O1 -fno-lto -J$(B)/pfstub
PF_FLAGS   = -I$(B)/pfstub
PF_XML    := -x
PF_QUICK   = $(if $(filter quick,$(TIER)),-q)
endif
PF_FLAGS  += -ffree-line-length-none -Wno-unused-function -Wno-unused-dummy-argument

# What the tests are made with: they are made anew where that changes. (Modules of the stand-in lie
# in a folder of their own, where genuine pFUnit does not look.)
$(B)/pf_command: FORCE
	@echo '$(PF_PROC) $(PF_DRIVER) $(PF_PLAIN) $(PF_FLAGS) $(PF_LIBS)' | $(SAVE) $@
# The library under test is optimised at link time. Its tests are not: suites are built as they are,
# what helps them quickly; what measures speed is as fast as the library. (private: not inherited by
# what a test depends on)
$(B)/obj/tests/%.o: private FAST := $(filter-out -flto=auto,$(FAST))
$(foreach part,unit/% verify/% gpu/gpu_%,$(B)/obj/tests/$(part).o): private FAST := $(QUICKLY)
$(foreach part,unit/test_% verify/verify_% gpu/test_%,$(B)/obj/tests/$(part).o): private FAST := -O0 -march=$(ARCH)
# (These are kept. Without a list .SECONDARY is for all files, and then make looks through what they
# depend on again and again: minutes before the first one is compiled.)
.SECONDARY: $(PF:%.pf=$(B)/%.F90) $(foreach part,unit verify gpu,$(B)/tests/$(part)/suites.inc)
$(B)/%.F90: %.pf $(PF_PROC) $(wildcard tests/pfstub/*.py) $(B)/pf_command
	@mkdir -p $(@D)
	@$(PF_PROC) $< $@
$(B)/obj/%.o: $(B)/%.F90 $(PF_MODULES) $(B)/command
	@mkdir -p $(@D)
	$(call say,compile $*.pf)
	$(Q)$(COMPILE) $(PF_FLAGS) -c $< -o $@ $(TOLD)
# The list of suites of a folder, kept when it does not change.
$(B)/tests/%/suites.inc: FORCE
	@{ :; $(foreach name,$(basename $(notdir $(filter tests/$*/%,$(PF)))),echo 'ADD_TEST_SUITE($(name)_suite)';) } | $(SAVE) $@
$(B)/tests/%/driver.o: $(PF_DRIVER) $(B)/tests/%/suites.inc $(PF_MODULES) $(B)/pf_command
	@$(FC) $(FFLAGS) -J$(@D) $(PF_FLAGS) -D_TEST_SUITES='"$(abspath $(word 2,$^))"' -c $< -o $@
define pf_run
$(B)/tests/$(1)/run: $(B)/tests/$(1)/driver.o $(LINKED) $(PF_MODULES) $(B)/pf_command \
    $(patsubst %,$(B)/obj/%.o,$(basename $(filter tests/$(1)/% $(if $(filter gpu,$(1)),tests/verify/shared_%),$(PF) $(PF_HELP))))
	$(call say,link $$@)
	$(Q)$(LINK) -o $$@ $$(filter %.o,$$^) $$(HDF5_LIBS) $$(PF_LIBS)
endef
$(foreach part,unit verify gpu,$(eval $(call pf_run,$(part))))

# The stand-in itself.
$(B)/tests/pfstub/funit.f90: tests/pfstub/write_funit.py
	@mkdir -p $(@D)
	@$< > $@
$(B)/obj/tests/pfstub/funit.o: $(B)/tests/pfstub/funit.f90 $(B)/obj/tests/pfstub/pf_core.o
	$(call say,compile $<)
	@$(FC) $(PF_PLAIN) -c $< -o $@
$(B)/obj/tests/pfstub/pf_mpi.o: $(B)/obj/tests/pfstub/pf_core.o
$(B)/obj/tests/pfstub/pf_run.o: $(B)/obj/tests/pfstub/pf_mpi.o
$(B)/obj/tests/pfstub/pf_report.o: $(B)/obj/tests/pfstub/pf_run.o
$(B)/obj/tests/pfstub/%.o: tests/pfstub/%.f90 $(B)/pf_command
	@mkdir -p $(@D) $(B)/pfstub
	@$(FC) $(PF_PLAIN) -c $< -o $@
