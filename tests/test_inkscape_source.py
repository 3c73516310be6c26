# SPDX-License-Identifier: GPL-2.0-or-later
"""Where the bytes of a picture come from, and from where they never come."""

from __future__ import annotations

import base64
import os
import socket
import urllib.parse

import pytest

inkex = pytest.importorskip("inkex")

from hypothesis import given
from hypothesis import strategies as st

from ddtcore.inkscape.source import (
    PictureError,
    data_bytes,
    find_file,
    is_relative,
    link_folders,
    read_picture,
)

CONTENT = bytes(range(256)) * 3


def image(**attributes):
    element = inkex.Image()
    for name, value in attributes.items():
        element.set(name.replace("__", ":"), value)
    return element


@given(st.binary(min_size=1), st.sampled_from(["", "image/png", "image/jpeg;charset=utf-8", "text/plain"]),
       st.sampled_from(["", "\n", "\r\n ", " ", "\t"]), st.booleans(), st.booleans())
def test_base64_in_every_form(data, kind, space, padded, encoded):
    text = base64.b64encode(data).decode()
    text = text if padded else text.rstrip("=")
    text = urllib.parse.quote(text, safe="") if encoded else text
    wrapped = space.join(text[at:at + 76] for at in range(0, len(text), 76)) + space
    assert data_bytes(f"data:{kind};base64,{wrapped}") == data


@given(st.binary(min_size=1))
def test_percent_encoded_data(data):
    assert data_bytes("data:image/png," + urllib.parse.quote(data)) == data


def test_data_uri_with_odd_spelling():
    assert data_bytes("DATA:;x=y; BASE64 ,-_-_") == base64.b64decode("+/+/")


@pytest.mark.parametrize("uri", ["data:image/png;base64,", "data:image/png;base64", "data:", "data:,",
                                 "data:;base64,!!!!", "data:;base64,A"])
def test_damaged_data_uri(uri):
    with pytest.raises(PictureError, match="empty or damaged"):
        data_bytes(uri)


@pytest.fixture
def folders(tmp_path):
    """A folder with the temporary copy of the document, and one with the document."""
    for name in ("copy", "document/bilder"):
        (tmp_path / name).mkdir(parents=True)
    return link_folders(str(tmp_path / "document" / "drawing.svg"), str(tmp_path / "copy" / "ink_ext.svg"))


@pytest.mark.parametrize("name", ["a.png", "bilder/mit leer.png", "bilder/größe.png", "100%.png", "a#b?c.png",
                                  "b%20c.png", "x;y,z&.png"])
@pytest.mark.parametrize("quoted", [True, False])
def test_relative_links(folders, name, quoted):
    path = os.path.join(folders[1], name)
    with open(path, "wb") as file:
        file.write(CONTENT)
    link = urllib.parse.quote(name) if quoted else name
    assert read_picture(image(xlink__href=link), folders) == CONTENT
    assert read_picture(image(href=link), folders) == CONTENT
    relative_to_copy = os.path.relpath(path, folders[0])
    assert find_file(relative_to_copy, folders) == os.path.abspath(path)


def test_a_link_is_looked_up_beside_the_copy_first(folders):
    for folder, content in zip(folders, (b"copy", b"document")):
        with open(os.path.join(folder, "a.png"), "wb") as file:
            file.write(content)
    assert read_picture(image(xlink__href="a.png"), folders) == b"copy"


@pytest.mark.parametrize("form", ["{path}", "file://{path}", "file:{path}", "FILE://localhost{path}"])
def test_absolute_links(tmp_path, form):
    path = tmp_path / "ein bild.png"
    path.write_bytes(CONTENT)
    for text in (str(path), urllib.parse.quote(str(path))):
        assert read_picture(image(xlink__href=form.format(path=text)), ()) == CONTENT


def test_absref_is_the_last_resort(tmp_path, folders):
    path = tmp_path / "moved.png"
    path.write_bytes(CONTENT)
    assert read_picture(image(xlink__href="gone/moved.png", sodipodi__absref=str(path)), folders) == CONTENT


@pytest.mark.parametrize("link", ["http://example.org/a.png", "https://example.org/a.png", "ftp://example.org/a",
                                  "//example.org/share/a.png", r"\\server\share\a.png", "smb://server/a.png",
                                  "file://server/share/a.png", "file:////server/share/a.png",
                                  "%2F%2Fserver/share/a.png", "file:///%5cserver/share/a.png"])
def test_nothing_is_fetched_from_a_network(monkeypatch, folders, link):
    monkeypatch.setattr(socket, "socket", lambda *_: pytest.fail("a socket was opened"))
    monkeypatch.setattr("builtins.open", lambda *_: pytest.fail("a file was opened"))
    monkeypatch.setattr(os.path, "isfile", lambda path: True)
    for element in (image(xlink__href=link), image(xlink__href=link, sodipodi__absref=link)):
        with pytest.raises(PictureError, match="not fetched from a network"):
            read_picture(element, folders)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
def test_only_regular_files_are_read(tmp_path, folders):
    os.mkfifo(tmp_path / "pipe.png")
    for link in (str(tmp_path / "pipe.png"), "/dev/zero", str(tmp_path), "a%00.png"):
        with pytest.raises(PictureError, match="no such file"):
            read_picture(image(xlink__href=link), folders)


def test_no_more_is_read_than_a_file_may_hold(tmp_path, monkeypatch):
    path = tmp_path / "a.png"
    path.write_bytes(CONTENT)
    monkeypatch.setattr("ddtcore.inkscape.source.MAX_BYTES", 9)
    assert read_picture(image(href=str(path)), ()) == CONTENT[:10]  # enough to be refused for its length


@pytest.mark.skipif(not os.path.isfile("/proc/self/stat"), reason="this system has no /proc")
def test_files_of_the_kernel_are_not_read():
    assert read_picture(image(href="/proc/self/stat"), ()) == b""


def test_an_unreadable_file_is_named(monkeypatch, tmp_path):
    path = tmp_path / "secret.png"
    path.write_bytes(CONTENT)

    def refuse(*_):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("builtins.open", refuse)
    with pytest.raises(PictureError, match=r"secret.png.* cannot be read \(Permission denied\)"):
        read_picture(image(xlink__href=str(path)), ())


def test_an_image_without_content():
    for element in (image(), image(href=""), image(xlink__href=" ")):
        with pytest.raises(PictureError, match="no content"):
            read_picture(element, ())


def test_a_long_link_is_shortened():
    with pytest.raises(PictureError) as caught:
        read_picture(image(href="a" * 10_000 + ".png"), ())
    assert len(str(caught.value)) < 300


def test_link_folders(tmp_path):
    svg = str(tmp_path / "a.svg")
    assert link_folders("", None) == ()
    assert link_folders(None, svg) == (str(tmp_path),)
    # Inkscape 1.4 gives the current folder for a document from a pipe.
    assert link_folders(str(tmp_path), svg) == (str(tmp_path), str(tmp_path))


@pytest.mark.parametrize("link, relative", [
    ("a.png", True), ("../b/a.png", True), ("a:b.png", True), ("", False), ("/a.png", False), ("#id", False),
    ("file:///a.png", False), ("data:,x", False), ("http://x/a.png", False), (r"\\x\a.png", False)])
def test_is_relative(link, relative):
    assert is_relative(link) is relative
