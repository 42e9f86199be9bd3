# Two commands do all the set-up: `make lab` and `make test`.
#
#   make lab ARGS=--no-browser       options for JupyterLab
#   make test ARGS="-k projection"   options for pytest
#   make test WORKERS=4              processes that share the test files (default 2)
#   make lab PYTHON=python3.12       another Python (3.11 or newer)
#   PIP_ARGS="..."                   options for pip, for example a mirror or PyTorch's CPU index

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt $(PIP_ARGS)
NOTEBOOK ?= notebooks/00_start_here.ipynb
WORKERS ?= 2

.PHONY: lab test book check browser hooks pictures clean help

help:
	@sed -n '1,8s/^# \{0,1\}//p' Makefile
	@echo "also: make book (the notebooks as a web site), make check (ruff and mypy), make hooks (for contributors), make pictures, make clean"

# At its first start JupyterLab asks whether it may fetch news: not here.
NO_NEWS := {"@jupyterlab/apputils-extension:notification": {"fetchNews": "false", "checkForUpdates": false}}

# JupyterLab refuses to run as root, as in most containers, unless it is told to.
lab: $(VENV)/.lab
	@mkdir -p $(VENV)/share/jupyter/lab/settings
	@echo '$(NO_NEWS)' > $(VENV)/share/jupyter/lab/settings/overrides.json
	$(BIN)/jupyter lab --LabApp.default_url=/lab/tree/$(NOTEBOOK) $(if $(filter 0,$(shell id -u)),--allow-root) $(ARGS)

test: $(VENV)/.test browser check
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest --numprocesses $(WORKERS) --dist loadfile $(ARGS)

# The notebooks as pages that need neither Python nor a network; a second build runs only what changed.
book: $(VENV)/.book
	OMP_NUM_THREADS=1 $(BIN)/python -m sphinx -b html --keep-going -j auto -d book/_build/doctrees $(ARGS) book book/_build/html
	@echo "Open book/_build/html/index.html in a browser."

check: $(VENV)/.test
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/nbstripout --keep-count --verify notebooks/*.ipynb

browser: $(VENV)/.test
	@$(BIN)/python tests/browser/install.py

# Contributors: from now on git strips notebooks of outputs, except those that tests compare.
hooks: $(VENV)/.test
	$(BIN)/nbstripout --install
	git config filter.nbstripout.clean '"$(CURDIR)/$(BIN)/python" -m nbstripout --keep-count'

pictures: $(VENV)/.test
	$(BIN)/projflow-lite reproduce contact-sheet

clean:
	rm -rf $(VENV) artefacts .pytest_cache .mypy_cache .ruff_cache .hypothesis
	rm -rf book/_build book/chapters book/equations book/reference book/lectures.md

$(VENV)/.made:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "projflow_lite needs Python 3.11 or newer; try: make $(MAKECMDGOALS) PYTHON=python3.12"; exit 1; }
	$(PYTHON) -m venv $(VENV)
	@touch $@

# torch first and pinned: an open range could pull a CUDA build of several GB.
$(VENV)/.torch: $(VENV)/.made constraints.txt
	@echo "Installing torch (a minute or two, once) ..."
	$(PIP) torch
	@touch $@

$(VENV)/.lab: $(VENV)/.torch pyproject.toml constraints.txt
	@echo "Installing projflow_lite and JupyterLab (a minute, once) ..."
	$(PIP) --editable .
	@touch $@

$(VENV)/.book: $(VENV)/.torch pyproject.toml constraints.txt
	@echo "Installing what the book needs (a minute, once) ..."
	$(PIP) --editable '.[book]'
	@touch $@ $(VENV)/.lab

$(VENV)/.test: $(VENV)/.torch pyproject.toml constraints.txt
	@echo "Installing what the tests need (a minute, once) ..."
	$(PIP) --editable '.[test]'
	@touch $@ $(VENV)/.lab $(VENV)/.book
