# make demo   drive a UR5 past an obstacle over a bad network
# make test   run the tests: some five minutes on two cores
# make test-long  those that take too long for every time, and more examples of the others
# make check  style, types, and the one way of imports
# make bench  speed, as ratios from one run
# make golden renew, on purpose, what the golden runs give, and say what changed
# make page  build the console's page anew (Node)
# make newer  prove one Python newer than 3.11, where pybullet's wheel for it is kept
# make faults what breaks on a real network, on three hosts in namespaces (root)
.PHONY: demo test test-long check bench golden page newer .venv clean faults

demo: .venv
	@.venv/bin/farhand demo $(ARGS)

test: .venv/.ready-tests
	@sh scripts/run-tests.sh $(ARGS)

test-long: .venv/.ready-tests
	@sh scripts/run-tests.sh long

check: .venv/.ready-tests
	@.venv/bin/ruff check .
	@.venv/bin/ruff format --check .
	@.venv/bin/mypy
	@.venv/bin/lint-imports
	@.venv/bin/python scripts/import_circles.py
	@.venv/bin/python scripts/page_is_built.py

bench: .venv/.ready-tests
	@.venv/bin/python -m benchmarks $(ARGS)

golden: .venv/.ready-tests
	@.venv/bin/python -m tests.farhand.laboratory.golden

faults: .venv
	@.venv/bin/python -m farhand.trials.faults.runner $(ARGS)

page:
	@cd operator_side/console/page && npm ci --ignore-scripts --silent && npm test --silent && npm run build --silent

newer:
	@sh scripts/try-newer-python.sh

.venv: .venv/.ready

.venv/.ready: requirements.lock pyproject.toml
	@sh scripts/make-environment.sh

.venv/.ready-tests: requirements.lock pyproject.toml
	@sh scripts/make-environment.sh tests

clean:
	rm -rf .venv runs .mypy_cache .ruff_cache .pytest_cache .hypothesis *.egg-info build
