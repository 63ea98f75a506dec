# Every target makes what it needs: an environment in .venv, with the extras it uses.
PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
EXTRAS := test,lint,docs,dask
LOWEST ?= .venv-lowest
# Tests that use every dependency, in about two minutes.
QUICK := $(addprefix tests/,cli datasets maps dynamics/test_mobility.py programs/test_programs_proxqp.py \
	robots/test_robot.py kernels/test_kernel.py show/test_viewer.py evidence/test_physics_strike.py \
	planning/test_learning.py docs/test_notebook.py)

.PHONY: demo test lowest lint bench docs figures clean

demo: $(VENV)/demo-ready
	mkdir -p out
	$(BIN)/hitjoints plan --object 0.5,0.3,0.5 --direction 0,1,0 --mass 2 --out out/plan.json --plot out/plan.png
	$(BIN)/hitjoints swing --plan out/plan.json --out out/trajectory.csv --plot out/swing.png
	@echo "Planned, and made a motion that a controller can be sent. Pictures: out/plan.png, out/swing.png. Next:"
	@echo "  $(BIN)/hitjoints hit --goal 0.5,0.4,0.5 --restitution 0.5 --friction 0.3 --out out/hit    a box, from A to B"
	@echo "  $(BIN)/hitjoints sweep joint --plot out/fig2.png    inertia, speed and flux of each joint (the paper's Fig. 2)"
	@echo "  $(BIN)/hitjoints plan --robot path/to/your_arm.urdf    the same for your arm"

test: $(VENV)/ready
	$(BIN)/python -m pytest

# With the lowest versions that pyproject.toml allows.
lowest: $(LOWEST)/ready
	$(LOWEST)/bin/python -m pytest $(QUICK)

lint: $(VENV)/ready
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

bench: $(VENV)/ready
	$(BIN)/python -m benchmarks.peers.install
	$(BIN)/python -m benchmarks --write
	$(BIN)/python -m benchmarks.where_time_goes --write

docs: $(VENV)/ready
	$(BIN)/sphinx-build -W -q -b html docs docs/_build/html
	@echo "docs/_build/html/index.html"

# The pictures of the documentation, again.
figures: $(VENV)/ready
	$(BIN)/python docs/make_figures.py

clean:
	rm -rf $(VENV) $(LOWEST) build dist out docs/_build *.egg-info

$(VENV)/bin/python:
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "Python 3.11 or newer is needed")'
	$(PYTHON) -m venv $(VENV)

$(VENV)/demo-ready: pyproject.toml | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable .
	touch $@

$(VENV)/ready: pyproject.toml | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[$(EXTRAS)]'
	touch $@ $(VENV)/demo-ready

$(LOWEST)/ready: pyproject.toml .ci/lowest.py
	$(PYTHON) -m venv $(LOWEST)
	$(PYTHON) .ci/lowest.py test > $(LOWEST)/constraints.txt
	$(LOWEST)/bin/python -m pip install --quiet --disable-pip-version-check \
		--constraint $(LOWEST)/constraints.txt --editable '.[test]'
	touch $@
