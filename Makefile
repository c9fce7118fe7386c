# Everything a developer needs, from nothing but python3 and make. The checkout itself is what runs.

PYTHON ?= python3
VENV := .venv
RUN := $(VENV)/bin/python -m
INSTALLED := $(VENV)/installed

# As the executables do for themselves, see al_questioner/__main__.py.
export OMP_NUM_THREADS ?= 1

# Nearly all of the tests' time is processes that start, so two files at a time, each in one process.
PYTEST := $(RUN) pytest -n 2 --dist loadfile

.PHONY: setup demo test test-all reproduction lint clean

setup: $(INSTALLED)

$(INSTALLED): setup.cfg pyproject.toml | $(VENV)/pyvenv.cfg
	$(RUN) pip install --quiet --editable '.[ros,dev]'
	@touch $@

$(VENV)/pyvenv.cfg:
	@$(PYTHON) -c "import platform as p, sys; v = sys.version_info[:2]; \
	sys.exit(None if (3, 10) <= v <= (3, 13) and (p.system(), p.machine()) == ('Linux', 'x86_64') else \
	'make needs Python 3.10 to 3.13 on x86-64 Linux, this is %d.%d on %s %s: choose another with PYTHON=...,' \
	' or use colcon in a ROS 2 Jazzy installation' % (v + (p.machine(), p.system())))"
	$(PYTHON) -m venv $(VENV) || { rm -rf $(VENV); exit 1; }

demo: setup
	$(RUN) al_questioner demo

test: setup
	$(PYTEST) -m 'not slow'

test-all: setup
	$(PYTEST)

# All of docs/reproduction.md: the weights from the demonstrations, then the comparison and what stands beside it. The paper
# does not say that its teacher shows other things than before, hence --repeat-shown.
reproduction: setup
	$(RUN) al_questioner train_weights bags/expert_0 bags/expert_1 bags/expert_2 --out out/reproduction/weights.yaml
	$(RUN) al_questioner experiment --out out/reproduction --weights-file out/reproduction/weights.yaml --samples 20 \
		--task prepare_lunch pack_lunchbox kitchen_table --amplitude 4 --repeat-shown --ceilings --studies --page docs/reproduction.md

lint: setup
	$(RUN) ruff format --check .
	$(RUN) ruff check .
	$(RUN) mypy

clean:
	rm -rf $(VENV) build install log *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
