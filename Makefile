# SPDX-License-Identifier: GPL-2.0-or-later
# make test     set up and run all tests, those with real Inkscape among them
# make demo     set up and trace a bundled bitmap into demo/
# make fuzz     try changed files and pixels for DURATION seconds (with atheris where it can be had)
# make coverage run all tests and list the branches of the engine that none of them takes
# make mutants  see that each of some deliberate faults makes a test fail
# make bench    measure time and memory over the size of the picture
# make install  copy the extension to where Inkscape looks for it
# make zip      pack it for the Extension Manager, into dist/
# make i18n     bring the texts to be translated up to date
# make clean    remove everything that these have made here

INKSCAPE ?= inkscape
PICTURE ?= tests/images/stegosaurus.png
DURATION ?= 600

.PHONY: setup test fuzz coverage mutants demo bench install zip i18n clean

setup:
	@.ci/setup

test:
	@.ci/setup browser
	.venv/bin/python -m pytest -q -n auto --dist loadgroup

fuzz: setup
	@.venv/bin/python -m pip install --quiet atheris || echo "There is no atheris for this Python" >&2
	.venv/bin/python tests/fuzz/fuzzing.py $(DURATION)

coverage: setup
	.venv/bin/python -m coverage run -m pytest -q
	.venv/bin/python -m coverage report

mutants: setup
	.venv/bin/python tests/mutants.py

demo: setup
	@.ci/demo $(PICTURE)

bench: setup
	.venv/bin/python tests/benchmark/speed.py

install:
	@INKSCAPE="$(INKSCAPE)" .ci/install

zip:
	@.ci/zip

i18n: setup
	.venv/bin/python tests/make_catalogues.py

clean:
	rm -rf .venv demo build dist *.egg-info .coverage .pytest_cache .hypothesis .mypy_cache .ruff_cache .benchmarks
	find . -name __pycache__ -prune -exec rm -rf {} +
