"""Spoilt files of every kind are read or refused in one line; `make fuzz` draws many more.

FUZZ=5000 draws that many for each reader. What fails is kept: copy it to corpus/READER/.
"""

import os
from pathlib import Path

import pytest
from clock import in_time
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from trust.fuzzing import CORPUS, READERS, read_spoilt, spoilt

EXAMPLES = int(os.environ.get("FUZZ", "6"))
SECONDS = 10  # of the processor: none of these files is large
KEPT = Path(os.environ.get("FUZZ_KEPT", "build/fuzz"))

pytestmark = pytest.mark.filterwarnings("ignore")  # a user's terminal shows them; they end nothing


@pytest.mark.parametrize("reader", READERS)
def test_the_file_that_is_spoilt_is_good(reader, tmp_path):
    good, read = READERS[reader]
    read(good, tmp_path)


# a data set is read on trial by another process, each time
@pytest.mark.parametrize(
    "reader", [pytest.param(r, marks=pytest.mark.slow if r == "nc" else ()) for r in READERS]
)
def test_a_spoilt_file_is_read_or_refused_in_one_line(reader):
    @settings(
        max_examples=EXAMPLES,
        database=None,
        derandomize="FUZZ" not in os.environ,
        suppress_health_check=list(HealthCheck),
    )
    @given(st.data())
    def spoil(data):
        content = data.draw(spoilt(READERS[reader][0]))
        try:
            with in_time(SECONDS):
                read_spoilt(reader, content)
        except BaseException:
            KEPT.mkdir(parents=True, exist_ok=True)
            (KEPT / reader).write_bytes(content)
            raise

    try:
        spoil()
    except BaseException as error:  # the file is kept, and too long to print
        line = f"{KEPT / reader}: {type(error).__name__}: {str(error)[:300]}"
        pytest.fail(line, pytrace=False)


def kept_files():
    """The corpus; a file that its library reads without end takes the time that it is given."""
    for path in sorted(CORPUS.glob("*/*")):
        file = path.relative_to(CORPUS)
        waited_for = file.name == "library_without_end"
        yield pytest.param(file, marks=pytest.mark.slow if waited_for else (), id=str(file))


@pytest.mark.parametrize("file", [*kept_files()])
def test_what_once_ended_in_a_traceback_is_refused_in_one_line(file, monkeypatch):
    monkeypatch.setattr("teleopdesign.studies.result._LONGEST", 5.0)  # s that its library is given
    with in_time(SECONDS):
        read_spoilt(file.parent.name, (CORPUS / file).read_bytes())
