"""Self-contact lists for Newton: by vertex, triangle and edge they are equal to brute force, and Warp can read them."""

import numpy as np
import pytest

import crumple
from conftest import peer
from crumple.adapters.newton import SelfContactDetector

RADIUS = 0.08


def cloth():
    """Returns (vertices, faces, edges) of a cloth pressed flat, so that it has many near features."""
    mesh = crumple.make_scene("cloth", triangles=600, frame=60)
    mesh = crumple.Mesh(mesh.vertices * np.float32([1, 0.05, 1]), mesh.faces)
    edges = crumple.proximities(mesh, radius=0).edges
    return mesh.vertices, mesh.faces, np.random.default_rng(1).permutation(edges)[:, ::-1]


def lists(kind, contacts, width):
    """Returns the list of each vertex, triangle or edge, and its least distance. Checks the arrays of the layout."""
    flat, offsets, sizes, counts, least = (
        getattr(contacts, kind + part) for part in ("", "_offsets", "_buffer_sizes", "_count", "_min_dist")
    )
    entries = flat.reshape(-1, width)
    np.testing.assert_array_equal(np.diff(offsets), counts)
    np.testing.assert_array_equal(sizes, counts)
    assert offsets[0] == 0 and offsets[-1] == len(entries)
    assert {a.dtype for a in (flat, offsets, sizes, counts)} == {np.dtype(np.int32)} and least.dtype == np.float32
    rows = [entries[offsets[i] : offsets[i + 1]] for i in range(len(counts))]
    if width == 2:
        assert all((row[:, 0] == i).all() for i, row in enumerate(rows))
    return [row[:, -1].tolist() for row in rows], least


def near(points, kind):
    """Returns, for pairs of features given by their points, whether they are near, and their distances."""
    squared = crumple.pair_distances(kind, points).squared_distance
    return squared < RADIUS**2, np.sqrt(squared)


def check_least(least, distances):
    """Checks that `least` is the least of `distances`, rounded down, or the radius if there are none."""
    expected = min([RADIUS, *distances])
    assert least <= expected and least >= np.float32(expected) * np.float32(1 - 2**-22)


@pytest.mark.parametrize("listed", [True, False])
def test_contact_lists_match_brute_force(listed):
    vertices, faces, edges = cloth()
    if not listed:
        edges = crumple.proximities((vertices, faces), radius=0).edges
    contacts = SelfContactDetector(faces, edges if listed else None, threads=1).detect(vertices, RADIUS)

    by_vertex, vertex_least = lists("vertex_colliding_triangles", contacts, 2)
    by_triangle, triangle_least = lists("triangle_colliding_vertices", contacts, 1)
    assert len(by_vertex) == len(vertices) and len(by_triangle) == len(faces)
    assert sum(map(len, by_vertex)) == sum(map(len, by_triangle)) > 100
    from_triangles = [[] for _ in faces]
    distances_of_triangles = [[] for _ in faces]
    for v in range(len(vertices)):
        others = np.flatnonzero((faces != v).all(axis=1))
        hit, distance = near(vertices[np.insert(faces[others], 0, v, axis=1)], "vertex_face")
        assert by_vertex[v] == others[hit].tolist()
        check_least(vertex_least[v], distance[hit])
        for face, apart in zip(others[hit], distance[hit]):
            from_triangles[face].append(v)
            distances_of_triangles[face].append(apart)
    assert by_triangle == from_triangles
    for least, distances in zip(triangle_least, distances_of_triangles):
        check_least(least, distances)

    by_edge, edge_least = lists("edge_colliding_edges", contacts, 2)
    assert len(by_edge) == len(edges) and sum(map(len, by_edge)) > 100
    for e, ends in enumerate(edges):
        others = np.flatnonzero((edges[:, :, None] != ends).all(axis=(1, 2)))
        points = np.column_stack([np.broadcast_to(ends, (len(others), 2)), edges[others]])
        hit, distance = near(vertices[points], "edge_edge")
        assert by_edge[e] == others[hit].tolist()
        check_least(edge_least[e], distance[hit])


def test_contacts_are_strictly_closer_than_the_radius():
    vertices = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [1, 1, 0.5], [9, 9, 9], [8, 9, 9]])
    detector = SelfContactDetector([[0, 1, 2], [3, 4, 5]])
    assert detector.detect(vertices, 0.5).vertex_colliding_triangles.tolist() == []
    contacts = detector.detect(vertices, np.nextafter(0.5, 1))
    assert contacts.vertex_colliding_triangles.tolist() == [3, 0]
    assert contacts.triangle_colliding_vertices.tolist() == [3]
    assert contacts.triangle_colliding_vertices_min_dist.tolist() == [0.5, 0.5]
    crossed = np.array([[-1, 0, 0], [1, 0, 0], [0, 0, -9], [0, -1, 0.5], [0, 1, 0.5], [0, 0, 9]])
    assert detector.detect(crossed, 0.5).edge_colliding_edges.tolist() == []
    assert detector.detect(crossed, np.nextafter(0.5, 1)).edge_colliding_edges.tolist() == [0, 3, 3, 0]


def test_warp_arrays_are_accepted_and_share_memory_with_results():
    wp = peer("warp")
    wp.config.quiet = True
    vertices, faces, edges = cloth()
    ends = np.concatenate([np.full_like(edges, -1), edges], axis=1)  # the layout of Newton's edge_indices
    with wp.ScopedDevice("cpu"):
        positions = wp.array(vertices, dtype=wp.vec3)
        detector = SelfContactDetector(wp.array(faces, dtype=wp.int32), wp.array(ends, dtype=wp.int32))
        contacts = detector.detect(positions, RADIUS)
        expected = SelfContactDetector(faces, edges).detect(vertices, RADIUS)
        arrays = contacts.warp_arrays()
        assert set(arrays) == set(expected._fields)
        for name, array in arrays.items():
            np.testing.assert_array_equal(array.numpy(), getattr(expected, name), name)
            assert array.ptr == getattr(contacts, name).ctypes.data or not len(array), "no copy"
            assert array.dtype in (wp.int32, wp.float32)


def with_worlds(worlds):
    """Returns (vertices, faces, worlds of vertices) of a copy of the cloth for each world, close to each other."""
    vertices, faces, _ = cloth()
    copies = [vertices + np.float32([0, 0, 0.01 * i]) for i in range(len(worlds))]
    triangles = np.concatenate([faces + i * len(vertices) for i in range(len(worlds))])
    return np.concatenate(copies), triangles, np.repeat(worlds, len(vertices))


@pytest.mark.parametrize("worlds", [[0, 1, 2], [0, -1, 1], [3, 3], [-1, -1]])
def test_features_of_different_worlds_are_not_paired(worlds):
    vertices, faces, of = with_worlds(worlds)
    every = SelfContactDetector(faces).detect(vertices, RADIUS)
    contacts = SelfContactDetector(faces, worlds=of).detect(vertices, RADIUS)
    edges = crumple.proximities((vertices, faces), radius=0).edges
    kinds = {"vertex_colliding_triangles": (of, of[faces[:, 0]]), "edge_colliding_edges": (of[edges[:, 0]],) * 2}
    for kind, (first, second) in kinds.items():
        before, after = (lists(kind, found, 2)[0] for found in (every, contacts))
        left_out = 0
        for i, (all_of, kept) in enumerate(zip(before, after)):
            common = [j for j in all_of if first[i] == second[j] or first[i] < 0 or second[j] < 0]
            assert kept == common
            left_out += len(all_of) - len(kept)
        assert (left_out > 0) == (len({w for w in worlds if w >= 0}) > 1)


@pytest.mark.parametrize("worlds", [[0], [0, 1, 2], [-1, 0, 1]])
def test_lists_are_those_of_newton(worlds):
    newton, wp = peer("newton"), peer("warp")
    wp.config.quiet = True
    vertices, faces, _ = cloth()
    builder = newton.ModelBuilder()
    for i, world in enumerate(worlds):
        own = newton.ModelBuilder()
        (builder if world < 0 else own).add_cloth_mesh(
            pos=wp.vec3(0.0, 0.0, 0.01 * i),
            rot=wp.quat_identity(),
            scale=1.0,
            vel=wp.vec3(0.0, 0.0, 0.0),
            vertices=[wp.vec3(*point) for point in vertices.tolist()],
            indices=faces.ravel().tolist(),
            density=1.0,
        )
        if world >= 0:
            builder.add_world(own)
    model = builder.finalize(device="cpu")
    pipeline = newton.CollisionPipeline(model)
    pipeline.init_soft_self_contact(
        margin=RADIUS,
        vertex_buffer_pre_alloc=512,
        edge_buffer_pre_alloc=512,
        record_triangle_contacting_vertices=False,
        topological_filter_threshold=0,
    )
    found = pipeline.contacts()
    pipeline.collide(model.state(), found, soft_self_contact=True)
    theirs = found.soft_self_contact_data
    ours = SelfContactDetector(model.tri_indices, model.edge_indices, model.particle_world).detect(
        model.particle_q, RADIUS
    )
    names = set(ours._fields)
    assert {name for name in dir(theirs) if name.startswith(("vertex_", "triangle_", "edge_"))} <= names
    for kind in ("vertex_colliding_triangles", "edge_colliding_edges"):
        expected, got = [], lists(kind, ours, 2)[0]
        entries, offsets = getattr(theirs, kind).numpy().reshape(-1, 2), getattr(theirs, kind + "_offsets").numpy()
        for begin, count in zip(offsets, getattr(theirs, kind + "_count").numpy()):
            expected.append(sorted(entries[begin : begin + count, 1].tolist()))
        different = sum(len(set(a) ^ set(b)) for a, b in zip(expected, got))
        assert different <= 1e-3 * sum(map(len, got)) and sum(map(len, got)) > 100, "Newton rounds in float32"
        apart = getattr(theirs, kind + "_min_dist").numpy() - getattr(ours, kind + "_min_dist")
        assert np.abs(apart).max() < 1e-4


def test_invalid_edges_and_radius_are_refused():
    vertices, faces, edges = cloth()
    with pytest.raises(crumple.InvalidInput, match=r"edges must have shape \(n, 2\) or \(n, 4\), not \(5, 3\)"):
        SelfContactDetector(faces, np.zeros((5, 3), int))
    odd = edges.copy()
    odd[7] = [0, 0]
    with pytest.raises(crumple.InvalidInput, match=r"each once, and edge 7, \(0, 0\), is not one of them"):
        SelfContactDetector(faces, odd).detect(vertices, RADIUS)
    with pytest.raises(crumple.InvalidInput, match=rf"the {len(edges)} edges of .* is missing"):
        SelfContactDetector(faces, edges[1:]).detect(vertices, RADIUS)
    with pytest.raises(
        crumple.InvalidInput, match=r"worlds \[0, .*\]; all vertices of a triangle must have the same world"
    ):
        SelfContactDetector(faces, worlds=np.arange(len(vertices)))
    with pytest.raises(crumple.InvalidInput, match="worlds must be one integer for each vertex"):
        SelfContactDetector(faces, worlds=np.zeros(len(vertices)))
    with pytest.raises(
        crumple.InvalidInput, match="worlds has 2 entries, but triangles use vertex .*; pass one entry for each vertex"
    ):
        SelfContactDetector(faces, worlds=[0, 0])
    with pytest.raises(crumple.InvalidInput, match="radius must be finite"):
        SelfContactDetector(faces, edges).detect(vertices, -1)
