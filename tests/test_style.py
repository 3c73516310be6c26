# SPDX-License-Identifier: GPL-2.0-or-later
"""The source itself: types by mypy, strictly, style by ruff, and a place for each deliberate fault."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path

import pytest
from mutants import MUTANTS

ROOT = Path(__file__).resolve().parent.parent


@pytest.mark.parametrize("arguments", [["mypy"], ["ruff", "check", "--quiet", "."]], ids=["mypy", "ruff"])
def test_the_source_is_judged_clean(arguments):
    if importlib.util.find_spec(arguments[0]) is None:
        pytest.skip(f"{arguments[0]} is not for this version of Python")
    done = subprocess.run([sys.executable, "-m", *arguments], cwd=ROOT, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("name", MUTANTS)
def test_deliberate_faults_have_a_place(name):
    """That tests find them takes minutes: ``make mutants``."""
    mutant = MUTANTS[name]
    assert mutant.right in (ROOT / "ddtcore" / mutant.file).read_text(encoding="utf-8")
    assert all((ROOT / "tests" / f"test_{tests}.py").exists() for tests in mutant.tests.split())
