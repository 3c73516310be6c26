# SPDX-License-Identifier: GPL-2.0-or-later
"""What an edge of the mesh costs: how sharp a crease the two triangles beside it make.

Let the colours of a triangle's three vertices span a plane over the picture, with
one gradient (a, b) per colour channel.  Two costs of an edge between the planes 1
and 2 are offered.

``yu`` is equation 1 of the paper, due to Yu, Morse and Sederberg [1]_::

    |G1| |G2| - <G1, G2>

over all channels at once (G is the matrix of the gradients, the norm Frobenius'): a
crease between two steep planes is dear, one beside a flat triangle costs nothing, and
neither does an edge between coplanar triangles.

``paper`` is the faster equation 2, read with absolute values and summed over the
channels::

    (|a1| + |b1|) (|a2| + |b2|) - (a1 a2 + b1 b2)

Read literally, as printed without the bars, equation 2 is no cost: it multiplies out to
a1 b2 + a2 b1, which changes its sign when the picture is turned by 90 degrees, (a, b)
becoming (-b, a).  What lowers it in a picture would raise it in the turned one; it is
2 a b, not zero, between coplanar triangles, and has no lower bound.  Equation 1 has lost
its bars in print as well.  The reading with bars is equation 1 with another norm; it is
never negative, but oblique ramps cost something.

.. [1] X. Yu, B. S. Morse, T. W. Sederberg: Image Reconstruction Using Data-Dependent
       Triangulation.  IEEE Computer Graphics and Applications 21(3), 2001, 62-68.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .model import Mesh


@dataclass(frozen=True)
class EdgeCost:
    """One of the two costs, for a number of colour channels.

    Both costs are products of the two triangles' *planes*: vectors of K numbers, first the
    size of the gradient (one for `yu`, one per channel for `paper`), then the gradients,
    all a, then all b.  So the cost of an edge is bilinear, and the costs of one triangle's
    edges sum to its product with the sum of its neighbours' planes.

    Attributes
    ----------
    name : {'yu', 'paper'}
    channels : int
    """

    name: str
    channels: int

    @property
    def sizes(self) -> int:
        """How many numbers of a plane are sizes."""
        return 1 if self.name == "yu" else self.channels

    def planes(self, gradients: np.ndarray) -> np.ndarray:
        """Planes of triangles, float64 (K, n), from gradients (2 * channels, n): all a, then all b."""
        planes = np.empty((self.sizes + len(gradients), gradients.shape[1]))
        planes[self.sizes:] = gradients
        if self.name == "yu":
            np.sqrt(np.einsum("ij,ij->j", gradients, gradients), out=planes[0])
        else:
            steep = np.abs(gradients)
            np.add(steep[:self.channels], steep[self.channels:], out=planes[:self.sizes])
        return planes

    def gradients(self, planes: np.ndarray) -> np.ndarray:
        """Gradients of planes: (2 * channels, n), a view."""
        return planes[self.sizes:]

    def between(self, planes: np.ndarray, others: np.ndarray) -> np.ndarray:
        """Cost of the edge between each plane and the other, float64 (n,), squared levels."""
        signs = np.full(len(planes), -1.0)
        signs[:self.sizes] = 1.0
        cost: np.ndarray = signs @ (planes * others)
        return cost


def premultiplied_levels(pixels: np.ndarray) -> np.ndarray:
    """Colours with the opacity multiplied in, rounded to whole levels: int32, shape as `pixels`.

    Parameters
    ----------
    pixels : ndarray of shape (..., 4) and dtype uint8
        RGBA.

    Notes
    -----
    What lies under transparent pixels has no meaning, and counts as black here.  Whole
    levels keep all gradients whole, and arithmetic on them exact.
    """
    colours = pixels.astype(np.int32)
    alpha = colours[..., 3:]
    if (alpha < 255).any():
        colours[..., :3] = (2 * colours[..., :3] * alpha + 255) // 510
    return colours


def framed_levels(image: np.ndarray) -> np.ndarray:
    """Premultiplied colours of all vertices of the framed grid, int32 ((H + 2) * (W + 2), 4).

    A vertex of the frame has the colour of the pixel nearest to it.
    """
    return premultiplied_levels(np.pad(image, ((1, 1), (1, 1), (0, 0)), mode="edge")).reshape(-1, 4)


def mesh_cost(mesh: Mesh, image: np.ndarray, name: str) -> float:
    """Total cost of a mesh, equation 3 of the paper: the sum over its inner edges.

    Parameters
    ----------
    mesh : Mesh
    image : ndarray of shape (H, W, 4) and dtype uint8
    name : {'yu', 'paper'}
    """
    colours = framed_levels(image)[mesh.triangles]
    x, y = np.moveaxis(mesh.points(mesh.triangles), -1, 0)
    # With twice the area 1 a gradient is a sum of colours times the opposite sides.
    a = np.einsum("tk,tkc->ct", np.roll(y, -1, axis=1) - np.roll(y, -2, axis=1), colours)
    b = np.einsum("tk,tkc->ct", np.roll(x, -2, axis=1) - np.roll(x, -1, axis=1), colours)
    cost = EdgeCost(name, colours.shape[2])
    planes = cost.planes(np.concatenate([a, b]))
    edges = np.flatnonzero(mesh.twins > np.arange(len(mesh.twins)))
    return float(cost.between(planes[:, edges // 3], planes[:, mesh.twins[edges] // 3]).sum())
