# Needs make, Python 3.11 to 3.13 and its venv module; everything else goes into .venv.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PYTEST_ARGS ?=
FUZZ ?= 2000
FAULT_ARGS ?= --warm
MUTATE ?= teleopdesign/effects tests/effects --number 10
STUDY_ARGS ?=
STUDY_OUTPUT ?= studies/output
# what is run with the lowest versions: files, equations, compiled code, proofs, tables
LOWEST_TESTS ?= tests/effects tests/measurement tests/check tests/realise tests/simulate \
	tests/studies tests/tuning tests/plot tests/design tests/commands
# processes at a time, of tests and of studies
JOBS ?= 2
# parts in which pages are read: more than cores, for some pages take minutes and others none
PARTS ?= 4
# parts of the golden files (default: all quick ones), and whether the long ones too: WHOLE=1
GOLDEN_PARTS ?=
WHOLE ?=
PIP := $(BIN)/python -m pip --disable-pip-version-check --no-input

.PHONY: help demo test slow lint types imports docs studies golden size benchmarks fuzz faults lowest lock licences wheel ci clean
# what one process has compiled to bytecode, hundreds of others need not compile again: collecting the
# tests takes each process 5.6 s of processor time, 9.5 s without
unexport PYTHONDONTWRITEBYTECODE
# as many processes as cores, each with a thread for each core, wait for each other: 8 % more processor time
test slow: export OPENBLAS_NUM_THREADS = 1

.DEFAULT_GOAL := help

help:  ## list these targets
	@grep -E '^[a-z]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 14

# One stamp for each set of extras: installed again only when pyproject.toml changes.
$(BIN)/python:
	@echo "== Creating the virtual environment $(VENV) with $$($(PYTHON) --version)"
	@$(PYTHON) -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 13))' || \
		{ echo "teleopdesign needs Python 3.11 to 3.13; choose one with: make PYTHON=python3.12 ..."; exit 1; }
	@$(PYTHON) -m venv $(VENV)

$(VENV)/installed-core: EXTRAS =
$(VENV)/installed-test: EXTRAS = [test]
$(VENV)/installed-studies: EXTRAS = [studies]
$(VENV)/installed-docs: EXTRAS = [docs]
$(VENV)/installed-fuzz: EXTRAS = [fuzz]
$(VENV)/installed-%: pyproject.toml | $(BIN)/python
	@echo "== Installing teleopdesign$(EXTRAS) and what it needs into $(VENV) (once; some minutes)"
	@$(PIP) install --editable ".$(EXTRAS)"
	@touch $@

demo: $(VENV)/installed-core  ## diagnose a recording that comes with the package
	@echo "== Demo: find the physical effect that a model lacks"
	@$(BIN)/teleopdesign demo

test: $(VENV)/installed-test  ## plain tests, some three minutes (PYTEST_ARGS adds or overrides)
	@echo "== Tests without those marked slow"
	@$(BIN)/pytest -n $(JOBS) --max-worker-restart 1 $(PYTEST_ARGS)

slow: $(VENV)/installed-test  ## tests marked slow
	@echo "== Slow tests"
	@$(BIN)/pytest -n $(JOBS) --max-worker-restart 1 -m slow $(PYTEST_ARGS)

fuzz: $(VENV)/installed-test $(VENV)/installed-fuzz  ## spoilt files for every reader, FUZZ of each, twice; failures go to build/fuzz
	@echo "== $(FUZZ) spoilt files for each reader"
	@FUZZ=$(FUZZ) $(BIN)/pytest tests/trust/test_fuzz.py $(PYTEST_ARGS)
	@echo "== $(FUZZ) more for each, led by the branches that they reach"
	@$(BIN)/python tests/trust/guided_fuzz.py --runs $(FUZZ)

golden: $(VENV)/installed-test  ## what the package answers against golden/frozen (GOLDEN_PARTS, WHOLE=1; see golden/README.md)
	@echo "== Golden files"
	@$(BIN)/python golden/freeze.py $(GOLDEN_PARTS) $(if $(WHOLE),--whole)

size:  $(VENV)/installed-core  ## lines, files, thresholds, importers, modules loaded
	@$(BIN)/python golden/size.py

faults: $(VENV)/installed-test  ## planted faults that the plain tests do not notice; hours (FAULT_ARGS="--anchors-only")
	@echo "== Planted faults"
	@$(BIN)/python golden/faults.py $(FAULT_ARGS)

benchmarks: $(VENV)/installed-test  ## times against their bounds, one at a time
	@echo "== Benchmarks"
	@$(BIN)/pytest -m benchmark -s $(PYTEST_ARGS)

lint: $(VENV)/installed-test  ## style and format
	@echo "== Style and format"
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .

types: $(VENV)/installed-test  ## strict types of the package
	@echo "== Types"
	@$(BIN)/mypy

imports: $(VENV)/installed-test  ## direction of imports between folders
	@echo "== Direction of imports"
	@$(BIN)/lint-imports

docs: $(VENV)/installed-docs  ## documentation in docs/_build/html, warnings are errors
	@echo "== Documentation"
	@$(BIN)/sphinx-build -W --keep-going -q -j $(PARTS) -b html docs docs/_build/html
	@echo "docs/_build/html/index.html"

lowest:  ## tests with every dependency at the lowest version that pyproject.toml declares, in build/lowest
	@echo "== Tests with the lowest declared versions"
	@$(PYTHON) -m venv --clear build/lowest
	@build/lowest/bin/python -m pip --disable-pip-version-check --no-input install --quiet \
		--constraint release/lowest.txt --editable ".[app,cluster,io,learn,ros,studies]" \
		hypothesis polars pytest
	@build/lowest/bin/python -m pytest $(LOWEST_TESTS) $(PYTEST_ARGS)

lock: $(VENV)/installed-test $(VENV)/installed-docs $(VENV)/installed-fuzz  ## release/lock.txt: the versions of this environment; release/lowest.txt
	@$(BIN)/python release/dependencies.py lowest lock

licences: $(VENV)/installed-test $(VENV)/installed-docs $(VENV)/installed-fuzz  ## docs/licences.md: the licence of everything that is installed
	@$(BIN)/python release/dependencies.py licences

wheel:  ## wheel and sdist into dist
	@$(PYTHON) -m venv build/wheel
	@build/wheel/bin/python -m pip --disable-pip-version-check --no-input install --quiet build
	@build/wheel/bin/python -m build --outdir dist .

studies: $(VENV)/installed-studies  ## every study, figures and numbers into STUDY_OUTPUT (STUDY_ARGS=--quick)
	@$(BIN)/python studies/_all.py --jobs $(JOBS) $(STUDY_ARGS) --output "$(STUDY_OUTPUT)"

ci:  ## everything that must hold, in the order of .ci/run
	@.ci/run

clean:  ## remove what was built (not .venv)
	rm -rf build dist docs/_build docs/_generated studies/output *.egg-info .pytest_cache .hypothesis \
		.mypy_cache .ruff_cache .import_linter_cache
	find teleopdesign tests studies -name __pycache__ -type d -prune -exec rm -rf {} + 2>/dev/null || true
