# SPDX-License-Identifier: GPL-2.0-or-later
"""DDT Trace: clip art to area-sorted Bézier paths by a data dependent triangulation.

The public names are those of `__all__`; nothing is loaded before it is used.

Examples
--------
>>> import ddtcore
>>> import numpy as np
>>> picture = np.full((8, 12), 255, dtype=np.uint8)
>>> picture[2:6, 3:9] = 0
>>> drawing = ddtcore.trace(picture, ddtcore.TraceOptions(tolerance=0.3))
>>> drawing.width, drawing.height
(12, 8)
>>> svg = drawing.to_svg()
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any, List

if TYPE_CHECKING:
    from .files import trace_file
    from .model import Drawing
    from .options import TraceOptions
    from .pipeline import trace
    from .raster import ImageError, load_image

__all__ = ["Drawing", "ImageError", "TraceOptions", "load_image", "trace", "trace_file"]
__version__ = "1.0.0"

_HOMES = {"Drawing": "model", "ImageError": "raster", "TraceOptions": "options",
          "load_image": "raster", "trace": "pipeline", "trace_file": "files"}


def __getattr__(name: str) -> Any:
    """Load a public name at its first use (PEP 562), so that ``--help`` needs no numpy."""
    if name not in _HOMES:
        raise AttributeError(f"module 'ddtcore' has no attribute {name!r}")
    value = getattr(import_module(f".{_HOMES[name]}", __name__), name)
    globals()[name] = value
    return value


def __dir__() -> List[str]:
    return sorted(__all__)
