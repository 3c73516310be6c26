# SPDX-License-Identifier: GPL-2.0-or-later
"""Pictures that are no clip art: a sprite, as it is and enlarged, and a photograph."""

from __future__ import annotations

import numpy as np

INVADER = """
..#.....#..
...#...#...
..#######..
.##.###.##.
###########
#.#######.#
#.#.....#.#
...##.##..."""


def sprite(colours=((0, 0, 0, 0), (60, 220, 80, 255))):
    rows = INVADER.split()
    return np.array(colours, np.uint8)[[[int(character == "#") for character in row] for row in rows]]


def enlarged(image, times):
    return np.repeat(np.repeat(image, times, axis=0), times, axis=1)


def photograph(size=256, channels=3, seed=0):
    """Clouds of all sizes, as the light of nature is: their power falls with the square of the frequency."""
    random = np.random.RandomState(seed)
    frequency = np.hypot(*np.meshgrid(np.fft.fftfreq(size), np.fft.fftfreq(size)))
    frequency[0, 0] = 1
    planes = []
    for _ in range(channels):
        cloud = np.fft.ifft2(np.fft.fft2(random.normal(size=(size, size))) / frequency ** 1.1).real
        planes.append((cloud - cloud.min()) / np.ptp(cloud))
    common = planes[0]
    rgb = [255 * (0.6 * common + 0.4 * planes[k % channels]) for k in range(3)]
    return np.dstack([*rgb, np.full((size, size), 255)]).astype(np.uint8)
