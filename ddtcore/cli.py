# SPDX-License-Identifier: GPL-2.0-or-later
"""The command line: arguments in, jobs out, one line for whatever goes wrong.

Exit codes: 0 all went well, 1 a picture failed, 2 bad usage, 130 interrupted.
numpy isn't loaded before there is a picture to trace.
"""

from __future__ import annotations

import argparse
import os
import sys
import warnings
from contextlib import suppress
from dataclasses import fields
from typing import Any, Dict, Iterator, List, NoReturn, Optional, Sequence, Tuple

from . import __version__
from .files import STANDARD, Job, Outcome, default_target, run_all
from .options import PRESETS, PURPOSES, TraceOptions, reader
from .progress import ProgressLine

_INTERRUPTED = 130

_GROUPS = {
    "what to draw": ("result", "stacking", "group", "decimals"),
    "colours and regions": ("colors", "palette", "merge", "background", "gradients", "speckle", "areas",
                            "regions", "threshold", "level"),
    "outlines and curves": ("tolerance", "corner", "curves", "positions", "suppression"),
    "triangulation": ("flips", "cost"),
    "limits": ("seconds", "megapixels", "work"),
}
"""Settings by heading of the help; those named nowhere come under the last one."""

_OTHERS = "more settings"

_UNITS = {"px": "PX", "px²": "AREA", "%": "PERCENT", "degrees": "DEGREES", "s": "SECONDS"}

_EXAMPLES = """\
examples:
  %(prog)s picture.png                 picture.svg beside it
  %(prog)s picture.png -o drawing.svgz
  %(prog)s *.png --out-dir traced      many pictures
  %(prog)s scan.jpg --colors 8 --speckle 20
  %(prog)s picture.png --preset paper --report
  %(prog)s - < picture.png > drawing.svg
  %(prog)s compare picture.png         a page: both, side by side

exit status: 0 if all went well, 1 if a picture failed, 2 on bad usage,
130 if interrupted."""

_ABOUT = "Trace clip-art bitmaps into SVG: areas of colour bounded by Bezier curves."

_COMPARE = "compare"

_COMPARE_USAGE = f"\n       %(prog)s {_COMPARE} [options] PICTURE..."

_COMPARE_ABOUT = """\
Write an HTML page that shows a picture and its trace under a divider, with the
stages of the method, the report, and the same at three settings."""

_COMPARE_EXAMPLES = """\
examples:
  %(prog)s picture.png                 writes picture.html
  %(prog)s picture.png -o page.html
  %(prog)s *.png --out-dir pages
  %(prog)s scan.jpg --colors 8 --speckle 20

The page needs no network: open it in any browser, or send it to somebody.
A picture with the name "compare" is traced as ./compare."""


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message} (--help lists the options)\n")


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """Run the command line.

    Parameters
    ----------
    arguments : sequence of str, optional
        ``sys.argv[1:]`` if left out.

    Returns
    -------
    int
        Exit code.
    """
    _fill_gaps()
    # The matrices here are small: threads for them only get into each other's way.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    words = list(sys.argv[1:] if arguments is None else arguments)
    page = words[:1] == [_COMPARE]
    try:
        return _run(_parser(page), words[page:], page)
    except KeyboardInterrupt:
        return _INTERRUPTED
    except ModuleNotFoundError as error:
        if error.name not in ("numpy", "PIL"):
            raise
        print(f"{_program()}: {error.name} is not installed; get it by {sys.executable} -m pip install numpy"
              " pillow, or on Debian and Ubuntu by apt-get install python3-numpy python3-pil", file=sys.stderr)
        return 1
    except BrokenPipeError:
        # The reader has what it wanted.
        return 0
    finally:
        _let_go()


def _fill_gaps() -> None:
    """Put something in place of standard streams that were closed: else a file of ours would take the place."""
    for name, mode, way in (("stdin", "r", os.O_WRONLY), ("stdout", "w", os.O_RDONLY), ("stderr", "w", os.O_WRONLY)):
        if getattr(sys, name) is None:
            # The wrong way for the first two: who reads or writes shall hear that it is of no use.
            setattr(sys, name, os.fdopen(os.open(os.devnull, way), mode, closefd=False))


def _let_go() -> None:
    """Forget what nobody can take: Python would complain about it when it flushes at exit."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except OSError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def _run(parser: _Parser, arguments: Sequence[str], page: bool) -> int:
    parsed, unknown = parser.parse_known_args(arguments)
    _refuse_unknown(parser, unknown)
    jobs = _jobs(parser, parsed, page)
    if not sys.warnoptions:
        warnings.simplefilter("ignore")
    outcomes = _outcomes(jobs, parsed.jobs, show=not parsed.quiet and sys.stderr.isatty())
    failed = sum(_tell(parser, outcome, parsed.quiet) for outcome in outcomes)
    if len(jobs) > 1 and not parsed.quiet:
        _say(parser, f"{len(jobs) - failed} of {len(jobs)} pictures traced, {failed} failed")
    return 1 if failed else 0


def _outcomes(jobs: Sequence[Job], workers: int, show: bool) -> Iterator[Outcome]:
    """Do all jobs; meanwhile the last line of the terminal says how far they are."""
    line, done = ProgressLine(sys.stderr), 0

    def tell(job: Job, stage: str, share: float) -> None:
        number = f"{done + 1} of {len(jobs)}, " if len(jobs) > 1 else ""
        line.show(f"{number}{job.source}: {stage}, {share:.0%}")

    try:
        for outcome in run_all(jobs, workers, tell if show else None):
            line.clear()
            yield outcome
            done += 1
            if show and done < len(jobs):
                line.show(f"{done} of {len(jobs)} done")
    finally:
        line.clear()


def _tell(parser: _Parser, outcome: Outcome, quiet: bool) -> bool:
    """Say what came of a job; returns whether it failed."""
    if outcome.error:
        _say(parser, outcome.error)
    elif not quiet:
        for note in outcome.notes:
            _say(parser, f"{outcome.job.source}: {note}")
    if outcome.report:
        return _print_report(parser, outcome)
    return bool(outcome.error)


def _print_report(parser: _Parser, outcome: Outcome) -> bool:
    """Print what a job is to report; returns whether that failed."""
    try:
        print(outcome.report, file=sys.stderr if outcome.job.target == STANDARD else sys.stdout, flush=True)
    except BrokenPipeError:
        pass  # The reader has what it wanted; the other drawings are wanted all the same.
    except OSError as error:
        _say(parser, f"{outcome.job.source}: the report can't be written: {error.strerror}")
        return True
    return False


def _say(parser: _Parser, text: str) -> None:
    # That nobody hears it must not cost a picture.
    with suppress(OSError):
        print(f"{parser.prog}: {text}", file=sys.stderr, flush=True)


def _program() -> str:
    program = os.path.basename(sys.argv[0])
    return "python3 -m ddtcore" if program == "__main__.py" else program


def _parser(page: bool = False) -> _Parser:
    program = _program()
    parser = _Parser(
        prog=f"{program} {_COMPARE}" if page else program,
        usage=f"%(prog)s [options] PICTURE...{'' if page else _COMPARE_USAGE}", allow_abbrev=False, add_help=False,
        description=_COMPARE_ABOUT if page else _ABOUT,
        epilog=f"{_presets()}\n\n{_COMPARE_EXAMPLES if page else _EXAMPLES}",
        formatter_class=argparse.RawDescriptionHelpFormatter)
    files = parser.add_argument_group("files")
    files.add_argument("pictures", metavar="PICTURE", nargs="*",
                       help="bitmap of any kind that Pillow reads, - for standard input")
    files.add_argument("-o", "--output", metavar="FILE",
                       help=f"{'page, .html' if page else 'drawing, .svg or .svgz'}, - for standard output"
                       " (default: beside the picture)")
    files.add_argument("--out-dir", metavar="FOLDER",
                       help=f"folder for the {'pages' if page else 'drawings'}, made if it is missing")
    files.add_argument("--jobs", metavar="N", type=int, default=1,
                       help="pictures to trace at a time, 0 for one per processor (default: 1)")
    say = parser.add_argument_group("what to say")
    if page:
        parser.set_defaults(report=False, timings=False, json=False)
    else:
        say.add_argument("--report", action="store_true",
                         help="print sizes of the bitmap, the triangles and the curves, ratios and counts")
        say.add_argument("--timings", action="store_true",
                         help="print how long each stage took, and the most memory used by then")
        say.add_argument("--json", action="store_true",
                         help="the report, or the timings, or both, as JSON: one line per picture")
    say.add_argument("-q", "--quiet", action="store_true", help="print errors only")
    say.add_argument("--version", action="version", version=f"DDT Trace {__version__}",
                     help="print the version and end")
    say.add_argument("-h", "--help", action="help", help="print this and end")
    _add_settings(parser)
    return parser


def _presets() -> str:
    """What presets are for, as a section of the help."""
    from textwrap import wrap

    indent = " " * (4 + max(map(len, PURPOSES)))
    lines = (f"  {name}".ljust(len(indent)) + purpose.replace("`", "") for name, purpose in PURPOSES.items())
    return "\n".join(["presets:", *(part for line in lines for part in wrap(line, 79, subsequent_indent=indent))])


def _add_settings(parser: _Parser) -> None:
    settings = {field.name: field for field in fields(TraceOptions)}
    named = {name for names in _GROUPS.values() for name in names}
    others = tuple(name for name in settings if name not in named)
    for title, names in [*_GROUPS.items(), (_OTHERS, others)]:
        group = parser.add_argument_group(title)
        if title == "what to draw":
            group.add_argument("--preset", metavar="NAME", default=next(iter(PRESETS)),
                               help="settings to start from, see below; what you set yourself wins"
                               " (default: %(default)s)")
        for name in names:
            _add_setting(group, name, settings[name].default, settings[name].metadata)


def _add_setting(group: Any, name: str, default: Any, meta: Any) -> None:
    if meta["choices"]:
        values, metavar = ", ".join(meta["choices"]), "NAME"
    elif isinstance(default, str):
        values, metavar = "colours or a .gpl file", "COLOURS"
    else:
        values, metavar = f"{meta['low']:.15g} to {meta['high']:.15g}", _UNITS.get(meta["unit"], "N")
    shown = default or "none" if isinstance(default, str) else f"{default:.15g}"
    group.add_argument(
        _flag(name), dest=name, metavar=metavar, type=reader(default, meta), default=argparse.SUPPRESS,
        help=f"{meta['help']} ({values}; default: {shown})".replace("%", "%%"))


def _flag(name: str) -> str:
    return "--" + name.replace("_", "-")


def _refuse_unknown(parser: _Parser, unknown: List[str]) -> None:
    if not unknown:
        return
    from difflib import get_close_matches

    mistyped = unknown[0].split("=")[0]
    flags = [flag for action in parser._actions for flag in action.option_strings]
    close = get_close_matches(mistyped, flags, n=1)
    parser.error(f"there is no option {mistyped}" + (f"; did you mean {close[0]}?" if close else ""))


def _refuse_mistyped_command(parser: _Parser, word: str) -> None:
    from difflib import get_close_matches

    if not os.path.exists(word) and get_close_matches(word, [_COMPARE]):
        parser.error(f"there is no picture or command {word}; did you mean {_COMPARE}?")


def _options(parser: _Parser, parsed: argparse.Namespace) -> TraceOptions:
    given = {field.name: getattr(parsed, field.name)
             for field in fields(TraceOptions) if hasattr(parsed, field.name)}
    try:
        return TraceOptions.preset(parsed.preset, **given)
    except (TypeError, ValueError) as error:
        name, _, rest = str(error).partition(" ")
        parser.error(f"{_flag(name)} {rest}")


def _jobs(parser: _Parser, parsed: argparse.Namespace, page: bool) -> List[Job]:
    """What is to be done; refuses arguments that contradict each other."""
    pictures, output, folder = parsed.pictures, parsed.output, parsed.out_dir
    options = _options(parser, parsed)
    if not pictures:
        parser.error("no picture given")
    _refuse_mistyped_command(parser, pictures[0])
    if parsed.jobs < 0:
        parser.error(f"--jobs must be 0 or more, not {parsed.jobs}")
    if len(pictures) > 1 and (output is not None or STANDARD in pictures):
        parser.error("-o and - are for one picture; --out-dir takes many")
    if output is not None and folder:
        parser.error("-o and --out-dir exclude each other")
    endings = (".html", ".htm") if page else (".svg", ".svgz")
    if output not in (None, STANDARD) and not _can_hold(output, endings):
        parser.error(f"-o must end in {' or '.join(endings)}, not {output!r}")
    if folder:
        try:
            os.makedirs(folder, exist_ok=True)
        except OSError as error:
            parser.error(f"--out-dir {folder!r} can't be made: {error.strerror}")
    form = "json" if parsed.json else "text"
    report = form if parsed.report or (parsed.json and not parsed.timings) else ""
    timings = form if parsed.timings else ""
    jobs = [Job(picture, output or (STANDARD if picture == STANDARD
                                    else default_target(picture, folder, endings[0])),
                options, report, timings, page) for picture in pictures]
    _refuse_collisions(parser, jobs)
    return jobs


def _can_hold(output: str, endings: Tuple[str, ...]) -> bool:
    is_device = os.path.exists(output) and not os.path.isfile(output) and not os.path.isdir(output)
    return is_device or output.lower().endswith(endings)


def _refuse_collisions(parser: _Parser, jobs: Sequence[Job]) -> None:
    sources: Dict[str, str] = {}
    for job in jobs:
        target = os.path.normcase(os.path.abspath(job.target))
        if target in sources:
            parser.error(f"{sources[target]} and {job.source} would both become {job.target}")
        sources[target] = job.source
