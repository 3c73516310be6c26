# SPDX-License-Identifier: GPL-2.0-or-later
# make test     set up and run all tests, those with real Inkscape among them
# make demo     set up and trace a bundled bitmap into demo/
# make bench    measure time and memory over the size of the picture
# make install  copy the extension to where Inkscape looks for it
# make zip      pack it for the Extension Manager, into dist/
# make i18n     bring the texts to be translated up to date
# make clean    remove everything that these have made here

INKSCAPE ?= inkscape
PICTURE ?= tests/images/stegosaurus.png

.PHONY: setup test demo bench install zip i18n clean

setup:
	@.ci/setup

test:
	@.ci/setup browser
	.venv/bin/python -m pytest -q

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
	rm -rf .venv demo build dist *.egg-info .pytest_cache .hypothesis .mypy_cache .ruff_cache .benchmarks
	find . -name __pycache__ -prune -exec rm -rf {} +
