# SPDX-License-Identifier: GPL-2.0-or-later
"""The settings of a trace: one field each, in units a person understands.

The command line, the dialog in Inkscape and the library all read this one list:
each field carries its help text, its range or its choices.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, replace
from typing import Any, Dict, Optional


def _setting(default: Any, help: str, *, choices: tuple = (), low: Optional[float] = None,
             high: Optional[float] = None, unit: str = "") -> Any:
    return field(default=default, metadata={
        "help": help, "choices": choices, "low": low, "high": high, "unit": unit})


@dataclass(frozen=True)
class TraceOptions:
    """Everything that can be set.  A value out of its range raises `ValueError`.

    Examples
    --------
    >>> TraceOptions(tolerance=0.5).tolerance
    0.5
    >>> TraceOptions.preset("paper").cost
    'paper'
    >>> TraceOptions(tolerance=-1)
    Traceback (most recent call last):
    ...
    ValueError: tolerance must be between 0.02 and 10 px, not -1
    """

    result: str = _setting(
        "curves", "which stage of the method to show",
        choices=("triangles", "border", "outlines", "curves"))
    regions: str = _setting(
        "palette", "how pixels are grouped into regions: by the flat colours of the picture, with"
        " anti-aliasing understood, or where neighbouring colours differ by less than the threshold",
        choices=("palette", "threshold"))
    threshold: float = _setting(
        4.0, "smallest difference between two colours that makes a border (regions=threshold)",
        low=0, high=100, unit="%")
    colors: int = _setting(
        0, "largest number of colours, 0 for as many as the picture has", low=0, high=256)
    speckle: float = _setting(
        0.0, "areas smaller than this are merged into their neighbour", low=0, high=10000, unit="px²")
    cost: str = _setting(
        "yu", "cost of a mesh edge: the exact one of Yu, Morse and Sederberg, or the paper's faster one",
        choices=("yu", "paper"))
    flips: str = _setting(
        "boundaries", "where mesh edges are flipped: at boundaries between regions only,"
        " or wherever the picture is not flat, with look-ahead",
        choices=("boundaries", "everywhere"))
    positions: str = _setting(
        "coverage", "where outlines run: where the anti-aliasing says, to a fraction of a pixel,"
        " or through the barycentres of the border triangles",
        choices=("coverage", "barycentres"))
    curves: str = _setting(
        "cubic", "kind of curve: few cubics within the tolerance, or quadratics with the outline's"
        " points as control points", choices=("cubic", "quadratic"))
    tolerance: float = _setting(
        0.2, "how far a curve may stray from the outline", low=0.02, high=10, unit="px")
    corner: float = _setting(
        30.0, "turn of the outline that counts as a corner", low=5, high=180, unit="degrees")
    suppression: int = _setting(
        0, "control points left out between two that are kept (curves=quadratic)", low=0, high=50)
    stacking: str = _setting(
        "stacked", "shapes continue under those in front of them, so that nothing shines through,"
        " or are cut out exactly", choices=("stacked", "cutout"))
    decimals: int = _setting(
        -1, "digits after the point in path data, -1 to choose by the size of the picture", low=-1, high=6)
    work: int = _setting(
        20_000_000, "largest number of edge costs to compute while flipping", low=0, high=10**12)

    def __post_init__(self) -> None:
        for f in fields(self):
            _check(f.name, getattr(self, f.name), f.default, f.metadata)

    @classmethod
    def preset(cls, name: str, **changes: Any) -> "TraceOptions":
        """The settings of a preset, with some of them changed.

        Parameters
        ----------
        name : str
            One of `PRESETS`.
        **changes
            Settings by name, which win over those of the preset.
        """
        if name not in PRESETS:
            raise ValueError(f"preset must be one of {', '.join(PRESETS)}, not {name!r}")
        return replace(cls(**PRESETS[name]), **changes)

    @property
    def threshold_levels(self) -> float:
        """The `threshold` as a distance between premultiplied colours of 0 to 255 per channel."""
        return self.threshold / 100 * 255 * math.sqrt(3)


PRESETS: Dict[str, Dict[str, Any]] = {
    "clip-art": {},
    "paper": dict(regions="threshold", cost="paper", flips="everywhere", positions="barycentres",
                  curves="quadratic", suppression=1),
}
"""Settings of each preset that differ from the default ones."""


def _check(name: str, value: Any, default: Any, meta: Any) -> None:
    if meta["choices"]:
        if value not in meta["choices"]:
            raise ValueError(f"{name} must be one of {', '.join(meta['choices'])}, not {value!r}")
        return
    kinds = (int,) if isinstance(default, int) else (int, float)
    if isinstance(value, bool) or not isinstance(value, kinds):
        kind = "a whole number" if kinds == (int,) else "a number"
        raise TypeError(f"{name} must be {kind}, not {value!r}")
    if not math.isfinite(value) or not meta["low"] <= value <= meta["high"]:
        unit = f" {meta['unit']}" if meta["unit"] else ""
        raise ValueError(f"{name} must be between {meta['low']:g} and {meta['high']:g}{unit}, not {value}")
