# SPDX-License-Identifier: MIT
# Studies: programs and scripts whose results are recorded in docs/data and drawn in docs/figures.
# `make test` needs none of them. Included by the Makefile.
STUDY    := $(sort $(wildcard tests/study/*.f90))
STUDIES  := $(patsubst %.f90,$(B)/%,$(filter tests/study/study_%,$(STUDY)))
PROBLEMS := $(addprefix tests/verify/,air_problems.f90 drawn_bodies.f90 exact_blasts.f90 \
            exact_riemann.f90 scene_tools.f90 solid_bodies.f90 solid_problems.f90 solid_scenes.f90 \
            taylor_bars.f90 taylor_elements.f90)
$(STUDIES): %: $(LINKED) $(STUDY:%.f90=$(B)/obj/%.o) $(PROBLEMS:%.f90=$(B)/obj/%.o)
	@mkdir -p $(@D)
	$(call say,link $@)
	$(Q)$(LINK) -o $@ $(filter-out $(B)/obj/tests/study/study_%,$^) \
	    $(patsubst $(B)/%,$(B)/obj/%.o,$@) $(HDF5_LIBS)

.PHONY: start-2d plate-models slab-models charts charts-air charts-solid charts-coupling charts-scenes \
        charts-fracture taylor stability stability-air validate compare
.PHONY: point-blast point-blast-gpu paper paper-coarse paper-questions
paper: all ## every scene of the paper at its resolution: exact quarters, on all GPUs; goes on where it stopped (ARGS="--share 2": two runs at a time on each)
	@$(PY) scripts/paper.py quarter $(ARGS)
paper-coarse: all ## the same, coarse, on this machine (an hour of two cores)
	@$(PY) scripts/paper.py coarse
paper-questions: all ## what the paper leaves open: edges, glue, mesh, charge, spacing, coarse (an hour of two cores)
	@$(PY) scripts/paper.py questions; $(PY) -m post questions out/paper/questions --markdown docs/paper_questions.md
charts: charts-air charts-solid ## error against seconds of every scheme, recorded and drawn (the solids: nine minutes)
charts-coupling: all ## the studies of docs/coupling.md (an hour of one core)
	$(PY) scripts/coupling_charts.py paper steps panel plate
charts-air: $(B)/tests/study/study_air
	@mkdir -p docs/data
	$< charts > $(B)/charts.csv && mv $(B)/charts.csv docs/data/air_accuracy.csv
	$(PY) scripts/air_charts.py accuracy docs/data/air_accuracy.csv docs/figures/speed_accuracy_air.png
charts-solid: $(B)/tests/study/study_solid
	@mkdir -p docs/data
	(export OMP_NUM_THREADS=1; $< charts && $< bars && $< plates) > $(B)/charts.csv && mv $(B)/charts.csv docs/data/solid_accuracy.csv
	$(PY) scripts/solid_charts.py docs/data/solid_accuracy.csv docs/figures/speed_accuracy_solid.png
taylor: $(B)/tests/study/study_taylor ## bars that strike a wall: particles, finite elements, experiment (15 minutes)
	$< shapes > $(B)/taylor.csv && mv $(B)/taylor.csv docs/data/taylor_bars.csv
	$< profiles > $(B)/taylor.csv && mv $(B)/taylor.csv docs/data/taylor_profiles.csv
	$(PY) scripts/taylor_charts.py docs/data/taylor_bars.csv docs/data/taylor_profiles.csv \
	    docs/data/taylor_experiment.csv docs/figures/taylor_copper.png
charts-fracture: all ## what cracks cost, run and drawn (a minute)
	$(PY) scripts/fracture_charts.py docs/figures/fracture_strips.png docs/figures/fracture_beam.png
charts-scenes: ## draw the impact on CFRP from what was recorded (scripts/scene_charts.py record OUTDIR...)
	$(PY) scripts/scene_charts.py draw
point-blast: $(B)/tests/study/study_air ## the point blast up to 128^3 cells, recorded (a quarter of an hour)
	$< sedov > $(B)/sedov.csv && mv $(B)/sedov.csv docs/data/point_blast.csv
compare: all ## Brisance beside other codes: rerun what is here, draw what is recorded (ARGS=--help)
	@$(PY) -m comparisons $(ARGS)
validate: all ## blasts of TNT against the Kingery-Bulmash curves, recorded and drawn
	$(PY) scripts/validate_air.py && $(PY) scripts/validate_reflection.py $(ARGS)
stability-air: $(B)/tests/study/study_air
	@mkdir -p docs/data
	$< stability > $(B)/map.csv && mv $(B)/map.csv docs/data/stability_air.csv
	$(PY) scripts/air_charts.py stability docs/data/stability_air.csv docs/figures/stability_air.png
stability: stability-air $(B)/tests/study/study_solid ## where schemes and formulations fail (half an hour)
	@mkdir -p docs/data
	$(B)/tests/study/study_solid stability > $(B)/map.csv && mv $(B)/map.csv docs/data/stability_solid.csv
	$(PY) scripts/stability_map.py docs/data/stability_solid.csv docs/figures/stability_solid.png
point-blast-gpu: $(B)/tests/gpu/study_gpu ## the point blast on the GPU up to 256^3 cells
	BRISANCE_PTX=$(PTX) $< $(or $(ARGS),64 128 256)
BLASTS   := $(patsubst %,$(B)/obj/tests/verify/%.o,air_problems exact_blasts exact_riemann)
$(B)/obj/tests/gpu/study_gpu.o: $(BLASTS)
$(B)/tests/gpu/study_gpu: $(patsubst %.f90,$(B)/obj/%.o,tests/gpu/study_gpu.f90 $(wildcard tests/gpu/gpu_*.f90)) $(BLASTS) $(LINKED)
	@mkdir -p $(@D)
	$(call say,link $@)
	$(Q)$(LINK) -o $@ $^ $(HDF5_LIBS)
start-2d: all ## a cylinder before a slab by every way to start it (docs/blast.md; ten minutes of one core)
	OMP_NUM_THREADS=1 $(PY) scripts/start_2d.py
plate-models: all ## the plate of the paper by load, starts, quarter and whole: error against seconds (ten minutes)
	$(PY) scripts/plate_models.py $(ARGS)
slab-models: all ## slab 2 of the paper, coarse, by load, starts and charge: error against seconds (an hour of one core)
	$(PY) scripts/slab_models.py $(ARGS)
