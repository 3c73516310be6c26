# SPDX-License-Identifier: GPL-2.0-or-later
"""Bad luck: no room on the disk, no right to write, no reader: it is said, and nothing is lost."""

from __future__ import annotations

import errno
import io
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from ddtcore import trace_file
from ddtcore.cli import main
from ddtcore.model import Drawing
from ddtcore.svg import save

ROOT = Path(__file__).resolve().parent.parent
NOBODY = 65534
OLD = b"the drawing that was there before"

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="limits, users and devices of POSIX")


@pytest.fixture
def folder(tmp_path):
    """Two pictures that anybody may read, one with a drawing that is there already."""
    for name in ("a.png", "b.png"):
        pixels = np.random.RandomState(0).randint(0, 2, (40, 40)).astype(np.uint8) * 255
        Image.fromarray(pixels).save(tmp_path / name)
    (tmp_path / "a.svg").write_bytes(OLD)
    tmp_path.chmod(0o755)
    return tmp_path


def limited(bytes_per_file):
    """Let a process write no more than so many bytes to a file, as on a disk that fills up."""
    import resource
    import signal

    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (bytes_per_file, bytes_per_file))


def run(*arguments, cwd, program=("-m", "ddtcore"), **settings):
    """Run a program; the file that Python may write beside a module is none of its business."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONDONTWRITEBYTECODE": "1", "DDT_TRACE_LOG": ""}
    return subprocess.run([sys.executable, *program, *map(str, arguments)], cwd=cwd, env=environment, timeout=120,
                          **{"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **settings})


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def one_line(done, *words):
    message = done.stderr.decode()
    assert message.count("\n") == 1 and all(word in message for word in words), message


@pytest.mark.parametrize("room", [0, 1, 1000])
def test_a_full_disk_leaves_the_old_drawing_and_no_other_file(folder, room):
    done = run("a.png", "--preset=clip-art", cwd=folder, preexec_fn=lambda: limited(room))
    assert done.returncode == 1
    one_line(done, "a.svg can't be written", os.strerror(errno.EFBIG))
    assert (folder / "a.svg").read_bytes() == OLD and names(folder) == ["a.png", "a.svg", "b.png"]


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="there is no /dev/full")
@pytest.mark.parametrize("arguments", [["a.png", "-o", "-"], ["a.png", "-o", "/dev/full"]], ids=["stdout", "device"])
def test_a_full_device_is_said(folder, arguments):
    with open("/dev/full", "wb") as full:
        done = run(*arguments, cwd=folder, stdout=full)
    assert done.returncode == 1
    one_line(done, "can't be written", os.strerror(errno.ENOSPC))


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="there is no /dev/full")
def test_reports_that_find_no_room_do_not_keep_a_batch_from_going_on(folder):
    with open("/dev/full", "wb") as full:
        done = run("a.png", "b.png", "--json", cwd=folder, stdout=full)
        lines = done.stderr.decode().splitlines()
        assert done.returncode == 1 and lines[2].endswith("0 of 2 pictures traced, 2 failed"), lines
        assert all(f"{name}.png: the report can't be written" in line for name, line in zip("ab", lines))
        assert run("bad.png", "b.png", cwd=folder, stderr=full).returncode == 1
    assert names(folder) == ["a.png", "a.svg", "b.png", "b.svg"]
    assert (folder / "a.svg").read_bytes() != OLD


@pytest.mark.parametrize("closed", [1, 2])
def test_a_reader_that_left_does_not_keep_a_batch_from_going_on(folder, closed):
    reading, writing = os.pipe()
    os.close(reading)
    done = run("a.png", "bad.png", "b.png", "--json", cwd=folder,
               **{"stdout" if closed == 1 else "stderr": writing})
    os.close(writing)
    assert done.returncode == 1 and names(folder) == ["a.png", "a.svg", "b.png", "b.svg"]
    assert (done.stderr or b"").count(b"\n") == (2 if closed == 1 else 0)


@pytest.mark.parametrize("closed, arguments, words", [
    (0, ["-", "-o", "c.svg"], "standard input can't be read"),
    (1, ["a.png", "-o", "-"], "standard output can't be written"),
    (1, ["a.png", "--report"], "a.png: the report can't be written"), (2, ["bad.png"], "")])
def test_standard_streams_that_were_closed(folder, closed, arguments, words):
    # A file that is opened must not take their place either: what is said would go there.
    done = run(*arguments, cwd=folder, preexec_fn=lambda: os.close(closed))
    assert (done.returncode, done.stdout) == (1, b"")
    if words:
        one_line(done, words)
    assert "c.svg" not in names(folder)


def test_standard_input_without_end(folder):
    with open("/dev/zero", "rb") as zeros:
        code = "import ddtcore.raster as r, ddtcore.cli as c; r.MAX_BYTES = 1 << 20; raise SystemExit(c.main(['-']))"
        done = run(cwd=folder, program=["-c", code], stdin=zeros)
    assert (done.returncode, done.stdout) == (1, b"")
    one_line(done, "the input has more than", "GB, the limit")


def as_somebody_else(folder, *arguments):
    """Status and error lines of the command line run by a user who may read in a folder, not write."""
    trace_file(folder / "b.png", folder / "b.svg")  # all modules are loaded now: that user may not reach them
    (folder / "b.svg").unlink()
    folder.chmod(0o555)
    closed = [parent for parent in folder.parents if not parent.stat().st_mode & 0o001]
    for parent in closed:
        parent.chmod(parent.stat().st_mode | 0o011)
    with tempfile.TemporaryFile() as error:
        child = os.fork()
        if not child:
            status = 99
            try:
                os.chdir(folder)
                os.dup2(error.fileno(), 2)
                sys.stderr = io.TextIOWrapper(io.FileIO(2, "w"))
                if os.getuid() == 0:
                    os.setgroups([])
                    os.setegid(NOBODY)
                    os.seteuid(NOBODY)
                status = main(arguments)
                sys.stderr.flush()
            finally:
                os._exit(status)
        status = os.waitpid(child, 0)[1]
        error.seek(0)
        return status >> 8, error.read().decode().splitlines()


def test_a_folder_without_the_right_to_write(folder):
    status, lines = as_somebody_else(folder, "a.png", "b.png")
    assert status == 1 and len(lines) == 3 and lines[2].endswith("0 of 2 pictures traced, 2 failed"), lines
    assert all(f"{name}.svg can't be written: Permission denied" in line for name, line in zip("ab", lines))
    assert (folder / "a.svg").read_bytes() == OLD and names(folder) == ["a.png", "a.svg", "b.png"]


def test_a_batch_goes_on_past_an_output_that_is_a_folder(folder):
    (folder / "a.svg").unlink()
    (folder / "a.svg").mkdir()
    done = run("a.png", "b.png", cwd=folder)
    assert done.returncode == 1 and "a.svg can't be written" in done.stderr.decode()
    assert (folder / "b.svg").read_bytes().startswith(b"<svg") and (folder / "a.svg").is_dir()
    assert names(folder) == ["a.png", "a.svg", "b.png", "b.svg"]


@pytest.mark.parametrize("step", ["write", "replace", "chmod"])
def test_whatever_step_of_writing_fails_the_old_drawing_stays(folder, step, monkeypatch):
    def fail(*arguments):
        raise OSError(errno.EIO, os.strerror(errno.EIO))

    def pieces(*arguments):
        yield b"half a drawing"
        fail()

    if step == "write":
        monkeypatch.setattr("ddtcore.svg.encoded", pieces)
    else:
        monkeypatch.setattr(os, step, fail)
    with pytest.raises(OSError):
        save(Drawing(3, 2), str(folder / "a.svg"))
    monkeypatch.undo()
    assert (folder / "a.svg").read_bytes() == OLD and names(folder) == ["a.png", "a.svg", "b.png"]


DOCUMENT = ('<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink">'
            '<image id="i" width="9" height="9" xlink:href="a.png"/></svg>')


def direct(folder, *arguments, **settings):
    """Call the extension itself on a document."""
    pytest.importorskip("inkex")
    document = folder / "in.svg"
    document.write_text(DOCUMENT)
    return run(*arguments, document, cwd=folder, program=[str(ROOT / "ddt_trace.py")], **settings)


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="there is no /dev/full")
def test_the_extension_says_when_its_output_is_full(folder):
    with open("/dev/full", "wb") as full:
        done = direct(folder, stdout=full)
    assert done.returncode != 0 and done.stderr
    assert (folder / "in.svg").read_text() == DOCUMENT


def test_the_extension_works_where_its_log_cannot_be_written(folder, monkeypatch):
    monkeypatch.setenv("DDT_TRACE_LOG", str(folder / "missing" / "log"))
    done = direct(folder, stdout=subprocess.PIPE)
    assert (done.returncode, done.stderr) == (0, b"") and b"<path" in done.stdout


def test_a_closed_error_stream_does_not_matter(folder):
    reading, writing = os.pipe()
    os.close(reading)
    done = subprocess.run([sys.executable, "-m", "ddtcore", "missing.png"], cwd=folder, stderr=writing,
                          env={**os.environ, "PYTHONPATH": str(ROOT)})
    os.close(writing)
    assert done.returncode in (0, 1)


def test_the_library_reports_it_as_an_os_error(folder):
    with pytest.raises(OSError):
        trace_file(folder / "a.png", folder / "missing" / "a.svg")
    assert names(folder) == ["a.png", "a.svg", "b.png"]
