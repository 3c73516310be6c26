# SPDX-License-Identifier: GPL-2.0-or-later
"""Bitmaps in: any picture that Pillow reads, as one RGBA array.

Pictures come from strangers.  Whatever arrives is either an array or an
`ImageError` with one plain sentence; nothing but the picture's own bytes is read, no
other program runs, and the header is asked for the size before anything is decoded.
"""

from __future__ import annotations

import io
import logging
import os
import stat
import threading
import warnings
from contextlib import contextmanager
from typing import TYPE_CHECKING, BinaryIO, Iterator, Union

import numpy as np

# Pillow itself is imported where a file is read: the extension can do without it.
if TYPE_CHECKING:
    from PIL import Image

Source = Union[str, bytes, "os.PathLike[str]", BinaryIO]

_VECTOR_FORMATS = ("EPS", "WMF", "EMF")
"""Pillow hands these to other programs, which is neither safe nor needed: they hold no bitmap."""

_ORIENTATION = 0x0112

_STRIP = 256
"""Rows of a picture converted at a time."""

MAX_BYTES = 1 << 31
"""Largest file that is read, bytes: more than the largest picture takes with 16 bits a channel."""

_pillow = threading.Lock()
logging.getLogger("PIL").addHandler(logging.NullHandler())


class ImageError(ValueError):
    """A picture that can't be read or traced; the text says why in one sentence."""


def load_image(source: Source, max_pixels: int = 200_000_000) -> np.ndarray:
    """Read a picture.

    The EXIF orientation is applied, 16-bit and floating grey values are scaled to 8 bits,
    and of an animation the first frame is taken.

    Parameters
    ----------
    source : str, path-like, bytes or binary file
        A regular file, or the bytes of one.
    max_pixels : int
        Largest picture to decode.

    Returns
    -------
    ndarray of shape (H, W, 4) and dtype uint8
        RGBA, not premultiplied.

    Raises
    ------
    ImageError
        If there is no such file, if it is no picture, damaged or too large.

    Examples
    --------
    >>> load_image(b"P1 3 2  0 1 0  1 0 1").shape
    (2, 3, 4)
    >>> load_image("missing.png")
    Traceback (most recent call last):
    ...
    ddtcore.raster.ImageError: missing.png can't be opened: No such file or directory
    """
    if isinstance(source, bytes):
        _check_length(len(source), "the input")
        return _decode(io.BytesIO(source), "the input", max_pixels)
    if not isinstance(source, (str, os.PathLike)):
        return _decode(source, "the input", max_pixels)
    name = os.fspath(source)
    try:
        status = os.stat(source)
        if not stat.S_ISREG(status.st_mode):
            raise ImageError(f"{name} is not a regular file")
        _check_length(status.st_size, name)
        with open(source, "rb") as file:
            return _decode(file, name, max_pixels)
    except ImageError:
        raise
    except (OSError, ValueError) as error:  # ValueError: names that no file can have.
        reason = getattr(error, "strerror", None) or error
        raise ImageError(f"{name} can't be opened: {reason}") from None


def check_image(image: np.ndarray) -> np.ndarray:
    """The array as RGBA.

    Parameters
    ----------
    image : ndarray of shape (H, W), (H, W, 3) or (H, W, 4) and dtype uint8
        Grey, RGB or RGBA.

    Returns
    -------
    ndarray of shape (H, W, 4) and dtype uint8
        Contiguous; `image` itself where it is that already.

    Raises
    ------
    TypeError
        If `image` is no array of bytes.
    ImageError
        If it has another shape, or no pixels.
    """
    if not isinstance(image, np.ndarray):
        raise TypeError(f"image must be a numpy array, not {type(image).__name__}: load_image reads files")
    if image.ndim not in (2, 3) or (image.ndim == 3 and image.shape[2] not in (3, 4)):
        raise ImageError(f"image must have the shape (H, W), (H, W, 3) or (H, W, 4), not {image.shape}")
    if image.dtype != np.uint8:
        raise TypeError(f"image must have the dtype uint8, not {image.dtype}: scale its values to 0..255")
    if image.size == 0:
        raise ImageError(f"image must have at least one pixel, not the shape {image.shape}")
    if image.ndim == 3 and image.shape[2] == 4:
        return np.ascontiguousarray(image)
    rgba = np.full((*image.shape[:2], 4), 255, dtype=np.uint8)
    rgba[..., :3] = image if image.ndim == 3 else image[..., None]
    return rgba


def packed(image: np.ndarray) -> np.ndarray:
    """Each pixel of a uint8 picture (H, W, 4) in one number, uint32 (H, W); 0 for all that are transparent."""
    return np.where(image[..., 3] > 0, pixel_keys(image), np.uint32(0))


def pixel_keys(image: np.ndarray) -> np.ndarray:
    """Each pixel of a uint8 picture (..., 4) in one number, uint32 (...): so four bytes are moved as one."""
    return np.asarray(np.ascontiguousarray(image).view(np.uint32)[..., 0])


def pixels_at(image: np.ndarray, numbers: np.ndarray) -> np.ndarray:
    """Pixels (..., 4) of a uint8 picture (H, W, 4), numbered row by row."""
    return np.asarray(pixel_keys(image).ravel().take(numbers)[..., np.newaxis].view(np.uint8))


def is_opaque(image: np.ndarray) -> bool:
    """Whether all pixels of a uint8 picture (H, W, 4) have alpha 255."""
    return bool(np.bitwise_and.reduce(pixel_keys(image).ravel())[np.newaxis].view(np.uint8)[3] == 255)


def _check_length(length: int, name: str) -> None:
    # What says that it is empty can be endless all the same, as some files in /proc are.
    if length == 0:
        raise ImageError(f"{name} is empty")
    if length > MAX_BYTES:
        raise ImageError(f"{name} has more than {MAX_BYTES / 1e9:.1f} GB, the limit")


def _decode(file: BinaryIO, name: str, max_pixels: int) -> np.ndarray:
    from PIL import Image, UnidentifiedImageError

    try:
        with _quiet_pillow(max_pixels), Image.open(file) as image:
            if image.format in _VECTOR_FORMATS:
                raise ImageError(f"{name} is a vector drawing, not a bitmap: {image.format}")
            if image.width * image.height > max_pixels:
                raise Image.DecompressionBombError
            image.load()
            rgba = _to_rgba(_upright(image))
    except ImageError:
        raise
    except UnidentifiedImageError:
        raise ImageError(f"{name} is not a picture of a kind that can be read") from None
    except Image.DecompressionBombError:
        raise ImageError(f"{name} has more than {max_pixels / 1e6:g} million pixels, the limit") from None
    except MemoryError:
        raise ImageError(f"{name} needs more memory than there is") from None
    except Exception as error:  # Pillow's readers raise nearly anything on damaged files.
        reason = " ".join(str(error).split()) or type(error).__name__
        raise ImageError(f"{name} can't be read, it may be damaged: {reason}") from None
    if rgba.size == 0:
        raise ImageError(f"{name} has no pixels")
    return rgba


@contextmanager
def _quiet_pillow(max_pixels: int) -> Iterator[None]:
    """Pillow with our limit on pixels, and without warnings; both are global to it."""
    from PIL import Image

    with _pillow, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        limit = Image.MAX_IMAGE_PIXELS
        # Pillow warns from this number on and refuses from twice as many.
        Image.MAX_IMAGE_PIXELS = max(max_pixels // 2, 1)
        try:
            yield
        finally:
            Image.MAX_IMAGE_PIXELS = limit


def _upright(image: Image.Image) -> Image.Image:
    try:
        if image.getexif().get(_ORIENTATION, 1) == 1:
            return image
        from PIL import ImageOps

        return ImageOps.exif_transpose(image) or image
    except Exception:  # Broken metadata must not cost the picture.
        return image


def _to_rgba(image: Image.Image) -> np.ndarray:
    if image.mode.startswith("I") or image.mode == "F":
        return _deep_grey(np.asarray(image), image.info.get("transparency"))
    rgba = np.empty((image.height, image.width, 4), np.uint8)
    # Pillow holds these with a fourth byte that means nothing.
    plain = image.mode == "RGB" and "transparency" not in image.info
    # In strips, for conversions need several times the memory of what they convert.
    for top in range(0, image.height, _STRIP):
        strip = image.crop((0, top, image.width, min(top + _STRIP, image.height)))
        if not plain:
            strip = strip.convert("RGBA")
        rgba[top:top + _STRIP] = np.frombuffer(strip.tobytes("raw", "RGBX" if plain else "RGBA"), np.uint8).reshape(
            strip.height, strip.width, 4)
    if plain:
        rgba[..., 3] = 255
    return rgba


def _deep_grey(values: np.ndarray, transparent: object) -> np.ndarray:
    """Grey values of more than 8 bits: 16-bit ones have a fixed scale, others that of the picture."""
    is_float = values.dtype.kind == "f"
    values = np.nan_to_num(values.astype(np.float64), posinf=0.0, neginf=0.0)
    low, high = min(values.min(), 0.0), values.max()
    for usual in (1.0, 255.0) if is_float else (65535.0,):
        if high <= usual:
            high = usual
            break
    grey = np.rint((values - low) * (255.0 / (high - low))).astype(np.uint8)
    rgba = check_image(grey)
    if isinstance(transparent, int):
        rgba[values == transparent, 3] = 0
    return rgba
