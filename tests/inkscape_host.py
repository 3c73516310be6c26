# SPDX-License-Identifier: GPL-2.0-or-later
"""Run real Inkscape for tests: a fresh profile with the extension, a virtual screen, a time limit."""

from __future__ import annotations

import os
import shlex
import shutil
import signal
import subprocess
from functools import lru_cache
from pathlib import Path
from xml.sax.saxutils import quoteattr

ROOT = Path(__file__).resolve().parent.parent
EXTENSION_ID = "io.github.ddttrace.ddt_trace"
MISSING = "Inkscape or xvfb-run was not found; as root: apt-get install inkscape xvfb xauth"
SECONDS = 120
"""Longest time that Inkscape may take, far more than it does: the machine may be busy."""


@lru_cache(maxsize=None)
def commands():
    """The Inkscapes to test with: the one on the PATH, and more named by DDT_TRACE_INKSCAPES.

    The variable holds commands separated by colons, such as a wrapper for another version.
    """
    if not shutil.which("xvfb-run"):
        return ()
    more = [tuple(shlex.split(text)) for text in os.environ.get("DDT_TRACE_INKSCAPES", "").split(":")]
    return tuple(command for command in [("inkscape",), *more] if command and shutil.which(command[0]))


class Inkscape:
    """One version of Inkscape with a profile of its own.

    The extension is there as links to the files of the project, or as unpacked from `package`.
    """

    def __init__(self, command, profile, package=None):
        self.command = list(command)
        self.profile = Path(profile)
        folder = self.profile / "extensions" / "ddt_trace"
        folder.mkdir(parents=True)
        if package:
            shutil.unpack_archive(str(package), str(folder))
            return
        for name in ("ddt_trace.inx", "ddt_trace.py", "ddtcore"):
            (folder / name).symlink_to(ROOT / name)

    def run(self, *arguments, log=None, language="en"):
        """Run Inkscape on a virtual screen; it has to end by itself and without an error.

        Returns what it says to standard error.
        """
        environment = dict(os.environ, INKSCAPE_PROFILE_DIR=str(self.profile), LANG="C.UTF-8",
                           LANGUAGE=language)
        environment.pop("LC_ALL", None)
        # The first python3 on the PATH runs the extension: the system's, as for most users.
        environment["PATH"] = os.pathsep.join(["/usr/bin", environment["PATH"]])
        if log:
            environment["DDT_TRACE_LOG"] = str(log)
        # Two that look for a free screen from the same number on may find the same one.
        screen = ["xvfb-run", "-a", "-n", str(100 + os.getpid() % 10_000)]
        process = subprocess.Popen([*screen, *self.command, *map(str, arguments)], env=environment,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, start_new_session=True)
        try:
            _, stderr = process.communicate(timeout=SECONDS)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)  # a box on the screen waits for somebody to close it
            raise
        said = stderr.decode(errors="replace")
        assert process.returncode == 0, said
        return said

    def trace(self, document, result, /, ids=(), log=None, language="en", more=(), **settings):
        """Trace pictures of a document through the menu action, with settings as the dialog keeps them.

        `more` are actions to run before the document is saved.
        """
        values = "".join(f" {EXTENSION_ID}.{name}={quoteattr(value)}" for name, value in settings.items())
        (self.profile / "preferences.xml").write_text(
            f'<inkscape version="1"><group id="extensions"{values}/></inkscape>')
        action = EXTENSION_ID.replace("_", "-") + ".noprefs"
        select = [f"select-by-id:{','.join(ids)}"] if ids else []
        steps = [*select, action, *more, f"export-filename:{result}", "export-do"]
        return self.run("--batch-process", f"--actions={';'.join(steps)}", document, log=log,
                        language=language)

    def render(self, *documents):
        """Write a PNG beside each document."""
        self.run("--export-type=png", "--export-area-page", *documents)
