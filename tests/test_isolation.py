# SPDX-License-Identifier: GPL-2.0-or-later
"""What the engine may load: numpy, Pillow and the light part of the standard library."""

from __future__ import annotations

import ast
import os
import subprocess
import sys

import pytest

import ddtcore

FOLDER = os.path.dirname(ddtcore.__file__)
MODULES = sorted(name for name in os.listdir(FOLDER) if name.endswith(".py"))

LIGHT = {
    "__future__", "bisect", "collections", "contextlib", "dataclasses", "functools", "heapq", "importlib",
    "io", "itertools", "logging", "math", "operator", "os", "signal", "stat", "sys", "threading", "time",
    "typing", "warnings", "zlib"}
"""Modules that numpy or Pillow load anyway, or that cost next to nothing."""

MORE = {"cli.py": {"argparse"}, "compare.py": {"base64", "html", "pkgutil", "re"}}
"""What files may load besides, as they are loaded only where they are needed."""


def imports(tree, top_level):
    """Names of the modules that a file imports, at its top level or anywhere."""
    nodes = ast.iter_child_nodes(tree) if top_level else ast.walk(tree)
    for node in nodes:
        if isinstance(node, ast.Import):
            yield from (alias.name.split(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            yield node.module.split(".")[0]


@pytest.mark.parametrize("name", MODULES)
def test_engine_files_import_only_what_they_may(name):
    with open(os.path.join(FOLDER, name), encoding="utf-8") as file:
        tree = ast.parse(file.read())
    assert not {"inkex", "lxml", "scipy", "cv2", "skimage"} & set(imports(tree, top_level=False))
    allowed = LIGHT | {"numpy", "PIL"} | MORE.get(name, set())
    assert set(imports(tree, top_level=True)) <= allowed


def run(code):
    """The output of some code in a new interpreter."""
    environment = {**os.environ, "PYTHONPATH": os.path.dirname(FOLDER)}
    return subprocess.run([sys.executable, "-c", code], env=environment, check=True, text=True,
                          stdout=subprocess.PIPE).stdout.split()


def test_engine_traces_without_inkex_and_lxml():
    drawn = run("""if True:
        import sys
        sys.modules["inkex"] = sys.modules["lxml"] = None
        import numpy, ddtcore
        picture = numpy.full((6, 8), 255, dtype=numpy.uint8)
        picture[2:4, 2:6] = 0
        for result in ("triangles", "border", "outlines", "curves"):
            svg = ddtcore.trace(picture, ddtcore.TraceOptions(result=result)).to_svg()
            print(svg.count("</svg>"))
        """)
    assert drawn == ["1"] * 4


@pytest.mark.parametrize("code", (
    "import ddtcore", "from ddtcore import TraceOptions", "import ddtcore.cli",
    "from ddtcore.cli import main\ntry: main(['--help'])\nexcept SystemExit: pass"))
def test_numpy_and_pillow_are_not_loaded_before_they_are_used(code):
    loaded = run(f"import sys\n{code}\nprint('LOADED', *sys.modules)")
    loaded = loaded[loaded.index("LOADED") + 1:]
    assert "ddtcore" in loaded
    heavy = {"numpy", "PIL", "concurrent.futures", "multiprocessing", "json", "tempfile", "gzip"}
    assert not heavy & set(loaded)


def test_tracing_a_file_loads_no_more_than_numpy_and_pillow_do():
    own = set(run("""if True:
        import sys, numpy
        from PIL import Image
        Image.init()
        before = set(sys.modules)
        import ddtcore
        ddtcore.trace(numpy.zeros((4, 4), numpy.uint8)).to_svg()
        print(*(set(sys.modules) - before))
        """))
    heavy = {"multiprocessing", "concurrent", "json", "gzip", "tempfile", "subprocess", "difflib", "argparse",
             "unittest", "ctypes", "urllib", "email", "http", "asyncio", "xml", "scipy"}
    assert not {name.split(".")[0] for name in own} & heavy


def test_public_names():
    assert dir(ddtcore) == sorted(ddtcore.__all__)
    for name in ddtcore.__all__:
        assert getattr(ddtcore, name).__name__ == name
    assert ddtcore.__version__ == "1.0.0"
    with pytest.raises(AttributeError, match="nonsense"):
        ddtcore.nonsense  # noqa: B018


@pytest.mark.parametrize("name", [name for name in MODULES if name != "__main__.py"])
def test_functions_have_types_and_say_what_they_do(name):
    with open(os.path.join(FOLDER, name), encoding="utf-8") as file:
        tree = ast.parse(file.read())
    assert ast.get_docstring(tree)
    for node in tree.body:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)) and not node.name.startswith("_"):
            assert ast.get_docstring(node), node.name
        if isinstance(node, ast.FunctionDef):
            given = [*node.args.args, *node.args.kwonlyargs]
            assert node.returns is not None and all(argument.annotation for argument in given), node.name
