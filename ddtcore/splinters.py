# SPDX-License-Identifier: GPL-2.0-or-later
"""Splinters: a few pixels that the mesh cut off from their region, in pictures with ripples.

Labels are connected over corners, too, but only one of two regions that meet at a corner is
connected there in the mesh.  In a clean picture it knows which.  Where ripples decide what
pixels on edges belong to, single ones get caught between pixels of a stroke, and each
would become a path of its own.  They join what lies beside them.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .merging import borders
from .model import Labels, PlanarMap

SHARE = 0.5
"""Faces with less than this share of what counts as a speck may be splinters."""


def join_splinters(labels: Labels, planar: PlanarMap) -> Labels:
    """Give splinters the label of what they share the longest border with.

    Returns
    -------
    Labels
        The same where there are no splinters.
    """
    face = planar.pixel_faces
    small = (planar.face_areas < SHARE * labels.speck) & (planar.face_areas > 0)
    if not small.any():
        return labels
    cut = _cut_off(face, labels.index, small)
    one, other = borders(face)
    own = cut[one] & ~small[other]
    code, length = np.unique(one[own] * len(labels.palette) + planar.face_labels[other[own]], return_counts=True)
    one, label = np.divmod(code, len(labels.palette))
    into = planar.face_labels.astype(labels.index.dtype)
    order = np.argsort(length, kind="stable")
    into[one[order]] = label[order]
    index = into[face]
    return replace(labels, index=index, thin=labels.thin & (index == labels.index))


def _cut_off(face: np.ndarray, index: np.ndarray, small: np.ndarray) -> np.ndarray:
    """Which of the small faces have a pixel of their label at a corner that is of another face, bool (F,)."""
    cut = np.zeros(small.size, bool)
    for first, second in ((np.s_[:-1, :-1], np.s_[1:, 1:]), (np.s_[:-1, 1:], np.s_[1:, :-1])):
        parted = (index[first] == index[second]) & (face[first] != face[second])
        cut[face[first][parted]] = True
        cut[face[second][parted]] = True
    return np.asarray(cut & small)
