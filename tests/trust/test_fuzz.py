"""Spoilt files of every kind are read or refused in one line; `make fuzz` draws many more.

FUZZ=5000 draws that many for each reader. What fails is kept: copy it to corpus/READER/.
"""

import os
import signal
from contextlib import contextmanager
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from trust.fuzzing import CORPUS, READERS, read_spoilt, spoilt

EXAMPLES = int(os.environ.get("FUZZ", "12"))
SECONDS = 10  # of the processor: none of these files is large
KEPT = Path(os.environ.get("FUZZ_KEPT", "build/fuzz"))

pytestmark = pytest.mark.filterwarnings("ignore")  # a user's terminal shows them; they end nothing


@contextmanager
def in_time():
    def late(*_):
        raise AssertionError(f"took more than {SECONDS} s")

    before = signal.signal(signal.SIGPROF, late)
    signal.setitimer(signal.ITIMER_PROF, SECONDS)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


@pytest.mark.parametrize("reader", READERS)
def test_the_file_that_is_spoilt_is_good(reader, tmp_path):
    good, read = READERS[reader]
    read(good, tmp_path)


#: readers that are known to let errors of their libraries through
OPEN = {"h5": "h5py raises RuntimeError and KeyError on damaged files"}


def marked(name, reader):
    if reader not in OPEN:
        return pytest.param(name, id=str(name))
    return pytest.param(
        name, id=str(name), marks=pytest.mark.xfail(reason=OPEN[reader], strict=False)
    )


@pytest.mark.parametrize("reader", [marked(reader, reader) for reader in READERS])
def test_a_spoilt_file_is_read_or_refused_in_one_line(reader):
    @settings(
        max_examples=EXAMPLES,
        deadline=None,
        database=None,
        derandomize="FUZZ" not in os.environ,
        suppress_health_check=list(HealthCheck),
    )
    @given(st.data())
    def spoil(data):
        content = data.draw(spoilt(READERS[reader][0]))
        try:
            with in_time():
                read_spoilt(reader, content)
        except BaseException:
            KEPT.mkdir(parents=True, exist_ok=True)
            (KEPT / reader).write_bytes(content)
            raise

    try:
        spoil()
    except BaseException as error:  # the file is kept, and too long to print
        said = f"{KEPT / reader}: {type(error).__name__}: {str(error)[:300]}"
        pytest.fail(said, pytrace=False)


@pytest.mark.parametrize(
    "file", [marked(p.relative_to(CORPUS), p.parent.name) for p in sorted(CORPUS.glob("*/*"))]
)
def test_what_once_ended_in_a_traceback_is_refused_in_one_line(file):
    with in_time():
        read_spoilt(file.parent.name, (CORPUS / file).read_bytes())
