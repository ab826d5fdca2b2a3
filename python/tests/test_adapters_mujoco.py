"""MuJoCo models: the same pairs are selected, contacts have the same pairs and normals, meshes are not convex hulls."""

import numpy as np
import pytest

import crumple
from conftest import peer

mujoco = peer("mujoco")
from crumple.adapters.mujoco import Collisions, selected_pairs  # noqa: E402


def made(text, **files):
    model = mujoco.MjModel.from_xml_string(text, files or None)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def contact_pairs(data):
    return {tuple(sorted(pair)) for pair in data.contact.geom.tolist()}


FILTERED = """<mujoco><worldbody>
  <geom name="w1" size="1"/><geom name="w2" size="1" contype="2" conaffinity="1"/>
  <body name="a"><freejoint/><geom name="a1" size="1"/><geom name="a2" size="1" contype="4" conaffinity="2"/>
    <body name="b"><joint/><geom name="b1" size="1"/><geom name="b2" size="1" contype="0" conaffinity="0"/>
      <body name="c"><geom name="c1" size="1"/>
        <body name="d"><joint/><geom name="d1" size="1" contype="2" conaffinity="4"/></body></body></body></body>
  <body name="e"><joint/><geom name="e1" size="1"/><body name="f"><joint/><geom name="f1" size="1"/></body></body>
</worldbody>
<contact><exclude body1="e" body2="a"/><pair geom1="e1" geom2="b2"/><pair geom1="e1" geom2="f1"/></contact>
<option><flag filterparent="%s"/></option></mujoco>"""


@pytest.mark.parametrize("filter_parents", ["enable", "disable"])
def test_selected_pairs_are_those_in_which_mujoco_finds_contacts(filter_parents):
    """All geoms are balls at one place, so every pair that MuJoCo tests has a contact."""
    model, data = made(FILTERED % filter_parents)
    pairs = selected_pairs(model)
    assert set(map(tuple, pairs.tolist())) == contact_pairs(data) and len(pairs) > 10
    assert (pairs[:, 0] < pairs[:, 1]).all()
    assert Collisions(model, threads=1).contacts(data).geoms.tolist() == pairs.tolist()


PRIMITIVES = """<mujoco><worldbody>
  <geom name="floor" type="plane" size="0 0 1" pos="0 0 -1.2" euler="5 3 0"/>
  <geom name="pillar" type="cylinder" size="0.3 1" pos="0.2 0.1 0"/>
  <body><freejoint/><geom type="box" size="0.4 0.3 0.2"/></body>
  <body><freejoint/><geom type="sphere" size="0.35"/></body>
  <body><freejoint/><geom type="capsule" size="0.2 0.4"/></body>
  <body><freejoint/><geom type="ellipsoid" size="0.5 0.3 0.2"/></body>
</worldbody></mujoco>"""


def random_positions(model, count, spread):
    random = np.random.default_rng(5)
    qpos = random.normal(size=(count, model.nq))
    for joint in range(model.njnt):
        start = model.jnt_qposadr[joint]
        qpos[:, start : start + 3] = random.uniform(-spread, spread, (count, 3))
        turn = qpos[:, start + 3 : start + 7]
        turn /= np.linalg.norm(turn, axis=1, keepdims=True)
    return qpos


def test_contacts_of_primitives_agree_with_mujoco():
    model, data = made(PRIMITIVES)
    collisions = Collisions(model, max_tessellation_error=1e-3, threads=1)
    assert 0 < collisions.tessellation_error <= 1e-3
    positions = random_positions(model, 60, 1.2)
    hits, agreeing, total = collisions.collides(positions.reshape(6, 10, -1)).ravel(), 0, 0
    for qpos, hit in zip(positions, hits):
        data.qpos[:] = qpos
        mujoco.mj_forward(model, data)
        contacts = collisions.contacts(data)
        ours, theirs = set(map(tuple, contacts.geoms.tolist())), {}
        for contact in data.contact:
            a, b = contact.geom
            normal = contact.frame[:3] if a < b else -contact.frame[:3]
            theirs.setdefault(tuple(sorted(contact.geom.tolist())), []).append((contact.dist, normal))
        deep = {pair for pair, found in theirs.items() if min(d for d, _ in found) < -5e-3}
        assert deep <= ours and hit == bool(ours)
        for pair, normal, depth in zip(map(tuple, contacts.geoms.tolist()), contacts.normal, contacts.depth):
            if pair in ours - set(theirs):
                assert not depth > 5e-3  # it touches only the polyhedron
            elif min(d for d, _ in theirs[pair]) > -0.1 and depth == depth:
                total += 1
                agreeing += max(normal @ other for _, other in theirs[pair]) > 0.9
    assert total > 20 and agreeing > 0.85 * total, "normals agree in shallow contacts"


def test_plane_reaches_below_all_geoms_wherever_they_are():
    model, data = made(
        """<mujoco><worldbody><geom type="plane" size="1 1 1"/>
        <body><freejoint/><geom type="box" size="0.5 0.5 0.5"/></body></worldbody></mujoco>"""
    )
    collisions = Collisions(model, threads=1)
    for x in (0, 1e4):
        data.qpos[:3] = [x, -x, 0.25]
        mujoco.mj_forward(model, data)
        contacts = collisions.contacts(data)
        assert contacts.geoms.tolist() == [[0, 1]] and contacts.volume[0] == pytest.approx(0.25, rel=1e-6)
        np.testing.assert_allclose(contacts.normal[0], [0, 0, 1], atol=1e-9)
        assert contacts.depth[0] == pytest.approx(0.25)
        np.testing.assert_allclose(contacts.position[0], [x, -x, -0.125], rtol=1e-6)
    assert collisions.collides([[9, 9, 0.51, 1, 0, 0, 0], [9, 9, 0.49, 1, 0, 0, 0]]).tolist() == [False, True]


def c_shaped():
    """Returns the vertices and faces of a closed body in the shape of a C."""
    outline = np.array([[0, 0], [3, 0], [3, 1], [1, 1], [1, 2], [3, 2], [3, 3], [0, 3]], float)
    vertices = np.concatenate([np.insert(outline, 2, z, axis=1) for z in (0, 1)])
    flat = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 7], [4, 5, 6], [4, 6, 7]]
    faces = [[a, c, b] for a, b, c in flat] + [[a + 8, b + 8, c + 8] for a, b, c in flat]
    for i in range(8):
        j = (i + 1) % 8
        faces += [[i, j, j + 8], [i, j + 8, i + 8]]
    return vertices, np.array(faces)


def test_meshes_are_not_replaced_by_their_convex_hulls():
    vertices, faces = c_shaped()
    text = f"""<mujoco><asset><mesh name="c" vertex="{" ".join(map(str, vertices.ravel()))}"
        face="{" ".join(map(str, faces.ravel()))}"/></asset><worldbody>
        <geom type="mesh" mesh="c" euler="10 20 30"/>
        <body><freejoint/><geom type="sphere" size="0.3"/></body></worldbody></mujoco>"""
    model, data = made(text)
    collisions = Collisions(model, threads=1)
    # MuJoCo moves vertices to the frame of the mesh's inertia, and the pose of the geom takes them back.
    mujoco.mju_euler2Quat(quaternion := np.zeros(4), np.radians([10, 20, 30]), "xyz")
    mujoco.mju_quat2Mat(turned := np.zeros(9), quaternion)
    points = ([2, 1.5, 0.5], True, False), ([0.5, 1.5, 0.5], True, True), ([2, 5, 0.5], False, False)
    for point, inside_hull, inside in points:
        data.qpos[:3] = turned.reshape(3, 3) @ point
        mujoco.mj_forward(model, data)
        assert (data.ncon > 0) == inside_hull
        assert collisions.collides(data) == inside == (len(collisions.contacts(data).geoms) > 0)


def test_height_field_is_cut_as_in_mujoco():
    model, data = made(
        """<mujoco><asset><hfield name="h" nrow="2" ncol="2" size="1 1 1 0.5" elevation="1 0 0 1"/></asset>
        <worldbody><geom type="hfield" hfield="h"/>
        <body><freejoint/><geom type="sphere" size="0.02"/></body></worldbody></mujoco>"""
    )
    collisions = Collisions(model, max_tessellation_error=1e-4, threads=1)
    for x, y in ((0, 0), (0.5, -0.5), (0.3, 0.4), (-0.5, -0.4)):
        heights = []
        for z in np.linspace(-0.2, 1.2, 141):
            data.qpos[:3] = x, y, z
            mujoco.mj_forward(model, data)
            heights.append((data.ncon > 0, bool(collisions.collides(data))))
        theirs, ours = np.array(heights).T
        assert np.flatnonzero(ours).max() == pytest.approx(np.flatnonzero(theirs).max(), abs=1), (x, y)
    shape = collisions._world.shapes[0]
    assert len(crumple.open_edges(shape.mesh)[0]) == 0


@pytest.mark.parametrize("pair, hit", [("", False), ('<contact><pair geom1="a" geom2="b"/></contact>', True)])
def test_models_of_which_nothing_moves_have_contacts_if_pairs_are_listed(pair, hit):
    model, data = made(
        f"""<mujoco><worldbody><geom name="a" size="1"/><geom name="b" size="1" pos="1 0 0"/></worldbody>
        {pair}</mujoco>"""
    )
    collisions = Collisions(model, threads=1)
    assert collisions.collides(data) == hit == len(collisions.contacts(data).geoms)
    assert collisions.collides(np.zeros((3, 0))).tolist() == [hit] * 3


def test_invalid_positions_are_refused_and_open_meshes_have_no_normal():
    vertices, faces = c_shaped()
    text = f"""<mujoco><asset><mesh name="c" vertex="{" ".join(map(str, vertices.ravel()))}" inertia="shell"
        face="{" ".join(map(str, faces[:-2].ravel()))}"/></asset><worldbody><geom type="mesh" mesh="c"/>
        <body><freejoint/><geom type="sphere" size="0.3"/></body></worldbody></mujoco>"""
    model, data = made(text)
    collisions = Collisions(model, threads=1)
    with pytest.raises(crumple.InvalidInput, match=r"positions must be MjData or have shape \(..., 7\), not \(2, 3\)"):
        collisions.collides(np.zeros((2, 3)))
    positions = np.zeros((2, 7))
    with pytest.raises(crumple.InvalidInput, match=r"contacts takes MjData or positions of shape \(7,\), not \(2, 7\)"):
        collisions.contacts(positions)
    positions[1, 2] = np.nan
    with pytest.raises(crumple.InvalidInput, match="positions: configuration 1 has a value that is not finite"):
        collisions.collides(positions)
    data.qpos[:3] = 0.5, 3, 0.5
    mujoco.mj_forward(model, data)
    contacts = collisions.contacts(data)
    assert contacts.geoms.tolist() == [[0, 1]] and np.isnan(contacts.normal).all() and np.isnan(contacts.depth).all()
