# SPDX-License-Identifier: GPL-2.0-or-later
"""The settings of the dialog: those of `TraceOptions`, a preset, and what becomes of the picture.

Inkscape takes whatever is in a field for files for a path, so a palette has two fields.
"""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from dataclasses import fields
from typing import Any, Dict

from ..options import PRESETS, TraceOptions, reader

SOURCE_CHOICES = ("keep", "hide", "remove")
"""What can become of the picture that was traced; the first is the default."""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare one argument for each setting of ``ddt_trace.inx``.

    Parameters
    ----------
    parser : ArgumentParser
    """
    parser.add_argument("--tab", type=str, help="page of the dialog; no setting")
    parser.add_argument("--preset", type=str, default=next(iter(PRESETS)), choices=tuple(PRESETS),
                        help="what the settings left at their default stand for")
    for setting in fields(TraceOptions):
        parser.add_argument("--" + setting.name, default=setting.default,
                            type=reader(setting.default, setting.metadata),
                            choices=setting.metadata["choices"] or None, help=_help(setting.metadata))
    parser.add_argument("--palette_file", type=str, default="",
                        help="the file of a palette, in place of a palette")
    parser.add_argument("--source", type=str, default=SOURCE_CHOICES[0], choices=SOURCE_CHOICES,
                        help="what becomes of the picture itself")


def trace_options(chosen: Namespace) -> TraceOptions:
    """The options of a trace: those of the preset, except where a setting was changed.

    Parameters
    ----------
    chosen : Namespace
        Parsed arguments.

    Returns
    -------
    TraceOptions

    Raises
    ------
    ValueError, TypeError
        A setting is out of its range.

    Notes
    -----
    The dialog knows nothing of presets and always passes every setting, so one that
    still has its default value follows the preset.
    """
    return TraceOptions.preset(chosen.preset, **changes(vars(chosen)))


def changes(values: Dict[str, Any]) -> Dict[str, Any]:
    """Those settings of a trace among `values` that differ from their default.

    Parameters
    ----------
    values : dict
        The file of a palette among them stands for the palette if there is none.

    Returns
    -------
    dict
    """
    standard = TraceOptions()
    values = {**values, "palette": values["palette"] or values["palette_file"]}
    return {setting.name: values[setting.name] for setting in fields(TraceOptions)
            if values[setting.name] != getattr(standard, setting.name)}


def _help(meta: Any) -> str:
    unit = f" ({meta['unit']})" if meta["unit"] else ""
    return f"{meta['help']}{unit}".replace("%", "%%")
