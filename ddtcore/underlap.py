# SPDX-License-Identifier: GPL-2.0-or-later
"""How shapes end under what is painted later: in as few lines as possible.

Shapes that only abut let the page shine through, by up to a quarter of its colour
where both cover half of a pixel.  So the earlier shape continues under the later one.
Nobody sees where it ends there, and a line takes the fewest bytes: find the polyline
with few corners that passes all doors (see `doors`) in their order.

From a corner, the directions in which the next doors are seen form a wedge, and each
further door narrows it.  The last door the wedge still reaches is where the next corner
lies; several depths are tried there, and the one is kept from which the next line gets
farthest.  (Ordered stabbing: L. Guibas, J. Hershberger, J. Mitchell and J. Snoeyink,
"Approximating polygons and subdivisions with minimum-link paths", International Journal
of Computational Geometry & Applications 3, 1993.)  All polylines grow at the same time.

Points are complex numbers here, for a turn is then a multiplication.
"""

from __future__ import annotations

from typing import List, NamedTuple, Tuple

import numpy as np

from .doors import Hidden, open_doors
from .loops import begins
from .rankmap import RankMap

_CANDIDATES = 5
"""How many depths of a door are tried for a corner."""

_WINDOW = 32
"""How many doors a line may pass."""

_FEW = 7
"""How many of these are looked through first: most lines pass no more."""

_BATCH = 4096
"""How many polylines grow at the same time, to bound the memory."""


class _Gates(NamedTuple):
    """The doors of many stretches as complex numbers; the last door of each is a point."""

    low: np.ndarray     # (N,) where each door begins, near the shape
    high: np.ndarray    # (N,) where it ends
    ahead: np.ndarray   # (N,) unit vector along the border
    starts: np.ndarray  # (R + 1,)
    origin: np.ndarray  # (R,) where each polyline begins


class _Sight(NamedTuple):
    """What is seen from corners: the best of each stretch's candidates."""

    corner: np.ndarray  # (R,)
    reach: np.ndarray   # (R,) how many doors one line from there passes
    least: np.ndarray   # (R,) slopes between which it passes the last of them
    most: np.ndarray


def hidden_lines(hidden: Hidden, ranks: RankMap) -> Tuple[np.ndarray, np.ndarray]:
    """Replace hidden borders by few lines below what covers them.

    Parameters
    ----------
    hidden : Hidden
    ranks : RankMap

    Returns
    -------
    starts : ndarray of shape (R + 1,) and dtype int64
    points : ndarray of shape (N, 2) and dtype float64
        Polylines.  Open ones keep the ends of their stretches, closed ones end where they begin.
    """
    if not len(hidden.rank):
        return np.zeros(1, np.int64), np.zeros((0, 2))
    gates = _gates(hidden, ranks)
    owners: List[np.ndarray] = []
    corners: List[np.ndarray] = []
    for first in range(0, len(gates.origin), _BATCH):
        _grow(gates, np.arange(first, min(first + _BATCH, len(gates.origin))), owners, corners)
    owner = np.concatenate(owners)
    points = np.concatenate(corners)[np.argsort(owner, kind="stable")]
    return begins(np.bincount(owner)), np.stack([points.real, points.imag], axis=1)


def _gates(hidden: Hidden, ranks: RankMap) -> _Gates:
    doors = open_doors(hidden, ranks)
    point = hidden.points[:, 0] + 1j * hidden.points[:, 1]
    outwards = doors.outwards[:, 0] + 1j * doors.outwards[:, 1]
    low, high = point + doors.low * outwards, point + doors.high * outwards
    first, last = hidden.starts[:-1], hidden.starts[1:] - 1
    origin = np.where(hidden.closed, (low + high)[first] / 2, point[first])
    low[last] = high[last] = np.where(hidden.closed, origin, point[last])
    later = np.ones(len(point), bool)
    later[first] = False
    starts = hidden.starts - np.arange(len(hidden.starts))
    return _Gates(low[later], high[later], 1j * outwards[later], starts, origin)


def _grow(gates: _Gates, owner: np.ndarray, owners: List[np.ndarray], corners: List[np.ndarray]) -> None:
    """Append the corners of some stretches' polylines, and whose they are, in order."""
    following, end = gates.starts[owner], gates.starts[owner + 1]
    candidates = np.repeat(gates.origin[owner, None], _CANDIDATES, axis=1)
    while owner.size:
        sight = _look(gates, following, end, candidates)
        door = following + np.maximum(sight.reach, 1) - 1
        candidates = _candidates(gates, following, door, sight)
        done = door == end - 1
        owners += [owner, owner[done]]
        corners += [sight.corner, gates.low[door[done]]]
        owner, end, following, candidates = owner[~done], end[~done], door[~done] + 1, candidates[~done]


def _look(gates: _Gates, following: np.ndarray, end: np.ndarray, candidates: np.ndarray) -> _Sight:
    """Which candidate (R, C) sees through most doors, from `following` on and before `end`."""
    sight = _look_through(gates, following, end, candidates, _FEW)
    far = np.flatnonzero((sight.reach == _FEW) & (end - following > _FEW))
    if far.size:
        farther = _look_through(gates, following[far], end[far], candidates[far], _WINDOW)
        for near, found in zip(sight, farther):
            near[far] = found
    return sight


def _look_through(gates: _Gates, following: np.ndarray, end: np.ndarray, candidates: np.ndarray, doors: int) -> _Sight:
    """The same, through so many doors at most."""
    index = following[:, None] + np.arange(min(doors, int((end - following).max())))
    inside = index < end[:, None]
    index = np.minimum(index, end[:, None] - 1)
    # Turn each view so that the border runs to the right; outwards is up, and y points down.
    turn = gates.ahead[following].conj()[:, None, None]
    low = (gates.low[index][:, None] - candidates[:, :, None]) * turn
    high = (gates.high[index][:, None] - candidates[:, :, None]) * turn
    with np.errstate(divide="ignore", invalid="ignore"):
        least = np.maximum.accumulate(-low.imag / low.real, axis=2)
        most = np.minimum.accumulate(-high.imag / high.real, axis=2)
        seen = inside[:, None] & (low.real > 1e-6) & (high.real > 1e-6) & (least <= most + 1e-9)
    reach = np.where(seen.all(axis=2), index.shape[1], np.argmin(seen, axis=2))
    row, best = np.arange(len(reach)), np.argmax(reach, axis=1)
    reach = reach[row, best]
    last = np.maximum(reach, 1) - 1
    return _Sight(candidates[row, best], reach, least[row, best, last], most[row, best, last])


def _candidates(gates: _Gates, following: np.ndarray, door: np.ndarray, sight: _Sight) -> np.ndarray:
    """Points (R, C) of the doors that are seen; of a door that isn't, all along it."""
    span = gates.high[door] - gates.low[door]
    bounds = []
    for slope, unseen in ((sight.least, 0.0), (sight.most, 1.0)):
        with np.errstate(invalid="ignore"):
            ray = (gates.ahead[following] * (1 - 1j * slope)).conj()
            across = (ray * span).imag
            hit = -(ray * (gates.low[door] - sight.corner)).imag / np.where(across == 0, 1, across)
        bounds.append(np.where(sight.reach > 0, np.clip(hit, 0, 1), unseen))
    share = np.linspace(0, 1, _CANDIDATES)
    depth = bounds[0][:, None] + (bounds[1] - bounds[0])[:, None] * share
    return np.asarray(gates.low[door][:, None] + span[:, None] * depth)
