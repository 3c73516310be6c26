# SPDX-License-Identifier: GPL-2.0-or-later
"""The settings: ranges, choices and presets."""

from __future__ import annotations

from dataclasses import FrozenInstanceError, fields, replace

import pytest

from ddtcore.options import AUTOMATIC, PRESETS, Automatic, TraceOptions

SETTINGS = {setting.name: setting for setting in fields(TraceOptions)}
CHOICES = {name for name, setting in SETTINGS.items() if setting.metadata["choices"]}
TEXTS = {"palette"}
NUMBERS = sorted(set(SETTINGS) - CHOICES - TEXTS)


def refused(error, **changes):
    with pytest.raises(error) as caught:
        TraceOptions(**changes)
    (name, value), = changes.items()
    assert str(caught.value).startswith(f"{name} must be ") and str(value) in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize("name", NUMBERS)
def test_numbers_are_taken_from_the_lowest_to_the_highest_only(name):
    low, high = SETTINGS[name].metadata["low"], SETTINGS[name].metadata["high"]
    for value in (low, high):
        assert getattr(TraceOptions(**{name: value}), name) == value
    for value in (low - 1, high + 1):
        assert f"{low:g}" in refused(ValueError, **{name: value})


@pytest.mark.parametrize("name", NUMBERS)
@pytest.mark.parametrize("value", ("1", None, True, [1]))
def test_what_is_no_number_is_refused(name, value):
    refused(TypeError, **{name: value})


@pytest.mark.parametrize("name", [name for name in NUMBERS if isinstance(SETTINGS[name].default, float)])
def test_real_numbers_must_be_finite_and_may_be_whole(name):
    for value in (float("nan"), float("inf"), -float("inf")):
        refused(ValueError, **{name: value})
    high = SETTINGS[name].metadata["high"]
    assert getattr(TraceOptions(**{name: int(high)}), name) == high


@pytest.mark.parametrize("name", [name for name in NUMBERS if isinstance(SETTINGS[name].default, int)])
def test_whole_numbers_must_be_whole(name):
    assert "whole number" in refused(TypeError, **{name: 1.5})


@pytest.mark.parametrize("name", sorted(CHOICES))
def test_choices(name):
    for choice in SETTINGS[name].metadata["choices"]:
        assert getattr(TraceOptions(**{name: choice}), name) == choice
    for value in ("", "nonsense", None, 1):
        assert SETTINGS[name].default in refused(ValueError, **{name: value})


@pytest.mark.parametrize("value, text", [
    ("#000 #fff #d22", "#000000 #ffffff #dd2222"), ("", ""), (["#000", (1, 2, 3)], "#000000 #010203"),
    ((), "")])
def test_palettes_are_kept_as_one_text(value, text):
    options = TraceOptions(palette=value)
    assert options.palette == text and TraceOptions(palette=text) == options
    assert hash(options) == hash(TraceOptions(palette=text))


@pytest.mark.parametrize("value", ["red", "#12", None, 5, "none.gpl"])
def test_what_is_no_palette_is_refused(value):
    refused(ValueError, palette=value)


@pytest.mark.parametrize("name", sorted(SETTINGS))
def test_every_setting_explains_itself(name):
    text = SETTINGS[name].metadata["help"]
    assert text and text[0].islower() and not text.endswith(".")


@pytest.mark.parametrize("name", sorted(PRESETS))
def test_presets_change_what_they_say_and_give_way_to_changes(name):
    preset = TraceOptions.preset(name)
    for setting in SETTINGS:
        assert getattr(preset, setting) == PRESETS[name].get(setting, SETTINGS[setting].default)
    assert TraceOptions.preset(name, tolerance=1.5).tolerance == 1.5
    with pytest.raises(ValueError, match=r"^tolerance must"):
        TraceOptions.preset(name, tolerance=-1)


def test_automatic_options_take_the_settings_of_any_preset_and_keep_what_was_given():
    options = TraceOptions.preset(AUTOMATIC, tolerance=TraceOptions().tolerance, colors=5)
    assert isinstance(options, Automatic) and options.colors == 5
    for name in set(PRESETS) - {AUTOMATIC}:
        settled = options.settled(name)
        assert type(settled) is TraceOptions
        assert settled == TraceOptions.preset(name, tolerance=TraceOptions().tolerance, colors=5)
    shown = replace(options, result="border").settled("photo")
    assert shown == replace(options.settled("photo"), result="border")
    assert Automatic().settled("photo") == TraceOptions.preset("photo")


def test_unknown_preset_is_named():
    with pytest.raises(ValueError, match=r"^preset must be one of .*clip-art.*'cartoon'"):
        TraceOptions.preset("cartoon")


def test_settings_cannot_change_afterwards():
    with pytest.raises(FrozenInstanceError):
        TraceOptions().tolerance = 1.0
    assert TraceOptions() == TraceOptions() and hash(TraceOptions()) == hash(TraceOptions())
