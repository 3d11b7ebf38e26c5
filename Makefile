# The project's commands; `make help` lists them. Beneath it: GNU make, a POSIX shell and python3 (3.11 or newer).
#
## make           run the main study and write reports/harmonic_drive_axis/
## make STUDY     run one study: a folder under studies/
## make all       run every study
## make test      check style and run the tests
## make fuzz      10 000 bad inputs to every command, then a hundred million calls of each law's firmware (INPUTS= CALLS=)
## make bench     run the benchmarks
## make bench-trace   trace many campaigns whose answers are known (make bench-trace CAMPAIGNS=200 SEED=1 ARGS=--help)
## make lock      pin the dependencies of pyproject.toml again (make lock UPGRADE=--upgrade: to the newest)
## make setup     set up .venv only; every command does so where it has to (make setup EXTRAS="hdf5 mdf", or EXTRAS=all)
## make third-party   write docs/third-party.md: every pinned package with its licence
## make clean     remove everything that these commands made: .venv, caches (kernels too), finished steps and reports

MAIN    := harmonic_drive_axis
PYTHON  ?= python3
WORKERS ?= 2
UPGRADE ?=
EXTRAS  ?=
CAMPAIGNS ?= 200
CALLS   ?= 100000000
INPUTS  ?= 10000
SEED    ?= 1
ARGS    ?=

VENV    := .venv
BIN     := $(VENV)/bin
STUDIES := $(sort $(MAIN) $(notdir $(patsubst %/study.toml,%,$(wildcard studies/*/study.toml))))
VERBS   := all bench bench-trace clean fuzz help lock setup test third-party

CLASH   := $(filter $(VERBS),$(STUDIES))
ifneq ($(CLASH),)
$(error The study '$(CLASH)' has the name of a command of this Makefile: rename its folder under studies/)
endif

.DEFAULT_GOAL := $(MAIN)
.PHONY: $(VERBS) $(STUDIES)

# --- the environment ------------------------------------------------------------------------------------------------
#
# PLACE names what a virtual environment cannot outlive: its folder (scripts hold absolute paths) and its Python.
# PINS names what is installed in it. Two empty files in .venv say what is true of it:
#
#   whole-PLACE           nothing was left half done. Taken away before anything is changed and put back after it, so a
#                         set-up killed at any moment leaves an environment without it, and the next one starts afresh.
#   installed-PLACE-PINS-EXTRAS   these very pins are installed: "lean", what the package itself needs, "a+b", that and
#                         two extras, or "all". While it is there, make neither installs nor asks the network.

PLACE := $(shell $(PYTHON) -c 'import os, sys, zlib; print("%d.%d-%08x" % (sys.version_info[:2] + \
           (zlib.crc32((os.getcwd() + getattr(sys, "base_prefix", "")).encode()) & 0xffffffff,)))')
PINS  := $(shell cat requirements.lock pyproject.toml | cksum | tr ' ' '-')
WHOLE := $(VENV)/whole-$(PLACE)
DONE  := $(VENV)/installed-$(PLACE)-$(PINS)
empty :=
FULL  := $(DONE)-all
LEAN  := $(DONE)-lean
# Where everything is installed, that will do for any choice of extras.
READY := $(or $(wildcard $(FULL)),$(if $(strip $(EXTRAS)),$(DONE)-$(subst $(empty) $(empty),+,$(sort $(EXTRAS))),$(LEAN)))

ifndef LOCKED

# One set-up at a time: a second make waits here and then finds everything done. The lock is on this folder, is held by
# whatever still runs of the set-up, and goes when that ends, however it ends. Python takes it because not every system
# has flock(1); the recursive make looks again at what is there once the lock is held.
UNDER_LOCK := $(PYTHON) -c 'import fcntl, os, sys; fd = os.open(".", os.O_RDONLY); os.set_inheritable(fd, True); \
                fcntl.flock(fd, fcntl.LOCK_EX); os.execvp(sys.argv[1], sys.argv[1:])'

$(sort $(READY) $(FULL)):
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and \
	    "This project needs Python 3.11 or newer; here python3 is %d.%d. Name another one: make PYTHON=..." \
	    % sys.version_info[:2])'
	@$(UNDER_LOCK) $(MAKE) --no-print-directory --silent LOCKED=1 $@

else

PIP       := $(BIN)/python -m pip --disable-pip-version-check --quiet
UV        := $(BIN)/uv --quiet
INSTALLER ?= uv

# The second try: of a killed venv, a child that installs pip may still be writing, without a hold on the lock.
$(WHOLE):
	@echo "Making a new environment in $(VENV)."
	@rm -rf $(VENV) 2> /dev/null || { sleep 5 && rm -rf $(VENV); }
	@$(PYTHON) -m venv $(VENV)
	@touch $@

# uv is pinned in the lock as everything else is, so pip fetches it with its hashes; where there is no uv for this
# machine (or with INSTALLER=pip), pip installs the rest of the lock by itself, which takes longer and gives the same.
# tools/pins.py takes of the lock what the extras need, and awk parts that: an entry begins at the margin, and its hashes
# follow indented. Everything is compiled here, so that the first command does not pay for it, even where nothing may be
# written later (PYTHONDONTWRITEBYTECODE).
$(sort $(READY) $(FULL)): | $(WHOLE)
	@$(PYTHON) tools/pins.py select $(patsubst lean,,$(subst +, ,$(patsubst $(DONE)-%,%,$@))) > $(VENV)/pins.txt
	@echo "Installing what requirements.lock pins ($(patsubst $(DONE)-%,%,$@))."
	@rm -f $(VENV)/whole-* $(VENV)/installed-*
	@awk '/^[^ ]/ { ours = /^uv==/ }  ours' $(VENV)/pins.txt > $(VENV)/uv.txt
	@awk '/^[^ ]/ { ours = /^uv==/ } !ours' $(VENV)/pins.txt > $(VENV)/rest.txt
	@if test $(INSTALLER) = uv && $(PIP) install --require-hashes -r $(VENV)/uv.txt && $(UV) --version > /dev/null; then \
	    $(UV) pip install --compile-bytecode --python $(BIN)/python --require-hashes -r $(VENV)/pins.txt && \
	    $(UV) pip install --python $(BIN)/python --no-build-isolation --no-deps --editable . ; \
	else \
	    echo "Without uv: pip installs, which takes a little longer." && \
	    $(PIP) install --require-hashes -r $(VENV)/rest.txt && \
	    $(PIP) install --no-build-isolation --no-deps --no-index --editable . ; \
	fi || { echo "The set-up did not finish, for the reason above. It needs the network once; run make again." >&2; exit 1; }
	@$(BIN)/python -m compileall -q workbench
	@touch $(WHOLE)
	@touch $(LEAN) $@

endif

# --- what is run in it ----------------------------------------------------------------------------------------------

$(STUDIES): $(READY)
	@$(BIN)/workbench run studies/$@

# A study of measured data that is not on this machine says so and is passed over.
all: $(READY)
	@for study in $(STUDIES); do $(BIN)/workbench run --if-data studies/$$study || exit; done

setup: $(READY)

# worksteal: each worker has a stretch of files, so that what tests of one file share is made once and not by every worker.
test: $(FULL)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/python -m pytest -n $(WORKERS) --dist worksteal

fuzz: $(FULL)
	@$(BIN)/python tests/fuzz.py $(INPUTS)
	@PYTHONPATH=tests $(BIN)/python tests/firmware/test_firmware_fuzz.py $(CALLS)

bench: $(FULL)
	@$(BIN)/python -m benchmarks

# What is done is kept under reports/bench_trace/, so that a run that was stopped goes on where it was.
bench-trace: $(FULL)
	@WORKERS=$(WORKERS) $(BIN)/python -m benchmarks.trace --campaigns $(CAMPAIGNS) --seed $(SEED) $(ARGS)

# One file for every system and Python (--universal), one version of each package (--fork-strategy fewest) so that the
# numbers of a study do not depend on the Python, hashes for all, what asked for each, and no address that a download came
# from.
lock: $(READY)
	@test -x $(BIN)/uv || { echo "Only uv can write the lock, and it could not be had on this machine." >&2; exit 1; }
	$(BIN)/uv pip compile pyproject.toml --quiet $(UPGRADE) --all-extras --universal --python-version 3.11 \
	    --fork-strategy fewest --generate-hashes --no-emit-index-url --no-emit-find-links --no-header \
	    --output-file requirements.lock

third-party: $(FULL)
	@$(BIN)/python tools/pins.py third-party

help:
	@sed -n 's/^## //p' Makefile
	@echo "Studies: $(STUDIES)"

# Kernels lie where kernel/cache.py puts them; only what is known to be ours goes from there, for the folder is anybody's.
KERNELS = $(or $(WORKBENCH_CACHE),$(or $(XDG_CACHE_HOME),$(HOME)/.cache)/servo-workbench)

clean:
	rm -rf "$(KERNELS)/kernels" "$(KERNELS)/times"
	-@rmdir "$(KERNELS)" 2> /dev/null
	rm -rf studies/*/.steps
	rm -rf $(VENV) .pytest_cache .ruff_cache .hypothesis
	find reports -mindepth 1 -maxdepth 1 ! -name README.md -exec rm -rf {} +
	find . -name .git -prune -o -name __pycache__ -prune -exec rm -rf {} +
