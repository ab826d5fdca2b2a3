"""Tests of reading and writing files of meshes, pairs and scenes."""

import errno
import gzip
import json
import os
import pickle
import subprocess
import sys

import numpy as np
import pytest

import crumple
from conftest import OnDevice, soup


@pytest.mark.parametrize("extension", ["ply", "obj", "off", "3mf", "ply.gz", "obj.gz"])
@pytest.mark.parametrize("scalar", ["float32", "float64"])
def test_written_and_read_coordinates_keep_every_bit(extension, scalar, tmp_path):
    mesh = soup(20, dtype=scalar)
    path = tmp_path / f"mesh.{extension}"
    crumple.write_mesh(path, (mesh.vertices, mesh.faces.astype(np.uint64)))
    read = crumple.read_mesh(str(path), precision=scalar)
    assert read.vertices.dtype == scalar and read.vertices.tobytes() == mesh.vertices.tobytes()
    assert read.faces.dtype == np.int32 and (read.faces == mesh.faces).all() and read.groups is None
    assert read.vertices.flags.writeable, "the arrays belong to whoever read them"


def test_files_named_gz_are_compressed(tmp_path, crossing, detector):
    result = detector.intersections(crossing)
    for extension in ("txt", "csv", "json", "npz", "ply", "3mf"):
        plain, packed = tmp_path / f"a.{extension}", tmp_path / f"a.{extension}.gz"
        result.save(plain)
        result.save(packed)
        assert gzip.decompress(packed.read_bytes()) == plain.read_bytes()
    with pytest.raises(crumple.InvalidInput, match="a.gz"):
        result.save(tmp_path / "a.gz")
    (tmp_path / "cut.ply.gz").write_bytes((tmp_path / "a.ply.gz").read_bytes()[:-1])
    with pytest.raises(crumple.InvalidInput, match="cut.ply.gz, byte [0-9]+: the gzip data is truncated"):
        crumple.read_mesh(tmp_path / "cut.ply.gz")


def test_ply_keeps_groups(tmp_path):
    mesh = soup(20)._replace(groups=np.arange(20) % 3)
    crumple.write_mesh(tmp_path / "mesh.ply", mesh)
    assert crumple.read_mesh(tmp_path / "mesh.ply", group_property="group").groups.tolist() == mesh.groups.tolist()


def test_stl_is_welded_unless_weld_is_no(tmp_path):
    crumple.write_mesh(tmp_path / "mesh.stl", ([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [[0, 1, 2], [1, 3, 2]]))
    assert len(crumple.read_mesh(tmp_path / "mesh.stl").vertices) == 4
    assert len(crumple.read_mesh(tmp_path / "mesh.stl", weld="no").vertices) == 6


def test_strided_and_contiguous_meshes_give_the_same_file(tmp_path):
    mesh = soup(20, dtype=np.float64)
    crumple.write_mesh(tmp_path / "a.ply", mesh)
    crumple.write_mesh(
        tmp_path / "b.ply", (np.asfortranarray(mesh.vertices), mesh.faces.astype("i8")[::-1].copy()[::-1])
    )
    assert (tmp_path / "a.ply").read_bytes() == (tmp_path / "b.ply").read_bytes()


def test_error_names_the_bad_file(tmp_path):
    with pytest.raises(crumple.FileError, match="none.ply") as caught:
        crumple.read_mesh(tmp_path / "none.ply")
    assert isinstance(caught.value, OSError) and caught.value.code == "file"
    assert (caught.value.errno, caught.value.strerror) == (errno.ENOENT, os.strerror(errno.ENOENT))
    assert str(caught.value) == f"cannot read {tmp_path}/none.ply: No such file or directory"
    copy = pickle.loads(pickle.dumps(caught.value))
    assert (type(copy), str(copy), copy.errno, copy.code) == (
        crumple.FileError,
        str(caught.value),
        errno.ENOENT,
        "file",
    )
    (tmp_path / "cut.off").write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n")
    with pytest.raises(crumple.InvalidInput, match="cut.off") as caught:
        crumple.read_mesh(tmp_path / "cut.off")
    assert caught.value.code == "format" and caught.value.element == "line"
    with pytest.raises(crumple.InvalidInput, match="precision must be one of"):
        crumple.read_mesh(tmp_path / "cut.off", precision="float16")
    with pytest.raises(crumple.InvalidInput, match="triangle 0 names vertex"):
        crumple.write_mesh(tmp_path / "mesh.ply", (np.zeros((2, 3)), [[0, 1, 2**40]]))
    with pytest.raises(crumple.Error):
        crumple.write_mesh(tmp_path / "mesh.docx", soup(1))
    assert sorted(p.name for p in tmp_path.iterdir()) == ["cut.off"]


def test_extension_decides_the_format_of_a_saved_result(tmp_path, crossing, detector):
    result = detector.intersections(crossing, output="contacts")
    for name, start in {
        "pairs.txt": b"0 1 segment ",
        "pairs.csv": b"a,b,kind,",
        "pairs.json": b"{",
        "pairs.npz": b"PK",
        "mesh.ply": b"ply\n",
        "mesh.obj": b"mtllib mesh.mtl\n",
        "mesh.glb": b"glTF",
        "mesh.html": b"<!DOCTYPE html>",
    }.items():
        result.save(tmp_path / name)
        assert (tmp_path / name).read_bytes().startswith(start)
    for name in ("pairs.txt", "pairs.csv", "pairs.json", "pairs.npz"):
        assert crumple.read_pairs(tmp_path / name).tolist() == [[0, 1]]
    assert json.loads((tmp_path / "pairs.json").read_text())["pairs"] == [[0, 1]]
    assert np.load(tmp_path / "pairs.npz")["contact_points"].shape == (2, 3)
    assert len(crumple.read_mesh(tmp_path / "mesh.ply").faces) == 3
    detector.intersections(crossing, crossing).save(tmp_path / "both.ply")
    assert len(crumple.read_mesh(tmp_path / "both.ply").faces) == 6
    np.savez_compressed(tmp_path / "long.npz", pairs=np.array([[5, 6], [7, 8]], np.int64, order="F"))
    assert crumple.read_pairs(tmp_path / "long.npz").tolist() == [[5, 6], [7, 8]]
    for name in ("mesh.html", "pairs.csv"):
        with pytest.raises(crumple.FileError, match=f"cannot write .*{name}: there is no folder .*none") as caught:
            result.save(tmp_path / "none" / name)
        assert caught.value.errno == errno.ENOENT
    result.save(os.fsencode(tmp_path / "bytes.txt"))
    assert (tmp_path / "bytes.txt").read_bytes() == (tmp_path / "pairs.txt").read_bytes()
    with pytest.raises(crumple.InvalidInput, match="a result is saved as .txt"):
        result.save(tmp_path / "pairs.xlsx")


def test_files_are_written_from_host_memory_only(tmp_path, crossing, detector):
    """Arrays in device memory are refused: their addresses would be read as addresses of host memory."""
    arrays = OnDevice(crossing.vertices, kind=1), OnDevice(crossing.faces, kind=1)
    results = [detector.intersections(*arrays), detector.intersections(crossing, arrays)]
    results[0].save(tmp_path / "mesh.html")
    (tmp_path / "mesh.html").unlink()
    for array in arrays:
        array.place = (2, 0)
    wanted = "vertices lie in CUDA memory, but must be in host memory: copy them to the host"
    with pytest.raises(crumple.InvalidInput, match=wanted):
        crumple.write_mesh(tmp_path / "mesh.ply", arrays)
    for result in results:
        for name in ("mesh.ply", "mesh.obj", "mesh.glb", "mesh.html"):
            with pytest.raises(crumple.InvalidInput, match=wanted):
                result.save(tmp_path / name)
        result.save(tmp_path / "pairs.csv")
    assert [path.name for path in tmp_path.iterdir()] == ["pairs.csv"]


@pytest.mark.parametrize("extension", ["ply", "obj", "glb", "html"])
def test_saving_a_mesh_is_refused_if_the_lists_no_longer_fit_the_result(extension, tmp_path, crossing, detector):
    def changed(change):
        vertices, faces = crossing.vertices.tolist(), crossing.faces.tolist()
        result = detector.intersections(vertices, faces)
        result.save(tmp_path / f"mesh.{extension}")
        change(vertices, faces)
        with pytest.raises(crumple.InvalidInput):
            result.save(tmp_path / f"mesh.{extension}")

    changed(lambda vertices, faces: vertices.pop())
    changed(lambda vertices, faces: vertices.clear())
    changed(lambda vertices, faces: vertices[0].pop())
    changed(lambda vertices, faces: faces.pop())
    changed(lambda vertices, faces: faces.append([0, 1, 2]))
    changed(lambda vertices, faces: faces[1].reverse() or faces[1].__setitem__(0, -1))
    changed(lambda vertices, faces: faces[1].__setitem__(0, 9))


@pytest.mark.parametrize("name", ["mesh.PLY", "mesh.GLB", "pairs.CSV", "pairs.Npz", "page.HTML"])
def test_extensions_may_be_upper_case(name, tmp_path, crossing, detector):
    result, lower = detector.intersections(crossing), tmp_path / f"lower_{name.lower()}"
    for path in (tmp_path / name, lower):
        result.save(path)
    assert (tmp_path / name).read_bytes()[:4] == lower.read_bytes()[:4]


@pytest.mark.parametrize("extension", ["txt", "csv", "json", "npz", "ply", "obj", "glb", "html", "png"])
def test_file_names_with_nul_or_a_lone_surrogate_are_refused(extension, crossing, detector):
    for name in ("a\0b", "\ud800"):
        with pytest.raises(crumple.InvalidInput, match="^path cannot be the name of a file$"):
            detector.intersections(crossing).save(f"{name}.{extension}")


@pytest.mark.parametrize("name", ["pairs.csv", "mesh.ply", "page.html"])
def test_error_escapes_a_file_name_that_is_not_utf8(name, tmp_path, crossing, detector):
    path = os.fsencode(tmp_path) + b"/\xff/" + name.encode()
    with pytest.raises(crumple.FileError) as caught:
        detector.intersections(crossing).save(path)
    assert str(caught.value) == rf"cannot write {tmp_path}/\xff/{name}: there is no folder {tmp_path}/\xff"
    with pytest.raises(crumple.FileError, match=r"\\xff") as caught:
        crumple.read_mesh(path)


def test_options_of_other_file_formats_are_refused(tmp_path, crossing, detector):
    result = detector.intersections(crossing)
    for name, options in [
        ("a.txt", {"window_size": (4, 3)}),
        ("a.npz", {"height": 3}),
        ("a.ply", {"colour": "red"}),
        ("a.html", {"height": 3, "width": 4}),
    ]:
        option, extension = list(options)[-1], name[1:]
        with pytest.raises(crumple.InvalidType, match=f"^{option} is not an option of {extension} files$"):
            result.save(tmp_path / name, **options)
    assert not list(tmp_path.iterdir())
    result.save(tmp_path / "a.html", height=333)
    assert "height:333px" in (tmp_path / "a.html").read_text()


def test_scenes_are_reproducible_and_default_to_the_last_frame():
    names = [scene.name for scene in crumple.scenes()]
    assert {"cloth", "soup", "shells"} <= set(names)
    a, b = (crumple.make_scene("bodies", triangles=2000, frame=7, seed=3) for _ in range(2))
    assert a.vertices.tobytes() == b.vertices.tobytes() and (a.groups == b.groups).all()
    for scene in crumple.scenes():
        one, other = (crumple.make_scene(scene.name, triangles=500, frame=frame) for frame in (None, scene.frames - 1))
        assert one.vertices.tobytes() == other.vertices.tobytes() and one.faces.tobytes() == other.faces.tobytes()
    last = crumple.make_scene("bodies", triangles=2000, frame=59)
    assert (
        crumple.make_scene("bodies", triangles=2000).vertices.tobytes()
        == last.vertices.tobytes()
        != a.vertices.tobytes()
    )
    with pytest.raises(crumple.InvalidInput, match="there is no scene tea; the scenes are cloth"):
        crumple.make_scene("tea")
    with pytest.raises(crumple.InvalidInput, match="has no frame 60; its frames are 0 to 59"):
        crumple.make_scene("bodies", frame=60)


CHEVRON = "v 4 -2 0\nv 1 0 0\nv 4 2 0\nv 0 0 0\nf 1 2 3 4\nf 1 2 3\n"


def test_polygons_are_cut_without_overlaps_and_keep_their_ids(tmp_path, detector):
    (tmp_path / "a.obj").write_text(CHEVRON)
    mesh = crumple.read_mesh(tmp_path / "a.obj")
    assert isinstance(mesh, crumple.Mesh) and isinstance(mesh, crumple.FileMesh)
    vertices, faces, groups = mesh
    assert faces.shape == (3, 3) and groups is None
    assert mesh.polygons.of_triangle.tolist() == [0, 0, 1] and mesh.polygons.offsets.tolist() == [0, 4, 7]
    assert mesh.polygons.corners.tolist() == [0, 1, 2, 3, 0, 1, 2]
    assert mesh.polygons.of_triangle.dtype == np.int32 and mesh.polygons.offsets.dtype == np.int64
    assert not detector.intersections(vertices, faces[:2])
    fan = crumple.read_mesh(tmp_path / "a.obj", triangulation="fan")
    result = detector.intersections(fan)
    assert result.pairs.tolist()[0] == [0, 1]
    by_polygon = np.unique(np.sort(fan.polygons.of_triangle[result.pairs]), axis=0)
    assert by_polygon.tolist() == [[0, 0], [0, 1]]
    copy = pickle.loads(pickle.dumps(mesh))
    assert copy.polygons.corners.tolist() == mesh.polygons.corners.tolist() and copy.faces.tolist() == faces.tolist()
    crumple.write_mesh(tmp_path / "b.off", mesh)
    assert crumple.read_mesh(tmp_path / "b.off").polygons is None
    with pytest.raises(crumple.InvalidInput, match='triangulation must be one of "ears", "fan", not "cut"'):
        crumple.read_mesh(tmp_path / "a.obj", triangulation="cut")


def test_unknown_obj_statement_is_a_warning_or_with_strict_an_error(tmp_path):
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nseam 1\nseam 2\nf 1 2 3\n")
    with pytest.warns(crumple.FileWarning, match="a.obj, line 4: the unknown statement 'seam' is skipped") as caught:
        crumple.read_mesh(tmp_path / "a.obj")
    assert len(caught) == 1 and caught[0].filename == __file__
    with pytest.raises(crumple.InvalidInput, match="line 4") as error:
        crumple.read_mesh(tmp_path / "a.obj", strict=True)
    assert (error.value.code, error.value.element, error.value.index) == ("format", "line", 4)
    with pytest.raises(crumple.InvalidType, match="strict must be True or False, not int"):
        crumple.read_mesh(tmp_path / "a.obj", strict=1)


def test_failed_write_keeps_the_old_file(tmp_path):
    """A limit on the size of files makes writing fail, as a full disk would."""
    code = f"""
import resource, signal, crumple, numpy
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
result = crumple.Detector().intersections(crumple.make_scene("lattice", triangles=5000))
resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
for name in ("a.html", "a.ply", "a.csv", "a.png"):
    try:
        path = {str(tmp_path)!r} + "/" + name
        if name == "a.png":  # as pictures are written, without PyVista
            crumple._core.write_bytes(path, bytes(9999))
        result.save(path)
    except crumple.FileError as error:
        assert error.errno == 27, error
    else:
        raise AssertionError(name)
"""
    for name in ("a.html", "a.ply", "a.csv", "a.png"):
        (tmp_path / name).write_text("precious")
    subprocess.run([sys.executable, "-c", code], check=True)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.csv", "a.html", "a.ply", "a.png"]
    assert all(path.read_text() == "precious" for path in tmp_path.iterdir())


def test_units_are_read_kept_and_converted(tmp_path, detector):
    mesh = soup(20, dtype=np.float64, size=0.5)
    crumple.write_mesh(tmp_path / "a.off", mesh)
    assert crumple.read_mesh(tmp_path / "a.off").unit is None
    inch = crumple.read_mesh(tmp_path / "a.off", unit="in")
    assert inch.unit == "in" and inch.vertices.tobytes() == mesh.vertices.tobytes()
    crumple.write_mesh(tmp_path / "a.3mf", inch)
    back = crumple.read_mesh(tmp_path / "a.3mf")
    assert back.unit == "in" and back.vertices.tobytes() == mesh.vertices.tobytes()
    millimetres = crumple.read_mesh(tmp_path / "a.3mf", unit="mm")
    assert millimetres.unit == "mm" and np.allclose(millimetres.vertices, 25.4 * mesh.vertices, rtol=1e-15, atol=0)
    crumple.write_mesh(tmp_path / "a.glb", inch)
    metres = crumple.read_mesh(tmp_path / "a.glb")
    assert metres.unit == "m" and np.allclose(metres.vertices, 0.0254 * mesh.vertices[mesh.faces].reshape(-1, 3))
    detector.intersections(inch).save(tmp_path / "hits.3mf")
    world = crumple.read_world(tmp_path / "hits.3mf")
    assert world.unit == "in" and pickle.loads(pickle.dumps(world)).unit == "in"
    detector.intersections(world).save(tmp_path / "again.3mf")
    assert crumple.read_mesh(tmp_path / "again.3mf").unit == "in"
    assert crumple.read_world(tmp_path / "again.3mf", unit="mm").unit == "mm"
    with pytest.raises(crumple.InvalidInput, match='unit must be one of "um", "mm", "cm", "in", "ft", "m", not "mile"'):
        crumple.read_mesh(tmp_path / "a.off", unit="mile")
    with pytest.raises(crumple.InvalidInput, match="the meshes are in different units, in and mm"):
        detector.intersections(inch, millimetres).save(tmp_path / "two.3mf")
