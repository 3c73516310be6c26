# SPDX-License-Identifier: GPL-2.0-or-later
"""The settings of the dialog become the options of a trace."""

from __future__ import annotations

from argparse import ArgumentParser

import pytest

pytest.importorskip("inkex")

from ddtcore.inkscape.settings import add_arguments, changes, trace_options
from ddtcore.options import PRESETS, Automatic, TraceOptions


def parse(*arguments):
    parser = ArgumentParser()
    add_arguments(parser)
    return parser.parse_args(arguments)


@pytest.mark.parametrize("preset", PRESETS)
def test_settings_at_their_default_follow_the_preset(preset):
    assert trace_options(parse(f"--preset={preset}")) == TraceOptions.preset(preset)


def test_a_changed_setting_wins_over_the_preset():
    options = trace_options(parse("--preset=paper", "--suppression=5", "--colors=7"))
    assert options == TraceOptions.preset("paper", suppression=5, colors=7)


def test_colours_and_files_are_taken_as_palettes(tmp_path):
    file = tmp_path / "two colours.gpl"
    file.write_text("GIMP Palette\n0 0 0 black\n255 0 0\tred\n")
    for arguments in (["--palette=#000, #f00"], ["--palette_file", str(file)], ["--palette", str(file)]):
        assert trace_options(parse(*arguments)).palette == "#000000 #ff0000"
    both = parse("--palette=#00f", "--palette_file", str(file))
    assert trace_options(both).palette == "#0000ff" and changes(vars(both)) == {"palette": "#00f"}
    with pytest.raises(ValueError, match=r"palette must be a file that can be read"):
        trace_options(parse("--palette_file", str(tmp_path / "none.gpl")))


def test_the_defaults_are_those_of_the_library():
    assert trace_options(parse()) == Automatic()
    assert changes(vars(parse())) == {}


@pytest.mark.parametrize("text", ["0.5", "0.50", "0.50000000000000000"])
def test_numbers_as_each_version_of_inkscape_writes_them(text):
    assert changes(vars(parse(f"--tolerance={text}"))) == {"tolerance": 0.5}


def test_a_value_out_of_range_is_named():
    with pytest.raises(ValueError, match="tolerance must be between"):
        trace_options(parse("--tolerance=1000"))


def test_every_argument_explains_itself():
    parser = ArgumentParser()
    add_arguments(parser)
    assert all(action.help for action in parser._actions)
    assert "threshold" in parser.format_help()
