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
from dataclasses import fields
from typing import Any, Dict, List, NoReturn, Optional, Sequence

from . import __version__
from .files import STANDARD, Job, default_target, run_all
from .options import PRESETS, TraceOptions

_INTERRUPTED = 130

_GROUPS = {
    "what to draw": ("result", "stacking", "decimals"),
    "colours and regions": ("regions", "threshold", "colors", "speckle"),
    "triangulation": ("cost", "flips", "work"),
    "outlines and curves": ("positions", "curves", "tolerance", "corner", "suppression"),
}
"""Settings by heading of the help; those named nowhere come under the last one."""

_OTHERS = "more settings"

_UNITS = {"px": "PX", "px²": "AREA", "%": "PERCENT", "degrees": "DEGREES"}

_EXAMPLES = """\
examples:
  %(prog)s picture.png                    writes picture.svg
  %(prog)s picture.png -o drawing.svgz    compressed
  %(prog)s *.png --out-dir traced         many pictures
  %(prog)s scan.jpg --colors 8 --speckle 20
  %(prog)s picture.png --preset paper --report
  cat picture.png | %(prog)s - > drawing.svg

exit status: 0 if all went well, 1 if a picture failed, 2 on bad usage."""


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
    try:
        return _run(_parser(), arguments)
    except KeyboardInterrupt:
        return _INTERRUPTED
    except BrokenPipeError:
        # The reader has what it wanted.  Without this Python would complain when it flushes at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0


def _run(parser: _Parser, arguments: Optional[Sequence[str]]) -> int:
    parsed, unknown = parser.parse_known_args(arguments)
    _refuse_unknown(parser, unknown)
    jobs = _jobs(parser, parsed)
    if not sys.warnoptions:
        warnings.simplefilter("ignore")
    failed = 0
    for outcome in run_all(jobs, parsed.jobs):
        if outcome.error:
            failed += 1
            _say(parser, outcome.error)
        elif not parsed.quiet:
            for note in outcome.notes:
                _say(parser, f"{outcome.job.source}: {note}")
        if outcome.report:
            to_error = outcome.job.target == STANDARD
            print(outcome.report, file=sys.stderr if to_error else sys.stdout, flush=True)
    if len(jobs) > 1 and not parsed.quiet:
        _say(parser, f"{len(jobs) - failed} of {len(jobs)} pictures traced, {failed} failed")
    return 1 if failed else 0


def _say(parser: _Parser, text: str) -> None:
    print(f"{parser.prog}: {text}", file=sys.stderr, flush=True)


def _parser() -> _Parser:
    program = os.path.basename(sys.argv[0])
    parser = _Parser(
        prog="python3 -m ddtcore" if program == "__main__.py" else program,
        usage="%(prog)s [options] PICTURE...", allow_abbrev=False, add_help=False,
        description="Trace clip-art bitmaps into SVG: areas of colour bounded by Bezier curves.",
        epilog=_EXAMPLES, formatter_class=argparse.RawDescriptionHelpFormatter)
    files = parser.add_argument_group("files")
    files.add_argument("pictures", metavar="PICTURE", nargs="*",
                       help="bitmap of any kind that Pillow reads, - for standard input")
    files.add_argument("-o", "--output", metavar="FILE",
                       help="drawing, .svg or .svgz, - for standard output (default: beside the picture)")
    files.add_argument("--out-dir", metavar="FOLDER", help="folder for the drawings, made if it is missing")
    files.add_argument("--jobs", metavar="N", type=int, default=1,
                       help="pictures to trace at a time, 0 for one per processor (default: 1)")
    say = parser.add_argument_group("what to say")
    say.add_argument("--report", action="store_true",
                     help="print sizes of the bitmap, the triangles and the curves, ratios and counts")
    say.add_argument("--json", action="store_true", help="the report as JSON, one line per picture")
    say.add_argument("-q", "--quiet", action="store_true", help="print errors only")
    say.add_argument("--version", action="version", version=f"DDT Trace {__version__}")
    say.add_argument("-h", "--help", action="help", help="print this and end")
    _add_settings(parser)
    return parser


def _add_settings(parser: _Parser) -> None:
    settings = {field.name: field for field in fields(TraceOptions)}
    grouped = {name: title for title, names in _GROUPS.items() for name in names}
    groups: Dict[str, Any] = {title: parser.add_argument_group(title) for title in _GROUPS}
    groups["what to draw"].add_argument(
        "--preset", metavar="NAME", default=next(iter(PRESETS)),
        help=f"settings to start from: {', '.join(PRESETS)} (default: %(default)s)")
    for name, setting in settings.items():
        title = grouped.get(name, _OTHERS)
        if title not in groups:
            groups[title] = parser.add_argument_group(title)
        _add_setting(groups[title], name, setting.default, setting.metadata)


def _add_setting(group: Any, name: str, default: Any, meta: Any) -> None:
    if meta["choices"]:
        values, metavar = ", ".join(meta["choices"]), "NAME"
    else:
        values, metavar = f"{meta['low']:.15g} to {meta['high']:.15g}", _UNITS.get(meta["unit"], "N")
    shown = default if isinstance(default, str) else f"{default:.15g}"
    group.add_argument(
        _flag(name), dest=name, metavar=metavar, type=type(default), default=argparse.SUPPRESS,
        help=f"{meta['help']}: {values} (default: {shown})".replace("%", "%%"))


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


def _options(parser: _Parser, parsed: argparse.Namespace) -> TraceOptions:
    given = {field.name: getattr(parsed, field.name)
             for field in fields(TraceOptions) if hasattr(parsed, field.name)}
    try:
        return TraceOptions.preset(parsed.preset, **given)
    except ValueError as error:
        name, _, rest = str(error).partition(" ")
        parser.error(f"{_flag(name)} {rest}")


def _jobs(parser: _Parser, parsed: argparse.Namespace) -> List[Job]:
    """What is to be done; refuses arguments that contradict each other."""
    pictures, output, folder = parsed.pictures, parsed.output, parsed.out_dir
    options = _options(parser, parsed)
    if not pictures:
        parser.error("no picture given")
    if parsed.jobs < 0:
        parser.error(f"--jobs must be 0 or more, not {parsed.jobs}")
    if len(pictures) > 1 and (output is not None or STANDARD in pictures):
        parser.error("-o and - are for one picture; --out-dir takes many")
    if output is not None and folder:
        parser.error("-o and --out-dir exclude each other")
    if output not in (None, STANDARD) and not _can_hold_svg(output):
        parser.error(f"-o must end in .svg or .svgz, not {output!r}")
    if folder:
        try:
            os.makedirs(folder, exist_ok=True)
        except OSError as error:
            parser.error(f"--out-dir {folder!r} can't be made: {error.strerror}")
    reports = "json" if parsed.json else "text" if parsed.report else ""
    jobs = [Job(picture, output or (STANDARD if picture == STANDARD else default_target(picture, folder)),
                options, reports) for picture in pictures]
    _refuse_collisions(parser, jobs)
    return jobs


def _can_hold_svg(output: str) -> bool:
    is_device = os.path.exists(output) and not os.path.isfile(output) and not os.path.isdir(output)
    return is_device or output.lower().endswith((".svg", ".svgz"))


def _refuse_collisions(parser: _Parser, jobs: Sequence[Job]) -> None:
    sources: Dict[str, str] = {}
    for job in jobs:
        target = os.path.normcase(os.path.abspath(job.target))
        if target in sources:
            parser.error(f"{sources[target]} and {job.source} would both become {job.target}")
        sources[target] = job.source
