# Everything a developer needs, from nothing but python3 and make. The checkout itself is what runs.

PYTHON ?= python3
VENV := .venv
RUN := $(VENV)/bin/python -m
INSTALLED := $(VENV)/installed
DOCUMENTED := $(VENV)/documented

# As the executables do for themselves, see al_questioner/__main__.py.
export OMP_NUM_THREADS ?= 1

# The environment has a ROS of its own, from PyPI, which must not be mixed with one that a setup.bash has set up.
unexport AMENT_PREFIX_PATH LD_LIBRARY_PATH PYTHONPATH RMW_IMPLEMENTATION _ROS_WHEELS_BOOTSTRAP_COMPLETE

# What Ubuntu 24.04 has: its Python, and the versions in test/noble.txt.
NOBLE_PYTHON ?= python3.12
NOBLE := .venv-noble
NOBLE_INSTALLED := $(NOBLE)/installed

# Nearly all of the tests' time is processes that start, so two files at a time, each in one process.
OPTIONS := -m pytest -n 2 --dist loadfile
PYTEST := $(VENV)/bin/python $(OPTIONS)
NOBLE_PYTEST := $(NOBLE)/bin/python $(OPTIONS)

.PHONY: setup demo test test-all test-noble test-noble-quick soak reproduction questioner generated docs lint clean

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
	$(PYTEST)

test-all: setup
	$(PYTEST) -m ''

# Both with the versions of Ubuntu 24.04.
test-noble: $(NOBLE_INSTALLED)
	$(NOBLE_PYTEST) -m ''

test-noble-quick: $(NOBLE_INSTALLED)
	$(NOBLE_PYTEST)

# The constraints hold for what builds matplotlib, too, which without the libraries of the system would download them.
$(NOBLE_INSTALLED): setup.cfg pyproject.toml test/noble.txt | $(NOBLE)/pyvenv.cfg
	@pkg-config --exists freetype2 qhull_r || { echo 'make test-noble builds matplotlib:' \
	'apt-get install g++ pkg-config libfreetype-dev libqhull-dev' >&2; exit 1; }
	printf '[libs]\nsystem_freetype = true\nsystem_qhull = true\n' > $(NOBLE)/matplotlib.cfg
	MPLSETUPCFG=$(CURDIR)/$(NOBLE)/matplotlib.cfg PIP_CONSTRAINT=test/noble.txt PIP_BUILD_CONSTRAINT=test/noble.txt \
	$(NOBLE)/bin/python -m pip install --quiet --no-binary matplotlib --editable '.[ros,dev]'
	@touch $@

$(NOBLE)/pyvenv.cfg:
	@$(NOBLE_PYTHON) -c 'import sys; sys.exit(sys.version_info[:2] != (3, 12))' || { echo 'make test-noble needs Python' \
	'3.12, which $(NOBLE_PYTHON) is not: tell where it is with NOBLE_PYTHON=...' >&2; exit 1; }
	$(NOBLE_PYTHON) -m venv $(NOBLE) || { rm -rf $(NOBLE); exit 1; }

# The whole graph under every fault, see docs/explanation/graph_in_a_bottle.md; it goes on where it was interrupted.
SEEDS ?= 10000

soak: setup
	PYTHONPATH=test $(RUN) shared.bottle.soak $(SEEDS) --state out/soak.json

# All of docs/results/reproduction.md: the weights from the demonstrations, then the comparison and what stands beside it. The paper
# does not say that its teacher shows other things than before, hence --repeat-shown, and has no relevance query. It does not
# tell its kernel; an RBF kernel is what most would take, and what learners have beyond it is ours.
PAPER_CLASSIFIERS := --amplitude 100 --kernel-shape rbf --class-balance 0

reproduction: setup
	$(RUN) al_questioner train_weights bags/expert_0 bags/expert_1 bags/expert_2 $(PAPER_CLASSIFIERS) --out out/reproduction/weights.yaml
	$(RUN) al_questioner experiment --out out/reproduction --weights-file out/reproduction/weights.yaml --samples 20 \
		--task prepare_lunch pack_lunchbox kitchen_table $(PAPER_CLASSIFIERS) --cost-relevance never --repeat-shown --ceilings 5 --studies --page docs/results/reproduction.md

# docs/results/questioner_tables.md and the figures of questioner.md: our questioner beside all others, at the settings that ship,
# then without the relevance query, and with teachers who err.
EXPERIMENT := $(RUN) al_questioner experiment
QUESTIONER := out/questioner
TABLES := --samples 20 --task prepare_lunch pack_lunchbox kitchen_table
KITCHENS := --samples 60 --task mixed_kitchens
PAPER := u_sampling dt_iros dt_task dt_task_env
CONTROLS := u_sampling_fsq random_fsq farthest_fsq rarest_demo typiclust probcover
NEVER := --strategy value_per_cost --cost-relevance never
MISJUDGED := --strategy value_per_cost --relevance-omission 0.1 --relevance-false-alarm 0.05
ERRING := --samples 10 --task prepare_lunch pack_lunchbox kitchen_table mixed_kitchens

questioner: setup
	$(EXPERIMENT) --out $(QUESTIONER)/tables $(TABLES) --strategy $(PAPER) value_per_cost $(CONTROLS)
	$(EXPERIMENT) --out $(QUESTIONER)/kitchens $(KITCHENS) --strategy value_per_cost $(CONTROLS)
	$(EXPERIMENT) --out $(QUESTIONER)/kitchens_paper --samples 20 --task mixed_kitchens --strategy $(PAPER)
	$(EXPERIMENT) --out $(QUESTIONER)/ceilings --samples 20 --task kitchen_table --strategy all_labels greedy_oracle
	$(EXPERIMENT) --out $(QUESTIONER)/never $(NEVER) --samples 20 --task kitchen_table
	$(EXPERIMENT) --out $(QUESTIONER)/kitchens_never $(NEVER) $(KITCHENS)
	$(EXPERIMENT) --out $(QUESTIONER)/misjudged $(MISJUDGED) --samples 20 --task kitchen_table
	$(EXPERIMENT) --out $(QUESTIONER)/kitchens_misjudged $(MISJUDGED) $(KITCHENS)
	$(EXPERIMENT) --out $(QUESTIONER)/wrong $(ERRING) --wrong-rate 0.1 --strategy value_per_cost u_sampling_fsq farthest_fsq rarest_demo
	$(EXPERIMENT) --out $(QUESTIONER)/unknown $(ERRING) --unknown-rate 0.1 --strategy value_per_cost
	$(VENV)/bin/python benchmarks/questioners.py $(addprefix $(QUESTIONER)/,tables kitchens kitchens_paper ceilings) \
		$(addprefix no_relevance=$(QUESTIONER)/,never kitchens_never) \
		$(addprefix misjudged=$(QUESTIONER)/,misjudged kitchens_misjudged) \
		$(foreach rate,wrong unknown,$(rate)=$(QUESTIONER)/$(rate)) \
		--page docs/results/questioner_tables.md --figures docs/results/figures/questioner

# The site, in out/site; a link that leads nowhere is an error.
docs: $(DOCUMENTED)
	$(RUN) mkdocs build

$(DOCUMENTED): setup.cfg | $(INSTALLED)
	$(RUN) pip install --quiet --editable '.[docs]'
	@touch $@

# The files and pages that are written from the code; tests compare them.
generated: setup
	$(VENV)/bin/python tools/generate.py
	$(VENV)/bin/python tools/python_api.py

lint: setup
	$(RUN) ruff format --check .
	$(RUN) ruff check .
	$(RUN) mypy

clean:
	rm -rf $(VENV) $(NOBLE) build install log *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
