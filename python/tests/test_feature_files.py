"""Tests of files of impacts, near pairs and candidates."""

import copy
import json
import pickle

import numpy as np
import pytest

import crumple
from conftest import OnDevice
from features import BODIES, CANDIDATE_KINDS, END, FACES, LISTS, START

WORLD = crumple.World(
    [crumple.Shape(START[:3], FACES[:1]), crumple.Shape(START[3:], FACES[:1], end=END[3:])], self_collisions=True
)
RESULTS = {
    "impacts": lambda d: d.impacts(START, END, FACES),
    "near": lambda d: d.proximities(START, FACES, radius=2),
    "impacts of a world": lambda d: d.impacts(WORLD),
    "impacts with triangles": lambda d: d.impacts(START, END, FACES, triangle_pairs=True),
    "near of a world": lambda d: d.proximities(WORLD, radius=2),
    "candidates": lambda d: d.candidates(START, FACES, end=END, kinds=CANDIDATE_KINDS, inflation=0.25),
    "candidates of a world": lambda d: d.candidates(WORLD, kinds=CANDIDATE_KINDS, inflation=0.25),
}


@pytest.mark.parametrize("extension", ["txt", "csv", "json", "npz"])
@pytest.mark.parametrize("name", RESULTS)
def test_unpickled_result_is_saved_with_the_same_bytes(name, extension, detector, tmp_path):
    result = RESULTS[name](detector)
    result.save(tmp_path / f"one.{extension}")
    pickle.loads(pickle.dumps(result)).save(str(tmp_path / f"other.{extension}"))
    one, other = ((tmp_path / f"{file}.{extension}").read_bytes() for file in ("one", "other"))
    assert one == other and len(one) > 10


@pytest.mark.parametrize("name", RESULTS)
def test_npz_and_json_hold_the_arrays_of_the_result(name, detector, tmp_path):
    result = RESULTS[name](detector)
    result.save(tmp_path / "lists.npz")
    result.save(tmp_path / "lists.json")
    read, text = np.load(tmp_path / "lists.npz"), json.loads((tmp_path / "lists.json").read_text())
    more = ["first_edge", *BODIES[:-1]] if "world" in name else []
    if name == "candidates of a world":
        more += ["edge_face_bodies", "face_face_bodies"]
    for array in (*LISTS[type(result).__name__], "edges", *more):
        np.testing.assert_array_equal(read[array], getattr(result, array))
        assert text[array] == getattr(result, array).tolist()
    assert text["statistics"]["pairs"] == len(result)
    if "triangles" in name:
        for array, of_file in (("pairs", "faces"), ("pair_toi", "face_toi"), ("pair_start", "face_start")):
            expected = getattr(result, f"triangle_{array}")
            np.testing.assert_array_equal(read[f"face_{of_file}"], expected)
            assert text[f"face_{of_file}"] == expected.tolist() != []


def test_text_has_one_line_for_each_pair(detector, tmp_path):
    expected = {"impacts": "vf 3 0 0.5 0\n", "impacts of a world": "vf 1:0 0:0 0.5 0\n"}
    for name, lines in expected.items():
        RESULTS[name](detector).save(tmp_path / "list.txt")
        assert (tmp_path / "list.txt").read_text() == lines
    between = crumple.PairFilter(groups="between")
    detector.impacts(START, END, FACES, groups=[0, 1], filter=between).save(tmp_path / "list.txt")
    assert (tmp_path / "list.txt").read_text() == expected["impacts"]
    detector.candidates(WORLD, kinds=["face_face", "vertex_face"]).save(tmp_path / "list.txt")
    assert (tmp_path / "list.txt").read_text() == "vf 1:0 0:0\nff 0:0 1:0\n"
    RESULTS["near"](detector).save(tmp_path / "list.txt")
    lines = (tmp_path / "list.txt").read_text().splitlines()
    assert len(lines) == 10 and lines[1] == "vf 3 0 1" and lines[4] == "ee 0 1 3 4 2"


def test_files_hold_only_the_requested_kinds(detector, tmp_path):
    for result in (one := detector.candidates(START, FACES, end=END, kinds="face_face"), copy.deepcopy(one)):
        result.save(tmp_path / "list.npz")
        result.save(str(tmp_path / "list.CSV"))
        with np.load(tmp_path / "list.npz") as read:
            assert sorted(read) == ["face_faces"] and read["face_faces"].tolist() == [[0, 1]]
        assert (tmp_path / "list.CSV").read_text() == "kind,vertex,face,a,b,c,d\nff,,0,1,,,\n"
        result.save(tmp_path / "list.json")
        assert set(json.loads((tmp_path / "list.json").read_text())) == {"face_faces", "statistics"}
        result.save(tmp_path / "list.txt")
        assert (tmp_path / "list.txt").read_text() == "ff 0 1\n"


@pytest.mark.parametrize("name", ["impacts", "near"])
def test_glb_is_refused_for_a_mesh_without_the_features_of_the_result(name, detector, tmp_path):
    result = RESULTS[name](detector)
    for mesh in ((START, FACES), crumple.Mesh(START.tolist(), FACES.ravel())):
        result.save(tmp_path / "mesh.glb", mesh)
        assert (tmp_path / "mesh.glb").read_bytes()[:4] == b"glTF"
    with pytest.raises(crumple.InvalidInput, match="the result refers to features that the mesh does not have"):
        result.save(tmp_path / "other.glb", (START[3:], FACES[:1]))
    with pytest.raises(crumple.InvalidInput, match="vertices lie in CUDA memory, but must be in host memory"):
        result.save(tmp_path / "other.glb", (OnDevice(START), OnDevice(FACES)))
    assert [path.name for path in tmp_path.iterdir()] == ["mesh.glb"]


def test_invalid_saves_are_refused_and_write_nothing(detector, tmp_path):
    candidates = RESULTS["candidates"](detector)
    for wrong in ("list.docx", "mesh.glb", "list"):
        with pytest.raises(crumple.InvalidInput, match=rf"{wrong}: candidates are saved as \.txt, \.csv, "):
            candidates.save(tmp_path / wrong)
    with pytest.raises(crumple.FileError, match="none"):
        candidates.save(tmp_path / "none" / "list.csv")
    with pytest.raises(crumple.InvalidType, match="path must be a str, bytes or os.PathLike, not int"):
        candidates.save(3)
    result = RESULTS["impacts"](detector)
    with pytest.raises(crumple.InvalidInput, match=r"list\.docx: a result is saved as \.txt, "):
        result.save(tmp_path / "list.docx")
    with pytest.raises(crumple.InvalidType, match=r"a coloured mesh needs the mesh: save\(path, mesh\)"):
        result.save(tmp_path / "mesh.glb")
    with pytest.raises(crumple.InvalidType, match=r"mesh is not an option of \.csv files"):
        result.save(tmp_path / "list.csv", (START, FACES))
    with pytest.raises(crumple.InvalidInput, match="but the scene is a world"):
        RESULTS["near of a world"](detector).save(tmp_path / "mesh.glb", (START, FACES))
    with pytest.raises(crumple.InvalidInput, match=r'was not requested: ImpactQuery\(output="pairs"\)'):
        detector.impacts(START, END, FACES, output="first").save(tmp_path / "list.csv")
    with pytest.raises(crumple.InvalidType, match="path must be a str, bytes or os.PathLike, not None"):
        result.save(None)
    with pytest.raises(crumple.FileError, match="none"):
        result.save(tmp_path / "none" / "list.csv")
    assert not list(tmp_path.iterdir())
