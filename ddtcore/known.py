# SPDX-License-Identifier: GPL-2.0-or-later
"""What is known of a picture before its strokes and edges are labelled: flat colours, ramps, how much pixels vary.

Which of these tells the most depends on how the picture came: clean, made smaller or larger,
as a JPEG, with its colours reduced, or scanned.
"""

from __future__ import annotations

from dataclasses import replace
from typing import List, NamedTuple, Optional, Tuple

import numpy as np

from . import banded, bleeding, detached, dither, glazes, overlays, palette, patches, ramps, ringing, surfaces, unsteady
from .calm import LEFT
from .canvas import Canvas, planes, within
from .growing import Surface
from .noise import ROUNDING, SPECK, STRONGEST, noise_level, noisy_colours, ripple_level, unlike
from .ridges import find_ridges
from .strokeinks import TWIN, new_colours


class Known(NamedTuple):
    """What is known of a picture before the pixels between its flat areas and ramps are labelled."""

    canvas: Canvas
    slopes: np.ndarray
    found: List[Optional[Surface]]
    plateaus: palette.Plateaus
    keys: np.ndarray
    noise: float             # how far pixels may be from their colour, levels
    doubt: float             # the same for pixels on edges
    rippled: bool
    speck: float             # regions smaller than this are ripples, px²
    clear: Optional[Canvas]  # the picture as edges are to be told from it, if that is not as it came
    even: Canvas             # the picture as flat areas tell their colours
    soft: Optional[unsteady.Soft] = None  # its soft ramps, if they were found under ripples


def know(canvas: Canvas, grain: float) -> Known:
    """Find the flat colours and soft ramps of a picture, without its ripples if it has such."""
    even = canvas
    slopes, count = ramps.find_ramps(canvas)
    found: List[Optional[Surface]] = [None] * count
    plateaus = palette.find_plateaus(canvas, slopes >= 0)
    dithered = None if grain else dither.undithered(canvas, plateaus.core)
    if dithered:
        return know_dithered(*dithered)
    bands = None if grain else banded.find_banded(canvas, plateaus.core | (slopes >= 0))
    if bands:
        return know_soft(bands)
    noise, rippled = (grain / LEFT, True) if grain else noise_level(canvas, plateaus.core, slopes)
    soft = unsteady.find_soft(canvas, ripple_level(canvas, plateaus.core)) if rippled and not grain else None
    if soft:
        return know_soft(soft)
    inks, clear, left, least = np.zeros(0, np.uint32), None, 1.0, SPECK
    rings = not grain and ringing.is_resized(canvas, plateaus.core | (slopes >= 0))
    near_edges = (rings or (noise > ROUNDING and not grain)) and ringing.is_ringing(canvas)
    known = _know_ringing(canvas) if count and (rings or near_edges) else None
    if known:
        return known
    if near_edges:
        (canvas, inks), noise, rippled = ringing.without_ringing(canvas), ringing.LEFT, True
        left, least = ringing.STROKES, ringing.SPECK
    plain = palette.plain_colours(canvas)
    if plain.size:
        noise, rippled, keys = ROUNDING, False, plain
    elif noise > ROUNDING:
        # The ramps are ripples of flat colours.
        slopes, found = ramps.no_ramps(canvas.shape), []
        plateaus = palette.find_plateaus(canvas, slopes >= 0)
        keys = _with_inks(canvas, noisy_colours(canvas, plateaus, noise, grain or noise), inks)
        keys = np.append(keys, patches.find_patches(canvas, keys, noise, ~plateaus.core).keys)
        if canvas.opaque and not grain and noise > ringing.LEFT:
            clear = canvas = bleeding.without_bleeding(canvas, keys, noise)
            left = bleeding.LEFT
    else:
        slopes, found, plateaus, inks = _surfaces(canvas, slopes, count, plateaus)
        keys = _with_inks(canvas, palette.choose_colours(canvas, plateaus, bool(found)), inks)
    return Known(canvas, slopes, found, plateaus, keys, noise, noise * left, rippled, least, clear, even)


def know_dithered(canvas: Canvas, dots: np.ndarray) -> Known:
    """The same of a picture without its dithering, whose dots were so far from it round each pixel (P,), levels."""
    soft = unsteady.find_soft(canvas, dither.SLOPING, np.maximum(dither.STRONGEST, dots / dither.LESS))
    return know_soft(soft) if soft else know(canvas, dither.LEFT * LEFT)


def know_soft(soft: unsteady.Soft) -> Known:
    """The same of a picture whose soft ramps were found under ripples."""
    canvas, slopes, found, plateaus, keys, noise, doubt, bled, grainy = soft
    if bled is not None:
        keys = unsteady.without_hue_twins(canvas, plateaus, keys, noise)
    labels = palette.known_labels(canvas, plateaus, keys, noise / unsteady.LEFT if grainy else noise)
    count, inks = overlays.add_drawn(canvas, slopes, found, keys, labels, doubt)
    plateaus, keys, clear = palette.find_plateaus(canvas, slopes >= 0), _with_inks(canvas, keys, inks), None
    if bled is not None:
        keys = np.append(keys, _stroke_colours(canvas, slopes, plateaus, keys, noise))
        drawn = canvas.rimmed(within((slopes >= len(found))[np.newaxis], 2, np.maximum)[0], False)
        clear = bleeding.without_bleeding(bled, keys, noise / unsteady.RIPPLED, slopes, found)
        clear = canvas = replace(canvas, keys=np.where(drawn, canvas.keys, clear.keys))
    return Known(canvas, slopes, [*found, *[None] * (count - len(found))], plateaus, keys,
                  noise, noise / (unsteady.LEFT if grainy else 2), True, unsteady.SPECK, clear, soft.canvas, soft)


def know_hatched(canvas: Canvas, inks: np.ndarray) -> Known:
    """The same of a hatched drawing, saved as JPEG, in a few packed inks, whose mixes all its pixels are."""
    clear = bleeding.without_bleeding(canvas, inks, STRONGEST)
    plateaus = palette.find_plateaus(clear, np.zeros(canvas.shape, bool))
    return Known(clear, ramps.no_ramps(canvas.shape), [], plateaus, inks, STRONGEST, STRONGEST * bleeding.LEFT,
                 True, SPECK, clear, canvas)


def _know_ringing(canvas: Canvas) -> Optional[Known]:
    """The same of a picture with soft ramps and with ripples beside its edges, unless these ramps are small."""
    soft = unsteady.ramps_under(canvas, ringing.margins(canvas))
    if soft is None:
        return None
    canvas, inks = ringing.without_ringing(canvas, *soft)
    slopes, count = ramps.find_ramps(canvas)
    noise = ringing.LEFT * ringing.STROKES
    slopes, found, plateaus, more = _surfaces(canvas, slopes, count, palette.find_plateaus(canvas, slopes >= 0), noise)
    keys = noisy_colours(canvas, plateaus, ringing.LEFT, ringing.LEFT, slopes >= 0)
    keys = np.append(keys, patches.find_patches(canvas, keys, ringing.LEFT, slopes < 0).keys)
    inks = np.array(unlike(canvas, np.append(inks, more), TWIN), np.uint32)
    keys = _with_inks(canvas, keys, inks)
    return Known(canvas, slopes, found, plateaus, keys, noise, noise, True, ringing.SPECK, None, canvas)


def _surfaces(canvas: Canvas, slopes: np.ndarray, count: int, plateaus: palette.Plateaus, rippled: float = 0.0
              ) -> Tuple[np.ndarray, List[Optional[Surface]], palette.Plateaus, np.ndarray]:
    """Ramps that one gradient each explains, with it, and what is drawn on them; plateaus left, and inks."""
    if not count:
        return slopes, [], plateaus, np.zeros(0, np.uint32)
    slopes, found = surfaces.separate(canvas, slopes, count, ~plateaus.core)
    plateaus = palette.find_plateaus(canvas, slopes >= 0)
    keys = overlays.flat_colours(canvas, plateaus)
    labels = palette.known_labels(canvas, plateaus, keys, ROUNDING)
    slopes, found = detached.join_detached(canvas, slopes, found, (slopes < 0) & (canvas.bare(labels) < 0))
    slopes, found, glazed = glazes.follow(canvas, slopes, found, plateaus)
    if glazed:
        plateaus = palette.find_plateaus(canvas, slopes >= 0)
        keys = overlays.flat_colours(canvas, plateaus)
        labels = palette.known_labels(canvas, plateaus, keys, ROUNDING)
    count, inks = overlays.add_drawn(canvas, slopes, found, keys, labels, rippled=rippled)
    return slopes, [*found, *[None] * (count - len(found))], palette.find_plateaus(canvas, slopes >= 0), inks


def _stroke_colours(canvas: Canvas, slopes: np.ndarray, plateaus: palette.Plateaus, keys: np.ndarray,
                    noise: float) -> np.ndarray:
    """Packed colours that only thin strokes have."""
    cells = canvas.cells(~plateaus.core & (slopes < 0))
    labels = palette.known_labels(canvas, plateaus, keys, noise)
    ridges = find_ridges(canvas, cells, noise / 2)
    return new_colours(canvas, cells, ridges, planes(keys, canvas.opaque), labels, noise / 2)


def _with_inks(canvas: Canvas, keys: np.ndarray, inks: np.ndarray) -> np.ndarray:
    """Flat colours, and the inks of strokes that are none of them."""
    known, more = planes(keys, canvas.opaque), planes(inks, canvas.opaque)
    off = np.abs(more[:, :, None] - known[:, None]).max(axis=0)
    return np.append(keys, inks[(off >= TWIN).all(axis=1)])
