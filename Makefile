# make demo   drive a UR5 past an obstacle over a bad network
# make test   run all tests
# make check  style, types, and the one way of imports
# make bench  speed, as ratios from one run
# make golden renew, on purpose, what the golden runs give, and say what changed
# make faults what breaks on a real network, on three hosts in namespaces (root)
.PHONY: demo test check bench golden .venv clean faults

demo: .venv
	@.venv/bin/farhand demo $(ARGS)

test: .venv
	@sh scripts/run-tests.sh $(ARGS)

check: .venv
	@.venv/bin/ruff check .
	@.venv/bin/ruff format --check .
	@.venv/bin/mypy
	@.venv/bin/lint-imports
	@.venv/bin/python scripts/import_circles.py

bench: .venv
	@.venv/bin/python -m benchmarks $(ARGS)

golden: .venv
	@.venv/bin/python -m tests.farhand.laboratory.golden

faults: .venv
	@.venv/bin/python -m farhand.trials.faults.runner $(ARGS)

.venv: .venv/.ready

.venv/.ready: requirements.lock pyproject.toml
	@sh scripts/make-environment.sh

clean:
	rm -rf .venv runs .mypy_cache .ruff_cache .pytest_cache .hypothesis *.egg-info build
