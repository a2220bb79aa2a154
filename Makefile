# `make run` and `make test` are all a newcomer needs; both prepare .venv first.
SCREEN = env -u WAYLAND_DISPLAY xvfb-run -a -s "-screen 0 1920x1080x24"

.PHONY: run test setup setup-test lint unit bench accuracy tunnelling choices evaluation-cost judgement capacity holding amounts collision-table looking-again pose-errors pour-plans pour-faults pour-soak scene-speed window-start window-tour window-kills screenshots clean

run: setup
	@if [ -n "$$DISPLAY$$WAYLAND_DISPLAY" ]; then .venv/bin/poursight; else .venv/bin/poursight demo; fi

setup:
	@tools/setup

setup-test:
	@tools/setup test

test: setup-test lint unit

lint:
	.venv/bin/ruff format --check .
	.venv/bin/ruff check .
	.venv/bin/mypy
	.venv/bin/lint-imports

# In two runs: without a screen OpenGL draws nothing, and with one a test's windows would need care.
unit:
	env -u DISPLAY -u WAYLAND_DISPLAY QT_QPA_PLATFORM=offscreen .venv/bin/python -m pytest -n 2 --dist loadgroup -m "not gl"
	$(SCREEN) .venv/bin/python -m pytest -m gl tests/app/gui

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

capacity: setup
	.venv/bin/python -m tests.benchmarks.capacity

holding: setup
	.venv/bin/python -m tests.benchmarks.holding

amounts: setup
	.venv/bin/python -m tests.benchmarks.amounts

collision-table: setup
	.venv/bin/python -m tests.benchmarks.collision_table

pose-errors: setup
	.venv/bin/python -m tests.benchmarks.pose_errors

looking-again: setup
	.venv/bin/python -m tests.benchmarks.looking_again

pour-plans: setup
	.venv/bin/python -m tests.benchmarks.pour_plans

pour-faults: setup
	.venv/bin/python -m tests.benchmarks.pour_faults

pour-soak: setup
	.venv/bin/python -m tests.benchmarks.pour_soak

scene-speed: setup-test
	$(SCREEN) .venv/bin/python -m tests.benchmarks.scene_speed

window-start: setup-test
	$(SCREEN) .venv/bin/python -m tests.benchmarks.window_start

window-tour: setup-test
	$(SCREEN) .venv/bin/python -m tests.benchmarks.window_tour

window-kills: setup
	.venv/bin/python -m tests.benchmarks.window_kills

screenshots: setup-test
	$(SCREEN) .venv/bin/python -m tests.screenshots docs/screenshots

clean:
	rm -rf .venv build *.egg-info
