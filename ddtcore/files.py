# SPDX-License-Identifier: GPL-2.0-or-later
"""From picture files to drawing files: one, or many in several processes.

One bad picture, or a worker that is killed, costs that picture and no other.
"""

from __future__ import annotations

import os
import signal
import sys
from itertools import zip_longest
from typing import TYPE_CHECKING, Callable, Iterator, NamedTuple, Optional, Sequence, Tuple, Union

from .options import Automatic, TraceOptions
from .progress import Stopwatch

if TYPE_CHECKING:
    import numpy as np

    from .model import Drawing

STANDARD = "-"
"""In place of a file: standard input or output."""


class Job(NamedTuple):
    """A picture to trace.

    Attributes
    ----------
    source, target : str
        Files, or `STANDARD`.
    options : TraceOptions
    report : str
        Also report on it: ``"text"``, ``"json"``, or ``""`` for no report.
    timings : str
        Also say how long each stage took, in the same ways.
    page : bool
        Write the page that compares the picture with its trace in place of the drawing.
    """

    source: str
    target: str
    options: TraceOptions
    report: str = ""
    timings: str = ""
    page: bool = False


Tell = Callable[[Job, str, float], object]
"""Told what stage of a job begins, and the share of the job that is done by then."""


class Outcome(NamedTuple):
    """What came of a job: an error in one line, or "" and the notes and what there is to report."""

    job: Job
    error: str = ""
    notes: Tuple[str, ...] = ()
    report: str = ""


def trace_file(path: Union[str, os.PathLike[str]], out: Union[str, os.PathLike[str], None] = None,
               options: Optional[TraceOptions] = None) -> str:
    """Trace a picture file into an SVG file; fit to be sent to other processes.

    Parameters
    ----------
    path : str or path-like
        Picture of any kind that Pillow reads.
    out : str or path-like, optional
        Ends in ``.svg`` or ``.svgz``; beside the picture if left out.
    options : TraceOptions, optional

    Returns
    -------
    str
        The file written.

    Raises
    ------
    ImageError
        If the picture can't be read.
    OSError
        If the drawing can't be written.

    Examples
    --------
    >>> import tempfile
    >>> from PIL import Image
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     picture = os.path.join(folder, "picture.png")
    ...     Image.new("RGB", (8, 6), "navy").save(picture)
    ...     os.path.basename(trace_file(picture))
    'picture.svg'
    """
    source = os.fspath(path)
    target = default_target(source) if out is None else os.fspath(out)
    _run(Job(source, target, options or Automatic()))
    return target


def default_target(source: str, folder: Optional[str] = None, ending: str = ".svg") -> str:
    """The drawing's file: beside the picture or in a folder."""
    stem = os.path.splitext(source)[0]
    return (stem if folder is None else os.path.join(folder, os.path.basename(stem))) + ending


def run_all(jobs: Sequence[Job], workers: int = 1, tell: Optional[Tell] = None) -> Iterator[Outcome]:
    """Do all jobs and say what came of each, in their order but for those that lost a worker.

    Parameters
    ----------
    jobs : sequence of Job
    workers : int
        Processes to use, 0 for as many as there are processors.
    tell : callable, optional
        Told of every stage of every job, if there is but one process.
    """
    workers = min(workers or _processors(), len(jobs))
    if workers < 2:
        for job in jobs:
            yield _attempt(job, tell)
        return
    while jobs:
        lost = []
        for job, outcome in _in_processes(jobs, workers):
            if outcome is None:
                lost.append(job)
            else:
                yield outcome
        # The worker died of one of the first of these: alone, each shows whether it was that one.
        for suspect in lost[:workers]:
            for job, outcome in _in_processes([suspect], 1):
                yield outcome or Outcome(job, f"{job.source}: the process that traced it was killed")
        jobs = lost[workers:]


def _in_processes(jobs: Sequence[Job], workers: int) -> Iterator[Tuple[Job, Optional[Outcome]]]:
    """Jobs with their outcomes, None for those that were lost because a worker died."""
    from concurrent.futures import ProcessPoolExecutor
    from concurrent.futures.process import BrokenProcessPool

    from . import pipeline  # noqa: F401  (loaded once, for all processes forked from here)

    with ProcessPoolExecutor(workers, initializer=_settle_worker) as pool:
        futures = []
        try:
            for job in jobs:
                futures.append(pool.submit(_attempt, job))
        except BrokenProcessPool:
            pass
        try:
            for job, future in zip_longest(jobs, futures):
                try:
                    outcome = future.result() if future else None
                except BrokenProcessPool:
                    outcome = None
                yield job, outcome
        finally:
            for future in futures:
                future.cancel()


def _settle_worker() -> None:
    """Let Ctrl-C end a worker without a traceback, but with its half-written file removed; one thread will do."""
    from .parts import limit_threads

    signal.signal(signal.SIGINT, lambda number, frame: sys.exit(130))
    limit_threads(1)


def _processors() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _attempt(job: Job, tell: Optional[Tell] = None) -> Outcome:
    """Do a job; whatever goes wrong becomes one line of text."""
    from .raster import ImageError

    try:
        return _run(job, tell)
    except (BrokenPipeError, ModuleNotFoundError):
        raise
    except ImageError as error:
        reason = str(error)
    except OSError as error:
        target = "standard output" if job.target == STANDARD else job.target
        reason = f"{target} can't be written: {error.strerror or error}"
    except MemoryError:
        reason = f"{job.source} needs more memory than there is"
    except Exception as error:  # A fault of ours; the other pictures shall not suffer.
        reason = f"{job.source}: unexpected {type(error).__name__}: {error}"
    return Outcome(job, " ".join(reason.split()))


def _run(job: Job, tell: Optional[Tell] = None) -> Outcome:
    watch = Stopwatch()

    def begin(stage: str, share: float) -> None:
        watch(stage)
        if tell:
            tell(job, stage, share)

    begin("start", 0)
    from .pipeline import trace
    from .raster import ImageError, load_image
    from .svg import encoded, save

    begin("reading", 0)
    image = load_image(_standard_input() if job.source == STANDARD else job.source)
    if STANDARD not in job[:2] and os.path.exists(job.target) and os.path.samefile(job.source, job.target):
        raise ImageError(f"{job.target} is the picture itself: choose another output")
    if job.page:
        return _compare(job, image)
    drawing = trace(image, job.options, begin)
    begin("writing", 0.97)
    if job.target == STANDARD:
        sys.stdout.buffer.writelines(encoded(drawing))
        sys.stdout.buffer.flush()
    else:
        save(drawing, job.target)
    watch.stop()
    return Outcome(job, notes=drawing.notes, report=_report(job, image, drawing, watch))


def _standard_input() -> bytes:
    """What standard input holds, or the first part of it that is too much."""
    from .raster import MAX_BYTES, ImageError

    try:
        return sys.stdin.buffer.read(MAX_BYTES + 1)
    except OSError as error:
        raise ImageError(f"standard input can't be read: {error.strerror or error}") from None


def _report(job: Job, image: np.ndarray, drawing: Drawing, watch: Stopwatch) -> str:
    """What the job asks for besides the drawing: figures, timings, or both."""
    figures = None
    if job.report:
        from .report import report

        figures = report(image, job.options, drawing if job.options.result == "curves" else None, job.source)
    if "json" in (job.report, job.timings):
        import json

        data = figures.to_dict() if figures else {"picture": job.source}
        return json.dumps({**data, "timings": watch.to_dicts()} if job.timings else data)
    texts = [figures.to_text()] if figures else []
    if job.timings:
        texts += [watch.to_text()] if figures else [job.source, watch.to_text()]
    return "\n".join(texts)


def _compare(job: Job, image: np.ndarray) -> Outcome:
    from .compare import compare
    from .svg import write

    name = "standard input" if job.source == STANDARD else os.path.basename(job.source)
    page = compare(image, job.options, name).encode("utf-8")
    if job.target == STANDARD:
        sys.stdout.buffer.write(page)
        sys.stdout.buffer.flush()
    else:
        write(job.target, [page])
    return Outcome(job)
