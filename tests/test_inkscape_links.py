# SPDX-License-Identifier: GPL-2.0-or-later
"""Links to pictures survive an effect in Inkscape 1.4, which forgets to turn them back."""

from __future__ import annotations

import pytest

inkex = pytest.importorskip("inkex")

from ddtcore.inkscape.links import make_links_absolute


def test_relative_links_to_files_become_absolute(tmp_path):
    for name in ("a b.png", "ü.png"):
        (tmp_path / name).write_bytes(b"x")
    svg = inkex.SvgDocumentElement()
    links = {"a%20b.png": "a%20b.png", "ü.png": "%C3%BC.png", "./a b.png": "a%20b.png"}
    for link in links:
        for attribute in ("href", "xlink:href"):
            svg.append(inkex.Image.new(**{attribute.replace(":", "__"): link}))
    make_links_absolute(svg, (str(tmp_path),))
    expected = [f"{tmp_path.as_uri()}/{name}" for name in links.values() for _ in range(2)]
    assert [image.get("href") or image.get("xlink:href") for image in svg] == expected
    assert all(len(image.attrib) == 1 for image in svg)


@pytest.mark.parametrize("link", ["no.png", "/a.png", "file:///a.png", "data:,x", "http://x/a.png", "#a", ""])
def test_other_links_stay(tmp_path, link):
    svg = inkex.SvgDocumentElement()
    image = inkex.Image()
    image.set("xlink:href", link)
    svg.append(image)
    use = inkex.Use()
    use.set("xlink:href", "a.png")
    (tmp_path / "a.png").write_bytes(b"x")
    svg.append(use)
    make_links_absolute(svg, (str(tmp_path),))
    assert (image.get("xlink:href"), use.get("xlink:href")) == (link, "a.png")
