#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Deliberate faults, each made in a copy of the project: some test has to fail for every one.

Usage: mutants.py [name...]
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent


class Mutant(NamedTuple):
    """A fault: what to replace where, and the test files one of which should find it."""

    file: str
    right: str
    wrong: str
    tests: str


MUTANTS = {
    "sign of the cost": Mutant("cost.py", "signs[:self.sizes] = 1.0", "signs[:self.sizes] = -1.0", "cost flips"),
    "half-pixel offset of the mesh": Mutant(
        "model.py", "np.stack([col - 0.5, row - 0.5], axis=-1)", "np.stack([col + 0.0, row - 0.5], axis=-1)",
        "position outline"),
    "half-pixel offset of the coverage": Mutant(
        "position.py", "position = cell + 0.5\n", "position = cell + 1.0\n", "position"),
    "hole rule": Mutant(
        "order.py", "lowest[loops.web] > order.rank[loops.face]", "lowest[loops.web] < order.rank[loops.face]",
        "stacking"),
    "holes wound like outer loops": Mutant(
        "loops.py", "begin = np.stack([planar.tail, planar.head], axis=1)",
        "begin = np.stack([planar.head, planar.tail], axis=1)", "loops"),
    "off by one at the right border": Mutant(
        "position.py", "col = np.clip(np.floor(points[..., 0]), 0, w - 1)",
        "col = np.clip(np.floor(points[..., 0]), 0, w - 2)", "position robust_tiny"),
    "smaller areas at the back": Mutant(
        "order.py", "np.lexsort((-area, -key, opacity == 1))", "np.lexsort((-area, key, opacity == 1))",
        "order trace"),
    "alpha is ignored": Mutant(
        "position.py", "colours[..., :3] *= colours[..., 3:] / np.float32(255)", "pass", "position fit trace"),
    "wrong diagonal": Mutant("quads.py", "= better > 0", "= better < 0", "quads triangulation"),
    "a junction missed": Mutant("outline.py", "mixed.all(axis=1)", "mixed.any(axis=1)", "outline"),
    "curves beyond the tolerance": Mutant(
        "segments.py", "bad = (fit.error > tolerance[run])", "bad = (fit.error > 3 * tolerance[run])", "fit"),
    "dots may vanish": Mutant("staircase.py", "DOT = 4", "DOT = 0", "robust_tiny"),
    "curves may leave the picture": Mutant(
        "fit.py", "control[bulging] = np.clip(control[bulging], 0, size)", "pass", "robust_any"),
    "half-written files stay": Mutant("svg.py", "os.unlink(beside)", "pass", "svg robust_luck"),
    "devices are read": Mutant(
        "raster.py", "if not stat.S_ISREG(status.st_mode):", "if False:", "raster"),
    "files without end are read": Mutant(
        "inkscape/source.py", "min(os.fstat(file.fileno()).st_size, MAX_BYTES + 1)", "-1", "inkscape_source"),
    "a lost report ends a batch": Mutant(
        "cli.py", "except OSError as error:\n        _say(", "except KeyError as error:\n        _say(", "robust_luck"),
    "wrong corner of a triangle": Mutant(
        "border.py", "mesh.points(mesh.triangles[triangles])", "mesh.points(mesh.triangles[triangles][:, [0, 0, 1]])",
        "border position"),
    "a tangent turned round": Mutant(
        "polish.py", "np.stack([-wire.handles[..., 1], wire.handles[..., 0]], axis=-1)",
        "np.stack([wire.handles[..., 1], -wire.handles[..., 0]], axis=-1)", "polish"),
    "one colour too many": Mutant("merging.py", "if painted.size <= most:", "if painted.size <= most + 1:", "merging"),
}


def survives(mutant: Mutant) -> bool:
    """Whether the tests pass in spite of the fault."""
    with tempfile.TemporaryDirectory(prefix="mutant") as folder:
        for name in ("ddtcore", "tests"):
            shutil.copytree(ROOT / name, Path(folder) / name, ignore=shutil.ignore_patterns("__pycache__"))
        for name in ("pyproject.toml", "ddt_trace.py", "ddt_trace.inx"):
            shutil.copy(ROOT / name, folder)
        path = Path(folder) / "ddtcore" / mutant.file
        text = path.read_text(encoding="utf-8")
        if text.count(mutant.right) < 1:
            raise SystemExit(f"{mutant.file} has no {mutant.right!r} any more: bring the list of mutants up to date")
        path.write_text(text.replace(mutant.right, mutant.wrong), encoding="utf-8")
        files = [f"tests/test_{name}.py" for name in mutant.tests.split()]
        done = subprocess.run([sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", *files],
                              cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              env={**os.environ, "PYTHONPATH": folder})
        if done.returncode not in (0, 1):
            raise SystemExit(done.stdout.decode())
        return done.returncode == 0


def main(names) -> int:
    """Try the mutants of these names, or all, and say which live."""
    alive = 0
    for name in names or MUTANTS:
        lives = survives(MUTANTS[name])
        alive += lives
        print(f"{'LIVES' if lives else 'found'}  {name}", flush=True)
    return 1 if alive else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
