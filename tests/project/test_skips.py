"""The rule on skips of conftest.py, tried on sessions that break it."""

from pathlib import Path

import pytest
from conftest import NO_DATA, measured

CONFTEST = (Path(__file__).resolve().parents[1] / "conftest.py").read_text(encoding="utf-8")

OFFENCES = """
import pytest, unittest

def test_call(): pytest.skip("it is slow")
def test_unittest(): raise unittest.SkipTest("it is slow")
def test_xfail_call(): pytest.xfail("some day")

@pytest.mark.xfail
def test_xfail(): assert False

@pytest.mark.xfail
def test_xpass(): pass

@pytest.mark.xfail(run=False)
def test_not_run(): assert False

@pytest.mark.skip
def test_mark(): pass

@pytest.mark.skipif(True, reason="it is slow")
def test_skipif(): pass

@pytest.fixture
def lazy(): pytest.skip("it is slow")
def test_fixture(lazy): pass

class TestCase(unittest.TestCase):
    @unittest.skip("it is slow")
    def test_case(self): pass
"""

SUBTEST = """
import pytest

def test_part(subtests):
    with subtests.test(): pytest.skip("it is slow")
"""

ALLOWED = """
import pytest

def test_call(): pytest.skip("no C compiler here")

@pytest.mark.skipif(True, reason="no browser here")
def test_mark(): pass

def test_that_runs(): pass
"""


LINES = ("pytest.importorskip('no_such_module')", "pytest.skip(allow_module_level=True)")
WHOLE = {f"test_{k}": f"import pytest\n{line}\ndef test_that_does_not_run(): pass\n" for k, line in enumerate(LINES)}


@pytest.fixture
def session(pytester):
    """Run test files under the project's conftest."""
    pytester.makeconftest(CONFTEST)

    def run(*arguments: str, **files: str):
        pytester.makepyfile(**files)
        return pytester.runpytest_subprocess("-p", "no:cacheprovider", *arguments)

    return run


def test_an_allowed_skip_stays_a_skip(session):
    result = session(test_allowed=ALLOWED)
    result.assert_outcomes(passed=1, skipped=2)
    assert result.ret == 0


def test_any_other_skip_and_every_expected_failure_is_a_failure(session):
    result = session(test_offences=OFFENCES)
    outcomes = result.parseoutcomes()
    # One of these fails for each test of the file; whether as failure or error depends on the phase that it skipped in.
    assert set(outcomes) <= {"failed", "errors"}
    assert sum(outcomes.values()) == OFFENCES.count("def test_")
    assert result.ret == 1


def test_a_part_of_a_test_may_not_skip_either(session):
    result = session(test_subtest=SUBTEST)
    assert set(result.parseoutcomes()) == {"failed"}
    assert result.ret == 1


def test_a_whole_file_may_not_skip_either(session):
    result = session(**WHOLE)
    assert result.ret != 0
    result.stdout.fnmatch_lines(["*skipped for a reason that is not allowed*"] * len(LINES))


def test_the_rule_holds_where_another_process_runs_the_tests(session):
    result = session("-n", "1", test_allowed=ALLOWED, test_offences=OFFENCES, test_subtest=SUBTEST, **WHOLE)
    outcomes = result.parseoutcomes()
    assert (outcomes.pop("passed"), outcomes.pop("skipped")) == (1, 2)
    assert set(outcomes) <= {"failed", "errors"}
    assert sum(outcomes.values()) >= OFFENCES.count("def test_") + 1 + len(LINES)
    assert result.ret == 1
    result.stdout.fnmatch_lines(["*skipped for a reason that is not allowed*"] * len(LINES))


def test_data_skips_where_the_variable_is_unset_and_fails_where_it_is_mistyped(monkeypatch, tmp_path):
    monkeypatch.delenv("WORKBENCH_DATA", raising=False)
    with pytest.raises(pytest.skip.Exception, match=NO_DATA):
        measured()
    monkeypatch.setenv("WORKBENCH_DATA", str(tmp_path / "mistyped"))
    with pytest.raises(pytest.fail.Exception, match="which is not a folder"):
        measured("campaigns")
    monkeypatch.setenv("WORKBENCH_DATA", str(tmp_path))
    assert measured() == tmp_path.resolve()
    with pytest.raises(pytest.skip.Exception, match=NO_DATA):
        measured("campaigns")
