# SPDX-License-Identifier: GPL-2.0-or-later
"""Which preset suits a picture: clip art unless it surely is pixel art or a photograph.

Clip art may be anti-aliased, saved as JPEG, scanned, shaded; it still has areas of few
colours with edges between them.  A photograph has many shades even where it is calm,
and texture all over.  Both are measured on blocks of 4 x 4 pixels, whose means are free
of most noise.  Pixel art has few colours and not one that is a mix of its neighbours'.
"""

from __future__ import annotations

from typing import NamedTuple, Optional, Tuple

import numpy as np

from .options import Automatic, TraceOptions
from .raster import packed
from .sprites import block_size, reduced

BLOCK = 4
"""Size of the blocks, px."""

SEEN = 1024
"""Larger pictures are looked at as if their longer side had this size: what counts as texture is seen from afar, px."""

SAMPLE = 1 << 13
"""Blocks looked at, more or less, in a large picture."""

CALM = 40
"""Largest range of a channel in a block without an edge, levels."""

TEXTURE = 24, 64
"""Range of a channel in a block that has texture, levels."""

GREY = 12
"""Largest difference between the channels of a block's mean that counts as grey, levels."""

SHADES, SHADES_OF_GREY = 40, 7
"""Fewest shades, 8 levels wide, that 80 % of the calm blocks of a photograph have."""

TEXTURED, TEXTURED_GREY = 0.10, 0.15
"""Least share of blocks with texture in a photograph."""

SPRITE = 64
"""Longest side of a picture that is taken for pixel art though it isn't enlarged, px."""

LARGE_SPRITE = 256
"""The same for the original of an enlarged picture, px."""

FEW, MORE = 24, 64
"""Most colours of a sprite, and of one that is enlarged."""

MIXED = 0.05
"""Largest share of the steps in pixel art that go over a mix of both sides."""

_SHADE = 8
_STEPS = 4


class Choice(NamedTuple):
    """A preset, and why it was chosen.

    Attributes
    ----------
    preset : str
    reason : str
        For people, e.g. ``"12 colours in 4 x 4 px squares"``.
    """

    preset: str
    reason: str

    def __str__(self) -> str:
        return f"{self.preset} ({self.reason})"


def settle(image: np.ndarray, options: Optional[TraceOptions]) -> Tuple[TraceOptions, str]:
    """The settings for a picture.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8
    options : TraceOptions, optional
        None stands for `Automatic`.

    Returns
    -------
    options : TraceOptions
    choice : str
        The preset that was chosen and why; "" if there was nothing to choose.
    """
    if options is None:
        options = Automatic()
    if not isinstance(options, TraceOptions):
        raise TypeError(f"options must be TraceOptions, not {options!r}")
    if not isinstance(options, Automatic):
        return options, ""
    choice = choose_preset(image)
    return options.settled(choice.preset), str(choice)


def choose_preset(image: np.ndarray) -> Choice:
    """Choose among ``clip-art``, ``photo`` and ``pixel-art`` by the look of a picture.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8
        RGBA, not premultiplied.

    Returns
    -------
    Choice

    Examples
    --------
    >>> choose_preset(np.full((20, 30, 4), 255, np.uint8)).preset
    'clip-art'
    """
    return _as_pixel_art(image) or _as_photo(image)


def _as_pixel_art(image: np.ndarray) -> Optional[Choice]:
    """The choice of pixel art, if the picture is that."""
    size = block_size(image)
    sprite = reduced(image, size)
    longest = LARGE_SPRITE if size > 1 else SPRITE
    if max(sprite.shape[:2]) > longest or min(sprite.shape[:2]) < 6:
        return None
    key = packed(sprite)
    colours = np.unique(key).size
    partial = ((sprite[..., 3] > 0) & (sprite[..., 3] < 255)).any()
    if colours < 2 or colours > (MORE if size > 1 else FEW) or (partial and size == 1):
        return None
    if min(_places(key), _places(key.T)) < _STEPS or (size == 1 and _mixed_share(sprite) > MIXED):
        return None
    squares = f" in squares of {size} x {size} px" if size > 1 else " without anti-aliasing"
    return Choice("pixel-art", f"{colours} colours{squares}")


def _places(key: np.ndarray) -> int:
    """In how many columns any row of a picture changes."""
    return int(np.count_nonzero((key[:, 1:] != key[:, :-1]).any(axis=0)))


def _mixed_share(sprite: np.ndarray) -> float:
    """Which part of the steps between colours goes over a pixel that is a mix of both sides."""
    colour = sprite.astype(np.int32)
    colour[..., :3] *= colour[..., 3:] // 255
    mixed = steps = 0
    for lines in (colour, colour.swapaxes(0, 1)):
        before, here, after = lines[:, :-2], lines[:, 1:-1], lines[:, 2:]
        span, part = after - before, here - before
        length = (span * span).sum(axis=-1)
        along = (part * span).sum(axis=-1)
        off = (part * part).sum(axis=-1) - along * along / np.maximum(length, 1)
        mixed += int(np.count_nonzero((length > 48 ** 2) & (off < 12 ** 2)
                                  & (along > 0.1 * length) & (along < 0.9 * length)))
        steps += int(np.count_nonzero((lines[:, 1:] != lines[:, :-1]).any(axis=-1)))
    return mixed / max(1, steps)


def _as_photo(image: np.ndarray) -> Choice:
    """The choice between clip art and a photograph."""
    mean, span = _blocks(image)
    if not len(span):
        return Choice("clip-art", "a very small picture")
    texture = float(np.mean((span > TEXTURE[0]) & (span <= TEXTURE[1])))
    calm = mean[span <= CALM]
    grey = np.mean(np.ptp(calm, axis=1) > GREY) < 0.02 if len(calm) else True
    shades = _count_shades(calm)
    kind = ("shade" if shades == 1 else "shades") + (" of grey" if grey else "")
    said = f"{shades} {kind} in its calm parts, {texture:.0%} of it textured"
    if shades >= (SHADES_OF_GREY if grey else SHADES) and texture >= (TEXTURED_GREY if grey else TEXTURED):
        return Choice("photo", said)
    return Choice("clip-art", said)


def _blocks(image: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Mean colour over white (n, 3) of an even sample of blocks, and the largest range of a channel (n,)."""
    wide = max(1, round(max(image.shape[:2]) / SEEN))
    side = wide * BLOCK
    rows, cols = image.shape[0] // side, image.shape[1] // side
    step = max(1, int(np.sqrt(rows * cols / SAMPLE)))
    blocks = image[:rows * side, :cols * side].reshape(rows, BLOCK, wide, cols, BLOCK, wide, 4)[::step, :, :, ::step]
    total = blocks[:, :, 0, :, :, 0].astype(np.uint16)
    for k in range(1, wide ** 2):
        total += blocks[:, :, k // wide, :, :, k % wide]
    pixels = np.ascontiguousarray((total // wide ** 2).transpose(1, 3, 4, 0, 2)).reshape(BLOCK ** 2, 4, -1)
    colour, alpha = pixels[:, :3], pixels[:, 3:]
    if (alpha < 255).any():
        colour = 255 - (255 - colour) * alpha // 255
    span = (colour.max(axis=0).astype(np.int16) - colour.min(axis=0)).max(axis=0)
    return (colour.sum(axis=0, dtype=np.uint16) / BLOCK ** 2).T, span


def _count_shades(mean: np.ndarray) -> int:
    """How many shades make up 80 % of some colours (n, 3)."""
    if not len(mean):
        return 0
    shade = (mean / _SHADE).astype(np.int64) @ np.array([1 << 10, 1 << 5, 1])
    count = np.sort(np.bincount(shade))[::-1]
    return int(np.searchsorted(np.cumsum(count), 0.8 * len(mean))) + 1
