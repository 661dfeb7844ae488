# SPDX-License-Identifier: MIT
# Rules for .pf files. With PFUNIT_DIR set, genuine pFUnit 4 is used, else the stand-in here.
ifdef PFUNIT_DIR
include $(lastword $(sort $(wildcard $(PFUNIT_DIR)/PFUNIT-*/include/PFUNIT.mk)))
PF_PROC   := $(dir $(lastword $(sort $(wildcard $(PFUNIT_DIR)/PFUNIT-*/bin/funitproc))))funitproc
PF_DRIVER := $(lastword $(sort $(wildcard $(PFUNIT_DIR)/PFUNIT-*/include/driver.F90)))
PF_FLAGS   = $(PFUNIT_EXTRA_FFLAGS)
PF_LIBS    = $(PFUNIT_EXTRA_LDFLAGS) -lfunit
else
PF_PROC   := tests/pfstub/pfproc.py
PF_DRIVER := tests/pfstub/driver.F90
PF_MODULES = $(addprefix $(B)/obj/tests/pfstub/,pf_core.o funit.o pf_run.o pf_report.o)
PF_PLAIN   = -std=f2018 -O1 -fno-lto -J$(B)/mod
endif
PF_FLAGS  += -ffree-line-length-none -Wno-unused-function -Wno-unused-dummy-argument

# The tests are not optimised at link time, the library under test is (private: not inherited by
# what a test depends on).
$(B)/obj/tests/%.o: private FAST := $(filter-out -flto=auto,$(FAST))
$(B)/%.F90: %.pf $(PF_PROC)
	@mkdir -p $(@D)
	@$(PF_PROC) $< $@
$(B)/obj/%.o: $(B)/%.F90 $(PF_MODULES) $(B)/command
	@mkdir -p $(@D)
	$(call say,compile $*.pf)
	$(Q)$(COMPILE) $(PF_FLAGS) -c $< -o $@
# The list of suites of a folder, kept when it does not change.
$(B)/tests/%/suites.inc: FORCE
	@{ :; $(foreach name,$(basename $(notdir $(filter tests/$*/%,$(PF)))),echo 'ADD_TEST_SUITE($(name)_suite)';) } | $(SAVE) $@
$(B)/tests/%/driver.o: $(PF_DRIVER) $(B)/tests/%/suites.inc $(PF_MODULES)
	@$(FC) $(FFLAGS) -I$(B)/mod $(PF_FLAGS) -D_TEST_SUITES='"$(abspath $(word 2,$^))"' -c $< -o $@
define pf_run
$(B)/tests/$(1)/run: $(B)/tests/$(1)/driver.o $(LIB) $(PF_MODULES) \
    $(patsubst %,$(B)/obj/%.o,$(basename $(filter tests/$(1)/%,$(PF) $(PF_HELP))))
	$(call say,link $$@)
	$(Q)$(FC) -fopenmp -o $$@ $$^ $$(HDF5_LIBS) $$(PF_LIBS)
endef
$(foreach part,unit verify gpu,$(eval $(call pf_run,$(part))))

# The stand-in itself.
$(B)/tests/pfstub/funit.f90: tests/pfstub/write_funit.py
	@mkdir -p $(@D)
	@$< > $@
$(B)/obj/tests/pfstub/funit.o: $(B)/tests/pfstub/funit.f90 $(B)/obj/tests/pfstub/pf_core.o
	$(call say,compile $<)
	@$(FC) $(PF_PLAIN) -c $< -o $@
$(B)/obj/tests/pfstub/pf_run.o: $(B)/obj/tests/pfstub/pf_core.o
$(B)/obj/tests/pfstub/pf_report.o: $(B)/obj/tests/pfstub/pf_run.o
$(B)/obj/tests/pfstub/%.o: tests/pfstub/%.f90
	@mkdir -p $(@D) $(B)/mod
	@$(FC) $(PF_PLAIN) -c $< -o $@
