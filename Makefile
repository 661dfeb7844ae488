# SPDX-License-Identifier: MIT
# Brisance. `make help` lists the targets and the variables.
VERSION := 0.2.0
.DEFAULT_GOAL := all
.DELETE_ON_ERROR:
.SUFFIXES:

# --- what to build: each choice has a build folder and a binary of its own -------------------
FC        := gfortran
PRECISION ?= double
# Without SLP vectors: with -march of Cascade Lake or newer, GCC 12.2 copies a structure that begins as
# 1, 1, 1, 1, 1, 1, 0, 0 as eight ones (air_sweep.f90 then left out the first brick of cells).
OPT       ?= -O3 -fno-math-errno -fno-trapping-math -finline-limit=400 -fno-tree-slp-vectorize
ARCH      := $(if $(PORTABLE),x86-64-v2,native)
KIND      := $(if $(DEBUG),-debug)$(if $(QUICK),-quick)$(if $(COVERAGE),-coverage)$(if $(PORTABLE),-portable)$(if $(filter mixed,$(PRECISION)),-mixed)
BUILD     ?= build
B         := $(BUILD)/cpu$(KIND)
BIN       := bin/brisance$(KIND)
# Threads that wait sleep: on a busy machine spinning ones cost more than they save.
OMP_WAIT_POLICY ?= passive
export OMP_WAIT_POLICY
# Scripts run by the interpreter of .venv where it is: a shim in its place costs 0.1 s of each.
export PATH := $(CURDIR)/.venv/bin:$(PATH)

HDF5_CFLAGS = $(shell pkg-config --cflags hdf5-serial)
HDF5_LIBS   = $(shell pkg-config --libs-only-L hdf5-serial) -lhdf5_fortran -lhdf5 -lz
WARN     := -Wall -Wextra -Wno-c-binding-type -Wno-compare-reals -Wno-maybe-uninitialized \
            -Werror=character-truncation
FAST     := $(OPT) -march=$(ARCH) -flto=auto
# Rooms without a loop of the step: to optimise them across files would double the time of a build.
SETUP_ROOMS := src/deck src/device src/gpu src/output src/solid/bodies src/step/backend src/step/check src/step/run
QUICKLY  := -O1 -fno-math-errno -fno-trapping-math -march=$(ARCH)
CHECKED  := -O0 -g -fcheck=all,no-array-temps -ffpe-trap=invalid,zero,overflow -fbacktrace
COUNTED  := -O1 -g --coverage -fprofile-abs-path -fprofile-update=atomic
FFLAGS    = -std=f2018 -fopenmp $(if $(COVERAGE),$(COUNTED),$(if $(DEBUG),$(CHECKED),$(if $(QUICK),$(QUICKLY),$(FAST)))) $(WARN) \
            $(if $(filter mixed,$(PRECISION)),-DBRZ_MIXED) $(EXTRA_FFLAGS)
# (tests and copies of the process leave by _exit: counts are written before: tests/coverage.c)
LINK      = $(FC) -fopenmp $(if $(COVERAGE),--coverage -Wl$(,)--wrap=_exit)
COMPILE   = $(FC) $(FFLAGS) $(HDF5_CFLAGS) -J$(B)/mod
, := ,
Q        := $(if $(V),,@)
PY       := .venv/bin/python
say       = $(if $(V),,@echo '  $(1)')
# What the compiler says is shown, and stays beside the object: see warnings.
TOLD      = 2>$(@:.o=.log) || { cat $(@:.o=.log) >&2; exit 1; }; cat $(@:.o=.log) >&2

# --- sources: whatever is there ----------------------------------------------------------------
SRC  := $(sort $(shell find src -name '*.f90' -o -name '*.F90'))
MAIN := $(wildcard src/main.f90)
# Loops, kernels and launches are written around loop bodies: src/README.md
MADE  := build/made
LOOP_BODIES := $(filter %_loop_bodies.f90,$(SRC))
BODY_NAMES := $(patsubst %_loop_bodies,%,$(basename $(notdir $(LOOP_BODIES))))
MODELS := $(wildcard src/materials/*.f90)
CUDA := $(sort $(wildcard cuda/*.CUF))
FAMILIES := $(sort $(foreach f,$(CUDA),$(firstword $(subst _, ,$(basename $(notdir $f))))))
VARIED := $(foreach f,$(FAMILIES),$(if $(shell grep -lsE '^ *!@kernel [^*]+$$' cuda/$f*.CUF),$f))
LOOPS := $(BODY_NAMES:%=$(MADE)/%_loops.f90) $(patsubst %,$(MADE)/%_launches.f90,$(BODY_NAMES) $(FAMILIES)) \
         $(if $(MODELS),$(MADE)/model_list.f90 $(MADE)/flow_list.f90)
OBJ   = $(patsubst %,$(B)/obj/%.o,$(basename $(filter-out $(MAIN),$(SRC)) $(LOOPS))) $(B)/obj/presets.o \
        $(if $(COVERAGE),$(B)/obj/tests/coverage.o)
LIB  := $(B)/brisance.o
# (apart, so that a commit is told without optimising all anew)
LINKED := $(LIB) $(B)/obj/version.o
KERNELS := $(CUDA) $(BODY_NAMES:%=$(MADE)/%_kernels.CUF) $(VARIED:%=$(MADE)/%_variants.CUF) \
           $(MADE)/model_kernels.CUF $(MADE)/model_list.f90 $(MADE)/flow_list.f90
PARTS_OF_KERNELS := $(wildcard cuda/*.ll)
PTX  := $(BIN).ptx
# what the GPU code is made from; the executable refuses a PTX file of other sources
DEVICE := $(shell grep -ls '^ *!@cuf' $(SRC)) $(CUDA) $(PARTS_OF_KERNELS) scripts/loop_heads.py scripts/loops.py scripts/models.py
STAMP := $(shell cat $(DEVICE) scripts/cuda_fortran.py | sha1sum | cut -c 1-16)
SAVE := scripts/write_if_changed.sh

.PHONY: all lib gpu emulator clean help FORCE
all: $(if $(MAIN),$(BIN),lib) ## build bin/brisance
lib: $(LINKED) ## build everything but the main program

$(BIN): $(B)/obj/src/main.o $(LINKED)
	@mkdir -p $(@D)
	$(call say,link $@)
	+$(Q)$(LINK) -o $@ $^ $(HDF5_LIBS)
# One object for all: link-time optimisation is done once, and the tests run the same code as $(BIN).
# (-fPIE: the functions are final, so that point physics is inlined across files)
$(LIB): $(OBJ)
	$(call say,optimise $@)
	+$(Q)$(FC) $(FFLAGS) -nostdlib -r $(if $(DEBUG)$(QUICK)$(COVERAGE),,-fPIE -flinker-output=nolto-rel) -o $@ $(OBJ)
gpu: $(PTX) ## build the GPU code, or take that of a release archive (FMA=off: no contraction; CUF=nvfortran: by that compiler, untested)
$(PTX): $(SRC) $(KERNELS) $(PARTS_OF_KERNELS) scripts/cuda_fortran.py scripts/gpu_build.py
	@mkdir -p $(@D)
	$(Q)$(PY) scripts/$(if $(filter nvfortran,$(CUF)),gpu_nvfortran,gpu_build).py --work build/gpu/ptx$(KIND) --out $@ --stamp $(STAMP) \
	    $(if $(filter mixed,$(PRECISION)),-D BRZ_MIXED) $(if $(filter off,$(FMA)),--no-fma) $(SRC) $(KERNELS)
EMULATOR := build/gpu/emulator$(KIND)/libcuda.so.1
emulator: $(EMULATOR) ## a CUDA driver that runs the kernels on the CPU: LD_LIBRARY_PATH=build/gpu/emulator
$(EMULATOR): $(DEVICE) $(KERNELS) scripts/gpu_emulate.py $(wildcard tests/gpu/emul*)
	$(call say,emulate $@)
	$(Q)$(PY) scripts/gpu_emulate.py --work build/gpu/emulated$(KIND) --out $@ \
	    $(if $(filter mixed,$(PRECISION)),-D BRZ_MIXED) $(SRC) $(KERNELS) >/dev/null
$(foreach f,$(sort $(dir $(LOOP_BODIES))),$(eval $(MADE)/%_loops.f90 $(MADE)/%_kernels.CUF $(MADE)/%_launches.f90: $f%_loop_bodies.f90 scripts/loops.py scripts/loop_heads.py ; \
    @mkdir -p $(MADE) && scripts/loops.py $(MADE) $$<))
$(foreach f,$(FAMILIES),$(eval $(MADE)/$f_launches.f90 $(if $(filter $f,$(VARIED)),$(MADE)/$f_variants.CUF) &: \
    $(wildcard cuda/$f*.CUF) scripts/loops.py scripts/loop_heads.py ; \
    @mkdir -p $(MADE) && scripts/loops.py $(MADE) $f $(wildcard cuda/$f*.CUF)))
$(MADE)/model_list.f90 $(MADE)/flow_list.f90 $(MADE)/model_kernels.CUF &: $(MODELS) scripts/models.py
	@mkdir -p $(MADE) && scripts/models.py $(MADE) $(MODELS)
$(if $(DEBUG)$(QUICK)$(COVERAGE),,$(patsubst %.f90,$(B)/obj/%.o,$(filter $(addsuffix /%,$(SETUP_ROOMS)),$(SRC))) \
    $(B)/obj/presets.o: private FAST := $(QUICKLY))
$(B)/obj/%.o: %.f90 $(B)/command
	@mkdir -p $(@D) $(B)/mod
	$(call say,compile $<)
	$(Q)$(COMPILE) -c $< -o $@ $(TOLD)
$(B)/obj/%.o: %.F90 $(B)/command
	@mkdir -p $(@D) $(B)/mod
	$(call say,compile $<)
	$(Q)$(COMPILE) -c $< -o $@ $(TOLD)
$(B)/obj/version.o $(B)/obj/presets.o: $(B)/obj/%.o: $(B)/%.f90 $(B)/command
	@mkdir -p $(@D) $(B)/mod
	$(call say,compile $<)
	$(Q)$(COMPILE) -c $< -o $@ $(TOLD)
$(B)/obj/tests/coverage.o: tests/coverage.c
	@mkdir -p $(@D)
	$(Q)gcc -c $< -o $@
$(B)/version.f90: FORCE
	@scripts/version.py --version '$(VERSION)' --compiler "$$($(FC) --version | head -n 1)" \
	    --flags '$(strip $(FFLAGS))' --precision $(PRECISION) --device-code $(STAMP) | $(SAVE) $@
$(B)/presets.f90: scripts/presets.py FORCE
	@$< $(wildcard inputs/presets/*.nml) | $(SAVE) $@

# --- tests: one executable for each of tests/unit and tests/verify -----------------------------
PF       := $(sort $(wildcard tests/unit/*.pf tests/verify/*.pf tests/gpu/*.pf))
PF_HELP  := $(sort $(wildcard tests/unit/*.f90 tests/verify/*.f90 tests/gpu/gpu_*.f90))
include tests/pfstub/pfunit.mk
BENCH    := $(sort $(wildcard tests/bench/bench_*.f90))
FLOORS   := $(wildcard tests/bench/floors.f90)
$(B)/tests/bench/%: $(B)/obj/tests/bench/%.o $(FLOORS:%.f90=$(B)/obj/%.o) $(LINKED)
	@mkdir -p $(@D)
	$(call say,link $@)
	$(Q)$(LINK) -o $@ $^ $(HDF5_LIBS)

# Studies have a Makefile of their own, which includes this one.
ifeq ($(filter studies/Makefile,$(MAKEFILE_LIST)),)
STUDIES := $(shell sed -n 's/^\([a-z][a-z0-9-]*\):.*/\1/p' /dev/null $(wildcard studies/Makefile))
.PHONY: $(STUDIES)
$(STUDIES):
	@$(MAKE) --no-print-directory -f studies/Makefile $@
endif
SITE := build/site
.PHONY: site unit verify try python figures lint format check-docs gpu-check setup test test-all demo bench bench-ranks golden vectors warnings coverage planted install dist corpus
# The figures that tests measure go to NOTES and PYTHON_NOTES; a whole run begins them anew.
NOTES := build/log/notes$(KIND).csv
PYTHON_NOTES := build/log/notes-python$(KIND).csv
unit verify: %: $(B)/tests/%/run ## run the unit tests, the verification tests (ARGS="-v -f name"; TIER=quick: none that is slow)
	@mkdir -p build/log
	@$(if $(ARGS)$(filter unit,$@),,rm -f $(NOTES))
	BRZ_NOTES=$(abspath $(NOTES)) $(B)/tests/$@/run $(PF_QUICK) $(PF_XML) build/log/$(if $(filter unit,$@),$(or $(UNIT),$@),$@).xml $(ARGS)

try: ## after an edit: build quickly, run the tests whose names hold a text, in seconds (ARGS="-f name")
	@$(MAKE) --no-print-directory QUICK=1 unit $(if $(ARGS),verify)
unit-mixed: ## run the unit tests in mixed precision, built quickly
	@$(MAKE) --no-print-directory PRECISION=mixed QUICK=1 UNIT=unit-mixed unit
.PHONY: unit-mixed

# The same tests on a GPU, or anywhere with the emulated driver. They need no compiler: carry $(B)/tests/gpu and bin.
GPU_TEST = BRISANCE_PTX=$(PTX) $(B)/tests/gpu/run
gpu-tests: $(B)/tests/gpu/run $(B)/tests/gpu/bench_gpu $(B)/tests/gpu/bench_gpu_solid $(B)/tests/gpu/bench_gpu_coupling $(PTX) ## build the tests and the benchmark of the GPU
test-gpu: ## run the tests of the GPU (make gpu-tests builds them)
	$(GPU_TEST) $(ARGS)
bench-gpu: ## measure the speed on the GPU (ARGS: cells in each direction)
	BRISANCE_PTX=$(PTX) $(B)/tests/gpu/bench_gpu $(or $(ARGS),128 256 400)
	BRISANCE_PTX=$(PTX) $(B)/tests/gpu/bench_gpu_solid
	BRISANCE_PTX=$(PTX) $(B)/tests/gpu/bench_gpu_coupling
emulated: $(B)/tests/gpu/run $(EMULATOR) ## run the tests of the GPU with the emulated driver
	@mkdir -p build/log
	@echo '// $(STAMP)' > build/gpu/emulated.ptx
	LD_LIBRARY_PATH=$(dir $(EMULATOR)) BRISANCE_PTX=build/gpu/emulated.ptx $(B)/tests/gpu/run $(PF_QUICK) $(PF_XML) build/log/emulated.xml $(ARGS)
$(B)/tests/gpu/bench_%: $(B)/obj/tests/gpu/bench_%.o $(patsubst %.f90,$(B)/obj/%.o,$(wildcard tests/gpu/gpu_*.f90) $(FLOORS)) $(LINKED)
	@mkdir -p $(@D)
	$(call say,link $@)
	$(Q)$(LINK) -o $@ $^ $(HDF5_LIBS)
.PHONY: gpu-tests test-gpu bench-gpu emulated

# --- what users and CI call ---------------------------------------------------------------------
FORMAT  = $(shell git ls-files -co --exclude-standard '*.f90' '*.F90' '*.inc' '*.CUF')
# (verify is one thread nearly all the time: the other parts fill the second core beside it)
QUICKLY_DONE := all unit verify+lint+emulated+python figures check-docs vectors warnings
EVERYTHING := all unit verify+unit-mixed+lint+gpu-check+gpu+emulated+python figures check-docs vectors warnings
setup: ## install what is missing
	@scripts/setup.sh
test: setup ## build, and run every test that is not labelled slow
	@$(PY) scripts/run_tests.py --quick $(QUICKLY_DONE)
test-all: setup ## build and run every test, in mixed precision and for the GPU as well
	@$(PY) scripts/run_tests.py $(EVERYTHING)
demo: setup ## a coarse blast on a CFRP plate, with pictures
	@$(MAKE) --no-print-directory all
	$(BIN) run inputs/demo.nml --replace
	$(PY) -m post report out/demo
bench: $(BENCH:%.f90=$(B)/%) ## measure the speed on this machine
	@for program in $^; do $$program || exit 1; done
bench-ranks: all ## speed of the air on several processes: strong and weak scaling (ARGS: numbers of processes, --backend gpu)
	@$(PY) scripts/bench_ranks.py $(BIN) $(or $(ARGS),1 2)
vectors: $(if $(DEBUG)$(QUICK)$(COVERAGE),,$(LIB)) ## are the pair loops of the solid still vector code?
	@$(if $(DEBUG)$(QUICK),echo 'skipped: not in this build',$(PY) scripts/vectors.py $(LIB))
COMPILED = $(OBJ) $(B)/obj/src/main.o $(patsubst %,$(B)/obj/%.o,$(basename $(PF) $(PF_HELP)))
WARNINGS = $(filter $(COMPILED:.o=.log),$(shell find $(B)/obj -name '*.log' -size +0))
warnings: ## has the compiler warned of anything in this build and its tests?
	@$(if $(WARNINGS),cat $(WARNINGS); exit 1,echo 'the compiler has warned of nothing')
COVERED ?= unit verify
coverage: ## which lines the tests run (COVERED="unit"; FILE=src/...: those of a file that they do not)
	@mkdir -p build/cpu-coverage; $(if $(COVERED),find build/cpu-coverage -name '*.gcda' -delete)
	@for part in $(COVERED); do $(MAKE) --no-print-directory COVERAGE=1 UNIT=unit-coverage $$part || exit 1; done
	@scripts/coverage.py build/cpu-coverage $(FILE)
planted: ## plant the faults of tests/planted.toml, and see whether the tests notice them (ARGS=text: those alone)
	@$(PY) scripts/planted.py $(ARGS)
corpus: all ## how often the error bars of `post certify` hold the truth (ARGS: scenes, --judge, --jobs N)
	@$(PY) studies/corpus.py $(ARGS)
PREFIX ?= /usr/local
install: all ## install program, GPU code, presets, examples and Python tools (PREFIX=/usr/local, DESTDIR=)
	@scripts/install.sh $(BIN) $(if $(filter mixed,$(PRECISION)),brisance-mixed,brisance) $(STAMP) '$(PREFIX)' '$(DESTDIR)'
dist: ## the release archive of the last commit: sources, and the GPU code of both precisions
	@git diff --quiet HEAD || { echo 'make dist: commit first, the archive holds the last commit' >&2; exit 1; }
	@$(MAKE) --no-print-directory gpu && $(MAKE) --no-print-directory PRECISION=mixed gpu
	@scripts/dist.sh $(VERSION) $(STAMP) bin/brisance.ptx bin/brisance-mixed.ptx
$(if $(KIND),$(if $(filter golden,$(MAKECMDGOALS)),$(error make golden: the curves are those of the native build, not of \
    $(notdir $(BIN)): leave out DEBUG, QUICK, COVERAGE, PORTABLE and PRECISION)))
golden: all ## write the golden curves of tests/golden anew from inputs/material (CASE=name: that one)
	@$(PY) tests/python/golden.py $(CASE)
python: all emulator ## tests of the Python tools and of the whole program (ARGS="-k name": those alone; TIER=quick)
	@mkdir -p build/log; $(if $(ARGS),,rm -f $(PYTHON_NOTES))
	@BRZ_NOTES=$(abspath $(PYTHON_NOTES)) $(if $(ARGS),,OMP_NUM_THREADS=1) $(PY) -m pytest $(if $(filter quick,$(TIER)),-m 'not slow') --junitxml=build/log/python.xml \
	    $(or $(ARGS),-n auto --dist loadfile)
lint: ## format, linters, the rules of the house
	@bad=0; $(PY) scripts/format.py --check $(FORMAT) || bad=1; \
	.venv/bin/fortitude check -q --output-format concise src tests studies || bad=1; \
	.venv/bin/ruff check -q --output-format concise . || bad=1; \
	.venv/bin/ruff format -q --check . || bad=1; \
	$(PY) scripts/structure.py . || bad=1; exit $$bad
format: ## format all sources
	@$(PY) scripts/format.py $(FORMAT)
	@.venv/bin/ruff format -q .
	@.venv/bin/ruff check -q --fix .
figures: ## are the figures in the tables of docs those of the tests? (after verify and python; ARGS=--write; TIER=quick: those that were measured)
	@$(if $(filter mixed,$(PRECISION)),echo 'skipped: the tables are those of real64',\
	$(PY) scripts/figures.py $(if $(filter quick,$(TIER)),--some) $(NOTES) $(PYTHON_NOTES) $(ARGS))
check-docs: all ## is docs/manual/deck_reference.md what the program says?
	@if [ -x $(BIN) ]; then $(BIN) --describe --markdown | diff -u docs/manual/deck_reference.md -; \
	else echo 'skipped: there is no $(BIN)'; fi
site: ## the documentation as web pages with search, links checked: build/site/index.html
	@.venv/bin/mkdocs build --strict --quiet --site-dir $(SITE) && echo '$(SITE)/index.html'
gpu-check: $(MADE)/model_list.f90 $(MADE)/flow_list.f90 ## compile all point physics as CUDA Fortran for the GPU, in mixed precision (make gpu compiles the other)
	@$(PY) scripts/gpu_check.py --work build/gpu/mixed -D BRZ_MIXED $(SRC) $^

# Files that change when the command or the list of sources does, and the rules of dependence.
SCANNED = $(SRC) $(LOOPS) $(wildcard tests/gpu/bench_*.f90) $(B)/version.f90 $(B)/presets.f90 $(PF) $(PF_HELP) $(BENCH) \
          $(FLOORS) $(wildcard studies/*.f90)
$(B)/command: FORCE
	@command -v $(FC) >/dev/null || { echo 'gfortran is missing: run make setup' >&2; exit 1; }
	@{ $(FC) --version | head -n 1; echo '$(COMPILE)' '$(SETUP_ROOMS)'; } | $(SAVE) $@
$(B)/sources: FORCE
	@echo '$(SCANNED)' | $(SAVE) $@
$(B)/depend.mk: $(SCANNED) $(B)/sources scripts/depend.py
	@scripts/depend.py --objects $(B)/obj --modules $(B)/mod --strip $(B)/ --external hdf5,funit,pfunit \
	    $(SCANNED) > $@
NO_BUILD := clean help site setup test test-all demo try coverage planted dist unit-mixed figures warnings lint format gpu-check gpu emulator charts-scenes $(STUDIES)
ifneq ($(filter-out $(NO_BUILD),$(or $(MAKECMDGOALS),all)),)
include $(B)/depend.mk
endif

clean: ## remove everything that make has made, except .venv
	rm -rf build bin out gpu
help: ## show this list
	@awk -F ':.*## ' '/^[a-z][a-z %:-]*:.*## / {sub(": %", "", $$1); printf "  make %-12s %s\n", $$1, $$2}' $(MAKEFILE_LIST)
	@$(if $(STUDIES),echo 'Studies (make -f studies/Makefile help): $(STUDIES)')
	@echo 'Variables: DEBUG=1 (checks, for gdb), QUICK=1 (builds fast, runs slower), PORTABLE=1 (any x86-64-v2), PRECISION=mixed, OPT=..., BUILD=folder, V=1'
