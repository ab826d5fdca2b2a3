"""Tests of crumple.check: reports about files, meshes and worlds are those of the command line."""

import json
import subprocess
import sys

import numpy as np
import pytest

import crumple

CORNERS = np.indices((2, 2, 2)).reshape(3, 8).T.astype(float)
SIDES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
FACES = np.array([face for a, b, c, d in SIDES for face in ((a, b, c), (a, c, d))])
LOW, HIGH = crumple.Mesh(CORNERS, FACES), crumple.Mesh(CORNERS + [0, 0, 0.75], FACES)
FAR, OPEN = crumple.Mesh(CORNERS + [0, 0, 1.0625], FACES), crumple.Mesh(CORNERS, FACES[:11])


def test_sound_mesh_has_no_findings():
    report = crumple.check(LOW, unit="mm")
    assert str(report) == "mesh: closed, volume 1 mm^3, 12 triangles\nno findings"
    assert report.findings == 0 and report.items == [] and report.unit == "mm"
    assert report.bodies[0]["closed"] and report.bodies[0]["volume"] == 1
    assert str(crumple.check(CORNERS, FACES)) == "mesh: closed, volume 1, 12 triangles\nno findings"


def test_items_have_typed_members():
    report = crumple.check(LOW, HIGH, names=["low", "high"])
    (item,) = report.items
    assert (item.kind, item.finding, item.ignored) == ("overlapping", True, False)
    assert (item.first, item.second, item.first_shell) == ("low", "high", None)
    assert item.volume == item.mean_depth == 0.25 and item.clearance is None
    assert item.depth_reached <= 0.25 <= item.depth_bound
    assert item.centre == [0.5, 0.5, 0.875] and item.box == {"low": [0, 0, 0.75], "high": [1, 1, 1]}
    assert len(item.places) == 1 and str(item) in str(report)
    assert repr(report) == "<crumple.CheckReport: 2 bodies, 1 findings>"
    assert crumple.check(OPEN).items[0].length == pytest.approx(2 + 2**0.5)


def test_files_give_the_report_of_the_command_line(tmp_path):
    for name, mesh in [("low", LOW), ("high", HIGH), ("open", OPEN)]:
        crumple.write_mesh(tmp_path / f"{name}.stl", mesh)
    files = [str(tmp_path / f"{name}.stl") for name in ("low", "high", "open")]
    report = crumple.check(*files, unit="mm", clearance="1um", excluded_bodies=[("low", "open")])
    options = ["--unit", "mm", "--clearance", "1um", "--excluded-bodies", "low,open", "--json"]
    program = [sys.executable, "-m", "crumple", "check", *files, *options]
    try:
        printed = subprocess.run(program, capture_output=True, text=True).stdout
    except FileNotFoundError:
        pytest.skip("the command line is not installed")
    if printed:
        assert report.to_dict() == json.loads(printed)
    assert report.findings == 3 and {item.kind for item in report.items} == {"hole", "overlapping", "undefined"}


def test_lengths_are_numbers_or_have_units():
    def findings(**options):
        return crumple.check(LOW, FAR, unit="cm", **options).findings

    assert findings() == findings(clearance=0.0625) == findings(clearance="0.6mm") == 0
    assert findings(clearance=0.063) == findings(clearance="1 mm") == 1
    assert crumple.check(LOW, HIGH, ignore_below=0.3).items[0].ignored
    with pytest.raises(crumple.InvalidInput, match="clearance must be a length such as \"0.1mm\""):
        findings(clearance="wide")
    with pytest.raises(crumple.InvalidInput, match="clearance: the bodies have no unit"):
        crumple.check(LOW, FAR, clearance="1mm")
    with pytest.raises(crumple.InvalidInput, match="ignore_below must not be negative"):
        findings(ignore_below=-1)


def test_worlds_and_meshes_of_files_keep_names_poses_and_units(tmp_path):
    poses = np.zeros((2, 3, 4))
    poses[:, :, :3] = np.eye(3)
    poses[1, 2, 3] = 0.75
    world = crumple.World([LOW], [0, 0], poses=poses, names=["a", "b"])
    report = crumple.check(world)
    assert [item.text for item in report.items] == [item.text for item in crumple.check(LOW, HIGH, names="ab").items]
    with pytest.raises(crumple.InvalidInput, match="one configuration"):
        crumple.check(world.configurations(np.stack([poses, poses])))
    crumple.write_mesh(tmp_path / "low.ply", LOW)
    in_cm, in_mm = (crumple.read_mesh(tmp_path / "low.ply", unit=unit) for unit in ("cm", "mm"))
    with pytest.warns(crumple.FileWarning, match="mesh is converted from mm to cm, the unit of mesh"):
        report = crumple.check(in_cm, in_mm)
    assert report.unit == "cm" and [body["name"] for body in report.bodies] == ["mesh", "mesh_2"]
    assert report.bodies[1]["volume"] == pytest.approx(0.001)


def test_depth_of_a_shell_in_itself_is_reported():
    part = crumple.make_scene("model", triangles=4000)
    report = crumple.check(part)
    own = [item for item in report.items if item.kind == "self_intersection"]
    assert own and all(0 < item.depth_reached <= item.depth_bound for item in own)
    assert sum(item.volume for item in own) == pytest.approx(report.bodies[0]["overlap_with_itself"])


def test_reports_are_saved_by_extension(tmp_path):
    report = crumple.check(LOW, HIGH)
    for extension in ("txt", "json", "csv", "html"):
        report.save(tmp_path / f"report.{extension}")
    assert (tmp_path / "report.txt").read_text() == f"{report}\n"
    assert json.loads((tmp_path / "report.json").read_text()) == report.to_dict()
    assert (tmp_path / "report.csv").read_text().startswith("kind,finding,first,")
    assert (tmp_path / "report.html").read_text().startswith("<!DOCTYPE html>")
    with pytest.raises(crumple.InvalidInput, match=r"saved as \.txt, \.csv, \.json or \.html"):
        report.save(tmp_path / "report.stl")
    with pytest.raises(crumple.FileError):
        report.save(tmp_path / "nowhere" / "report.txt")


def test_wrong_arguments_are_refused(tmp_path):
    with pytest.raises(TypeError, match="none is given"):
        crumple.check()
    with pytest.raises(TypeError, match="Did you mean 'clearance'"):
        crumple.check(LOW, clearence=1)
    with pytest.raises(crumple.FileError, match="missing.stl"):
        crumple.check(tmp_path / "missing.stl")
    with pytest.raises(crumple.InvalidInput, match="excluded_bodies: there is no body hihg"):
        crumple.check(LOW, HIGH, names=["low", "high"], excluded_bodies=[("low", "hihg")])
    with pytest.raises(crumple.InvalidInput, match="fewer names"):
        crumple.check(LOW, HIGH, names=["low"])
    with pytest.raises(crumple.InvalidInput, match="not finite"):
        crumple.check(CORNERS * np.nan, FACES)


def test_detector_searches_with_its_options():
    detector = crumple.Detector(threads=1, backend="cpu")
    assert crumple.check(LOW, HIGH, detector=detector).to_dict() == crumple.check(LOW, HIGH).to_dict()
    with pytest.raises(crumple.InvalidType, match="detector must be a crumple.Detector"):
        crumple.check(LOW, detector=1)
