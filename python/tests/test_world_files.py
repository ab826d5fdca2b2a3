"""Tests of worlds from glTF files and from trimesh, files of poses, and files and pictures of results."""

import warnings

import numpy as np
import pytest

import crumple
from conftest import peer, soup
from worlds import random_columns, random_poses

PLACED = {"stone": [0, 0, 0], "pebble": [0.2, 0.3, 0.1], "far": [9, 0, 0], "cube": [0.5, 0, 0]}


def at(place):
    pose = np.eye(4)
    pose[:3, 3] = place
    return pose


def scene():
    """Returns a trimesh.Scene of three instances of one ball, two of which meet, and a box."""
    trimesh = peer("trimesh")
    result = trimesh.Scene()
    ball, box = trimesh.creation.icosphere(subdivisions=1), trimesh.creation.box()
    for name, place in PLACED.items():
        kind = "box" if name == "cube" else "ball"
        if kind in result.geometry:
            result.graph.update(name, geometry=kind, matrix=at(place))
        else:
            mesh = box if kind == "box" else ball
            result.add_geometry(mesh, node_name=name, geom_name=kind, transform=at(place))
    return result


def expected_hits(detector, meshes):
    """Returns the pairs of names whose meshes collide. The meshes are posed; each pair is searched alone."""
    names = list(meshes)
    return {(a, b) for i, a in enumerate(names) for b in names[i + 1 :] if detector.any([meshes[a], meshes[b]])}


def test_trimesh_scene_becomes_a_world_with_its_collisions(detector):
    given = scene()
    world = crumple.World.from_trimesh(given)
    assert sorted(world.names) == sorted(PLACED) and len(world.shapes) == 2
    placed = {}
    for node in given.graph.nodes_geometry:
        transform, geometry = given.graph[node]
        mesh = given.geometry[geometry].copy()
        mesh.apply_transform(transform)
        placed[node] = mesh
    expected = expected_hits(detector, placed)
    found = detector.intersections(world, output="body_pairs", filter=crumple.PairFilter(bodies="between")).names
    assert {frozenset(pair) for pair in found} == {frozenset(pair) for pair in expected} and len(found) == 3
    less = detector.intersections(
        world, output="body_pairs", filter=crumple.PairFilter(bodies="between", excluded_bodies=[{"stone", "pebble"}])
    ).names
    assert len(less) == 2
    assert repr(world.shapes[0]).startswith("<crumple.Shape: ") and world.shapes[0].name is None


def test_error_explains_how_to_make_a_world_of_a_trimesh_scene(detector):
    with pytest.raises(crumple.InvalidType, match=r"use crumple.World.from_trimesh\(scene\), or .*to_mesh"):
        detector.intersections(scene())
    assert detector.intersections(scene().to_mesh()) is not None


def test_later_changes_of_a_trimesh_scene_do_not_change_its_world(detector):
    given = scene()
    world = crumple.World.from_trimesh(given)
    before = detector.intersections(world).pairs.tolist()
    for mesh in given.geometry.values():
        mesh.vertices[:] = np.nan
    assert detector.intersections(world).pairs.tolist() == before
    assert crumple.Detector().intersections(world).pairs.tolist() == before
    with pytest.raises(ValueError, match="read-only"):
        world.shapes[0].mesh.vertices[0] = 0


def test_point_clouds_of_a_trimesh_scene_are_left_out(detector):
    trimesh = peer("trimesh")
    given = scene()
    given.add_geometry(trimesh.PointCloud(np.zeros((3, 3))), node_name="points")
    assert "points" not in crumple.World.from_trimesh(given).names
    assert len(crumple.World.from_trimesh(trimesh.Scene())) == 0
    for wrong in (trimesh.creation.box(), None, [1]):
        with pytest.raises(crumple.InvalidType, match="scene must be a trimesh.Scene, not "):
            crumple.World.from_trimesh(wrong)


@pytest.mark.parametrize("extension", ["glb", "gltf"])
def test_gltf_file_of_a_trimesh_scene_gives_the_same_bodies_and_collisions(extension, tmp_path, detector):
    given = scene()
    path = tmp_path / f"model.{extension}"
    if extension == "glb":
        given.export(path)
    else:
        for name, data in peer("trimesh").exchange.gltf.export_gltf(given).items():
            (tmp_path / name).write_bytes(data)
    world = crumple.read_world(path, precision="float64")
    assert sorted(world.names) == sorted(PLACED) and len(world.shapes) == 2
    found = {
        frozenset(pair)
        for pair in detector.intersections(
            world, output="body_pairs", filter=crumple.PairFilter(bodies="between")
        ).names
    }
    direct = detector.intersections(
        crumple.World.from_trimesh(given), output="body_pairs", filter=crumple.PairFilter(bodies="between")
    ).names
    assert found == {frozenset(pair) for pair in direct} and found
    assert crumple.read_world(path).shapes[0].mesh.vertices.dtype == np.float32


def test_file_3mf_keeps_the_bodies_of_a_world(tmp_path, detector):
    given = crumple.World.from_trimesh(scene())
    result = detector.intersections(given)
    result.save(tmp_path / "hits.3mf")
    world = crumple.read_world(tmp_path / "hits.3mf")
    assert world.names == given.names and len(world) == len(given)
    assert detector.intersections(world).pairs.tolist() == result.pairs.tolist()
    assert len(crumple.read_mesh(tmp_path / "hits.3mf").faces) == len(given.mesh.faces)
    trimesh = peer("trimesh")
    pytest.importorskip("lxml")
    pytest.importorskip("networkx")
    theirs = trimesh.load(tmp_path / "hits.3mf")
    assert sum(len(mesh.faces) for mesh in theirs.dump()) == len(given.mesh.faces)
    assert np.allclose(theirs.bounds, [given.mesh.vertices.min(axis=0), given.mesh.vertices.max(axis=0)])


def test_mesh_file_is_a_world_of_one_body(tmp_path, detector):
    mesh = soup(30, size=0.5)
    crumple.write_mesh(tmp_path / "part.ply", mesh)
    world = crumple.read_world(tmp_path / "part.ply")
    assert world.names == ("part",) and len(world) == 1
    assert detector.intersections(world).pairs.tolist() == [], (
        "a body is not tested against itself unless that is wanted"
    )
    deformable = crumple.World(world.shapes, self_collisions=True)
    assert detector.intersections(deformable).pairs.tolist() == detector.intersections(mesh).pairs.tolist()
    with pytest.raises(crumple.FileError, match="none.glb"):
        crumple.read_world(tmp_path / "none.glb")
    (tmp_path / "bad.glb").write_bytes(b"glTF\2\0\0\0")
    with pytest.raises(crumple.InvalidInput, match="bad.glb"):
        crumple.read_world(tmp_path / "bad.glb")
    with pytest.raises(TypeError, match="Did you mean 'precision'"):
        crumple.read_world(tmp_path / "part.ply", precison="float64")


def test_read_world_gives_the_warnings_of_read_mesh(tmp_path):
    (tmp_path / "odd.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 1 2\nf 1 2 3 3\nseam 1\n")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        mesh = crumple.read_mesh(tmp_path / "odd.obj")
        expected = [str(w.message) for w in caught]
        assert len(expected) == 1 and "'seam'" in expected[0]
        caught.clear()
        world = crumple.read_world(tmp_path / "odd.obj")
        assert [str(w.message) for w in caught] == expected
        assert all(w.filename == __file__ for w in caught)
    assert world.shapes[0].triangles == len(mesh.faces)


@pytest.mark.parametrize("rows", [3, 4])
@pytest.mark.parametrize("kind", ["npy", "csv", "txt"])
def test_poses_are_read_from_npy_csv_and_text(kind, rows, tmp_path, detector):
    poses = random_poses(np.random.default_rng(1), 10).reshape(5, 2, 3, 4)
    given = np.concatenate([poses, np.broadcast_to([0, 0, 0, 1.0], (5, 2, 1, 4))], axis=2)[:, :, :rows]
    path = tmp_path / f"poses.{kind}"
    if kind == "npy":
        np.save(path, given)
    else:
        numbers = given.reshape(10, -1)
        path.write_text(
            "".join((", " if kind == "csv" else " ").join(map(repr, row)) + "\n" for row in numbers.tolist())
        )
    base = crumple.World([soup(20)], [0, 0, 0], worlds=[0, 0, -1], names=["a", "b", "table"], self_collisions=True)
    for bodies in (2, base, ["a", "b"], np.int64(2)):
        np.testing.assert_array_equal(crumple.read_poses(path, bodies), poses)
    assert crumple.read_poses(path).shape == (10, 1, 3, 4)
    assert detector.intersections(base.configurations(crumple.read_poses(path, base)), output="any") is not None
    with pytest.raises(crumple.InvalidInput, match="10 rows for 3 bodies: the last configuration has 1"):
        crumple.read_poses(path, 3)


def test_error_in_a_file_of_poses_names_the_body(tmp_path):
    path = tmp_path / "poses.csv"
    path.write_text("1 0 0 0 0 1 0 0 0 0 1 0\n" * 3 + "1 0 0 0 0 1 0 0 0 0 nan 0\n")
    with pytest.raises(crumple.InvalidInput, match=r"row 3 \(configuration 1, body .?hand.?\): number 11 is not"):
        crumple.read_poses(path, ["arm", "hand"])
    for wrong in ("arm", 1.5, True, [1, 2]):
        with pytest.raises((crumple.InvalidType, TypeError)):
            crumple.read_poses(path, wrong)
    with pytest.raises(crumple.InvalidInput, match="bodies must be at least one"):
        crumple.read_poses(path, 0)


def test_mesh_of_a_world_has_the_pairs_of_the_world(detector):
    columns = random_columns(3)
    single = [shape._replace(vertices=shape.vertices.astype(np.float32)) for shape in columns.shapes]
    world = columns._replace(shapes=single, worlds=np.zeros(8, int)).world(named=False, self_collisions=True)
    mesh = world.mesh
    assert len(mesh.faces) == 8 * 30 and mesh.vertices.dtype == np.float32
    found = detector.intersections(world)
    expected = detector.intersections(mesh.vertices, mesh.faces).pairs
    np.testing.assert_array_equal(
        np.sort(30 * found.bodies + found.pairs, axis=1), expected[np.lexsort(expected.T[::-1])]
    )


@pytest.mark.parametrize("name", ["world.glb", "world.ply", "world.obj", "world.html"])
def test_result_of_a_world_is_saved_as_glb_ply_obj_and_html(name, tmp_path, detector):
    world = crumple.World.from_trimesh(scene())
    result = detector.intersections(world, output="contacts")
    result.save(tmp_path / name)
    assert (tmp_path / name).stat().st_size > 1000
    if name == "world.glb":
        again = crumple.read_world(tmp_path / name)
        assert again.names == world.names
        assert {
            frozenset(p)
            for p in detector.intersections(
                again, output="body_pairs", filter=crumple.PairFilter(bodies="between")
            ).names
        } == {
            frozenset(p)
            for p in detector.intersections(
                world, output="body_pairs", filter=crumple.PairFilter(bodies="between")
            ).names
        }
    if name == "world.ply":
        assert len(crumple.read_mesh(tmp_path / name).faces) == len(world.mesh.faces)
        red = red_faces(tmp_path / name, 252)
        np.testing.assert_array_equal(red, detector.intersections(world, index=True).hit)
    if name == "world.obj":
        assert len(crumple.read_mesh(tmp_path / name).faces) == len(world.mesh.faces)
    if name == "world.html":
        assert f"{len(result)} colliding pairs" in (tmp_path / name).read_text()


def test_body_pairs_are_saved_with_whole_bodies_coloured(tmp_path, detector):
    world = crumple.World.from_trimesh(scene())
    detector.intersections(world, output="body_pairs", filter=crumple.PairFilter(bodies="between")).save(
        tmp_path / "world.ply"
    )
    red = red_faces(tmp_path / "world.ply", 252)
    assert red.tolist() == [world.names[body] != "far" for body in world.mesh.groups]


def red_faces(path, count):
    face = np.dtype([("corners", "u1"), ("vertices", "<i4", 3), ("group", "<i4"), ("colour", "u1", 3)])
    colour = np.frombuffer(path.read_bytes()[-count * face.itemsize :], face)["colour"]
    return colour[:, 0].astype(int) - colour[:, 2] > 50


def test_invalid_saves_are_refused(tmp_path, detector):
    world = crumple.World.from_trimesh(scene())
    with pytest.raises(crumple.InvalidInput, match="bodies was not requested"):
        detector.intersections(world, output="any").save(tmp_path / "world.glb")
    result = detector.intersections(world)
    with pytest.raises(crumple.InvalidInput, match="is saved as .ply"):
        result.save(tmp_path / "world.csv")
    with pytest.raises(crumple.InvalidType, match="height is not an option of .glb files"):
        result.save(tmp_path / "world.glb", height=3)
    with pytest.raises(crumple.FileError):
        result.save(tmp_path / "none" / "world.glb")


def test_result_of_configurations_can_be_saved_as_glb(tmp_path, detector):
    base = crumple.World([soup(20, size=0.5)], [0, 0], worlds=[0, -1], names=["a", "table"], self_collisions=False)
    result = detector.intersections(base.configurations(random_poses(np.random.default_rng(1), 3, 3)[:, None]))
    result.save(tmp_path / "many.glb")
    assert crumple.read_world(tmp_path / "many.glb").names == ("a 0", "a 1", "a 2", "table")


def test_result_of_a_world_can_be_saved_as_png(tmp_path, detector):
    peer("pyvista")
    detector.intersections(crumple.World.from_trimesh(scene()), output="contacts").save(tmp_path / "world.png")
    assert (tmp_path / "world.png").stat().st_size > 5000
