"""Progress: nothing below two seconds, a share and what remains after it, one line where output is no terminal."""

import io

import pytest

from workbench.verbs import progress
from workbench.verbs.progress import Progress, kind, spoken


class Screen(io.StringIO):
    """A terminal."""

    def isatty(self):
        return True


@pytest.fixture
def clock(monkeypatch, tmp_path):
    """A clock that is set by hand, and a place for what is remembered."""
    now = [0.0]
    monkeypatch.setattr(progress, "QUIET", 2.0)
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    monkeypatch.setenv("WORKBENCH_CACHE", str(tmp_path))
    return now


COURSE = ((1.0, "reading"), (10.0, "case 1 of 4"), (20.0, "case 2 of 4"), (30.0, "writing"))


def ran(clock, start, speed=1.0, name="axis"):
    clock[0] = start
    with Progress("run", name) as say:
        for at, what in COURSE:
            clock[0] = start + at * speed
            say(what)
        clock[0] = start + 40.0 * speed


def test_a_quick_command_says_nothing(clock, capsys):
    with Progress("run") as say:
        for clock[0] in (0.1, 1.0, 1.9):
            say("reading")
    assert capsys.readouterr().err == ""


def test_elsewhere_than_on_a_terminal_it_is_one_line(clock, capsys):
    ran(clock, 0.0)
    assert capsys.readouterr().err == " 10.0 s  case 1 of 4\n"


def test_the_second_time_it_says_the_share_and_what_remains(clock, capsys):
    ran(clock, 0.0)
    capsys.readouterr()
    ran(clock, 100.0, speed=2.0)  # twice as slow
    # the cases begin at 25 % and end at 75 %; the first of four done is an eighth of the whole more
    assert capsys.readouterr().err == " 20.0 s  38 %, about 35 s still  case 1 of 4\n"


def test_another_study_remembers_its_own(clock, capsys):
    ran(clock, 0.0)
    capsys.readouterr()
    ran(clock, 100.0, name="other")
    assert "%" not in capsys.readouterr().err


def test_on_a_terminal_it_is_a_line_written_anew_that_goes_in_the_end(clock, monkeypatch):
    screen = Screen()
    monkeypatch.setattr(progress.sys, "stderr", screen)
    ran(clock, 0.0)
    said = screen.getvalue()
    assert "\n" not in said and said.count("\r\x1b[K") == 4 and said.endswith("\r\x1b[K")


def test_a_command_that_fails_or_a_broken_memory_leaves_none(clock, tmp_path):
    with pytest.raises(ZeroDivisionError), Progress("run", "axis") as say:
        clock[0] = 5.0
        say("reading")
        raise ZeroDivisionError
    assert list(tmp_path.rglob("*.json")) == []
    ran(clock, 0.0)
    (file,) = tmp_path.rglob("*.json")
    for broken in ("", "[1, 2]", "{}", '[["reading", "x"]]', "null"):
        file.write_text(broken)
        assert progress.remembered(file) == []


def test_the_share_never_falls_and_what_is_not_known_changes_nothing(clock):
    say = Progress("run", "axis")
    say.known = [("a", 0.1), ("case # of #", 0.2), ("a", 0.6), ("b", 0.9)]
    shares = []
    for what in ("a", "new", "case 1 of 2", "case 2 of 2", "a", "case 1 of 2", "b", "a"):
        say(what)
        shares.append(round(say.share, 6))
    assert shares == [0.1, 0.1, 0.4, 0.6, 0.6, 0.6, 0.9, 0.9]


@pytest.mark.parametrize(
    ("seconds", "words"), [(0.2, "1 s"), (7.4, "7 s"), (33.0, "35 s"), (89.0, "90 s"), (200.0, "3 min")]
)
def test_times_are_said_as_one_says_them(seconds, words):
    assert spoken(seconds) == words and kind("case 512 of 2000 at 0.5") == "case # of # at #"
