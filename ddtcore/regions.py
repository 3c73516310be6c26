# SPDX-License-Identifier: GPL-2.0-or-later
"""Which flat colour each pixel belongs to: the stage before the mesh.

Flat art is plateaus of few colours, and anti-aliasing between them.  First come
the pixels that are sure (soft ramps, plateaus), then strokes too thin to have
plateaus, then every pixel in between goes to the nearer of its two sides.
"""

from __future__ import annotations

from typing import Tuple

import numpy as np

from . import (
    areas,
    dither,
    filling,
    hatching,
    merging,
    overlays,
    palette,
    ramps,
    regained,
    scraps,
    spots,
    uneven,
    unsteady,
)
from .calm import without_grain
from .canvas import Canvas, mean_colours, planes, prepare, unpack
from .exact import exact_colours
from .known import Known, know, know_dithered, know_hatched, know_soft
from .model import Labels
from .noise import ROUNDING, mixing_error, ripple_level
from .options import TraceOptions
from .posterise import MOST_REGIONS, is_noisy, posterise
from .ridges import Ridges, find_ridges, unexplained
from .sprites import label_sprite
from .strokeinks import new_colours
from .threshold import label_steps

MANY = 40
"""Most colours for a picture without flat ones."""

DITHER = 0.003
"""Share of specks among the pixels that are no plateaus, from which a picture counts as dithered."""

QUANTISED = 3.5
"""Error of the mixes on edges from which a picture's colours count as reduced, levels."""

PIECES = 3.0
"""Pieces that differ by ripples only are such up to so many times the size of specks."""

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
        return _label_rest(know_dithered(*dithered))
    soft = unsteady.find_soft(canvas, ripple_level(canvas, plateaus.core))
    if soft:
        return _label_rest(know_soft(soft))
    inks = hatching.find_inks(canvas)
    if inks.size:
        return _label_rest(know_hatched(canvas, inks))
    calmed = without_grain(canvas)
    return label_flat_art(*calmed) if calmed else posterise(canvas, most)


def label_flat_art(canvas: Canvas, grain: float = 0.0) -> Labels:
    """Label a picture made of flat colours, soft ramps and anti-aliasing between them.

    `grain` is how strong the grain was that was taken out of it, levels.
    """
    return _label_rest(know(canvas, grain))


def _label_rest(known: Known) -> Labels:
    """Label the strokes and edges of a picture, too."""
    canvas, slopes, found, plateaus, keys, noise, doubt, rippled, speck, clear, even, soft = known
    count = len(found)
    if not keys.size and not count:
        return posterise(canvas, MANY)
    labels = palette.known_labels(canvas, plateaus, keys, noise)
    cells = canvas.cells(~plateaus.core & (slopes < 0))
    doubt = max(doubt, mixing_error(canvas, labels, cells))
    rippled |= doubt > QUANTISED
    ridges = find_ridges(canvas, cells, doubt)
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
                    clear=None if clear is None else unpack(clear.bare(clear.keys)), speck=speck if rippled else 0.0)
    if soft is not None:
        result = regained.regain_ramps(soft.canvas, result, found, soft.canvas.bare(soft.doubt), noise)
    result = merging.merge_twins(result, canvas.mixing(result.palette))
    if noise > ROUNDING and rippled and clear is None and not count:
        result = uneven.join_slopes(canvas, result, noise)
    if specks > DITHER * cells.size + 10:
        result = merging.merge_specks(result, speck)
    elif rippled:
        result = _merge_ripples(canvas, result, noise, speck)
    else:
        return merging.drop_unused(result)
    return exact_colours(even, result, noise) if noise > ROUNDING else result


def _stray(canvas: Canvas, labels: np.ndarray, colour: np.ndarray) -> bool:
    """Whether pixels differ from the only colour (C, 1) there is: no mixes with another one explain them."""
    off = np.abs(canvas.colours(canvas.cells(canvas.bare(labels) < 0)) - colour)
    return bool((off > CONTRAST).any())


def _with_rare(canvas: Canvas, plateaus: palette.Plateaus, cells: np.ndarray, ridges: Ridges, keys: np.ndarray,
               labels: np.ndarray, noise: float, doubt: float, soft: bool,
               blurred: bool) -> Tuple[np.ndarray, np.ndarray]:
    """The colours and those that only thin strokes and small spots have, and labels with them.

    Where there are `soft` ramps, plateaus are not asked again; strokes of a `blurred` picture are nowhere full.
    """
    strange = unexplained(ridges, planes(keys, canvas.opaque), doubt - ROUNDING)
    more = new_colours(canvas, cells, strange, planes(keys, canvas.opaque), labels, doubt, blurred)
    if noise <= ROUNDING and not soft:
        more = np.append(more, palette.unmixed_colours(canvas, plateaus, np.append(keys, more)))
    if more.size:
        keys = np.append(keys, more)
        labels = palette.known_labels(canvas, plateaus, keys, noise)
    spot = spots.find_spots(canvas, cells, strange, planes(keys, canvas.opaque), labels, doubt - ROUNDING)
    labels[spot] = keys.size + np.arange(spot.size)
    return np.append(keys, canvas.keys[spot]), labels


def _merge_ripples(canvas: Canvas, labels: Labels, noise: float, least: float) -> Labels:
    """Merge the specks of less than `least` px² that JPEG and resizing leave, but no dots that stand out."""
    colours = canvas.mixing(labels.palette)

    def stands_out(mask: np.ndarray, index: np.ndarray) -> np.ndarray:
        off = canvas.colours(canvas.cells(mask)) - colours[:, index]
        return np.asarray(np.abs(off).max(axis=0) > max(CONTRAST, 5 * noise))

    labels = merging.merge_specks(labels, least, stands_out)
    if noise > ROUNDING:
        labels = merging.merge_like_pieces(labels, canvas.mixing(labels.palette), PIECES * least, noise)
    return labels
