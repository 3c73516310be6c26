# SPDX-License-Identifier: GPL-2.0-or-later
"""What the user sees when something goes wrong: one plain sentence, never a traceback."""

from __future__ import annotations

import os
import sys
import tempfile
import traceback
from contextlib import contextmanager
from typing import Iterator

import inkex
from inkex.utils import ABORT_STATUS

from .log import note
from .words import _


@contextmanager
def plain_messages() -> Iterator[None]:
    """Turn whatever goes wrong into one sentence and the exit status that inkex users expect.

    An `AbortExtension` passes (status 251); anything unforeseen goes to a log file
    and ends the program with status 1.
    """
    try:
        with _quiet_libraries():
            yield
    except (inkex.AbortExtension, MemoryError) as error:
        no_memory = _("There is not enough memory to trace a picture of this size.")
        message = no_memory if isinstance(error, MemoryError) else str(error)
        if note(message):
            sys.exit(ABORT_STATUS)
        raise inkex.AbortExtension(message) from error
    except Exception as error:  # anything else is a fault of this program
        details = traceback.format_exc()
        if not note(details):
            inkex.errormsg(_unforeseen(error, details))
        sys.exit(1)


@contextmanager
def _quiet_libraries() -> Iterator[None]:
    """Send to nowhere what C libraries write to stderr, such as libtiff about unknown tags."""
    try:
        sys.stderr.flush()
        stderr = os.dup(2)
    except (AttributeError, OSError):  # there is none, as under pythonw
        yield
        return
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 2)
        yield
    finally:
        sys.stderr.flush()
        os.dup2(stderr, 2)
        os.close(stderr)
        os.close(nowhere)


def _unforeseen(error: Exception, details: str) -> str:
    try:
        return _("DDT Trace has met an unforeseen fault; please report it with the file {path}.").format(
            path=_log_file(details))
    except OSError:  # a full disk, perhaps
        fault = " ".join(f"{type(error).__name__} {error}".split())
        return _("DDT Trace has met an unforeseen fault, and cannot write down the details:"
                 " {fault}.").format(fault=fault)


def _log_file(details: str) -> str:
    with tempfile.NamedTemporaryFile("w", prefix="ddt_trace-", suffix=".log", delete=False,
                                     encoding="utf-8") as file:
        file.write(f"{sys.version}\ninkex {inkex.__version__}\n{details}")
    return file.name
