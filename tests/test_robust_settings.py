# SPDX-License-Identifier: GPL-2.0-or-later
"""Every setting out of its range, and of a wrong type, through each of the four doors."""

from __future__ import annotations

import math
import re
from dataclasses import fields

import numpy as np
import pytest
from test_inkscape_program import PICTURE as PICTURE_FILE
from test_inkscape_program import image, write

from ddtcore import TraceOptions, trace
from ddtcore.cli import main
from ddtcore.options import PRESETS

SETTINGS = fields(TraceOptions)
PICTURE = np.zeros((2, 3), np.uint8)


def out_of_range(setting):
    """Values of the right type that must be refused."""
    meta = setting.metadata
    if meta["choices"]:
        return ["", "nonsense", meta["choices"][0].upper(), meta["choices"][0] + " "]
    if isinstance(setting.default, str):
        return ["nonsense", "#12", "#ggg", "missing.gpl"]
    step = 1 if isinstance(setting.default, int) else 0.001
    values = [meta["low"] - step, meta["high"] + step, -10**18, 10**18]
    return values if isinstance(setting.default, int) else [*values, math.nan, math.inf, -math.inf]


def wrong_types(setting):
    """Values of another type."""
    if setting.metadata["choices"] or isinstance(setting.default, str):
        return [None, 1, 1.5, True]
    return [None, "1", [1], (), {}, True, 1j, b"1"] + ([1.5] if isinstance(setting.default, int) else [])


def no_numbers(setting):
    """Texts that are no value of the type."""
    if isinstance(setting.default, str):
        return []
    return ["", "wide", "1,5", "0x10", "--"] + (["1.5", "1e3"] if isinstance(setting.default, int) else [])


def limits(setting):
    """What a message has to name besides the setting."""
    meta = setting.metadata
    if meta["choices"]:
        return list(meta["choices"])
    if isinstance(setting.default, str):
        return []
    return [f"{meta['low']:g}", f"{meta['high']:g}"]


def named(message, setting, flag=None):
    """Whether a message is one line that names a setting and what it can be."""
    words = [flag or setting.name, *limits(setting)]
    return "\n" not in message.strip() and all(word in message for word in words)


CASES = [pytest.param(setting, id=setting.name) for setting in SETTINGS]


@pytest.mark.parametrize("setting", CASES)
def test_library(setting):
    for error, values in ((ValueError, out_of_range(setting)), ((TypeError, ValueError), wrong_types(setting))):
        for value in values:
            for make in (TraceOptions, *(lambda preset=preset, **changes: TraceOptions.preset(preset, **changes)
                                         for preset in PRESETS)):
                with pytest.raises(error) as caught:
                    make(**{setting.name: value})
                assert named(str(caught.value), setting), caught.value


@pytest.mark.parametrize("options", [{}, "paper", TraceOptions, 1, [TraceOptions()]], ids=repr)
def test_library_takes_options_only(options):
    with pytest.raises(TypeError, match=r"options must be TraceOptions"):
        trace(PICTURE, options)


def test_library_knows_no_other_setting():
    with pytest.raises(TypeError, match="colour"):
        TraceOptions(colour=3)


@pytest.mark.parametrize("setting", CASES)
def test_command_line(setting, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    flag = "--" + setting.name.replace("_", "-")
    for value in [*map(str, out_of_range(setting)), *no_numbers(setting)]:
        with pytest.raises(SystemExit) as caught:
            main([f"{flag}={value}", "a.png"])
        out, error = capsys.readouterr()
        assert (caught.value.code, out) == (2, "") and named(error, setting, flag), error
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("setting", CASES)
def test_direct_call(setting, tmp_path, capsys):
    pytest.importorskip("inkex")
    from ddt_trace import DdtTrace

    document = tmp_path / "in.svg"
    document.touch()
    for value in [*map(str, out_of_range(setting)), *no_numbers(setting)]:
        with pytest.raises(SystemExit) as caught:
            DdtTrace().parse_arguments([f"--{setting.name}={value}", str(document)])
        out, error = capsys.readouterr()
        # Before the message argparse tells the usage.
        message = error.splitlines()[-1]
        assert (caught.value.code, out) == (2, "") and named(message, setting), message



IN_DIALOG = {
    "numbers too low": {s.name: str(out_of_range(s)[0]) for s in SETTINGS if not isinstance(s.default, str)},
    "numbers too high": {s.name: str(out_of_range(s)[1]) for s in SETTINGS if not isinstance(s.default, str)},
    "nothing": {s.name: "" for s in SETTINGS},
    "nonsense": {s.name: "nonsense" for s in SETTINGS},
}


@pytest.mark.parametrize("values", [pytest.param(values, id=name) for name, values in IN_DIALOG.items()])
def test_inkscape(values, inkscape, tmp_path):
    """Inkscape brings numbers back into their range; all else is refused by name, in one line and no box."""
    document, result, log = tmp_path / "in.svg", tmp_path / "out.svg", tmp_path / "log"
    write(document, image("only", 0, PICTURE_FILE))
    inkscape.trace(document, result, log=log, **values)
    message, = log.read_text(encoding="utf-8").splitlines()
    traced = "Settings: preset=" in result.read_text(encoding="utf-8")
    assert traced == message.startswith('"only": ')
    if not traced:
        setting, = (s for s in SETTINGS if re.match(f"A setting is wrong: (argument --)?{s.name}[ :]", message))
        assert all(word in message for word in limits(setting))
