# SPDX-License-Identifier: GPL-2.0-or-later
"""The settings of a trace: one field each, in units a person understands.

The command line, the dialog in Inkscape and the library all read this one list:
each field carries its help text, its range or its choices.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, replace
from typing import Any, Callable, Dict, List, Optional, Tuple

from .swatches import RGB, colours_of, palette_text


def _setting(default: Any, help: str, *, choices: Tuple[str, ...] = (), low: Optional[float] = None,
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
    >>> TraceOptions(palette=["#000", (255, 255, 255)]).palette
    '#000000 #ffffff'
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
        " anti-aliasing understood; where neighbouring colours differ by less than the threshold;"
        " in black and white; all that are equal, as in pixel art, which may be enlarged; or into"
        " areas that differ as much as possible, as for photographs",
        choices=("palette", "threshold", "black-white", "pixels", "areas"))
    threshold: float = _setting(
        4.0, "smallest difference between two colours that makes a border (regions=threshold)",
        low=0, high=100, unit="%")
    colors: int = _setting(
        0, "largest number of colours, 0 for as many as the picture has", low=0, high=256)
    palette: str = _setting(
        "", "the only colours to paint with, each area in the one that looks most like it: a list"
        " such as '#000 #fff #d22', or a GIMP palette")
    merge: float = _setting(
        0.0, "colours that look less different than this become one, in percent of the difference"
        " between black and white", low=0, high=100, unit="%")
    background: str = _setting(
        "keep", "what becomes of the colour that most of the picture's border has, where it is"
        " connected with the border", choices=("keep", "drop"))
    level: float = _setting(
        0.0, "how light a grey may be to become black, 0 to find the best threshold"
        " (regions=black-white)", low=0, high=100, unit="%")
    areas: int = _setting(
        0, "largest number of connected areas, those that stand out least being merged first; 0 for"
        " no limit", low=0, high=100000)
    gradients: str = _setting(
        "gradients", "what soft changes of colour become: gradients, where they explain an area and pay"
        " for their bytes; at most twelve bands of flat colours each; or one flat colour each",
        choices=("gradients", "bands", "flat"))
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
        "cubic", "kind of curve: few cubics within the tolerance; quadratics with the outline's"
        " points as control points; or none, but the edges of the pixels as they are",
        choices=("cubic", "quadratic", "crisp"))
    tolerance: float = _setting(
        0.2, "how far a curve may stray from the outline", low=0.02, high=10, unit="px")
    corner: float = _setting(
        30.0, "turn of the outline that counts as a corner", low=5, high=180, unit="degrees")
    suppression: int = _setting(
        0, "control points left out between two that are kept (curves=quadratic)", low=0, high=50)
    stacking: str = _setting(
        "stacked", "shapes continue under those in front of them, so that nothing shines through,"
        " or are cut out exactly", choices=("stacked", "cutout"))
    group: str = _setting(
        "none", "shapes of one colour one after the other, as a group, as far as that looks the same",
        choices=("none", "color"))
    decimals: int = _setting(
        -1, "digits after the point in path data, -1 to choose by the size of the picture", low=-1, high=6)
    work: int = _setting(
        20_000_000, "largest number of edge costs to compute while flipping", low=0, high=10**12)
    seconds: float = _setting(
        20.0, "longest time that a trace may take, about; what would take longer is traced at a lower"
        " resolution", low=0.1, high=3600, unit="s")
    megapixels: float = _setting(
        40.0, "largest picture to trace as it is, in millions of pixels; larger ones are traced at a"
        " lower resolution", low=0.01, high=1000)

    def __post_init__(self) -> None:
        object.__setattr__(self, "palette", palette_text(self.palette))
        for f in fields(TraceOptions):
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
        if name == AUTOMATIC:
            return Automatic(**changes, given=tuple(sorted(changes)))
        return replace(cls(**PRESETS[name]), **changes)

    @property
    def swatches(self) -> List[RGB]:
        """The colours of the `palette`."""
        return colours_of(self.palette)

    @property
    def threshold_levels(self) -> float:
        """The `threshold` as a distance between premultiplied colours of 0 to 255 per channel."""
        return self.threshold / 100 * 255 * math.sqrt(3)


@dataclass(frozen=True)
class Automatic(TraceOptions):
    """Settings whose preset is chosen by the look of the picture.

    What differs from the defaults wins over the preset, and what is named in `given` too.

    Attributes
    ----------
    given : tuple of str
        Settings that count though they may have their default value.
    """

    given: Tuple[str, ...] = ()

    def settled(self, name: str) -> TraceOptions:
        """The settings with a certain preset."""
        standard = TraceOptions()
        changes = {f.name: getattr(self, f.name) for f in fields(TraceOptions)}
        return TraceOptions.preset(name, **{
            setting: value for setting, value in changes.items()
            if setting in self.given or value != getattr(standard, setting)})


AUTOMATIC = "automatic"
"""The preset that stands for the one that suits the picture."""

PRESETS: Dict[str, Dict[str, Any]] = {
    AUTOMATIC: {},
    "clip-art": {},
    "logo": dict(colors=8, merge=6.0, speckle=8.0, tolerance=0.3),
    "line-art": dict(regions="black-white"),
    "pixel-art": dict(regions="pixels", curves="crisp"),
    "photo": dict(regions="areas", areas=2500, tolerance=0.8),
    "paper": dict(regions="threshold", cost="paper", flips="everywhere", positions="barycentres",
                  curves="quadratic", suppression=1),
}
"""Settings of each preset that differ from the default ones."""

PURPOSES: Dict[str, str] = {
    "automatic": "any picture: one of `clip-art`, `pixel-art`, `photo` by its look; the report says which and why",
    "clip-art": "drawings with flat or softly changing colours",
    "logo": "few clean colours, few nodes",
    "line-art": "ink on paper, drawn or scanned, in black and white",
    "pixel-art": "sprites and icons, each pixel a square, enlarged or not",
    "photo": "photographs, as a poster with a limited number of areas",
    "paper": "the method as it was published",
}
"""What each preset is for, in Markdown."""


def _check(name: str, value: Any, default: Any, meta: Any) -> None:
    if meta["choices"]:
        if value not in meta["choices"]:
            raise ValueError(f"{name} must be one of {', '.join(meta['choices'])}, not {value!r}")
        return
    if isinstance(default, str):
        return
    kinds = (int,) if isinstance(default, int) else (int, float)
    if isinstance(value, bool) or not isinstance(value, kinds):
        raise TypeError(f"{name} must be {_wanted(default, meta)}, not {value!r}")
    if not math.isfinite(value) or not meta["low"] <= value <= meta["high"]:
        raise ValueError(f"{name} must be {_between(meta)}, not {value}")


def _wanted(default: Any, meta: Any) -> str:
    return f"{'a whole number' if isinstance(default, int) else 'a number'} {_between(meta)}"


def _between(meta: Any) -> str:
    unit = f" {meta['unit']}" if meta["unit"] else ""
    return f"between {meta['low']:g} and {meta['high']:g}{unit}"


def reader(default: Any, meta: Any) -> Callable[[str], Any]:
    """What makes the value of a setting from text, for the argument parsers of the program and the extension."""
    def read(text: str) -> Any:
        try:
            return type(default)(text)
        except ValueError:
            from argparse import ArgumentTypeError

            raise ArgumentTypeError(f"must be {_wanted(default, meta)}, not {text!r}") from None

    # By this name inkex tells what kind of setting it is.
    read.__name__ = type(default).__name__
    return read
