# SPDX-License-Identifier: GPL-2.0-or-later
"""Which flat colour each pixel belongs to: the stage before the mesh.

Flat art is plateaus of few colours, and anti-aliasing between them.  First come
the pixels that are sure (soft ramps, plateaus), then strokes too thin to have
plateaus, then every pixel in between goes to the nearer of its two sides.
"""

from __future__ import annotations

from dataclasses import replace
from typing import List, NamedTuple, Optional, Tuple

import numpy as np

from . import (
    areas,
    banded,
    bleeding,
    detached,
    dither,
    filling,
    glazes,
    merging,
    overlays,
    palette,
    ramps,
    regained,
    ringing,
    scraps,
    spots,
    strokes,
    surfaces,
    uneven,
    unsteady,
)
from .calm import LEFT, without_grain
from .canvas import Canvas, mean_colours, planes, prepare, unpack, within
from .growing import Surface
from .model import Labels
from .noise import ROUNDING, SPECK, mixing_error, noise_level, noisy_colours, ripple_level, unlike
from .options import TraceOptions
from .posterise import MOST_REGIONS, is_noisy, posterise
from .sprites import label_sprite
from .threshold import label_steps

MANY = 40
"""Most colours for a picture without flat ones."""

DITHER = 0.003
"""Share of specks among the pixels that are no plateaus, from which a picture counts as dithered."""

QUANTISED = 3.5
"""Error of the mixes on edges from which a picture's colours count as reduced, levels."""

CONTRAST = 48.0
"""A speck that differs by more than this from its surroundings is no ripple, levels."""


def label_pixels(image: np.ndarray, options: TraceOptions) -> Labels:
    """Decide which flat colour each pixel of a picture belongs to.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8
        RGBA, not premultiplied.
    options : TraceOptions
        `regions`, `threshold`, `colors`, `areas` and `speckle` are used.

    Returns
    -------
    Labels
    """
    canvas = prepare(image)
    if options.regions == "threshold":
        labels = label_steps(canvas, options.threshold)
    elif options.regions == "pixels":
        labels = label_sprite(canvas)
    elif options.regions == "areas":
        labels = ramps.mark_slopes(canvas, areas.label_areas(canvas, options.areas or MOST_REGIONS))
    elif is_noisy(canvas):
        labels = _label_grainy(canvas, options.colors or MANY)
    else:
        labels = label_flat_art(canvas)
    if options.colors:
        labels = merging.limit_colours(labels, options.colors)
    if options.speckle:
        labels = merging.merge_specks(labels, options.speckle)
    if options.areas:
        labels = areas.limit_areas(labels, options.areas)
    return labels


def _label_grainy(canvas: Canvas, most: int) -> Labels:
    """Label a picture with a grain all over, or a photograph; that in `most` colours."""
    plateaus = palette.find_plateaus(canvas, np.zeros(canvas.shape, bool))
    dithered = dither.undithered(canvas, plateaus.core)
    if dithered:
        return _label_rest(_know_dithered(*dithered))
    soft = unsteady.find_soft(canvas, ripple_level(canvas, plateaus.core))
    if soft:
        return _label_rest(_know_soft(soft))
    calmed = without_grain(canvas)
    return label_flat_art(*calmed) if calmed else posterise(canvas, most)


def label_flat_art(canvas: Canvas, grain: float = 0.0) -> Labels:
    """Label a picture made of flat colours, soft ramps and anti-aliasing between them.

    `grain` is how strong the grain was that was taken out of it, levels.
    """
    return _label_rest(_know(canvas, grain))


class _Known(NamedTuple):
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
    soft: Optional[unsteady.Soft] = None  # its soft ramps, if they were found under ripples


def _know(canvas: Canvas, grain: float) -> _Known:
    """Find the flat colours and soft ramps of a picture, without its ripples if it has such."""
    slopes, count = ramps.find_ramps(canvas)
    found: List[Optional[Surface]] = [None] * count
    plateaus = palette.find_plateaus(canvas, slopes >= 0)
    dithered = None if grain else dither.undithered(canvas, plateaus.core)
    if dithered:
        return _know_dithered(*dithered)
    bands = None if grain else banded.find_banded(canvas, plateaus.core | (slopes >= 0))
    if bands:
        return _know_soft(bands)
    noise, rippled = (grain / LEFT, True) if grain else noise_level(canvas, plateaus.core, slopes)
    soft = unsteady.find_soft(canvas, ripple_level(canvas, plateaus.core)) if rippled and not grain else None
    if soft:
        return _know_soft(soft)
    inks, clear, left, least = np.zeros(0, np.uint32), None, 1.0, SPECK
    if noise > ROUNDING and not grain and ringing.is_ringing(canvas):
        (canvas, inks), noise = ringing.without_ringing(canvas), ringing.LEFT
        left, least = ringing.STROKES, ringing.SPECK
    plain = palette.plain_colours(canvas)
    if plain.size:
        noise, rippled, keys = ROUNDING, False, plain
    elif noise > ROUNDING:
        # The ramps are ripples of flat colours.
        slopes, found = ramps.no_ramps(canvas.shape), []
        plateaus = palette.find_plateaus(canvas, slopes >= 0)
        keys = _with_inks(canvas, noisy_colours(canvas, plateaus, noise, grain or noise), inks)
        if canvas.opaque and not grain and noise > ringing.LEFT:
            clear = canvas = bleeding.without_bleeding(canvas, keys, noise)
            left = bleeding.LEFT
    else:
        if count and not grain and ringing.overshoots(canvas) > ringing.OVERSHOOTING:
            known = _know_ringing(canvas)
            if known:
                return known
        slopes, found, plateaus, inks = _surfaces(canvas, slopes, count, plateaus)
        keys = _with_inks(canvas, palette.choose_colours(canvas, plateaus, bool(found)), inks)
    return _Known(canvas, slopes, found, plateaus, keys, noise, noise * left, rippled, least, clear)


def _know_dithered(canvas: Canvas, dots: np.ndarray) -> _Known:
    """The same of a picture without its dithering, whose dots were so far from it round each pixel (P,), levels."""
    soft = unsteady.find_soft(canvas, dither.SLOPING, np.maximum(dither.STRONGEST, dots / dither.LESS))
    return _know_soft(soft) if soft else _know(canvas, dither.LEFT * LEFT)


def _know_soft(soft: unsteady.Soft) -> _Known:
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
    return _Known(canvas, slopes, [*found, *[None] * (count - len(found))], plateaus, keys,
                  noise, noise / (unsteady.LEFT if grainy else 2), True, unsteady.SPECK, clear, soft)


def _know_ringing(canvas: Canvas) -> Optional[_Known]:
    """The same of a picture with soft ramps and with ripples beside its edges, unless these ramps are small."""
    soft = unsteady.ramps_under(canvas, ringing.margins(canvas))
    if soft is None:
        return None
    canvas, inks = ringing.without_ringing(canvas, *soft)
    slopes, count = ramps.find_ramps(canvas)
    noise = ringing.LEFT * ringing.STROKES
    slopes, found, plateaus, more = _surfaces(canvas, slopes, count, palette.find_plateaus(canvas, slopes >= 0), noise)
    keys = noisy_colours(canvas, plateaus, ringing.LEFT, ringing.LEFT, slopes >= 0)
    inks = np.array(unlike(canvas, np.append(inks, more), strokes.TWIN), np.uint32)
    keys = _with_inks(canvas, keys, inks)
    return _Known(canvas, slopes, found, plateaus, keys, noise, noise, True, ringing.SPECK, None)


def _stroke_colours(canvas: Canvas, slopes: np.ndarray, plateaus: palette.Plateaus, keys: np.ndarray,
                    noise: float) -> np.ndarray:
    """Packed colours that only thin strokes have."""
    cells = canvas.cells(~plateaus.core & (slopes < 0))
    labels = palette.known_labels(canvas, plateaus, keys, noise)
    ridges = strokes.find_ridges(canvas, cells, noise / 2)
    return strokes.new_colours(canvas, cells, ridges, planes(keys, canvas.opaque), labels, noise / 2)


def _label_rest(known: _Known) -> Labels:
    """Label the strokes and edges of a picture, too."""
    canvas, slopes, found, plateaus, keys, noise, doubt, rippled, speck, clear, soft = known
    count = len(found)
    if not keys.size and not count:
        return posterise(canvas, MANY)
    labels = palette.known_labels(canvas, plateaus, keys, noise)
    cells = canvas.cells(~plateaus.core & (slopes < 0))
    doubt = max(doubt, mixing_error(canvas, labels, cells))
    rippled |= doubt > QUANTISED
    ridges = strokes.find_ridges(canvas, cells, doubt)
    beyond = overlays.beyond_ramps(canvas, slopes, found, labels, ridges) if count and noise <= ROUNDING else ridges
    keys, labels = _with_rare(canvas, plateaus, cells, beyond, keys, labels, noise, doubt, count > 0,
                              soft is not None and soft.grainy)
    if keys.size == 1 and not count and _stray(canvas, labels, planes(keys, canvas.opaque)):
        return posterise(canvas, MANY)
    colours = unpack(keys).astype(np.float64)
    if count:
        # What is drawn on ramps is narrow, and so are its pieces.
        wide = sum(surface is not None for surface in found)
        like = max(ramps.SOFT, 2 * noise)
        ramps.absorb_pieces(canvas, labels, np.where(slopes < wide, slopes, -1), ramps.PIECE, like)
        ramps.absorb_pieces(canvas, labels, slopes, overlays.WIDE, like)
        canvas.bare(labels)[slopes >= 0] = slopes[slopes >= 0] + keys.size
        colours = np.concatenate([colours, mean_colours(canvas, slopes)])

    # A large picture should not be held more often than needed.
    del known, slopes, plateaus
    found = [*[None] * keys.size, *found]
    thin, specks, colours, found = filling.label_unknown(
        canvas, labels, keys, colours, found, ridges, doubt, count > 0 and noise <= ROUNDING)
    if count:
        scraps.join_scraps(canvas, labels, canvas.mixing(colours), found, thin)
    index, thin = (np.ascontiguousarray(canvas.bare(plane)) for plane in (labels, thin))
    del labels
    result = Labels(index=index, palette=colours, thin=thin, ramp=np.arange(len(colours)) >= keys.size,
                    gradients=tuple(surface and surface.gradient for surface in found),
                    clear=None if clear is None else unpack(clear.bare(clear.keys)))
    if soft is not None:
        result = regained.regain_ramps(soft.canvas, result, found, soft.canvas.bare(soft.doubt), noise)
    result = merging.merge_twins(result, canvas.mixing(result.palette))
    if noise > ROUNDING and rippled and clear is None and not count:
        result = uneven.join_slopes(canvas, result, noise)
    if specks > DITHER * cells.size + 10:
        return merging.merge_specks(result, speck)
    return _merge_ripples(canvas, result, noise, speck) if rippled else merging.drop_unused(result)


def _stray(canvas: Canvas, labels: np.ndarray, colour: np.ndarray) -> bool:
    """Whether pixels differ from the only colour (C, 1) there is: no mixes with another one explain them."""
    off = np.abs(canvas.colours(canvas.cells(canvas.bare(labels) < 0)) - colour)
    return bool((off > CONTRAST).any())


def _with_inks(canvas: Canvas, keys: np.ndarray, inks: np.ndarray) -> np.ndarray:
    """Flat colours, and the inks of strokes that are none of them."""
    known, more = planes(keys, canvas.opaque), planes(inks, canvas.opaque)
    off = np.abs(more[:, :, None] - known[:, None]).max(axis=0)
    return np.append(keys, inks[(off >= strokes.TWIN).all(axis=1)])


def _with_rare(canvas: Canvas, plateaus: palette.Plateaus, cells: np.ndarray, ridges: strokes.Ridges, keys: np.ndarray,
               labels: np.ndarray, noise: float, doubt: float, soft: bool,
               blurred: bool) -> Tuple[np.ndarray, np.ndarray]:
    """The colours and those that only thin strokes and small spots have, and labels with them.

    Where there are `soft` ramps, plateaus are not asked again; strokes of a `blurred` picture are nowhere full.
    """
    strange = strokes.unexplained(ridges, planes(keys, canvas.opaque), doubt - ROUNDING)
    more = strokes.new_colours(canvas, cells, strange, planes(keys, canvas.opaque), labels, doubt, blurred)
    if noise <= ROUNDING and not soft:
        more = np.append(more, palette.unmixed_colours(canvas, plateaus, np.append(keys, more)))
    if more.size:
        keys = np.append(keys, more)
        labels = palette.known_labels(canvas, plateaus, keys, noise)
    spot = spots.find_spots(canvas, cells, strange, planes(keys, canvas.opaque), labels, doubt - ROUNDING)
    labels[spot] = keys.size + np.arange(spot.size)
    return np.append(keys, canvas.keys[spot]), labels


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


def _merge_ripples(canvas: Canvas, labels: Labels, noise: float, least: float) -> Labels:
    """Merge the specks of less than `least` px² that JPEG and resizing leave, but no dots that stand out."""
    colours = canvas.mixing(labels.palette)

    def stands_out(mask: np.ndarray, index: np.ndarray) -> np.ndarray:
        off = canvas.colours(canvas.cells(mask)) - colours[:, index]
        return np.asarray(np.abs(off).max(axis=0) > max(CONTRAST, 5 * noise))

    return merging.merge_specks(labels, least, stands_out)
