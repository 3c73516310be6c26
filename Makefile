# SPDX-License-Identifier: GPL-2.0-or-later
# make test     set up and run all tests, those with real Inkscape among them
# make demo     set up and trace a bundled bitmap into demo/
# make install  copy the extension to where Inkscape looks for it
# make clean    remove everything that these have made here

INKSCAPE ?= inkscape
PICTURE ?= tests/images/stegosaurus.png

.PHONY: setup test demo install clean

setup:
	@.ci/setup

test: setup
	.venv/bin/python -m pytest -q

demo: setup
	@.ci/demo $(PICTURE)

install:
	@INKSCAPE="$(INKSCAPE)" .ci/install

clean:
	rm -rf .venv demo build dist *.egg-info .pytest_cache .hypothesis .mypy_cache .ruff_cache .benchmarks
	find . -name __pycache__ -prune -exec rm -rf {} +
