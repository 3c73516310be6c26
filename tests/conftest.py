# SPDX-License-Identifier: GPL-2.0-or-later
"""What all tests share: a clean environment, real Inkscape, and a loud word if it was missing."""

from __future__ import annotations

import os

import browser
import inkscape_host
import pytest


def pytest_addoption(parser):
    parser.addoption("--update-golden", action="store_true", help="write the drawings in tests/golden anew")


def pytest_collection_modifyitems(config, items):
    """Where tests run in parallel, Inkscape runs once at a time: virtual screens can collide."""
    if config.pluginmanager.hasplugin("xdist"):
        for item in items:
            if {"inkscape", "virtual_screen"} & set(item.fixturenames):
                item.add_marker(pytest.mark.xdist_group("inkscape"))


@pytest.fixture(autouse=True)
def clean_environment(monkeypatch):
    """Nothing that Inkscape, or inkex in an earlier test, left in the environment; no warnings asked for."""
    for name in ("DOCUMENT_PATH", "DDT_TRACE_LOG", "INKSCAPE_PROFILE_DIR", "PYTHONWARNINGS"):
        # Set first, so that it is undone even where inkex sets it later on.
        monkeypatch.setenv(name, "")
        monkeypatch.delenv(name)


@pytest.fixture(scope="session", params=inkscape_host.commands() or [None],
                ids=lambda command: os.path.basename(command[0]) if command else "missing")
def inkscape(request, tmp_path_factory):
    """Real Inkscape with the extension installed; each test using it runs once per version found."""
    if request.param is None:
        if os.environ.get("DDT_TRACE_NEED_INKSCAPE"):
            pytest.fail(inkscape_host.MISSING)
        pytest.skip(inkscape_host.MISSING)
    return inkscape_host.Inkscape(request.param, tmp_path_factory.mktemp("profile"))


@pytest.fixture
def virtual_screen():
    """For tests that start Inkscape by a script of the project, which looks for a free screen itself."""


def pytest_terminal_summary(terminalreporter):
    """Say loudly that tests with real Inkscape or with a real browser were skipped."""
    if not inkscape_host.commands():
        terminalreporter.section("NOT TESTED WITH REAL INKSCAPE")
        terminalreporter.line(inkscape_host.MISSING)
    if not browser.command():
        terminalreporter.section("NOT TESTED WITH A REAL BROWSER")
        terminalreporter.line(browser.MISSING)
