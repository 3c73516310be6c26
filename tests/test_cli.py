# SPDX-License-Identifier: GPL-2.0-or-later
"""The command line, from outside and from inside."""

from __future__ import annotations

import gzip
import json
import os
import signal
import subprocess
import sys
from dataclasses import fields

import numpy as np
import pytest
from PIL import Image

import ddtcore
from ddtcore import TraceOptions
from ddtcore.cli import main
from ddtcore.model import Drawing
from ddtcore.options import PRESETS, PURPOSES, Automatic
from ddtcore.pipeline import STAGES

ROOT = os.path.dirname(os.path.dirname(ddtcore.__file__))


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with three pictures and a file that is none, as the current one."""
    monkeypatch.chdir(tmp_path)
    for k, name in enumerate(("a.png", "b.jpg", "c d.png")):
        pixels = np.full((8, 12, 3), 255, dtype=np.uint8)
        pixels[2:6, 2:6 + k] = (200, 40, 50)
        Image.fromarray(pixels).save(name)
    (tmp_path / "bad.png").write_bytes(b"no picture")
    return tmp_path


def process(*arguments, **settings):
    """Run the command line as a program of its own."""
    environment = {**os.environ, "PYTHONPATH": ROOT, "COLUMNS": "80"}
    return subprocess.run([sys.executable, "-m", "ddtcore", *arguments], env=environment,
                          capture_output=True, **settings)


def lines(capsys):
    """What went to standard output and to standard error, as lines."""
    out, error = capsys.readouterr()
    return out.splitlines(), error.splitlines()


def new_files(folder):
    return sorted(set(os.listdir(folder)) - {"a.png", "b.jpg", "c d.png", "bad.png"})


# -- files ------------------------------------------------------------------------

def test_drawing_goes_beside_the_picture_in_silence(folder, capsys):
    assert main(["a.png"]) == 0
    assert new_files(folder) == ["a.svg"] and lines(capsys) == ([], [])
    assert (folder / "a.svg").read_text() == ddtcore.trace(ddtcore.load_image("a.png")).to_svg()


def test_output_file_may_be_compressed(folder):
    assert main(["a.png", "-o", "x.svg"]) == main(["a.png", "--output=y.svgz"]) == 0
    assert gzip.decompress((folder / "y.svgz").read_bytes()) == (folder / "x.svg").read_bytes()


def test_standard_input_and_output(folder):
    main(["a.png"])
    expected = (folder / "a.svg").read_bytes()
    done = process("-", input=(folder / "a.png").read_bytes())
    assert (done.returncode, done.stdout, done.stderr) == (0, expected, b"")
    done = process("a.png", "-o", "-", "--report")
    assert done.stdout == expected and b"BMP / SVG" in done.stderr


@pytest.mark.parametrize("jobs", ("1", "2"))
def test_batch_goes_on_past_bad_files_and_sums_up(folder, capsys, jobs):
    code = main(["a.png", "bad.png", "none.png", "b.jpg", "c d.png", "--out-dir", "deep/er", "--jobs", jobs])
    out, error = lines(capsys)
    assert code == 1 and out == [] and sorted(os.listdir("deep/er")) == ["a.svg", "b.svg", "c d.svg"]
    assert len(error) == 3 and "bad.png" in error[0] and "none.png" in error[1]
    assert error[2].endswith("3 of 5 pictures traced, 2 failed")


def test_one_failure_is_one_line(folder, capsys):
    assert main(["bad.png"]) == 1
    out, error = lines(capsys)
    assert out == [] and len(error) == 1
    assert error[0].endswith("bad.png is not a picture of a kind that can be read")
    assert main(["a.png", "-o", "no/folder/a.svg"]) == 1
    assert lines(capsys)[1][0].endswith("no/folder/a.svg can't be written: No such file or directory")
    assert new_files(folder) == []


# -- usage ------------------------------------------------------------------------

@pytest.mark.parametrize("arguments, said", [
    ([], "no picture given"),
    (["a.png", "--tollerance", "1"], "no option --tollerance; did you mean --tolerance?"),
    (["a.png", "--colours=3"], "did you mean --colors?"),
    (["a.png", "--xyzzy"], "no option --xyzzy (--help"),
    (["comapre", "a.png"], "no picture or command comapre; did you mean compare?"),
    (["a.png", "--tolerance", "-1"], "--tolerance must be between 0.02 and 10 px, not -1"),
    (["a.png", "--tolerance", "nan"], "--tolerance must be between"),
    (["a.png", "--tolerance", "wide"], "--tolerance: must be a number between 0.02 and 10 px, not 'wide'"),
    (["a.png", "--colors", "1.5"], "--colors: must be a whole number between 0 and 256, not '1.5'"),
    (["a.png", "--cost", "cheap"], "--cost must be one of yu, paper, not 'cheap'"),
    (["a.png", "--preset", "cartoon"], "--preset must be one of automatic, clip-art"),
    (["a.png", "--palette", "#000 red"], "--palette must be colours such as '#000 #fff #d22', or a GIMP palette"),
    (["a.png", "--palette", "no.gpl"], "--palette must be a file that can be read, not 'no.gpl'"),
    (["a.png", "--merge", "101"], "--merge must be between 0 and 100 %, not 101"),
    (["a.png", "--jobs", "-1"], "--jobs must be 0 or more, not -1"),
    (["a.png", "b.jpg", "-o", "x.svg"], "-o and - are for one picture"),
    (["a.png", "b.jpg", "-o", ""], "-o and - are for one picture"),
    (["a.png", "-"], "-o and - are for one picture"),
    (["a.png", "-o", "x.png"], "-o must end in .svg or .svgz, not 'x.png'"),
    (["a.png", "-o", ""], "-o must end in"),
    (["a.png", "-o", "."], "-o must end in"),
    (["a.png", "-o", "x.svg", "--out-dir", "y"], "exclude each other"),
    (["a.png", "--out-dir", "a.png"], "--out-dir 'a.png' can't be made"),
    (["a.png", "a.gif"], "a.png and a.gif would both become a.svg"),
    (["a.png", "x/a.png", "--out-dir", "y"], "would both become"),
])
def test_bad_usage_is_one_line_and_nothing_is_done(folder, capsys, arguments, said):
    with pytest.raises(SystemExit) as caught:
        main(arguments)
    out, error = lines(capsys)
    assert caught.value.code == 2 and out == [] and len(error) == 1 and said in error[0]
    assert not [name for name in new_files(folder) if name.endswith("svg")]


def given(monkeypatch, *arguments):
    """The options that arguments lead to."""
    seen = []
    monkeypatch.setattr("ddtcore.cli.run_all", lambda jobs, *given: seen.extend(jobs) or [])
    assert main(["a.png", *arguments]) == 0
    return seen[0].options


SETTINGS = fields(TraceOptions)


@pytest.mark.parametrize("setting", SETTINGS, ids=[setting.name for setting in SETTINGS])
def test_every_setting_is_a_flag(monkeypatch, capsys, setting):
    meta = setting.metadata
    text = isinstance(setting.default, str)
    value = meta["choices"][-1] if meta["choices"] else "#000 #fff" if text else type(setting.default)(meta["low"])
    flag = "--" + setting.name.replace("_", "-")
    options = given(monkeypatch, flag, str(value))
    assert options == TraceOptions.preset("automatic", **{setting.name: value})
    assert given(monkeypatch, flag, str(value), "--preset=clip-art") == TraceOptions(**{setting.name: value})
    if not text:
        with pytest.raises(SystemExit):
            main(["a.png", flag, str(type(setting.default)(meta["high"] + 1))])
        assert f"{flag} must be between" in lines(capsys)[1][0]


def test_flags_win_over_the_preset(monkeypatch):
    assert given(monkeypatch) == Automatic()
    assert given(monkeypatch, "--preset", "paper") == TraceOptions.preset("paper")
    changed = given(monkeypatch, "--suppression", "3", "--preset", "paper", "--cost", "yu")
    assert changed == TraceOptions.preset("paper", suppression=3, cost="yu")


def test_help_fits_in_80_columns_and_names_everything():
    done = process("--help")
    text = done.stdout.decode()
    assert (done.returncode, done.stderr) == (0, b"")
    assert max(map(len, text.splitlines())) < 80
    for setting in SETTINGS:
        assert f"  --{setting.name.replace('_', '-')} " in text
    words = " ".join(text.split())
    for name, purpose in PURPOSES.items():
        assert f" {name} {purpose.replace('`', '')}" in words
    assert list(PURPOSES) == list(PRESETS)
    assert "examples:" in text and "exit status:" in text and "%(" not in text and "%%" not in text


@pytest.mark.parametrize("missing", ["numpy", "PIL"])
def test_a_missing_library_is_one_line_that_says_how_to_get_it(folder, missing):
    code = (f"import sys; sys.modules[{missing!r}] = None\n"
            "from ddtcore.cli import main; sys.exit(main(['a.png']))")
    done = subprocess.run([sys.executable, "-c", code], env={**os.environ, "PYTHONPATH": ROOT},
                          stderr=subprocess.PIPE, text=True)
    assert done.returncode == 1 and done.stderr.count("\n") == 1
    assert missing in done.stderr.replace("Pillow", "PIL") and "install" in done.stderr


def test_version():
    done = process("--version")
    assert (done.returncode, done.stdout.split()) == (0, [b"DDT", b"Trace", ddtcore.__version__.encode()])


# -- what is said -----------------------------------------------------------------

def test_report_as_text_and_as_json(folder, capsys):
    assert main(["a.png", "--report"]) == 0
    out, error = lines(capsys)
    assert out[0] == "a.png, 12 x 8 px" and error == []
    assert main(["a.png", "b.jpg", "bad.png", "--json", "--quiet"]) == 1
    out, error = lines(capsys)
    assert [json.loads(line)["picture"] for line in out] == ["a.png", "b.jpg"] and len(error) == 1


def test_timings_as_text_and_as_json(folder, capsys):
    assert main(["a.png", "--timings"]) == 0
    out, error = lines(capsys)
    assert out[0] == "a.png" and error == []
    stages = ["start", "reading", *STAGES, "writing"]
    assert [line.rsplit(None, 4)[0].strip() for line in out[1:]] == [*stages, "in all"]
    assert main(["a.png", "--timings", "--json"]) == 0
    (line,), error = lines(capsys)
    figures = json.loads(line)
    assert set(figures) == {"picture", "timings"} and error == []
    assert [lap["stage"] for lap in figures["timings"]] == stages
    assert all(lap["seconds"] >= 0 and lap["peak_mb"] >= 0 for lap in figures["timings"])


def test_report_and_timings_go_together(folder, capsys):
    assert main(["a.png", "--report", "--timings"]) == 0
    out, _ = lines(capsys)
    assert out[0] == "a.png, 12 x 8 px" and out[-1].strip().startswith("in all") and "a.png" not in out
    assert main(["a.png", "b.jpg", "--report", "--timings", "--json"]) == 0
    out, _ = lines(capsys)
    assert [{"bytes", "timings"} <= set(json.loads(line)) for line in out] == [True, True]


def test_a_budget_that_bites_is_one_line(folder, capsys):
    Image.fromarray(np.random.RandomState(1).randint(0, 256, (90, 120, 3)).astype(np.uint8)).save("a.png")
    assert main(["a.png", "--megapixels", "0.01"]) == 0
    out, error = lines(capsys)
    assert out == [] and len(error) == 1 and "a.png: traced at 1/2 of its resolution" in error[0]
    assert 'width="120" height="90"' in (folder / "a.svg").read_text()


def test_notes_go_to_standard_error_unless_quiet(folder, capsys, monkeypatch):
    monkeypatch.setattr("ddtcore.pipeline.trace", lambda *given: Drawing(12, 8, notes=("one", "two")))
    assert main(["a.png"]) == 0
    out, error = lines(capsys)
    assert out == [] and [line.split(": ", 1)[1] for line in error] == ["a.png: one", "a.png: two"]
    assert main(["a.png", "b.jpg", "--quiet"]) == 0
    assert lines(capsys) == ([], [])


def test_warnings_of_libraries_are_not_shown(folder):
    code = ("import warnings, ddtcore.pipeline as p, ddtcore.cli as c; trace = p.trace;"
            " p.trace = lambda *a: (warnings.warn('noise'), trace(*a))[1]; c.main(['a.png'])")
    done = subprocess.run([sys.executable, "-c", code], env={**os.environ, "PYTHONPATH": ROOT},
                          stderr=subprocess.PIPE)
    assert (done.returncode, done.stderr) == (0, b"")


# -- bad luck ---------------------------------------------------------------------

@pytest.mark.skipif(sys.platform == "win32", reason="POSIX signals and pipes")
class TestUnix:
    def test_a_closed_pipe_is_no_error(self, folder):
        reading, writing = os.pipe()
        os.close(reading)
        done = subprocess.run([sys.executable, "-m", "ddtcore", "a.png", "-o", "-"], stdout=writing,
                              stderr=subprocess.PIPE, env={**os.environ, "PYTHONPATH": ROOT})
        os.close(writing)
        assert (done.returncode, done.stderr) == (0, b"")

    @pytest.mark.parametrize("jobs", (1, 2))
    def test_interruption_is_silent_and_leaves_no_file(self, folder, jobs):
        # The file is half written when Ctrl-C comes, to the whole group as from a terminal.
        # One write per line: those of two processes may come in any order, but not mixed.
        code = f"""if True:
            import os, sys, time, ddtcore.svg, ddtcore.cli
            def pieces(*arguments):
                yield b"half a "
                os.write(1, b"ready\\n")
                time.sleep(600)
            ddtcore.svg.encoded = pieces
            sys.exit(ddtcore.cli.main(["a.png", "b.jpg", "--jobs", "{jobs}"]))"""
        # Shells let what they start in the background ignore Ctrl-C; that would be inherited.
        child = subprocess.Popen([sys.executable, "-c", code], start_new_session=True, stdout=subprocess.PIPE,
                                 stderr=subprocess.PIPE, env={**os.environ, "PYTHONPATH": ROOT},
                                 preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
        for _ in range(jobs):
            assert child.stdout.readline() == b"ready\n"
        os.killpg(child.pid, signal.SIGINT)
        _, error = child.communicate(timeout=30)
        assert (child.returncode, error) == (130, b"") and new_files(folder) == []

    def on_a_terminal(self, *arguments):
        """What a terminal receives when the command line runs there, and the exit code."""
        import pty

        terminal, end = pty.openpty()
        child = subprocess.Popen([sys.executable, "-m", "ddtcore", *arguments], stderr=end, stdout=end,
                                 env={**os.environ, "PYTHONPATH": ROOT})
        os.close(end)
        pieces = []
        while True:
            try:
                pieces.append(os.read(terminal, 1 << 12))
            except OSError:  # Linux says this where others send nothing more.
                break
            if not pieces[-1]:
                break
        os.close(terminal)
        return b"".join(pieces).decode(), child.wait()

    def test_a_terminal_sees_how_far_it_is_and_nothing_of_it_in_the_end(self, folder):
        text, code = self.on_a_terminal("a.png", "c d.png")
        for stage, share in STAGES.items():
            assert f"1 of 2, a.png: {stage}, {share:.0%}" in text and f"2 of 2, c d.png: {stage}" in text
        shown, last = text.split("\n")[-2].rstrip("\r").split("\r")[-2:]
        assert code == 0 and shown.strip() == "" and last.endswith("2 of 2 pictures traced, 0 failed")
        text, code = self.on_a_terminal("a.png", "c d.png", "--jobs", "2")
        assert code == 0 and "1 of 2 done" in text

    def test_a_quiet_terminal_stays_empty(self, folder):
        assert self.on_a_terminal("a.png", "--quiet") == ("", 0)

    def test_a_device_is_written_to(self, folder):
        done = process("a.png", "-o", "/dev/stdout")
        assert done.returncode == 0 and done.stdout.startswith(b"<svg")
