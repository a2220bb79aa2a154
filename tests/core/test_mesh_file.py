from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from core.errors import InputError
from core.geometry import AnyArray
from core.mesh import TriangleMesh
from core.mesh_file import MAX_FACES, read_mesh, read_mesh_parts, write_mesh
from core.mesh_topology import is_convex, topology
from core.progress import Reporter


class Listener(Reporter):
    def __init__(self) -> None:
        super().__init__()
        self.sentences: list[str] = []

    def warn(self, sentence: str) -> None:
        self.sentences.append(sentence)


def box(size_m: float = 0.1) -> TriangleMesh:
    made = trimesh.creation.box((size_m, size_m, size_m))
    return TriangleMesh(np.array(made.vertices), np.array(made.faces, dtype=np.int64))


def refusal(path: Path) -> str:
    with pytest.raises(InputError) as caught:
        read_mesh(path, Reporter())
    said = str(caught.value)
    assert path.name in said
    assert "\n" not in said
    return said


def big_ply(path: Path, n_faces: int) -> None:
    faces: AnyArray = np.zeros(n_faces, dtype=[("n", "u1"), ("corners", "<i4", 3)])
    faces["n"], faces["corners"] = 3, [0, 1, 2]
    header = (
        "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
        f"property float z\nelement face {n_faces}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    path.write_bytes(header.encode() + np.eye(3, dtype="<f4").tobytes() + faces.tobytes())


@pytest.mark.parametrize("ending", ["obj", "ply", "stl", "off"])
def test_every_format_gives_the_closed_box(tmp_path: Path, ending: str) -> None:
    made = box()
    path = tmp_path / f"box.{ending}"
    trimesh.Trimesh(made.vertices_m, made.faces).export(path)
    mesh = read_mesh(path, Reporter())
    assert len(mesh.vertices_m) == 8
    assert topology(mesh).is_closed
    assert mesh.volume_m3 == pytest.approx(1e-3)


def test_glb_is_turned_from_y_up_to_z_up(tmp_path: Path) -> None:
    trimesh.creation.box((0.1, 0.3, 0.2)).export(tmp_path / "tall.glb")
    mesh = read_mesh(tmp_path / "tall.glb", Reporter())
    np.testing.assert_allclose(mesh.extents_m, [0.1, 0.2, 0.3], atol=1e-6)
    assert mesh.volume_m3 > 0


@pytest.mark.parametrize("ending", [".ply", ".obj"])
def test_written_mesh_comes_back_exactly(tmp_path: Path, ending: str) -> None:
    mesh = TriangleMesh(box().vertices_m / 3 + 0.1, box().faces)
    write_mesh(tmp_path / f"m{ending}", mesh)
    back = read_mesh(tmp_path / f"m{ending}", Reporter())
    np.testing.assert_array_equal(back.vertices_m, mesh.vertices_m)
    np.testing.assert_array_equal(back.faces, mesh.faces)


def test_write_refuses_other_endings(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"m\.stl"):
        write_mesh(tmp_path / "m.stl", box())


def test_groups_of_an_obj_are_parts_in_the_file_s_order(tmp_path: Path) -> None:
    path = tmp_path / "three.obj"
    lines, start = [], 1
    for k in range(3):
        part = box(0.1 + 0.1 * k)
        lines += [f"o part_{k}", *(f"v {x} {y} {z}" for x, y, z in part.vertices_m)]
        lines += [f"f {a} {b} {c}" for a, b, c in part.faces + start]
        start += len(part.vertices_m)
    path.write_text("\n".join(lines))
    parts = read_mesh_parts(path, Reporter())
    assert [round(float(part.extents_m[0]), 6) for part in parts] == [0.1, 0.2, 0.3]
    assert len(read_mesh(path, Reporter()).faces) == 36


def test_the_authors_convex_parts(shared_data: Path) -> None:
    path = shared_data / "real_scan/amazon_tray/reference/authors_vhacd.obj"
    parts = read_mesh_parts(path, Reporter())
    assert len(parts) == 16
    assert all(map(is_convex, parts))


def test_missing_file(tmp_path: Path) -> None:
    assert "no mesh file" in refusal(tmp_path / "nothing.obj")


def test_unknown_ending(tmp_path: Path) -> None:
    path = tmp_path / "part.step"
    path.write_text("ISO-10303-21;")
    assert "convert it to one of .obj" in refusal(path)


@pytest.mark.parametrize("ending", ["obj", "ply", "stl", "off", "glb"])
def test_empty_file(tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"empty.{ending}"
    path.write_bytes(b"")
    refusal(path)


def test_points_without_faces(tmp_path: Path) -> None:
    path = tmp_path / "points.obj"
    path.write_text("v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\n")
    assert "no faces" in refusal(path)


def test_faces_without_area(tmp_path: Path) -> None:
    path = tmp_path / "line.obj"
    path.write_text("v 0 0 0\nv 0.1 0 0\nv 0.2 0 0\nf 1 2 3\n")
    assert "no face with an area" in refusal(path)


def test_vertices_that_are_no_numbers(tmp_path: Path) -> None:
    vertices = box().vertices_m.copy()
    vertices[3, 1] = np.nan
    write_mesh(tmp_path / "nan.ply", TriangleMesh(vertices, box().faces))
    assert "not finite numbers" in refusal(tmp_path / "nan.ply")


def test_faces_that_name_missing_vertices(tmp_path: Path) -> None:
    write_mesh(tmp_path / "wild.ply", TriangleMesh(box().vertices_m, box().faces + 4))
    assert "vertices it does not hold" in refusal(tmp_path / "wild.ply")


@pytest.mark.parametrize(
    ("size", "word"),
    [(95.0, "millimetres"), (240.0, "millimetres"), (9.5, "centimetres"), (1e6, "larger than any cell")],
)
def test_not_in_metres(tmp_path: Path, size: float, word: str) -> None:
    write_mesh(tmp_path / "mug.obj", box(size))
    assert word in refusal(tmp_path / "mug.obj")


def test_smaller_than_a_particle(tmp_path: Path) -> None:
    write_mesh(tmp_path / "crumb.ply", box(0.004))
    assert "smaller than a candy" in refusal(tmp_path / "crumb.ply")


def test_inside_out(tmp_path: Path) -> None:
    write_mesh(tmp_path / "turned.ply", TriangleMesh(box().vertices_m, box().faces[:, ::-1]))
    assert "inside out" in refusal(tmp_path / "turned.ply")


def test_every_face_twice_is_a_surface_with_a_warning(tmp_path: Path) -> None:
    made = box()
    doubled = TriangleMesh(made.vertices_m, np.vstack([made.faces, made.faces[:, ::-1]]))
    write_mesh(tmp_path / "doubled.ply", doubled)
    listener = Listener()
    assert len(read_mesh(tmp_path / "doubled.ply", listener).faces) == 2 * len(made.faces)
    assert "18 non-manifold edges" in listener.sentences[0]
    assert "taken as a surface" in listener.sentences[0]


def test_one_non_manifold_edge_of_many_is_a_warning(tmp_path: Path) -> None:
    made = trimesh.creation.icosphere(subdivisions=3, radius=0.05)
    vertices = np.vstack([made.vertices, [0, 0, 0.1]])
    fin = [[*made.faces[0][:2], len(made.vertices)]]
    write_mesh(tmp_path / "fin.ply", TriangleMesh(vertices, np.vstack([made.faces, fin])))
    listener = Listener()
    read_mesh(tmp_path / "fin.ply", listener)
    assert len(listener.sentences) == 1
    assert "fin.ply has 1 non-manifold" in listener.sentences[0]


def test_a_mesh_that_is_not_closed_is_a_surface_with_a_warning(tmp_path: Path) -> None:
    write_mesh(tmp_path / "torn.ply", TriangleMesh(box().vertices_m, box().faces[1:]))
    listener = Listener()
    read_mesh(tmp_path / "torn.ply", listener)
    assert len(listener.sentences) == 1
    assert "torn.ply is not closed (3 open edges): it is taken as a surface" in listener.sentences[0]


def test_a_face_against_its_neighbours_is_a_warning(tmp_path: Path) -> None:
    faces = box().faces.copy()
    faces[0] = faces[0, ::-1]
    write_mesh(tmp_path / "mixed.ply", TriangleMesh(box().vertices_m, faces))
    listener = Listener()
    read_mesh(tmp_path / "mixed.ply", listener)
    assert "opposite sides" in listener.sentences[0]


def test_five_million_faces_are_refused_unread(tmp_path: Path) -> None:
    big_ply(tmp_path / "huge.ply", 5_000_000)
    assert "5,000,000 faces" in refusal(tmp_path / "huge.ply")
    stl = tmp_path / "huge.stl"
    stl.write_bytes(bytes(80) + np.uint32(5_000_000).tobytes())
    with stl.open("r+b") as file:
        file.truncate(84 + 50 * 5_000_000)  # sparse: the disk holds its header only
    assert "5,000,000 faces" in refusal(stl)


def test_text_formats_are_counted_before_they_are_parsed(tmp_path: Path) -> None:
    obj = tmp_path / "huge.obj"
    obj.write_bytes(b"v 0 0 0\nv 1 0 0\nv 0 1 0\n" + b"f 1 2 3\n" * (MAX_FACES + 1))
    assert f"{MAX_FACES + 1:,} faces" in refusal(obj)
    off = tmp_path / "huge.off"
    off.write_text("OFF # a comment\n3 9000000 0\n")
    assert "9,000,000 faces" in refusal(off)


@pytest.mark.parametrize("ending", ["obj", "ply", "stl", "off", "glb"])
def test_a_folder_is_no_mesh(tmp_path: Path, ending: str) -> None:
    (tmp_path / f"folder.{ending}").mkdir()
    refusal(tmp_path / f"folder.{ending}")


HEADS = [
    b"",
    b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nelement face 1\nend_header\n",
    b"ply\nformat binary_little_endian 1.0\nelement vertex 999999999999\nproperty float x\nend_header\n",
    b"solid x\nfacet normal 0 0 1\nouter loop\n",
    b"OFF\n3 1 0\n",
    b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 ",
    b"glTF\x02\x00\x00\x00",
]


@pytest.mark.filterwarnings("ignore")
@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.sampled_from(["obj", "ply", "stl", "off", "glb"]), st.sampled_from(HEADS), st.binary(max_size=300))
def test_any_bytes_give_a_mesh_or_a_sentence(tmp_path: Path, ending: str, head: bytes, tail: bytes) -> None:
    path = tmp_path / f"any.{ending}"
    path.write_bytes(head + tail)
    try:
        assert len(read_mesh(path, Reporter()).faces) > 0
    except InputError as error:
        assert path.name in str(error)


@pytest.mark.filterwarnings("ignore")
@settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    arrays(np.float64, (6, 3), elements=st.floats() | st.floats(-1, 1)),
    arrays(np.int64, st.tuples(st.integers(1, 12), st.just(3)), elements=st.integers(-2, 8)),
)
def test_any_numbers_give_a_mesh_or_a_sentence(tmp_path: Path, vertices: AnyArray, faces: AnyArray) -> None:
    path = tmp_path / "any.ply"
    write_mesh(path, TriangleMesh(vertices, faces))
    try:
        mesh = read_mesh(path, Reporter())
    except InputError as error:
        assert path.name in str(error)
    else:
        assert np.isfinite(mesh.vertices_m).all()
        assert len(np.unique(mesh.faces)) == len(mesh.vertices_m)
