# Everything that a newcomer types: make demo, make test. What is needed is made in .venv.

PYTHON ?= python3
WORKERS ?= auto
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.installed
GL := $(VENV)/.gl
TYPES := $(VENV)/.types

.PHONY: demo test tests test-long lint style types clean help

help:
	@echo "make demo        the thesis's scenario in twelve actions: a recording, a film and a contact sheet in out/"
	@echo "make test        all tests and checks, some 5 minutes on two cores"
	@echo "make test-long   soak, fuzz, stalls and further cases"
	@echo "make lint        ruff, pyright and the direction of imports"

demo: $(READY) $(GL)
	$(BIN)/ahmss demo

# What is compiled once is kept, whatever the shell says: each of some hundred processes would compile all of it anew.
unexport PYTHONDONTWRITEBYTECODE

# What is soonest done comes first. The types, which take a minute, are looked at beside the tests, which have precedence.
# What they say is said again at the end, where one looks.
test: $(READY) $(GL) style
	@$(MAKE) --no-print-directory -j 2 tests types || { echo "the types, above beside the tests:"; tail -n 12 $(TYPES); exit 1; }

tests: $(READY) $(GL)
	$(BIN)/pytest -q -n $(WORKERS) --dist loadfile --no-loadscope-reorder

test-long: $(READY) $(GL)
	$(BIN)/pytest -q -m long --timeout 1800

lint: style types

style: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/lint-imports

types: $(READY)
	@nice -n 5 $(BIN)/pyright --warnings > $(TYPES); status=$$?; cat $(TYPES); exit $$status

# Python 3.11 or newer, a virtual environment, and this package in it with what its tests need.
$(READY): pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
	  || { echo "make: $(PYTHON) is older than 3.11; type: make PYTHON=python3.11 $(MAKECMDGOALS)"; exit 1; }
	@$(PYTHON) -c 'import venv, ensurepip' 2>/dev/null \
	  || { echo "make: this Python makes no virtual environments; type: sudo apt-get install python3-venv"; exit 1; }
	@echo "making $(VENV), once: a minute or two"
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e '.[dev]'
	@touch $@

# The libraries that draw without a display. Without them everything but pictures works.
$(GL): | $(READY)
	@sh scripts/install_gl.sh && touch $@ || true

clean:
	rm -rf $(VENV) out .pytest_cache .ruff_cache .import_linter_cache .hypothesis
