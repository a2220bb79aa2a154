import numpy as np
import pytest
from PIL import Image

from app.library.session_folder import THUMBNAIL_FILE
from app.library.summary import summarize
from app.library.thumbnail import SIZE_PX, current_thumbnail, make_thumbnail
from core.errors import SessionError
from core.imagination.rendering.pictures import BAR_PX
from core.mesh import TriangleMesh
from core.mesh_file import read_ply
from core.mesh_picture import shaded_picture
from core.session import Session


def opened(path):
    with Image.open(path) as picture:
        assert (picture.format, picture.size) == ("PNG", SIZE_PX)
        return picture.convert("RGB")


def test_the_evidence_is_shown_without_its_caption(make_session):
    folder = make_session("mug")
    make_session.render(folder)
    still = folder / "evidence" / "drop_6_end.png"
    with Image.open(still) as picture:
        picture.paste((255, 255, 255), (0, picture.height - BAR_PX, picture.width, picture.height))
        picture.save(still)
    assert current_thumbnail(folder) is None
    path = make_thumbnail(folder)
    assert path == folder / THUMBNAIL_FILE == summarize(folder).thumbnail
    assert opened(path).getextrema() == ((200, 200), (0, 0), (0, 0))


def test_without_evidence_the_middle_of_the_first_view_is_shown(make_session):
    folder = make_session("mug")
    first = folder / "scan" / "rgbd" / "frame-000000.color.png"
    picture = Image.new("RGB", (640, 480), (9, 9, 9))
    picture.paste((0, 250, 0), (280, 200, 360, 280))
    picture.save(first)
    shown = opened(make_thumbnail(folder))
    assert shown.getpixel((160, 120)) == (0, 250, 0)
    share = sum(pixel[1] > 100 for pixel in shown.get_flattened_data()) / (320 * 240)
    assert share == pytest.approx(80 * 80 / (640 * 480) / 0.6**2, rel=0.05)


def test_a_mesh_is_shaded(make_session):
    folder = make_session.of_mesh("pot", "teapot.ply")
    shown = opened(make_thumbnail(folder))
    background = shown.getpixel((0, 0))
    body = {pixel for pixel in shown.get_flattened_data() if pixel != background}
    assert shown.getpixel((160, 120)) in body
    share = sum(pixel != background for pixel in shown.get_flattened_data()) / (320 * 240)
    assert 0.2 < share < 0.8


def test_near_faces_hide_far_ones_and_an_inside_is_seen_from_above(make_session):
    box = read_ply(make_session.of_mesh("box", "box.ply") / "mesh" / "mesh.ply")
    top = [k for k, face in enumerate(box.faces) if (box.vertices_m[face][:, 2] > 0.04).all()]
    open_box = TriangleMesh(box.vertices_m, box.faces[[k for k in range(len(box.faces)) if k not in top]])
    closed, opened_box = shaded_picture(box, SIZE_PX), shaded_picture(open_box, SIZE_PX)
    assert closed.tobytes() != opened_box.tobytes()
    lower = (160, 200)  # a side wall, in front of whatever the open box shows
    assert closed.getpixel(lower) == opened_box.getpixel(lower)


def test_it_is_made_anew_only_when_its_source_changed(make_session):
    folder = make_session("mug")
    first = make_thumbnail(folder)
    made = first.stat().st_mtime_ns
    make_thumbnail(folder)
    assert first.stat().st_mtime_ns == made
    make_session.render(folder)
    assert summarize(folder).thumbnail is None
    make_thumbnail(folder)
    assert opened(first).getpixel((160, 120)) == (200, 0, 0)
    assert not list(folder.glob(".*.part"))


def test_evidence_of_another_scan_is_not_shown(make_session):
    folder = make_session("mug")
    make_session.render(folder)
    with Session.open(folder) as session, session.writing("scan", inputs={}, parameters={}) as stage:
        Image.new("RGB", (64, 48), (0, 77, 0)).save(stage / "frame-000000.color.png")
    assert opened(make_thumbnail(folder)).getpixel((160, 120)) == (0, 77, 0)


def test_an_empty_session_has_none(make_session):
    folder = make_session.empty("new")
    assert make_thumbnail(folder) is None
    assert current_thumbnail(folder) is None


@pytest.mark.parametrize("share", [0.0, 0.3, 0.6])
def test_a_damaged_picture_is_a_sentence(make_session, share):
    folder = make_session("mug")
    first = folder / "scan" / "rgbd" / "frame-000000.color.png"
    noise = np.random.default_rng(0).integers(0, 255, (48, 64, 3), dtype=np.uint8)
    Image.fromarray(noise).save(first)
    content = first.read_bytes()
    first.write_bytes(content[: int(share * len(content))])
    with pytest.raises(SessionError, match="frame-000000"):
        make_thumbnail(folder)
