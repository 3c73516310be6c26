# SPDX-License-Identifier: GPL-2.0-or-later
"""For those who wait: a line that says how far a trace is, and what each stage took.

Both are told of the stages as they begin, see `Progress` in `pipeline`.
"""

from __future__ import annotations

import os
import sys
import time
from typing import Any, Dict, List, NamedTuple, TextIO


class ProgressLine:
    """The last line of a terminal, written again and again and gone in the end.

    Parameters
    ----------
    stream : text file
        The terminal.
    """

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self._shown = 0

    def show(self, text: str) -> None:
        """Put a text in the place of the one before; what is too long loses its beginning."""
        text = text[-max(self._columns() - 1, 1):]
        self._stream.write("\r" + text.ljust(self._shown))
        self._stream.flush()
        self._shown = len(text)

    def clear(self) -> None:
        """Leave the line empty, for something else to be written."""
        if self._shown:
            self._stream.write("\r" + " " * self._shown + "\r")
            self._stream.flush()
            self._shown = 0

    def _columns(self) -> int:
        try:
            return os.get_terminal_size(self._stream.fileno()).columns or 80
        except (OSError, ValueError):
            return 80


class Lap(NamedTuple):
    """What a stage took.

    Attributes
    ----------
    stage : str
    seconds : float
    peak_mb : float
        Most memory that the process has used up to the end of the stage, 0 if the system
        doesn't tell.
    """

    stage: str
    seconds: float
    peak_mb: float


class Stopwatch:
    """Takes the time of stages; call it with the name of each when it begins.

    Attributes
    ----------
    laps : list of Lap
        The stages that are over, in their order.
    """

    def __init__(self) -> None:
        self.laps: List[Lap] = []
        self._stage = ""
        self._began = 0.0

    def __call__(self, stage: str, share: float = 0.0) -> None:
        """Begin a stage, and end the one before."""
        now = time.perf_counter()
        if self._stage:
            self.laps.append(Lap(self._stage, now - self._began, peak_memory()))
        self._stage, self._began = stage, now

    def stop(self) -> None:
        """End the last stage."""
        self("")

    def to_dicts(self) -> List[Dict[str, Any]]:
        """The laps for programs; JSON can hold them."""
        return [{"stage": lap.stage, "seconds": round(lap.seconds, 4), "peak_mb": round(lap.peak_mb, 1)}
                for lap in self.laps]

    def to_text(self) -> str:
        """The laps as a table for people."""
        total = sum(lap.seconds for lap in self.laps)
        peak = max((lap.peak_mb for lap in self.laps), default=0.0)
        rows = [f"  {name:<20}{seconds:>10.3f} s{megabytes:>10.0f} MB"
                for name, seconds, megabytes in [*self.laps, Lap("in all", total, peak)]]
        return "\n".join(rows)


def peak_memory() -> float:
    """Most memory that this process has used so far, in MB; 0 if the system doesn't tell."""
    try:
        import resource
    except ImportError:  # Windows
        return 0.0
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / 1e6 if sys.platform == "darwin" else peak * 1024 / 1e6
