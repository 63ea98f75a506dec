# Every target makes what it needs: an environment in .venv, with the extras it uses.
PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
EXTRAS := test,lint,docs,dask

.PHONY: demo test lint bench docs clean

demo: $(VENV)/demo-ready
	mkdir -p out
	$(BIN)/hitjoints plan --object 0.5,0.3,0.5 --direction 0,1,0 --mass 2 --out out/plan.json --plot out/plan.png
	$(BIN)/hitjoints swing --plan out/plan.json --out out/trajectory.csv --plot out/swing.png
	@echo "Planned, and made a motion that a controller can be sent. Pictures: out/plan.png, out/swing.png. Next:"
	@echo "  $(BIN)/hitjoints sweep joint --plot out/fig2.png         inertia, speed and flux of each joint (the paper's Fig. 2)"
	@echo "  $(BIN)/hitjoints inspect --impact all --contact-time 0.01  the mass that a real arm shows"
	@echo "  $(BIN)/hitjoints plan --robot path/to/your_arm.urdf        the same for your arm"

test: $(VENV)/ready
	$(BIN)/python -m pytest

lint: $(VENV)/ready
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

bench: $(VENV)/ready
	$(BIN)/python -m benchmarks.peers.install
	$(BIN)/python -m benchmarks --write

docs: $(VENV)/ready
	$(BIN)/sphinx-build -W -q -b html docs docs/_build/html
	@echo "docs/_build/html/index.html"

clean:
	rm -rf $(VENV) build dist out docs/_build *.egg-info

$(VENV)/bin/python:
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "Python 3.11 or newer is needed")'
	$(PYTHON) -m venv $(VENV)

$(VENV)/demo-ready: pyproject.toml | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable .
	touch $@

$(VENV)/ready: pyproject.toml | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[$(EXTRAS)]'
	touch $@ $(VENV)/demo-ready
