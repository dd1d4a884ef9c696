# Two commands on a fresh machine: `make train` and `make test`. Each sets up .venv by itself.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
CONFIG ?= configs/leas_p1.yaml
RUN_DIR ?= runs/leas_p1
BENCH ?=
WORKERS ?= 2
# What only the tests need is not installed to train: two locked lists, two stamps.
RUN_STAMP := $(VENV)/.run-installed
DEV_STAMP := $(VENV)/.dev-installed

.PHONY: train test test-all lint bench docs lock clean

train: $(RUN_STAMP)
	@if [ -e $(RUN_DIR)/config.yaml ]; then \
	  echo "$(RUN_DIR) exists: resuming it (RUN_DIR=another starts anew)"; \
	  $(BIN)/python train.py --resume $(RUN_DIR); \
	else \
	  $(BIN)/python train.py $(CONFIG) --run-dir $(RUN_DIR); \
	fi

# Files of tests are dealt out to WORKERS processes: fixtures that train are made once a file.
PYTEST = $(BIN)/python -m pytest --numprocesses $(WORKERS) --dist loadfile

# Slow tests guard headline claims: `make test-all` runs them, and so does `make test` in CI.
test: $(DEV_STAMP)
	$(PYTEST) $(if $(filter true 1,$(CI)),,-m "not slow")

test-all: $(DEV_STAMP)
	$(PYTEST)

lint: $(DEV_STAMP)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/pyright

bench: $(DEV_STAMP)
	$(BIN)/python -m benchmarks $(BENCH)

# The documentation site, build/site; broken links fail, and so does whatever a page would fetch.
docs: $(DEV_STAMP)
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet
	$(BIN)/python scripts/check_site.py build/site

# Locked for every platform and Python at once; the lists name no registry.
COMPILE = $(BIN)/uv pip compile pyproject.toml --quiet --universal --python-version 3.11 \
	--no-annotate --no-header --no-emit-index-url
lock: $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet uv
	$(COMPILE) --output-file requirements/run.txt
	$(COMPILE) --extra dev --output-file requirements/dev.txt

clean:
	rm -rf build dist .pytest_cache .ruff_cache

$(VENV)/bin/python:
	$(PYTHON) -m venv $(VENV)

$(RUN_STAMP): requirements/run.txt pyproject.toml | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet -r requirements/run.txt
	$(BIN)/python -m pip install --quiet --no-deps --editable .
	touch $@

$(DEV_STAMP): requirements/dev.txt pyproject.toml | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet -r requirements/dev.txt
	$(BIN)/python -m pip install --quiet --no-deps --editable .
	touch $@ $(RUN_STAMP)
