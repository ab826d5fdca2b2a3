"""Robots from files: geometry, joints and allowed collisions are those of the URDF and the SRDF."""

import os
from pathlib import Path

import numpy as np
import pytest

import crumple
from crumple.adapters import urdf

ROBOT = """<?xml version="1.0"?>
<robot name="tiny">
  <link name="base"><collision><geometry><box size="0.4 0.4 0.2"/></geometry></collision></link>
  <link name="arm">
    <collision><origin xyz="0 0 0.5"/><geometry><cylinder radius="0.05" length="1"/></geometry></collision>
    <collision><origin xyz="0 0 1"/><geometry><sphere radius="0.08"/></geometry></collision>
  </link>
  <link name="flange"/>
  <link name="left"><collision><origin rpy="0 1.5707963267948966 0"/>
    <geometry><mesh filename="package://tiny_description/finger.stl" scale="1 1 -2"/></geometry></collision></link>
  <link name="right"><collision><geometry><mesh filename="finger.stl"/></geometry></collision></link>
  <joint name="fix" type="fixed"><parent link="arm"/><child link="flange"/><origin xyz="0 0 1.1"/></joint>
  <joint name="turn" type="continuous"><parent link="base"/><child link="arm"/>
    <origin xyz="0 0 0.1" rpy="0 0 0.5"/><axis xyz="0 1 0"/></joint>
  <joint name="open" type="prismatic"><parent link="flange"/><child link="left"/><origin xyz="0 0.02 0"/>
    <axis xyz="0 1 0"/><limit lower="0" upper="0.1" effort="1" velocity="1"/></joint>
  <joint name="also" type="prismatic"><parent link="flange"/><child link="right"/><origin xyz="0 -0.02 0"/>
    <axis xyz="0 -1 0"/><limit lower="0" upper="0.1" effort="1" velocity="1"/>
    <mimic joint="open" multiplier="2" offset="0.01"/></joint>
</robot>
"""
ALLOWED = """<robot name="tiny"><disable_collisions link1="left" link2="right" reason="Never"/>
<disable_collisions link1="flange" link2="base" reason="Never"/></robot>"""
FINGER = (0.04, 0.02, 0.1)


def write(folder, text=ROBOT):
    """Writes the files of the robot. Its fingers are a mesh without shared vertices."""
    mesh = urdf.box(FINGER)
    crumple.write_mesh(folder / "finger.stl", (mesh.vertices.astype(np.float32), mesh.faces))
    (folder / "tiny.urdf").write_text(text)
    (folder / "tiny.srdf").write_text(ALLOWED)
    return folder / "tiny.urdf"


def test_srdf_lists_pairs_in_its_order(tmp_path):
    write(tmp_path)
    assert urdf.read_srdf(tmp_path / "tiny.srdf") == [("left", "right"), ("flange", "base")]
    (tmp_path / "bad.srdf").write_text("<robot><disable_collisions link1='a'/></robot>")
    with pytest.raises(crumple.InvalidInput, match="disable_collisions lacks 'link2'"):
        urdf.read_srdf(tmp_path / "bad.srdf")
    (tmp_path / "bad.srdf").write_text("<robot>")
    with pytest.raises(crumple.InvalidInput, match="is not valid XML"):
        urdf.read_srdf(tmp_path / "bad.srdf")


def test_load_without_yourdfpy_names_the_missing_package(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "yourdfpy", None)
    with pytest.raises(ImportError, match="pip install yourdfpy"):
        urdf.load(write(tmp_path))


def test_robot_has_the_links_joints_and_limits_of_its_files(tmp_path):
    pytest.importorskip("yourdfpy")
    robot = urdf.load(write(tmp_path), tmp_path / "tiny.srdf", max_tessellation_error=0.001, threads=1)
    assert robot.links == ("base", "arm", "left", "right") and robot.variables == ("turn", "open")
    assert robot.limits.tolist() == [[-np.inf, 0], [np.inf, 0.1]]
    assert 0 < robot.tessellation_error <= 0.001
    pairs = {("base", "arm"), ("arm", "left"), ("arm", "right"), ("left", "right")}
    assert robot.allowed == set(map(frozenset, pairs))
    one, _, left, right = robot.poses([np.pi / 2, 0.05])
    np.testing.assert_array_equal(one, np.eye(4))
    cosine, sine = np.cos(0.5), np.sin(0.5)  # the arm lies along x, turned by 0.5 about z
    across = np.array([-sine, cosine, 0])
    np.testing.assert_allclose(left[:3, 3], [1.1 * cosine, 1.1 * sine, 0.1] + 0.07 * across, atol=1e-15)
    np.testing.assert_allclose(right[:3, 3], [1.1 * cosine, 1.1 * sine, 0.1] - (0.02 + 0.11) * across, atol=1e-15)


def test_geometry_of_a_link_is_posed_scaled_and_closed(tmp_path):
    pytest.importorskip("yourdfpy")
    robot = urdf.load(write(tmp_path), threads=1)
    meshes = [shape.mesh for shape in robot.shapes.values()]
    for mesh in meshes:
        assert len(crumple.open_edges(mesh)[0]) == 0 and mesh.vertices.dtype == np.float64
    size = np.ptp(meshes[2].vertices, axis=0)
    np.testing.assert_allclose(size, [2 * FINGER[2], FINGER[1], FINGER[0]], rtol=1e-6)
    np.testing.assert_allclose(np.ptp(meshes[3].vertices, axis=0), FINGER, rtol=1e-6)
    assert meshes[1].vertices[:, 2].max() == pytest.approx(1.08, abs=1e-3)
    volume = crumple.Detector(threads=1).overlaps((meshes[2].vertices, meshes[2].faces)).body_volume[0]
    assert volume == pytest.approx(2 * np.prod(FINGER), rel=1e-5), "mirrored faces point outwards"


def test_collisions_depend_on_joint_values(tmp_path):
    pytest.importorskip("yourdfpy")
    robot = urdf.load(write(tmp_path), tmp_path / "tiny.srdf", threads=1)
    wall = urdf.Obstacles({"wall": (urdf.box([0.1, 4, 4]), np.column_stack([np.eye(3), [1, 0, 0]]))})
    angles = np.column_stack([np.linspace(-3, 3, 61), np.full(61, 0.02)])
    hits = robot.collides(angles, wall)
    reach = 1.1 * np.sin(angles[:, 0]) * np.cos(0.5)
    assert hits[reach > 0.95].all() and not hits[np.abs(angles[:, 0]) < 0.5].any() and not hits[-2 * reach > 1].any()
    assert robot.collides_between(angles[:1], angles[-1:], wall)
    found = robot.colliding_links(angles, wall)
    assert set(np.array(found.names)[found.bodies[:, 1]]) <= {"wall", "left", "right", "arm"}


@pytest.mark.parametrize("place", ["package", "meshes of a folder above", "packages="])
def test_mesh_files_are_found(tmp_path, place):
    pytest.importorskip("yourdfpy")
    folder = tmp_path / "robots"
    folder.mkdir()
    path = write(folder)
    moved = {"package": folder / "tiny_description", "packages=": tmp_path / "elsewhere"}.get(place, tmp_path)
    moved.mkdir(exist_ok=True)
    os.replace(folder / "finger.stl", moved / "finger.stl")
    path.write_text(ROBOT.replace('"finger.stl"', '"package://tiny_description/finger.stl"'))
    packages = {"tiny_description": moved} if place == "packages=" else None
    assert "left" in urdf.load(path, packages=packages).links
    if place == "packages=":
        with pytest.raises(
            crumple.InvalidInput,
            match="link 'left': there is no mesh package://tiny.*; pass packages={'tiny_description': FOLDER}",
        ):
            urdf.load(path)


def test_robot_may_be_a_single_link(tmp_path):
    pytest.importorskip("yourdfpy")
    path = tmp_path / "one.urdf"
    shape = "<collision><geometry><box size='1 1 1'/></geometry></collision>"
    path.write_text(f"<robot name='one'><link name='a'>{shape}</link></robot>")
    robot, beside = urdf.load(path, threads=1), np.column_stack([np.eye(3), [3, 0, 0]])
    nothing = np.zeros((2, 0))
    assert robot.collides(nothing).tolist() == [False, False]
    assert robot.collides(nothing, {"b": urdf.box([1, 1, 1])}).all()
    assert robot.clearances(nothing, {"b": (urdf.box([1, 1, 1]), beside)}).tolist() == [2, 2]
    assert not robot.collides_between(nothing, nothing, {"b": (urdf.box([1, 1, 1]), beside)}).any()
    with pytest.raises(crumple.InvalidInput, match="obstacle 'a' has the name of a link; rename it"):
        robot.collides(nothing, {"a": urdf.box([1, 1, 1])})


def test_meshes_in_collada_files_are_read(tmp_path):
    pytest.importorskip("yourdfpy")
    pytest.importorskip("collada")
    trimesh = pytest.importorskip("trimesh")
    trimesh.creation.box([1, 2, 3]).export(tmp_path / "box.dae")
    path = tmp_path / "one.urdf"
    shape = "<collision><geometry><mesh filename='box.dae'/></geometry></collision>"
    path.write_text(f"<robot name='one'><link name='a'>{shape}</link></robot>")
    mesh = urdf.load(path).shapes["a"].mesh
    assert len(mesh.vertices) == 8
    np.testing.assert_allclose(np.ptp(mesh.vertices, axis=0), [1, 2, 3], rtol=1e-6)


@pytest.mark.parametrize("name", ["broken.dae", "broken.stl"])
def test_meshes_that_cannot_be_read_are_named(tmp_path, name):
    pytest.importorskip("yourdfpy")
    (tmp_path / name).write_text("not a mesh")
    path = write(tmp_path, ROBOT.replace('"finger.stl"', f'"{name}"'))
    packages = ".*pip install trimesh pycollada" if name.endswith(".dae") else ""
    with pytest.raises(crumple.InvalidInput, match=f"link 'right': its mesh .*{name}{packages}"):
        urdf.load(path)


def test_limits_without_a_value_are_zero(tmp_path):
    pytest.importorskip("yourdfpy")
    for given, expected in (('upper="0.1"', [0, 0.1]), ('lower="-0.1"', [-0.1, 0]), ("", [0, 0])):
        robot = urdf.load(write(tmp_path, ROBOT.replace('lower="0" upper="0.1"', given)), threads=1)
        assert robot.limits[:, 1].tolist() == expected


def test_invalid_robots_are_refused(tmp_path):
    pytest.importorskip("yourdfpy")
    with pytest.raises(crumple.FileError, match="none.urdf: there is no such file"):
        urdf.load(tmp_path / "none.urdf")
    with pytest.raises(crumple.FileError, match="none.srdf: there is no such file"):
        urdf.load(write(tmp_path), tmp_path / "none.srdf")
    path = write(tmp_path, ROBOT.replace('"continuous"', '"floating"'))
    with pytest.raises(crumple.InvalidInput, match="joint 'turn': joints of the type 'floating' are not supported"):
        urdf.load(path)
    path.write_text("<robot name='x'><link name='a'/></robot>")
    with pytest.raises(crumple.InvalidInput, match="no link of the robot has a mesh"):
        urdf.load(path)
    path.write_text("<robot name='x'><link name='a'/><link name='b'/></robot>")
    with pytest.raises(crumple.InvalidInput, match="no joint connects the links a, b"):
        urdf.load(path)
    path.write_text("<robot name='x'><link/></robot>")
    with pytest.raises(crumple.InvalidInput, match="is not a valid URDF file"):
        urdf.load(path)
    path = write(tmp_path, ROBOT.replace('radius="0.08"', 'radius="-1"'))
    with pytest.raises(crumple.InvalidInput, match="radius must be finite and above 0"):
        urdf.load(path)


def test_panda_has_no_collisions_where_its_planning_problems_start(tmp_path):
    pytest.importorskip("yourdfpy")
    folder = Path(os.environ.get("CRUMPLE_DATA", Path(__file__).parents[3] / "shared" / "data")) / "motionbenchmaker"
    if not folder.is_dir():
        pytest.skip(f"needs the folder {folder}")
    robot = urdf.load(folder / "panda.urdf", folder / "panda.srdf")
    assert len(robot.variables) == 7 and robot.tessellation_error == 0
    ready = [0, -0.785, 0, -2.356, 0, 1.571, 0.785]
    folded = [0, 1.7, 0, -3.0, 0, 3.7, 0.785]
    assert robot.collides([ready, folded]).tolist() == [False, True]
    assert 0 < robot.clearances(ready) < 0.1
