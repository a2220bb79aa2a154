# `make run` and `make test` are all a newcomer needs; both prepare .venv first.
.PHONY: run test setup lint unit bench accuracy judgement collision-table looking-again pose-errors pour-plans pour-faults pour-soak clean

run: setup
	.venv/bin/poursight demo

setup:
	@tools/setup

test: setup lint unit

lint:
	.venv/bin/ruff format --check .
	.venv/bin/ruff check .
	.venv/bin/mypy
	.venv/bin/lint-imports

unit:
	.venv/bin/python -m pytest

bench: setup
	.venv/bin/python -m tests.benchmarks.stages

accuracy: setup
	.venv/bin/python -m tests.benchmarks.accuracy

judgement: setup
	.venv/bin/python -m tests.benchmarks.judgement build/judgement

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

clean:
	rm -rf .venv build *.egg-info
