# SPDX-License-Identifier: GPL-2.0-or-later
"""Soft ramps under the ripples of JPEG, the dots of dithering, or the grain of a scan.

No step is even there, and each ripple looks like a ramp or a thing drawn on one.  So the
picture is calmed first, and then ramps are what one gradient explains but for the ripples,
up to the edges beside them.  What is left has few flat colours, as in other noisy pictures.
"""

from __future__ import annotations

from dataclasses import replace
from typing import List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from .calm import calm
from .canvas import LUMA, RIM, Canvas, planes, within
from .components import mask_areas
from .growing import FIT, Surface, gradient_surface
from .noise import REDUCED, ROUNDING, UNSTEADY, noisy_colours, unlike, zigzags
from .palette import Plateaus, find_plateaus, known_labels
from .patches import find_patches
from .ramps import MANY, find_ramps
from .spans import renumber, spans_of
from .surfaces import AREA as CLEAN_PIECE
from .surfaces import extend, separate

GRAINY = 0.42
"""Share of those of three steps that only a grain makes, which is the same everywhere."""

RIPPLED, DITHERED = 1.4, 2.0
"""How much stronger than most are the ripples beside edges in a JPEG, and the dots of colours far apart in a GIF."""

FINE = 0.6
"""Pixels of a ramp in a scan differ from it by less than this share of the grain, as that was averaged away."""

SLOPING = 0.03
"""Smallest share of a picture's area that its ramps have, unless they are sure."""

SURE, FEW = 1.4, 0.002
"""How much more contrast in brightness than ripples sure ramps have, and their smallest share of a picture's area."""

BEND = 3.0
"""Largest change of the step from pixel to pixel on a ramp without most of its ripples, levels."""

LEFT = 3.0
"""How much less pixels vary there at least."""

PIECE = 128
"""Smaller pieces of a ramp go to the one that they touch if that explains them, too, px²."""

BLOCK = 4
"""Contrast is told for squares with this side, and ripples reach two of them beyond, px."""

STRONG = 192.0
"""Contrast with which ripples are strongest, levels of a channel."""

DOT, DOTS = 96.0, 3
"""What stands out more is no dot of dithering, levels; and the fewest dots in 5 x 5 pixels of an area with such."""

AREA = 64
"""Smallest ramp, px²."""

BETWEEN = 0.05
"""Least share of a ramp's pixels in the middle half of its contrast."""

FLAT = 256
"""A flat area of so many pixels is no part of the ramp beside it, px²."""

SPECK = 24.0
"""Regions smaller than this are ripples, px²."""

AMONG, MINGLED = 3, 0.7
"""Two hues of one colour have this share of the pixels of the rarer one so near to the other, px."""

_TURN = 2
_ASKED = 1 << 10
_ENDS = 2, 98


class Soft(NamedTuple):
    """A calmed picture and its soft ramps.

    Attributes
    ----------
    canvas : Canvas
    slopes : ndarray of shape (H, W) and dtype int16
        Number of the ramp of each pixel, -1 where there is none.
    surfaces : list of Surface
        One for each ramp.
    plateaus : Plateaus
        Those apart from the ramps.
    keys : ndarray of shape (K,) and dtype uint32
        The flat colours, packed.
    noise : float
        How far pixels of flat areas may be from their colour, levels.
    doubt : ndarray of shape (P,) and dtype float64
        How far each pixel may be from the colour of its ramp, levels.
    bled : Canvas, optional
        The picture as it came, if its hue may have bled over edges.
    grainy : bool
        Whether the ripples are the grain of a scan.
    """

    canvas: Canvas
    slopes: np.ndarray
    surfaces: List[Surface]
    plateaus: Plateaus
    keys: np.ndarray
    noise: float
    doubt: np.ndarray
    bled: Optional[Canvas]
    grainy: bool


def find_soft(canvas: Canvas, noise: float, margins: Optional[np.ndarray] = None) -> Optional[Soft]:
    """The ramps of a picture with ripples, most of them no stronger than `noise` levels, if it has both.

    How strong they are at most round each pixel, (P,), may be known already: its `margins`.
    """
    grainy = False
    if margins is None:
        if noise <= ROUNDING or zigzags(canvas, 4) < UNSTEADY:
            return None
        noise, margins, grainy = _margins(canvas, noise)
    even = _calmed(canvas, margins)
    known = _steep_ramps(even, margins, max(FIT, noise / LEFT), PIECE, 1.0, True)
    if known is None:
        return None
    slopes, surfaces, free = known
    surfaces = [_clipped(surface, 3 if canvas.opaque else 4, noise / 4) for surface in surfaces]
    extend(even, slopes, surfaces, free, canvas.bare(margins) * (FINE if grainy else 1))
    plateaus = find_plateaus(even, slopes >= 0)
    keys = _flat_colours(even, plateaus, slopes >= 0, noise, margins)
    bled = canvas if canvas.opaque and margins.min() < noise else None
    return Soft(even, slopes, surfaces, plateaus, keys, noise, margins / LEFT, bled, grainy)


def _beside_flat(slopes: np.ndarray, canvas: Canvas, count: int, margins: np.ndarray) -> Tuple[np.ndarray, int]:
    """Take flat areas out of the ramps that run into them, in place.

    Returns where they are, (H, W), and how many ramps there are then.
    """
    flat, rest = np.zeros(slopes.shape, bool), np.zeros(slopes.shape, bool)
    _, steep, _ = _steep(canvas, slopes, [None] * count, margins)
    for number, spans in enumerate(spans_of(slopes, count)):
        if spans.size < FLAT or steep[number]:
            continue
        cells = spans.every(1)
        inner = canvas.numbers(*np.divmod(cells, slopes.shape[1]))
        usual = np.median(canvas.colours(inner[::-(-inner.size // _ASKED)]), axis=1)
        near = np.abs(canvas.colours(inner) - usual[:, None]).max(axis=0) <= margins[inner] / LEFT
        if 2 * np.count_nonzero(near) >= near.size:
            flat.ravel()[cells[near]] = True
            rest.ravel()[cells[~near]] = True
    slopes[flat | rest] = -1
    areas = mask_areas(rest)
    large = np.flatnonzero(areas.size >= AREA)
    large = large[np.argsort(-areas.size[large], kind="stable")[:MANY]]
    given = np.full(areas.size.size, -1, slopes.dtype)
    given[large] = np.arange(count, count + large.size)
    areas.put(slopes.ravel(), given)
    return flat, count + large.size


def ramps_under(canvas: Canvas, margins: np.ndarray) -> Optional[Tuple[np.ndarray, List[Surface]]]:
    """The ramps (H, W) of a picture with ripples no stronger than some margins (P,), and their surfaces, if it has any.

    Beside its ripples the picture is clean.
    """
    even = _calmed(canvas, margins)
    known = _steep_ramps(even, margins, FIT, CLEAN_PIECE, 0.5, False)
    if known is None:
        return None
    slopes, surfaces, free = known
    extend(even, slopes, surfaces, free, np.maximum(FIT, canvas.bare(margins)))
    return slopes, surfaces


def _calmed(canvas: Canvas, margins: np.ndarray) -> Canvas:
    """The picture without most of its ripples."""
    return calm(calm(canvas, margins), margins / 2)


def _steep_ramps(canvas: Canvas, margins: np.ndarray, fit: float, piece: int, joint: float,
                 fading: bool) -> Optional[Tuple[np.ndarray, List[Surface], np.ndarray]]:
    """The ramps (H, W) of a calmed picture that ripples alone do not make, their surfaces, and where they may go on.

    None where they have too small a share of the picture.  They may be `fading` into flat areas.
    """
    slopes, count = find_ramps(canvas, BEND)
    slopes = slopes.copy()
    flat = np.zeros(slopes.shape, bool)
    if fading:
        flat, count = _beside_flat(slopes, canvas, count, margins)
    size, steep, sure = _steep(canvas, slopes, [None] * count, margins)
    if not _enough(size, steep, sure, slopes.size):
        return None
    flat |= np.append(~steep & (size >= FLAT), False)[slopes]
    renumber(slopes, _numbers(steep))
    slopes, surfaces = separate(canvas, slopes, int(steep.sum()), ~flat, fit, piece, joint)
    size, steep, sure = _steep(canvas, slopes, surfaces, margins)
    if not _enough(size, steep, sure, slopes.size):
        return None
    flat |= np.append(~steep & (size >= FLAT), False)[slopes]
    renumber(slopes, _numbers(steep))
    return slopes, [surfaces[number] for number in np.flatnonzero(steep)], ~flat


def _flat_colours(canvas: Canvas, plateaus: Plateaus, ramps: np.ndarray, noise: float,
                  margins: np.ndarray) -> np.ndarray:
    """The flat colours apart from the ramps (H, W), packed: where there are few ripples, nearly alike ones, too."""
    keys = noisy_colours(canvas, plateaus, noise, noise, ramps)
    rippled = ramps | (canvas.bare(margins) > noise / 2)
    more = noisy_colours(canvas, find_plateaus(canvas, rippled), noise / LEFT, noise, rippled)
    keys = np.array(unlike(canvas, np.append(keys, more), 2 * noise / LEFT), np.uint32)
    return np.append(keys, find_patches(canvas, keys, noise, ~ramps).keys)


def without_hue_twins(canvas: Canvas, plateaus: Plateaus, keys: np.ndarray, noise: float) -> np.ndarray:
    """The packed flat colours of a JPEG, of those that differ in hue alone and lie among each other only the mean."""
    colours = planes(keys, canvas.opaque)
    dark = LUMA.dot(colours[:3])
    off = np.abs(colours[:, :, None] - colours[:, None]).max(axis=0)
    twins = np.triu((np.abs(dark[:, None] - dark) <= noise / LEFT) & (off <= 2 * noise), 1)
    if not twins.any():
        return keys
    labels = canvas.bare(known_labels(canvas, plateaus, keys, noise))
    size = np.bincount(labels[labels >= 0], minlength=keys.size)
    kept = np.ones(keys.size, bool)
    for one, other in np.argwhere(twins).tolist():
        minor, major = sorted((one, other), key=lambda k: int(size[k]))
        near = within((labels == major)[None].astype(np.int8), AMONG, np.maximum)[0] > 0
        if kept[minor] and kept[major] and np.count_nonzero(near & (labels == minor)) > MINGLED * size[minor]:
            colours[:, major] = np.average(colours[:, [minor, major]], axis=1, weights=size[[minor, major]] + 1)
            size[major] += size[minor]
            kept[minor] = False
    rgba = np.full((keys.size, 4), 255, np.uint8)
    rgba[:, :len(colours)] = np.rint(colours.T)
    return np.asarray(rgba.view(np.uint32)[:, 0][kept])


def _margins(canvas: Canvas, noise: float) -> Tuple[float, np.ndarray, bool]:
    """How strong ripples are at most, and round each pixel (P,), levels; and whether they are a grain.

    Most have `noise` levels.  A grain is the same everywhere.
    """
    if zigzags(canvas, 3) > GRAINY:
        return noise, np.full(canvas.keys.size, noise), True
    if np.unique(canvas.keys).size <= REDUCED:
        return DITHERED * noise, np.maximum(_of_dots(canvas), DITHERED * noise), False
    return RIPPLED * noise, _beside_edges(canvas, RIPPLED * noise), False


def _of_dots(canvas: Canvas) -> np.ndarray:
    """How much the dots of dithering stand out round each pixel (P,), 0 where there are none.

    A dot is darker, or lighter, than the four pixels beside it.
    """
    values = planes(canvas.keys.reshape(-1, canvas.stride), canvas.opaque)
    here = values[:, 1:-1, 1:-1]
    off = np.stack([values[:, :-2, 1:-1], values[:, 2:, 1:-1], values[:, 1:-1, :-2], values[:, 1:-1, 2:]]) - here
    dot = (off.min(axis=0) >= _TURN) | (off.max(axis=0) <= -_TURN)
    height = (np.abs(off).max(axis=0) * dot).max(axis=0)
    height[height > DOT] = 0
    height = np.pad(height, 1, mode="constant")
    several = within((height > 0)[None].astype(np.int8), 2, np.add)[0] >= DOTS
    return np.asarray((within(height[None], 2, np.maximum)[0] * several).ravel())


def _beside_edges(canvas: Canvas, noise: float) -> np.ndarray:
    """How strong the ripples of a JPEG may be round each pixel, of which the strongest have `noise` levels, (P,).

    They are the stronger, the more contrast there is near them.
    """
    values = planes(canvas.bare(canvas.keys), canvas.opaque)
    rims = [(0, -size % BLOCK) for size in canvas.shape]
    values = np.pad(values, [(0, 0), *rims], mode="edge")
    blocks = values.reshape(len(values), values.shape[1] // BLOCK, BLOCK, -1, BLOCK)
    high, low = (within(extreme.reduce(blocks, axis=(2, 4)), 2, extreme) for extreme in (np.maximum, np.minimum))
    span = (high - low).max(axis=0)
    margin = noise * np.minimum(1 / LEFT + (1 - 1 / LEFT) / STRONG * span, 1)
    margin = margin.repeat(BLOCK, axis=0).repeat(BLOCK, axis=1)
    return np.pad(margin[:canvas.shape[0], :canvas.shape[1]], RIM, mode="edge").ravel()


def _steep(canvas: Canvas, slopes: np.ndarray, surfaces: Sequence[Optional[Surface]],
           margins: np.ndarray) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Sizes of some ramps, which of them are large and have more contrast than ripples alone, and which surely so.

    The contrast is that of their surfaces, which have to be gradients, where they are known.
    """
    size = np.zeros(len(surfaces), np.int64)
    steep, sure = np.zeros((2, len(surfaces)), bool)
    for number, (spans, surface) in enumerate(zip(spans_of(slopes, len(surfaces)), surfaces)):
        size[number] = spans.size
        if spans.size >= AREA and (surface is None or surface.gradient):
            row, col = np.divmod(spans.every(-(-spans.size // _ASKED)), slopes.shape[1])
            cells = canvas.numbers(row, col)
            colour = surface.colours(np.stack([col, row], axis=1) + 0.5).T if surface else canvas.colours(cells)
            low, high = np.percentile(colour, _ENDS, axis=1)
            most = int(np.argmax(high - low))
            share = (colour[most] - low[most]) / max(high[most] - low[most], 1.0)
            # Two flat colours have next to nothing between them.
            between = np.mean(np.abs(share - 0.5) < 0.25)
            dark, bright = np.percentile(LUMA @ colour[:3], _ENDS)
            margin = margins[cells].mean()
            steep[number] = high[most] - low[most] >= margin and between >= BETWEEN
            # It is the hue that JPEG moves most.
            sure[number] = steep[number] and bright - dark >= SURE * margin
    return size, steep, sure


def _enough(size: np.ndarray, steep: np.ndarray, sure: np.ndarray, area: int) -> bool:
    """Whether ramps have a large enough share of a picture's area."""
    return bool(size[steep].sum() >= SLOPING * area or size[sure].sum() >= FEW * area)


def _clipped(surface: Surface, channels: int, margin: float) -> Surface:
    """A surface with channels of its stops at 0 or 255 that are nearly so: noise moves them away from there only."""
    gradient = surface.gradient
    if gradient is None:
        return surface

    def clipped(level: int) -> int:
        return 0 if level <= margin else 255 if level >= 255 - margin else level

    stops = tuple((offset, (clipped(red), clipped(green), clipped(blue)), opacity)
                  for offset, (red, green, blue), opacity in gradient.stops)
    return gradient_surface(replace(gradient, stops=stops), channels)


def _numbers(kept: np.ndarray) -> np.ndarray:
    """Numbers of the ramps that are kept, -1 for the others, and for pixels that belong to none."""
    return np.append(np.where(kept, np.cumsum(kept) - 1, -1), -1).astype(np.int32)
