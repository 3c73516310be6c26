# SPDX-License-Identifier: GPL-2.0-or-later
"""Whatever goes wrong, the user sees one plain sentence."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest

inkex = pytest.importorskip("inkex")

from ddtcore.inkscape.faults import plain_messages
from ddtcore.inkscape.log import note


def test_an_abort_passes():
    with pytest.raises(inkex.AbortExtension, match="plain"), plain_messages():
        raise inkex.AbortExtension("plain")


def test_too_little_memory_is_an_abort():
    with pytest.raises(inkex.AbortExtension, match="not enough memory"), plain_messages():
        raise MemoryError


def test_an_unforeseen_fault_gives_one_sentence_and_a_file(capfd, monkeypatch, tmp_path):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    with pytest.raises(SystemExit) as caught, plain_messages():
        raise ZeroDivisionError("secret detail")
    message = capfd.readouterr().err
    assert caught.value.code == 1
    assert message.count("\n") <= 1 and "secret" not in message
    details = Path(re.search(r"the file (.*)\.$", message.strip()).group(1)).read_text(encoding="utf-8")
    assert "secret detail" in details and "Traceback" in details


def test_an_unforeseen_fault_on_a_full_disk(capfd, monkeypatch):
    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("tempfile.NamedTemporaryFile", full)
    with pytest.raises(SystemExit) as caught, plain_messages():
        raise ZeroDivisionError("some\ndetail")
    message = capfd.readouterr().err
    assert caught.value.code == 1
    assert message.endswith("ZeroDivisionError some detail.\n") and message.count("\n") == 1


@pytest.mark.parametrize("error, status", [(inkex.AbortExtension("sentence"), 251 - 256), (MemoryError(), -5),
                                           (KeyError("detail"), 1)])
def test_in_batch_runs_a_file_gets_everything(capfd, monkeypatch, tmp_path, error, status):
    monkeypatch.setenv("DDT_TRACE_LOG", str(tmp_path / "log"))
    with pytest.raises(SystemExit) as caught, plain_messages():
        raise error
    assert caught.value.code == status
    assert capfd.readouterr().err == ""
    assert re.search("sentence|memory|detail", (tmp_path / "log").read_text(encoding="utf-8"))


def test_libraries_cannot_write_to_stderr(capfd):
    with plain_messages():
        os.write(2, b"warning of a library")
    os.write(2, b"ours")
    assert capfd.readouterr().err == "ours"


def test_notes_are_appended(monkeypatch, tmp_path):
    assert not note("nowhere")
    monkeypatch.setenv("DDT_TRACE_LOG", str(tmp_path / "log"))
    assert note("one") and note("zwei: ü\ud800\n")
    assert (tmp_path / "log").read_text(encoding="utf-8") == "one\nzwei: ü?\n"
    monkeypatch.setenv("DDT_TRACE_LOG", str(tmp_path))
    assert not note("a folder is no file")
