# `make run` and `make test` are all a newcomer needs; both prepare .venv first.
QUICK = tests/core/parameters tests/core/session tests/core/evaluation tests/core/report tests/core/scan \
	tests/core/imagination/amount tests/core/imagination/test_results.py tests/core/imagination/risk/test_race.py \
	tests/core/imagination/test_particle_shape.py tests/core/motion/test_kinematics.py tests/core/test_stages.py \
	tests/core/test_mesh.py tests/core/test_mesh_file.py tests/app/operations/test_pouring.py \
	tests/app/cli/test_remedies.py tests/app/cli/test_parameters.py tests/app/library/test_summary.py \
	tests/hardware/cell tests/test_no_front_end.py
OFFSCREEN = env -u DISPLAY -u WAYLAND_DISPLAY QT_QPA_PLATFORM=offscreen OPENBLAS_NUM_THREADS=1 .venv/bin/python -m pytest
TWO_AT_A_TIME = -n 2 --dist loadfile --no-loadscope-reorder
# Compiled sources are kept, whatever the environment says: tests start hundreds of processes that import them.
export PYTHONDONTWRITEBYTECODE =
SCREEN = env -u WAYLAND_DISPLAY xvfb-run -a -s "-screen 0 1920x1080x24"

.PHONY: run test test-system quick setup setup-test lint unit views bench accuracy tunnelling choices evaluation-cost judgement families capacity holding amounts worlds collision-table looking-again pose-errors hand-eye calibrated-scans calibration-choice decision drift pour-plans pour-faults pour-soak fuzz kills scene-speed stop-latency window-start window-tour window-kills screenshots train-appearance own-kinematics window-load film clean

run: setup
	@if [ -n "$$DISPLAY$$WAYLAND_DISPLAY" ]; then .venv/bin/poursight; else .venv/bin/poursight demo; fi

setup:
	@tools/setup

setup-test:
	@tools/setup test

# Neither the checks of the sources nor the 3D views keep two processors busy: they run side by side.
test: setup-test
	@echo "Checking the sources and drawing the 3D views: a minute or two without a word."
	@$(MAKE) --no-print-directory --jobs=2 --output-sync=target lint views
	@$(MAKE) --no-print-directory unit

lint:
	.venv/bin/ruff format --check .
	.venv/bin/ruff check .
	.venv/bin/mypy
	.venv/bin/lint-imports

# Two processes with their workers are enough threads: more of OpenBLAS's own would only wait for each other.
unit:
	$(OFFSCREEN) $(TWO_AT_A_TIME) -m "not gl and not system"

# In a run of their own: without a screen OpenGL draws nothing, and with one a test's windows would need care.
views:
	$(SCREEN) .venv/bin/python -m pytest -m "gl and not system" tests/app/gui

# Whole jobs: demos, pours, faults, kills and the tour of the window, in real processes over real protocols;
# and physics that takes more than some ten seconds a test.
# What drives an arm in real time has the machine to itself: a real arm's computer does nothing else either.
test-system: setup-test
	$(OFFSCREEN) $(TWO_AT_A_TIME) -m "not gl and system and not punctual"
	$(OFFSCREEN) -m "not gl and punctual"
	$(SCREEN) .venv/bin/python -m pytest -m "gl and system" tests/app/gui

# What needs no physics, no window and no clock: the inner loop.
quick: setup-test lint
	.venv/bin/python -m pytest -q -n 2 --dist loadfile --no-loadscope-reorder $(QUICK)

bench: setup
	.venv/bin/python -m tests.benchmarks.stages

accuracy: setup
	.venv/bin/python -m tests.benchmarks.accuracy

tunnelling: setup
	.venv/bin/python -m tests.benchmarks.tunnelling

choices: setup
	.venv/bin/python -m tests.benchmarks.choices

evaluation-cost: setup
	.venv/bin/python -m tests.benchmarks.evaluation_cost

judgement: setup
	.venv/bin/poursight evaluate ../shared/data/objects --out build/judgement

# N objects of the families that nothing was developed with.
N = 500
FAMILIES = build/families-$(N)
families: setup
	test -f $(FAMILIES)/objects/labels.csv || .venv/bin/poursight objects make $(FAMILIES)/objects --half judging --n $(N)
	.venv/bin/poursight evaluate $(FAMILIES)/objects --input mesh --pours 0 --variant imagination --out $(FAMILIES)/judged
	.venv/bin/python -m tests.benchmarks.families $(FAMILIES)/judged

capacity: setup
	.venv/bin/python -m tests.benchmarks.capacity

holding: setup
	.venv/bin/python -m tests.benchmarks.holding

amounts: setup
	.venv/bin/python -m tests.benchmarks.amounts

worlds: setup-test
	.venv/bin/python -m tests.benchmarks.worlds

collision-table: setup
	.venv/bin/python -m tests.benchmarks.collision_table

pose-errors: setup
	.venv/bin/python -m tests.benchmarks.pose_errors

looking-again: setup
	.venv/bin/python -m tests.benchmarks.looking_again

hand-eye: setup
	.venv/bin/python -m tests.benchmarks.hand_eye

decision: setup
	.venv/bin/python -m tests.benchmarks.decision

calibration-choice: setup
	.venv/bin/python -m tests.benchmarks.calibration_choice

calibrated-scans: setup
	.venv/bin/python -m tests.benchmarks.calibrated_scans

drift: setup
	.venv/bin/python -m tests.benchmarks.drift

own-kinematics: setup
	.venv/bin/python -m tests.benchmarks.own_kinematics

pour-plans: setup
	.venv/bin/python -m tests.benchmarks.pour_plans

pour-faults: setup
	.venv/bin/python -m tests.benchmarks.pour_faults

pour-soak: setup
	.venv/bin/python -m tests.benchmarks.pour_soak

scene-speed: setup-test
	$(SCREEN) .venv/bin/python -m tests.benchmarks.scene_speed

fuzz: setup-test
	.venv/bin/python -m tests.fuzz.fuzzing

kills: setup-test
	.venv/bin/python -m tests.benchmarks.kills

stop-latency: setup-test
	$(SCREEN) .venv/bin/python -m tests.benchmarks.stop_latency

window-start: setup-test
	$(SCREEN) .venv/bin/python -m tests.benchmarks.window_start

window-tour: setup-test
	$(SCREEN) .venv/bin/python -m tests.benchmarks.window_tour

ROUNDS = 20
window-load: setup-test
	$(SCREEN) .venv/bin/python -m tests.benchmarks.window_load $(ROUNDS)

window-kills: setup
	.venv/bin/python -m tests.benchmarks.window_kills

screenshots: setup-test
	$(SCREEN) .venv/bin/python -m tests.screenshots build/screenshots

film: setup-test
	env -u WAYLAND_DISPLAY xvfb-run -a -s "-screen 0 1280x800x24" .venv/bin/python -m tests.film docs/pictures

# The appearance network anew, from nothing but a seed; needs what `pip install -e '.[train]'` brings. All steps with
# few views, and nothing that is shipped changed: MEMBERS=144 EPOCHS=2 SHIPPED=build/short CURVES=build/short.png
TRAINED = build/appearance
MEMBERS = 1300
EPOCHS = 14
SHIPPED = resources/appearance
CURVES = docs/pictures/appearance-curves.png
train-appearance: setup
	@.venv/bin/python -c "import jax, optax" || { echo "First: .venv/bin/python -m pip install -e '.[train]'"; exit 1; }
	.venv/bin/python -m training.appearance.render $(TRAINED)/examples.npz --members $(MEMBERS)
	.venv/bin/python -m training.appearance.train $(TRAINED)/examples.npz $(TRAINED)/trained --epochs $(EPOCHS)
	.venv/bin/python -m training.appearance.curves $(TRAINED)/trained/curves.csv $(CURVES)
	mkdir -p $(SHIPPED)
	cp $(TRAINED)/trained/weights.npz $(TRAINED)/trained/check.npz $(TRAINED)/trained/curves.csv \
		$(TRAINED)/trained/provenance.json $(SHIPPED)/

clean:
	rm -rf .venv build *.egg-info
