"""Every bad input gives one sentence that names the file."""

from __future__ import annotations

import shutil

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from PIL import Image

from core.errors import InputError
from core.progress import Reporter
from core.scan import Scan, read_scan

VIEW = "frame-000002"


def refused(folder, *words: str) -> str:
    with pytest.raises(InputError) as caught:
        read_scan(folder, Reporter())
    sentence = str(caught.value)
    for word in words:
        assert word in sentence
    assert "\n" not in sentence
    assert sentence.endswith(".")
    return sentence


def save(path, pixels, **options) -> None:
    Image.fromarray(pixels).save(path, **options)


def test_no_such_folder(tmp_path):
    refused(tmp_path / "nowhere", "nowhere", "no folder")


def test_a_file_instead_of_a_folder(tmp_path):
    (tmp_path / "file").write_text("")
    refused(tmp_path / "file", "file")


def test_an_empty_folder(tmp_path):
    refused(tmp_path, str(tmp_path), "no views")


@pytest.mark.parametrize("ending", ["color.png", "depth.png", "pose.txt"])
def test_a_missing_file(folder, ending):
    (folder / "rgbd" / f"{VIEW}.{ending}").unlink()
    refused(folder, f"{VIEW}.{ending}", "missing")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("1 0 0 0\n0 1 0 0\n0 0 1 0\n", "4x4"),
        ("1 0 0\n0 1 0\n0 0 1\n0 0 0\n", "4x4"),
        ("", "4x4"),
        ("2 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", "not a rotation"),
        ("-1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", "not a rotation"),
        ("0 0 0 0\n0 0 0 0\n0 0 0 0\n0 0 0 1\n", "not a rotation"),
        ("1e300 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", "not a rotation"),
        ("nan 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", "NaN"),
        ("1 0 0 inf\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", "NaN or infinity"),
        ("1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 2\n", "last row"),
        ("1 0 0 0\n0 1 0 0\n0 0 1 0\n0.1 0 0 1\n", "last row"),
        ("1 0 0 450\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", "metres"),
        ("1 0 0 zero\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", "not a number"),
    ],
)
def test_a_pose_that_is_none(folder, text, words):
    (folder / "rgbd" / f"{VIEW}.pose.txt").write_text(text)
    refused(folder, f"{VIEW}.pose.txt", words)


def test_a_pose_that_is_no_text(folder):
    (folder / "rgbd" / f"{VIEW}.pose.txt").write_bytes(b"\xff\xfe\x00\x01")
    refused(folder, f"{VIEW}.pose.txt")


@pytest.mark.parametrize("ending", ["color.png", "depth.png"])
@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 0.95])
def test_a_truncated_png(folder, ending, share):
    path = folder / "rgbd" / f"{VIEW}.{ending}"
    content = path.read_bytes()
    path.write_bytes(content[: int(len(content) * share)])
    refused(folder, f"{VIEW}.{ending}", "cannot be read")


def test_depth_as_float_metres(folder):
    path = folder / "rgbd" / f"{VIEW}.depth.png"
    save(path, np.full((12, 16), 0.7, dtype=np.float32), format="TIFF")
    refused(folder, f"{VIEW}.depth.png", "floating-point", "millimetres")


def test_depth_in_whole_metres(folder):
    save(folder / "rgbd" / f"{VIEW}.depth.png", np.full((12, 16), 2, dtype=np.uint16))
    refused(folder, f"{VIEW}.depth.png", "in metres")


@pytest.mark.parametrize("shape", [(12, 16), (12, 16, 3)])
def test_8_bit_depth(folder, shape):
    save(folder / "rgbd" / f"{VIEW}.depth.png", np.full(shape, 200, dtype=np.uint8))
    refused(folder, f"{VIEW}.depth.png", "8-bit")


def test_16_bit_color(folder):
    save(folder / "rgbd" / f"{VIEW}.color.png", np.full((12, 16), 2000, dtype=np.uint16))
    refused(folder, f"{VIEW}.color.png", "8-bit RGB")


def test_depth_of_another_size(folder):
    save(folder / "rgbd" / f"{VIEW}.depth.png", np.full((24, 32), 700, dtype=np.uint16))
    refused(folder, f"{VIEW}.depth.png", "32 x 24", "16 x 12")


def test_color_of_another_size(folder):
    save(folder / "rgbd" / f"{VIEW}.color.png", np.full((24, 32, 3), 70, dtype=np.uint8))
    refused(folder, f"{VIEW}.color.png", "32 x 24", "16 x 12")


def test_missing_intrinsics(folder):
    (folder / "camera-intrinsics.txt").unlink()
    refused(folder, "camera-intrinsics.txt", "missing")


@pytest.mark.parametrize(
    "text",
    ["", "1 2 3\n", "0 0 8\n0 13 6\n0 0 1", "13 5 8\n0 13 6\n0 0 1", "nan 0 8\n0 13 6\n0 0 1", "a b c\n" * 3],
)
def test_invalid_intrinsics(folder, text):
    (folder / "camera-intrinsics.txt").write_text(text)
    refused(folder, "camera-intrinsics.txt")


def test_intrinsics_of_another_resolution(folder):
    (folder / "camera-intrinsics.txt").write_text("26.2 0 15.8\n0 26.4 12.2\n0 0 1\n")
    refused(folder, "camera-intrinsics.txt", "16 x 12")


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        '{"platform_height_m": "high"}',
        '{"platform_height_m": NaN}',
        '{"crop_min_m": [0, 0, 0]}',
        '{"crop_min_m": [0, 0], "crop_max_m": [1, 1]}',
        '{"crop_min_m": [0, 0, 0], "crop_max_m": [1, 1, Infinity]}',
        '{"crop_min_m": [0, 0, 0], "crop_max_m": [1, 1, 0.001]}',
    ],
)
def test_a_damaged_scan_json(folder, text):
    (folder / "scan.json").write_text(text)
    refused(folder, "scan.json")


def blank(folder, view: str) -> None:
    save(folder / "rgbd" / f"{view}.depth.png", np.zeros((12, 16), dtype=np.uint16))


def test_an_empty_depth_image_is_left_out(folder, listener):
    blank(folder, VIEW)
    scan = read_scan(folder, listener)
    assert [frame.name for frame in scan.frames] == ["frame-000000", "frame-000001", "frame-000003"]
    assert len(listener.warnings) == 1
    assert f"{VIEW}.depth.png" in listener.warnings[0]


def test_too_many_empty_depth_images(folder):
    blank(folder, "frame-000001")
    blank(folder, VIEW)
    refused(folder, "2 of the 4 views", str(folder))


def copy_view(folder, endings) -> None:
    for ending in endings:
        shutil.copy(folder / "rgbd" / f"frame-000000.{ending}", folder / "rgbd" / f"{VIEW}.{ending}")


def test_a_repeated_view_is_left_out(folder, listener):
    copy_view(folder, ["depth.png", "pose.txt"])
    assert VIEW not in [frame.name for frame in read_scan(folder, listener).frames]
    assert VIEW in listener.warnings[0]
    assert "left out" in listener.warnings[0]


def test_a_repeated_pose_with_another_image_stays(folder, listener):
    copy_view(folder, ["pose.txt"])
    assert VIEW in [frame.name for frame in read_scan(folder, listener).frames]
    assert "same pose" in listener.warnings[0]


words = st.one_of(
    st.floats(width=64).map(repr), st.sampled_from(["1", "0", "-1", "nan", "x", "1_0"]), st.text(max_size=5)
)
rows = st.lists(words, min_size=2, max_size=5).map(" ".join)
matrices = st.lists(rows, min_size=2, max_size=5).map("\n".join)
depths = st.one_of(
    st.binary(max_size=200).map(lambda content: ("bytes", content)),
    st.tuples(
        st.sampled_from(["uint8", "uint16", "int32", "float32"]),
        st.tuples(st.integers(1, 14), st.integers(1, 18)),
        st.integers(0, 70000),
    ),
)


@settings(max_examples=120, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    pose=st.one_of(st.none(), matrices), intrinsics=st.one_of(st.none(), matrices), depth=st.none() | depths
)
def test_whatever_the_files_hold_it_is_a_scan_or_a_sentence(
    folder, tmp_path_factory, pose, intrinsics, depth
):
    spoiled = tmp_path_factory.mktemp("spoiled") / "scan"
    shutil.copytree(folder, spoiled)
    if pose is not None:
        (spoiled / "rgbd" / f"{VIEW}.pose.txt").write_text(pose, encoding="utf-8")
    if intrinsics is not None:
        (spoiled / "camera-intrinsics.txt").write_text(intrinsics, encoding="utf-8")
    if depth is not None:
        path = spoiled / "rgbd" / f"{VIEW}.depth.png"
        if depth[0] == "bytes":
            path.write_bytes(depth[1])
        else:
            kind, shape, value = depth
            save(
                path,
                np.full(shape, min(value, np.iinfo(np.uint8).max if kind == "uint8" else 65535)).astype(kind),
                format="TIFF",
            )
    try:
        scan = read_scan(spoiled, Reporter())
    except InputError as error:
        assert "\n" not in str(error)
    else:
        assert isinstance(scan, Scan)
