# SPDX-License-Identifier: GPL-2.0-or-later
"""The paper's Table 1 for any picture: the way from the bitmap to the compressed SVG.

Sizes of the bitmap, of its triangulation as SVG, of the curves and of the compressed
curves; the two ratios that section VI speaks of; and what the stages counted.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Dict, Optional

import numpy as np

from .model import Drawing
from .options import Automatic, TraceOptions
from .svg import encoded

_BMP_HEADER = 54


@dataclass(frozen=True)
class Report:
    """Sizes in bytes, and counts.

    Attributes
    ----------
    name : str
        Of the picture.
    width, height : int
        Pixels.
    bmp, ddt_svg, svg, svgz : int
        Sizes of the 24-bit bitmap, the triangles, the curves and the compressed curves.
    counts : dict
        Triangles, flips, border triangles, outlines, curves.
    choice : str
        The preset that was chosen for the picture, and why; "" if none was to be chosen.
    """

    name: str
    width: int
    height: int
    bmp: int
    ddt_svg: int
    svg: int
    svgz: int
    counts: Dict[str, int]
    choice: str = ""

    def to_text(self) -> str:
        """A table for people."""
        sizes = [("24-bit BMP", self.bmp), ("DDT SVG", self.ddt_svg), ("SVG", self.svg), ("SVGZ", self.svgz)]
        ratios = [("BMP / SVG", self.bmp / self.svg), ("DDT SVG / SVGZ", self.ddt_svg / self.svgz)]
        lines = [f"{self.name}, {self.width} x {self.height} px"]
        lines += [f"  preset: {self.choice}"] if self.choice else []
        lines += [f"  {label:<20}{size:>15,} bytes" for label, size in sizes]
        lines += [f"  {label:<20}{ratio:>15,.1f}" for label, ratio in ratios]
        lines += [f"  {label:<20}{count:>15,}" for label, count in self.counts.items()]
        return "\n".join(lines)

    def to_dict(self) -> Dict[str, Any]:
        """The same for programs; JSON can hold it."""
        return {
            "picture": self.name, "width": self.width, "height": self.height, "choice": self.choice,
            "bytes": {"bmp": self.bmp, "ddt_svg": self.ddt_svg, "svg": self.svg, "svgz": self.svgz},
            "ratios": {"bmp/svg": self.bmp / self.svg, "ddt_svg/svgz": self.ddt_svg / self.svgz},
            "counts": dict(self.counts)}

    def to_json(self) -> str:
        """`to_dict` as one line of JSON."""
        import json

        return json.dumps(self.to_dict())


def report(image: np.ndarray, options: Optional[TraceOptions] = None,
           drawing: Optional[Drawing] = None, name: str = "picture",
           mesh: Optional[Drawing] = None) -> Report:
    """Trace a picture to its triangles and to its curves, and measure both.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8
    options : TraceOptions, optional
        Their `result` doesn't matter.
    drawing : Drawing, optional
        The curves, if they are there already.
    name : str
        What the report calls the picture.
    mesh : Drawing, optional
        The triangles, if they are there already.

    Returns
    -------
    Report
    """
    from .pipeline import trace

    options = options or Automatic()
    mesh = mesh or trace(image, replace(options, result="triangles"))
    curves = drawing or trace(image, replace(options, result="curves"))
    height, width = image.shape[:2]
    return Report(
        name, width, height,
        # The rows of a bitmap fill whole words of four bytes.
        bmp=_BMP_HEADER + (3 * width + 3) // 4 * 4 * height,
        ddt_svg=sum(map(len, encoded(mesh))),
        svg=sum(map(len, encoded(curves))),
        svgz=sum(map(len, encoded(curves, compressed=True))),
        counts={**mesh.counts, **curves.counts}, choice=curves.choice)
