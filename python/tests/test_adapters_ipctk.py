"""Tests of the adapters for the IPC Toolkit: their candidates are the near pairs, and ipctk's functions accept them."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import crumple
from conftest import peer, soup, toi_of

ipctk = peer("ipctk")
from crumple.adapters import ipctk as adapter  # noqa: E402

DATA = Path(os.environ.get("CRUMPLE_DATA", Path(__file__).parents[3] / "shared" / "data")) / "scalable-ccd"
LISTS = {
    "face_vertex": (("vertex_id", "face_id"), "vertex_face"),
    "edge_edge": (("edge0_id", "edge1_id"), "edge_edge"),
    "edge_vertex": (("vertex_id", "edge_id"), "vertex_edge"),
    "vertex_vertex": (("vertex0_id", "vertex1_id"), "vertex_vertex"),
}


def columns(array):
    return np.asfortranarray(array)


def scene(rods=True):
    """Returns vertices, edges and faces: triangles, and optionally rods and points. Edges are shuffled and reversed."""
    mesh = soup(40, size=0.4, dtype=np.float64)
    random = np.random.default_rng(5)
    vertices = np.concatenate([mesh.vertices, 0.3 * random.random((8 if rods else 0, 3)) + 0.3])
    edges = ipctk.edges(columns(mesh.faces))[:, ::-1]
    if rods:
        edges = np.concatenate([edges, [[120, 121], [122, 121], [3, 123]]])
    edges = random.permutation(edges)
    return columns(vertices), columns(edges), columns(mesh.faces)


def numbers(candidates, kind):
    names = LISTS[kind][0]
    pairs = [tuple(getattr(c, name) for name in names) for c in candidates]
    if kind in ("edge_edge", "vertex_vertex"):
        pairs = [tuple(sorted(pair)) for pair in pairs]
    assert len(set(pairs)) == len(pairs)
    return set(pairs)


def points_of(kind, pairs, edges, faces):
    corners = {"face_vertex": (None, faces), "edge_edge": (edges, edges), "edge_vertex": (None, edges)}
    pairs = np.array(sorted(pairs))
    first, second = corners.get(kind, (None, None))
    return pairs, np.column_stack([i if of is None else of[i] for i, of in zip(pairs.T, (first, second))])


@pytest.mark.parametrize("kind", LISTS)
@pytest.mark.parametrize("moving", [False, True])
def test_candidates_are_pairs_within_twice_the_inflation_radius(kind, moving):
    vertices, edges, faces = scene()
    radius = 0.04
    end = columns(vertices + 0.1 * np.random.default_rng(2).random(vertices.shape)) if moving else None
    arrays = (vertices, end, edges, faces) if moving else (vertices, edges, faces)
    boxes, ours = ipctk.LBVH(), adapter.BroadPhase(threads=1)
    found = []
    for broad_phase in (boxes, ours):
        broad_phase.build(*arrays, radius)
        found.append(numbers(getattr(broad_phase, f"detect_{kind}_candidates")(), kind))
    pairs, points = points_of(kind, found[0], edges, faces)
    if moving:
        near = crumple.pair_impacts(LISTS[kind][1], vertices[points], end[points], min_distance=2 * radius).hit
    else:
        near = crumple.pair_distances(LISTS[kind][1], vertices[points]).squared_distance <= (2 * radius) ** 2
    assert near.any() and not near.all()
    assert found[1] == {tuple(pair) for pair in pairs[near].tolist()}


def boxes_overlap(points, split, end_points, radius):
    """Returns, for each row, whether the boxes of its first `split` points and of its other points overlap.

    Boxes contain the points at the start and at the end, and are inflated by the radius.
    """
    both = np.concatenate([points, end_points], axis=1) if end_points is not None else points
    count, number = points.shape[1], np.arange(both.shape[1]) % points.shape[1]
    first, second = both[:, number < split], both[:, number >= split]
    gap = np.maximum(first.min(1) - second.max(1), second.min(1) - first.max(1)).max(axis=1)
    assert 0 < split < count and np.abs(gap - 2 * radius).min() > 1e-12, "too close to tell by floating point"
    return gap <= 2 * radius


@pytest.mark.parametrize(
    "kind, split", [("face_vertex", 1), ("edge_edge", 2), ("edge_vertex", 1), ("vertex_vertex", 1)]
)
@pytest.mark.parametrize("moving", [False, True])
def test_box_candidates_are_those_of_ipctk_whose_exact_boxes_overlap(kind, split, moving):
    vertices, edges, faces = scene()
    radius = 0.04
    end = columns(vertices + 0.1 * np.random.default_rng(2).random(vertices.shape)) if moving else None
    arrays = (vertices, end, edges, faces) if moving else (vertices, edges, faces)
    found = []
    for broad_phase in (ipctk.LBVH(), adapter.BroadPhase(boxes=True)):
        broad_phase.build(*arrays, radius)
        found.append(numbers(getattr(broad_phase, f"detect_{kind}_candidates")(), kind))
    pairs, points = points_of(kind, found[0], edges, faces)
    overlap = boxes_overlap(vertices[points], split, end[points] if moving else None, radius)
    assert found[1] == {tuple(pair) for pair in pairs[overlap].tolist()}
    assert len(found[1]) > 3


def test_box_candidates_give_step_size_and_has_intersections_of_ipctk():
    vertices, edges, faces = scene(rods=False)
    end = columns(vertices + 0.02 * (np.random.default_rng(2).random(vertices.shape) - 0.5))
    mesh, answers = ipctk.CollisionMesh(vertices, edges, faces), []
    for broad_phase in (ipctk.LBVH(), adapter.BroadPhase(boxes=True)):
        step = ipctk.compute_collision_free_stepsize(mesh, vertices, end, broad_phase=broad_phase)
        broad_phase.build(vertices, edges, faces)
        crossed = [len(getattr(broad_phase, f"detect_{kind}_candidates")()) for kind in ("edge_face", "face_face")]
        answers.append((step, ipctk.has_intersections(mesh, vertices, broad_phase=broad_phase), crossed))
    assert answers[0] == answers[1] and 0 < answers[0][0] < 1 and min(answers[0][2]) > 0


def test_step_ends_at_the_first_impact_and_is_no_shorter_than_ipctks():
    vertices, edges, faces = scene(rods=False)
    end = columns(vertices + 0.02 * (np.random.default_rng(2).random(vertices.shape) - 0.5))
    mesh, candidates, steps = ipctk.CollisionMesh(vertices, edges, faces), ipctk.Candidates(), []
    exact = toi_of(crumple.first_impact(vertices, end, faces))
    assert 0 < exact < 1
    for broad_phase in (adapter.BroadPhase(), ipctk.LBVH()):
        candidates.build(mesh, vertices, end, 0.0, broad_phase)
        assert adapter.compute_collision_free_stepsize(candidates, mesh, vertices, end) == exact
        assert adapter.compute_collision_free_stepsize(candidates, mesh, vertices, vertices) == 1
        assert not adapter.is_step_collision_free(candidates, mesh, vertices, end)
        assert adapter.is_step_collision_free(candidates, mesh, vertices, vertices)
        assert not ipctk.is_step_collision_free(mesh, vertices, end, broad_phase=broad_phase)
        steps.append(ipctk.compute_collision_free_stepsize(mesh, vertices, end, broad_phase=broad_phase))
    assert 0 < steps[1] <= steps[0] <= exact

    share = {"min_distance_share": 0.2}  # `candidates` has all overlaps of boxes, so also pairs that only come near
    first = adapter.compute_collision_free_stepsize(candidates, mesh, vertices, end, **share)
    assert first == toi_of(crumple.first_impact(vertices, end, faces, **share)) < exact
    assert not adapter.is_step_collision_free(candidates, mesh, vertices, end, **share)


def test_step_with_minimum_distance_ends_at_the_first_impact():
    vertices, edges, faces = scene(rods=False)
    end = columns(vertices + 0.02 * (np.random.default_rng(2).random(vertices.shape) - 0.5))
    least = float(np.sqrt(crumple.proximities(vertices, faces, radius=0.05).edge_edge_squared_distance.min()))
    mesh, candidates = ipctk.CollisionMesh(vertices, edges, faces), ipctk.Candidates()
    candidates.build(mesh, vertices, end, least / 4, adapter.BroadPhase())
    first = adapter.compute_collision_free_stepsize(candidates, mesh, vertices, end, least / 2)
    assert first == toi_of(crumple.first_impact(vertices, end, faces, min_distance=least / 2)) > 0


def test_step_with_rods_is_the_same_with_the_broad_phase_of_ipctk():
    vertices, edges, faces = scene()
    end = columns(vertices + 0.3 * (np.random.default_rng(2).random(vertices.shape) - 0.5))
    mesh = ipctk.CollisionMesh(vertices, edges, faces)
    times = []
    for broad_phase in (ipctk.LBVH(), adapter.BroadPhase()):
        candidates = ipctk.Candidates()
        candidates.build(mesh, vertices, end, 0.1, broad_phase)
        assert candidates.vv_candidates and candidates.ev_candidates
        times.append(adapter.compute_collision_free_stepsize(candidates, mesh, vertices, end, 0.05))
    assert times[0] == times[1] < 1


def test_normal_collisions_match_ipctks_in_count_and_minimum_distance():
    vertices, edges, faces = scene(rods=False)
    mesh, least = ipctk.CollisionMesh(vertices, edges, faces), []
    for broad_phase in (ipctk.LBVH(), adapter.BroadPhase()):
        collisions = ipctk.NormalCollisions()
        collisions.build(mesh, vertices, 0.05, 0.0, broad_phase)
        least.append((len(collisions), collisions.compute_minimum_distance(mesh, vertices)))
    assert least[0] == least[1] and least[0][0] > 10


def test_points_collide_with_points_and_rods():
    vertices = columns([[0, 0, 0], [4, 0, 0], [9, 0, 0], [9, 5, 0], [6.0, 1, 0]])
    end = vertices.copy(order="F")
    end[[0, 4], 0] += [3, 6]
    mesh = ipctk.CollisionMesh(vertices, columns([[2, 3]]), np.empty((0, 3), np.int32))
    for broad_phase in (ipctk.LBVH(), adapter.BroadPhase()):
        candidates = ipctk.Candidates()
        candidates.build(mesh, vertices, end, 0.5, broad_phase)
        assert numbers(candidates.vv_candidates, "vertex_vertex") == {(0, 1)}
        assert numbers(candidates.ev_candidates, "edge_vertex") == {(4, 0)}
        assert adapter.compute_collision_free_stepsize(candidates, mesh, vertices, end) == 0.5
        assert adapter.compute_collision_free_stepsize(candidates, mesh, vertices, end, 1.5) == 0.25
        candidates.ev_candidates = []
        assert adapter.compute_collision_free_stepsize(candidates, mesh, vertices, end) == 1
        assert adapter.compute_collision_free_stepsize(candidates, mesh, vertices, end, 2.5) == 0.5


def test_edge_pairs_rejected_by_can_vertices_collide_are_left_out():
    vertices, edges, faces = scene(rods=False)
    broad_phase = adapter.BroadPhase()
    broad_phase.build(vertices, edges, faces, 0.05)
    every = numbers(broad_phase.detect_edge_edge_candidates(), "edge_edge")
    broad_phase.can_vertices_collide = ipctk.CollisionFilter(lambda a, b: (5 * a + b) % 7 == 0)
    wanted = {(i, j) for i, j in every if any((5 * a + b) % 7 == 0 for a in edges[i] for b in edges[j])}
    assert numbers(broad_phase.detect_edge_edge_candidates(), "edge_edge") == wanted
    assert 0 < len(wanted) < len(every)


def test_unlisted_edges_are_in_no_edge_edge_candidates():
    vertices, edges, faces = scene(rods=False)
    broad_phase, few = adapter.BroadPhase(), edges[::3]
    broad_phase.build(vertices, edges, faces, 0.05)
    every = numbers(broad_phase.detect_edge_edge_candidates(), "edge_edge")
    broad_phase.build(vertices, few, faces, 0.05)
    found = numbers(broad_phase.detect_edge_edge_candidates(), "edge_edge")
    assert found == {(a // 3, b // 3) for a, b in every if a % 3 == b % 3 == 0}
    assert found


CROSSED = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [1, 1, -1], [1, 1, 2], [3, 1, 2.0]])
BOTH = np.array([[0, 1, 2], [3, 4, 5]])


@pytest.mark.parametrize("faces, rods", [(BOTH, []), (BOTH[:1], [[3, 4]]), (BOTH[:1], [[4, 5]]), (BOTH[:0], [[3, 4]])])
def test_has_intersections_matches_brute_force_with_and_without_rods(faces, rods):
    edges = np.array([*ipctk.edges(faces).tolist(), *rods]) if len(faces) else np.array(rods)
    mesh = ipctk.CollisionMesh(CROSSED, edges, faces)
    theirs = ipctk.has_intersections(mesh, columns(CROSSED), broad_phase=ipctk.BruteForce())
    assert ipctk.has_intersections(mesh, columns(CROSSED), broad_phase=adapter.BroadPhase()) == theirs


@pytest.mark.parametrize("edges, found", [([[0, 1], [5, 3]], [(0, 1), (1, 0)]), ([[5, 3]], [(0, 0)]), ([], [])])
def test_edge_face_candidates_use_numbers_of_listed_edges(edges, found):
    broad_phase = adapter.BroadPhase()
    broad_phase.build(CROSSED, np.reshape(edges, (-1, 2)).astype(int), BOTH)
    assert [(c.edge_id, c.face_id) for c in broad_phase.detect_edge_face_candidates()] == found
    assert [(c.face0_id, c.face1_id) for c in broad_phase.detect_face_face_candidates()] == [(0, 1)]


def test_invalid_edges_and_arguments_are_refused():
    broad_phase = adapter.BroadPhase()
    with pytest.raises(crumple.InvalidInput, match="edges 1 and 2 are the same edge"):
        broad_phase.build(CROSSED, [[0, 2], [0, 1], [1, 0]], BOTH)
    with pytest.raises(crumple.InvalidInput, match="edge 1 names vertex 4 twice"):
        broad_phase.build(CROSSED, [[0, 2], [4, 4]], BOTH)
    with pytest.raises(TypeError, match="three or four arrays"):
        broad_phase.build(CROSSED, BOTH)
    broad_phase.build(CROSSED, CROSSED, [[0, 1]], BOTH, 0.1)
    with pytest.raises(NotImplementedError, match="build with positions at one time"):
        broad_phase.detect_edge_face_candidates()
    broad_phase.clear()
    assert broad_phase.detect_face_vertex_candidates() == broad_phase.detect_edge_edge_candidates() == []
    assert broad_phase.detect_edge_vertex_candidates() == broad_phase.detect_vertex_vertex_candidates() == []


ONE_THREAD = """
import sys
import numpy as np
import ipctk
import crumple
from crumple.adapters.ipctk import BroadPhase, NarrowPhaseCCD

try:
    ipctk.set_num_threads(2)
    NarrowPhaseCCD()
    raise SystemExit("it would hang")
except crumple.InvalidInput as error:
    assert "set_num_threads(1)" in str(error)
ipctk.set_num_threads(1)
random = np.random.default_rng(1)
vertices = random.random((24, 3))
faces = np.arange(24).reshape(8, 3)
vertices = vertices[faces].mean(1).repeat(3, 0) + 0.3 * (vertices - 0.5)
end = vertices + 0.2 * (random.random((24, 3)) - 0.5)
vertices, end, faces = map(np.asfortranarray, (vertices, end, faces))
mesh = ipctk.CollisionMesh(vertices, np.asfortranarray(ipctk.edges(faces)), faces)
for share in (0, 0.1):
    exact = crumple.first_impact(vertices, end, faces, min_distance_share=share).toi
    ccd = NarrowPhaseCCD(min_distance_share=share)
    found = ipctk.compute_collision_free_stepsize(mesh, vertices, end, narrow_phase_ccd=ccd)
    assert found == exact and 0 < exact < 1, (found, exact)
assert not ipctk.is_step_collision_free(mesh, vertices, end, narrow_phase_ccd=NarrowPhaseCCD())
assert ipctk.is_step_collision_free(mesh, vertices, vertices, narrow_phase_ccd=NarrowPhaseCCD())

ccd, far = NarrowPhaseCCD(), float("inf")
points = np.array([[0, 0], [2, 0], [1, -1], [1, 1.0]])  # a vertex goes from the first to the second; an edge at rest
assert ccd.point_edge_ccd(points[0], *points[2:], points[1], *points[2:]) == (True, 0.5)
assert ccd.point_edge_ccd(points[0], *points[2:], points[1], *points[2:], tmax=0.25) == (False, far)
assert ccd.point_edge_ccd(points[0], *points[2:], points[1], *points[2:], min_distance=0.5) == (True, 0.25)
assert ccd.point_point_ccd(points[0], points[1], points[1], points[1], 0.5) == (True, 0.75)
assert ccd.point_point_ccd(points[0], points[1], points[0], points[1]) == (False, far)
print("done")
"""


def test_narrow_phase_is_exact_and_needs_one_thread():
    done = subprocess.run([sys.executable, "-c", ONE_THREAD], capture_output=True, text=True, timeout=100)
    assert done.stdout.endswith("done\n"), done.stderr


@pytest.mark.skipif(not DATA.exists(), reason=f"no frames in {DATA}")
def test_cloth_step_ends_at_the_first_impact_and_is_no_shorter_than_ipctks():
    first, second = (crumple.read_mesh(DATA / "cloth-funnel" / "frames" / f"{frame}.ply") for frame in (227, 228))
    start, end = columns(first.vertices.astype(float)), columns(second.vertices.astype(float))
    mesh = ipctk.CollisionMesh(start, columns(ipctk.edges(columns(first.faces))), columns(first.faces))
    exact, steps = toi_of(crumple.first_impact(start, end, first.faces)), []
    for broad_phase in (ipctk.LBVH(), adapter.BroadPhase()):
        steps.append(ipctk.compute_collision_free_stepsize(mesh, start, end, broad_phase=broad_phase))
        candidates = ipctk.Candidates()
        candidates.build(mesh, start, end, 0.0, broad_phase)
        assert adapter.compute_collision_free_stepsize(candidates, mesh, start, end) == exact
    assert 0 < steps[0] <= steps[1] <= exact
    assert len(candidates) == 134


def weights_of_collisions(collisions):
    """Returns the weight of each collision, by its kind and features."""
    names = ("vertex0_id", "vertex1_id", "edge0_id", "edge1_id", "edge_id", "vertex_id", "face_id")
    weights = {}
    for c in (collisions[i] for i in range(len(collisions))):
        features = [getattr(c, name) for name in names if hasattr(c, name)]
        of_one_kind = hasattr(c, "vertex0_id") or hasattr(c, "edge0_id")
        weights[(type(c).__name__, *(sorted(features) if of_one_kind else features))] = c.weight
    return weights


@pytest.mark.parametrize("area_weighting", [False, True])
@pytest.mark.parametrize("rods", [False, True])
@pytest.mark.parametrize("dhat", [0.05, 0.2])
def test_normal_collisions_have_the_energy_and_gradient_of_ipctk(dhat, rods, area_weighting):
    vertices, edges, faces = scene(rods)
    stretched = columns(vertices * [1, 0.9, 1.1])
    check_normal_collisions(vertices, stretched, edges, faces, dhat, area_weighting)


@pytest.mark.parametrize("area_weighting", [False, True])
def test_normal_collisions_of_a_cloth_are_those_of_ipctk(area_weighting):
    cloth = crumple.make_scene("cloth", triangles=5000, frame=40)
    vertices, faces = columns(cloth.vertices.astype(float)), columns(cloth.faces)
    check_normal_collisions(vertices, vertices, columns(ipctk.edges(faces)), faces, 0.1, area_weighting)


def check_normal_collisions(rest, vertices, edges, faces, dhat, area_weighting):
    mesh = ipctk.CollisionMesh(rest, edges, faces)
    theirs = ipctk.NormalCollisions()
    theirs.use_area_weighting = area_weighting
    theirs.build(mesh, vertices, dhat)
    ours = adapter.normal_collisions(mesh, vertices, dhat, area_weighting=area_weighting)
    assert len(ours) == len(theirs) > 0
    for name in ("vv_collisions", "ev_collisions", "ee_collisions", "fv_collisions"):
        assert len(getattr(ours, name)) == len(getattr(theirs, name))
    potential = ipctk.BarrierPotential(dhat, 1.0)
    np.testing.assert_allclose(potential(ours, mesh, vertices), potential(theirs, mesh, vertices), rtol=1e-12)
    ours, theirs = (potential.gradient(found, mesh, vertices) for found in (ours, theirs))
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-13 * np.abs(theirs).max())


def test_normal_collisions_obey_can_collide_and_dmin():
    vertices, edges, faces = scene(rods=False)  # for single vertices, ipctk 1.6 calls can_collide with other numbers
    mesh = ipctk.CollisionMesh(vertices, edges, faces)
    mesh.can_collide = ipctk.CollisionFilter(lambda v, w: (v + w) % 3 == 0)
    ipctk.set_num_threads(1)  # ipctk calls the function from its threads
    theirs = ipctk.NormalCollisions()
    theirs.build(mesh, vertices, 0.1, 0.02)
    ours = adapter.normal_collisions(mesh, vertices, 0.1, 0.02)
    assert weights_of_collisions(ours) == weights_of_collisions(theirs) != {}
    assert {ours[i].dmin for i in range(len(ours))} == {0.02}


def test_normal_collisions_need_three_dimensions():
    mesh = ipctk.CollisionMesh(columns([[0.0, 0], [1, 0], [0, 1]]), columns([[0, 1], [1, 2]]), np.empty((0, 3), np.int32))
    with pytest.raises(crumple.InvalidInput, match="needs a mesh in 3 dimensions, not 2"):
        adapter.normal_collisions(mesh, [[0, 0], [1, 0], [0, 1]], 0.1)
