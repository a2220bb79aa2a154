import os
import tempfile
from pathlib import Path

from hypothesis import given
from hypothesis import strategies as st

from core.session.record import file_sizes, folder_digest

NAMES = st.text("abc.", min_size=1, max_size=3).filter(lambda name: name.strip("."))
CONTENTS = st.dictionaries(NAMES, st.binary(max_size=8), max_size=4)


def digest_of(contents: dict[str, bytes], *, backwards: bool = False, time_s: int = 0) -> str:
    with tempfile.TemporaryDirectory() as folder:
        for name in sorted(contents, reverse=backwards):
            path = Path(folder, name)
            path.write_bytes(contents[name])
            os.utime(path, (time_s, time_s))
        Path(folder, "record.json").write_text(str(time_s))
        return folder_digest(Path(folder))


@given(CONTENTS)
def test_digest_knows_no_times_and_no_order(contents: dict[str, bytes]) -> None:
    assert digest_of(contents) == digest_of(contents, backwards=True, time_s=1_000_000)


@given(CONTENTS, CONTENTS)
def test_digests_are_equal_exactly_when_the_files_are(one: dict[str, bytes], other: dict[str, bytes]) -> None:
    assert (digest_of(one) == digest_of(other)) == (one == other)


def test_names_and_contents_do_not_run_together() -> None:
    assert digest_of({"a": b"bc"}) != digest_of({"ab": b"c"})
    assert digest_of({"a": b"", "b": b"x"}) != digest_of({"a": b"x", "b": b""})


def test_files_below_count_and_the_record_does_not(tmp_path: Path) -> None:
    (tmp_path / "rgbd").mkdir()
    (tmp_path / "rgbd" / "a.png").write_bytes(b"123")
    (tmp_path / "record.json").write_text("{}")
    assert file_sizes(tmp_path) == {"rgbd/a.png": 3}
