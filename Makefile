# Everything a fresh clone needs: `make demo` and `make test` set themselves up.
PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
MINUTES ?= 30
JOBS   ?= auto
STAMP  := $(VENV)/.ready
DOCS   := $(VENV)/.docs-ready

.PHONY: help setup demo kernels client page picture test coverage check docs serve bench papers mutants fuzz lock sbom audit clean
help:            ## list the targets
	@grep -E '^[a-z]+: .*##|^[a-z]+:  *##' $(MAKEFILE_LIST) | sed 's/:.*##/\t/'

$(STAMP): pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "ikplan needs Python 3.11 or newer (make PYTHON=python3.12 ...)" >&2; exit 2; }
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable '.[dev]'
	@touch $@

setup: $(STAMP)  ## make the virtual environment in .venv

demo: $(STAMP)   ## plan the helix of examples/ and write out/helix.{json,csv,png}
	$(BIN)/python examples/demo.py

kernels: $(STAMP) ## compile every kernel, for any processor of the family, into a wheel in dist; minutes
	$(BIN)/python kernels/build.py kernels/ikplan_kernels/kernels.pack
	$(BIN)/python -m pip wheel --quiet --disable-pip-version-check --no-deps --wheel-dir dist ./kernels

client: $(STAMP) ## write the wheel of the client alone to dist
	$(BIN)/python -m pip wheel --quiet --disable-pip-version-check --no-deps --wheel-dir dist ./client

page: $(STAMP)   ## check and bundle the page that the service shows at /
	$(BIN)/python web/build.py

picture: page    ## renew docs/page.png; needs chromium
	$(BIN)/python -m tests.page.picture docs/page.png

test: $(STAMP)   ## run the tests, a process a core; JOBS=1 for one
	$(BIN)/python -m pytest --numprocesses $(JOBS) --dist loadfile

coverage: $(STAMP)  ## run the tests and print which lines and branches of Python they miss
	$(BIN)/python -m pytest --cov --cov-report=term

check: $(STAMP)  ## lint and type-check
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/hadolint docker/Dockerfile

$(DOCS): $(STAMP)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable '.[dev,docs]'
	@touch $@

docs: $(DOCS)    ## build the site of the documentation into out/site
	$(BIN)/python docs/build_site.py out/site

serve: $(STAMP)  ## start the service on 127.0.0.1:8000
	$(BIN)/ikplan serve

bench: $(STAMP)  ## print the speed ratios
	$(BIN)/python -m benchmarks.speed

papers: $(STAMP) ## run a reduced version of the papers' experiments into out/papers; about 5 minutes
	$(BIN)/python -m benchmarks.papers --runs 3 --thin 10 --jobs 2

mutants: $(STAMP) ## plant faults and print those that no test finds; up to 30 minutes
	$(BIN)/python -m benchmarks.mutants

fuzz: $(STAMP)   ## read damaged requests, scenes, points and URDFs for MINUTES=30; documents of faults to out/fuzz
	$(BIN)/python -m benchmarks.fuzz --minutes $(MINUTES)

lock: $(STAMP)   ## write what the container installs, with hashes, from constraints.txt
	$(BIN)/python docker/lock.py

sbom: $(STAMP)   ## write the bill of materials of the container (CycloneDX) to out/sbom.cdx.json
	mkdir -p out
	$(BIN)/python docker/sbom.py out/sbom.cdx.json

audit: $(STAMP)  ## look for known faults of what the container installs; says if the data cannot be reached
	$(BIN)/python docker/audit.py

clean:           ## remove the environment and every output
	rm -rf $(VENV) out build dist web/dist web/node_modules
