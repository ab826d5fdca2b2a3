"""Cases that MPI ranks run for test_mpi.py: mpirun -n 3 python -m mpi4py mpi_ranks.py CASE. A rank that fails ends all.

Every rank also searches the whole scene by itself, and compares its local rows with its part of that result.
"""

import ctypes
import os
from dataclasses import replace

import numpy as np
from mpi_local_meshes import (
    COMM,
    ONE,
    RankMesh,
    RankWorld,
    all_on_the_last,
    blocks,
    bodies_by_turns,
    bodies_of_the_last,
    check_features,
    check_rows,
    cloth,
    error_of,
    grouped,
    local_world,
    round_robin,
    run,
)

import crumple
import crumple.mpi
from conftest import OnDevice, soup

BETWEEN_SOME = crumple.PairFilter(groups="between", excluded_groups=[(0, 1)])


def intersections_match_a_single_detector():
    queries = [
        (cloth(), dict(output="contacts")),
        (soup(500, dtype=np.float64), dict(neighbours="skip")),
        (soup(500), dict(weld=True, kind="proper")),
        (grouped(), dict(filter=BETWEEN_SOME)),
        (grouped(), dict(output="contacts", filter=crumple.PairFilter(groups="within"))),
        (crumple.Mesh(np.zeros((0, 3)), np.zeros((0, 3), np.int32)), dict(output="contacts")),
        (soup(2), {}),
    ]
    for mesh, members in queries:
        expected = crumple.Detector(**ONE).intersections(mesh, **members)
        for distribution in (round_robin, blocks, all_on_the_last):
            local = RankMesh(mesh, distribution(mesh))
            for options in ({}, dict(parts=7, batch_bytes=1024)):
                with crumple.mpi.Detector(COMM, **ONE, **options) as detector:
                    check_rows(detector.intersections(local.mesh, **local.ids, **members), local, expected)
                    query = crumple.IntersectionQuery(**members)
                    check_rows(detector.find(local, query), local, expected)
                    assert detector.find(local, replace(query, output="count")).count == len(expected)
                    assert detector.any(local, query) is bool(expected)


def boxes(distribution, opened=None):
    """Returns boxes in a row, each of which overlaps the next ones. A triangle of the box `opened` is missing."""
    corners = np.indices((2, 2, 2)).reshape(3, 8).T.astype(float)
    sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    faces = np.array([face for a, b, c, d in sides for face in ((a, b, c), (a, c, d))])
    shapes = [crumple.Shape(crumple.Mesh(corners, faces[1:] if b == opened else faces)) for b in range(8)]
    poses = np.tile(np.eye(3, 4), (8, 1, 1))
    poses[:, 0, 3] = 0.375 * np.arange(8)
    poses[:, 1, 3] = 0.25 * (np.arange(8) % 2)
    return RankWorld(shapes, distribution, poses, poses)


EVERYTHING = dict(
    self_overlaps=True,
    gradient=True,
    curves=True,
    windings=True,
    depths=True,
    depth_tolerance=0.1,
    directions=[(0, 0, 1)],
    translation=True,
    unions=True,
    regions=True,
)
LISTS = ("gradient", "curve", "curve_point", "winding", "depth", "region")


def overlaps_match_a_single_detector():
    one = crumple.Detector(**ONE)
    for distribution in (bodies_by_turns, bodies_of_the_last):
        local = boxes(distribution)
        expected = one.overlaps(local.whole, **EVERYTHING)
        assert len(expected) > 10
        mine = local.rows(expected.bodies)
        with crumple.mpi.Detector(COMM, **ONE) as detector:
            found = detector.overlaps(local.world, body_ids=local.body_ids, **EVERYTHING)
            query = crumple.OverlapQuery(**EVERYTHING)
            assert detector.find(local, query).volume.tobytes() == found.volume.tobytes()
            assert found.count == len(expected) and len(found) == mine.sum() and bool(found) and found.any
            for name in ("bodies", "relation", "volume", "normal", "torque", "depth_bound", "translation_low", "box"):
                assert getattr(found, name).tobytes() == getattr(expected, name)[mine].tobytes(), name
            for name in LISTS[:2] + LISTS[3:]:
                counts = np.diff(getattr(expected, f"{name}_offsets"))
                np.testing.assert_array_equal(np.diff(getattr(found, f"{name}_offsets")), counts[mine], name)
            rows = np.repeat(mine, np.diff(expected.depth_offsets))
            assert found.depths.tobytes() == expected.depths[rows].tobytes()
            np.testing.assert_array_equal(found.depth_vertices, expected.depth_vertices[rows])
            points = [curve for curves, row in zip(expected.curves, mine) if row for curve in curves]
            assert np.concatenate([*points, np.zeros((0, 3))]).tobytes() == found.curve_points.tobytes()
            np.testing.assert_array_equal(found.body_volume, expected.body_volume[local.body_ids])
            assert found.is_solid.tolist() == [True] * len(local.body_ids)
            assert repr(found).startswith(f"<crumple.mpi.Overlaps: {mine.sum()} pairs of bodies on this rank, ")
            assert "not supported on ranks" in str(error_of(getattr, found, "world_hit"))
            assert detector.any(local, query) and detector.find(local, replace(query, output="any")).any
            some = detector.find(local, replace(query, output="body_pairs"))
            np.testing.assert_array_equal(some.bodies, found.bodies)
            assert 'output="pairs"' in str(error_of(getattr, some, "volume"))


def overlap_of_a_mesh_with_itself_matches_a_single_detector():
    shapes = boxes(bodies_by_turns).whole.shapes
    corners = np.concatenate([np.asarray(shape.mesh.vertices) + [0.375 * b, 0, 0] for b, shape in enumerate(shapes)])
    mesh = crumple.Mesh(corners, np.concatenate([np.asarray(shapes[0].mesh.faces) + 8 * b for b in range(8)]))
    members = dict(gradient=True, windings=True)
    expected = crumple.Detector(**ONE).overlaps(mesh, **members)
    assert len(expected) == 1
    for distribution in (round_robin, blocks, all_on_the_last):
        local = RankMesh(mesh, distribution(mesh))
        for options in ({}, dict(parts=7, batch_bytes=1024)):
            with crumple.mpi.Detector(COMM, **ONE, **options) as detector:
                found = detector.overlaps(local.mesh, **local.ids, **members)
                assert found.any and found.count == 1 and len(found) == (0 in local.triangle_ids)
                for name in ("volume", "bodies", "gradient", "gradient_vertices", "windings", "body_volume"):
                    whole = getattr(expected, name)
                    assert getattr(found, name).tobytes() == whole[: len(whole) * len(found)].tobytes(), name
                assert found.part is None and "not supported on ranks" in str(error_of(getattr, found, "part_pairs"))
                assert detector.any(local, crumple.OverlapQuery())


def overlaps_of_open_bodies_and_meshes_are_refused_on_all_ranks():
    local = boxes(bodies_by_turns, opened=3)
    with crumple.mpi.Detector(COMM, **ONE) as detector:
        error = error_of(detector.overlaps, local.world, body_ids=local.body_ids)
        assert "body 3: its surface is not closed" in str(error) and error.index == 3, error
        found = detector.overlaps(local.world, body_ids=local.body_ids, open="skip")
        assert found.skipped.tolist() == [3] * (3 in local.body_ids) and 3 not in found.bodies
        error = error_of(detector.overlaps, cloth())
        assert "body 0: its surface is not closed" in str(error), error


def impacts_match_a_single_detector():
    queries = [
        (cloth(60), cloth(61).vertices, {}),
        (
            cloth(60),
            np.asarray(cloth(61).vertices, np.float64),
            dict(min_distance=1e-3, min_distance_share=0.1, weld=True),
        ),
        (grouped(), np.flip(grouped().vertices, 1), dict(filter=BETWEEN_SOME)),
        (soup(200, size=0.3), soup(200, size=0.3).vertices, {}),
        (soup(1), soup(1).vertices, {}),
    ]
    for mesh, end, members in queries:
        expected = crumple.Detector(**ONE).impacts(mesh, end, **members)
        for distribution in (round_robin, all_on_the_last):
            local = RankMesh(mesh.moving_to(end), distribution(mesh))
            vertices, faces, groups = local.mesh
            with crumple.mpi.Detector(COMM, **ONE) as detector:
                found = detector.impacts(vertices, local.mesh.end, faces, groups=groups, **local.ids, **members)
                check_features(found, local, expected, ("toi", "start"))
                assert found.first == expected.first
                query = crumple.ImpactQuery(**members)
                check_features(detector.find(local, query), local, expected, ("toi", "start"))
                first = detector.find(local, replace(query, output="first"))
                assert first.first == expected.first and first.any == expected.any == ("first at" in repr(first))
                assert 'output="pairs"' in str(error_of(getattr, first, "vertex_faces"))
                assert detector.any(local, query) is expected.any
                some = detector.find(local, replace(query, output="any"))
                assert some.any == expected.any and 'output="first"' in str(error_of(getattr, some, "first"))
                for result in (found, first, some):
                    assert repr(result).startswith("<crumple.mpi.Impacts: "), result


def near_pairs_match_a_single_detector():
    queries = [
        (cloth(), dict(radius=0.02)),
        (cloth(), dict(radius=0.02, strict=True, closest=True, weld=True)),
        (grouped(), dict(radius=0.2, closest=True, filter=crumple.PairFilter(groups="within"))),
        (soup(1), dict(radius=0.1)),
    ]
    for mesh, members in queries:
        expected = crumple.Detector(**ONE).proximities(mesh, **members)
        columns = ("squared_distance", "touching", *(("type", "at") if members.get("closest") else ()))
        for distribution in (round_robin, all_on_the_last):
            local = RankMesh(mesh, distribution(mesh))
            with crumple.mpi.Detector(COMM, **ONE) as detector:
                found = detector.proximities(local.mesh, **local.ids, **members)
                check_features(found, local, expected, columns)
                if "closest" not in members:
                    assert "closest=True" in str(error_of(getattr, found, "edge_edge_type"))
                query = crumple.ProximityQuery(**members)
                check_features(detector.find(local, query), local, expected, columns)
                assert detector.any(local, query) is expected.any
                some = detector.find(local, replace(query, output="any"))
                assert some.any == expected.any and 'output="pairs"' in str(error_of(getattr, some, "count"))
                for result in (found, some):
                    assert repr(result).startswith("<crumple.mpi.Proximities: "), result


def on_device(array):
    """Returns a copy in the memory of the device that the CPU emulates for crumple.mpi."""
    allocate = ctypes.CDLL(crumple._mpi.__file__).crumple_test_device_memory
    allocate.restype, allocate.argtypes = ctypes.c_void_p, [ctypes.c_size_t]
    memory = (ctypes.c_byte * max(array.nbytes, 1)).from_address(allocate(max(array.nbytes, 1)))
    copy = np.frombuffer(memory, array.dtype, array.size).reshape(array.shape)
    copy[...] = array
    return OnDevice(copy)


def arrays_can_be_in_device_memory():
    mesh = grouped()
    local = RankMesh(mesh, round_robin(mesh))
    on_host = (local.mesh.vertices, local.mesh.faces, local.mesh.groups.astype(np.int32))
    with crumple.mpi.Detector(COMM, **ONE) as detector:
        for failing in range(COMM.size):
            given = crumple.Mesh(*(map(OnDevice, on_host) if COMM.rank == failing else on_host))
            error = error_of(detector.intersections, given, **local.ids)
            assert error.rank == failing and "CUDA memory, which needs the cuda backend" in str(error), error
        check_rows(detector.find(local), local, crumple.Detector(**ONE).intersections(mesh))
    if "CRUMPLE_CUDA_ON_CPU" not in os.environ:
        return
    one = crumple.Detector(**ONE)
    members = dict(filter=crumple.PairFilter(groups="between"))
    with crumple.mpi.Detector(COMM, backend="cuda", threads=1) as detector:
        for some in (COMM.rank == 0, True):  # arrays are on the device on rank 0 only, then on all ranks
            given = crumple.Mesh(*(map(on_device, on_host) if some else on_host))
            found = detector.intersections(given, **local.ids, **members)
            check_rows(found, local, one.intersections(mesh, **members))
            end = local.mesh.vertices[:, ::-1].copy()
            found = detector.impacts(given, on_device(end) if some else end, **local.ids, **members)
            expected = one.impacts(mesh, np.asarray(mesh.vertices)[:, ::-1].copy(), **members)
            check_features(found, local, expected, ("toi", "start"))
            found = detector.proximities(given, radius=0.1, **local.ids, **members)
            expected = one.proximities(mesh, radius=0.1, **members)
            check_features(found, local, expected, ("squared_distance", "touching"))
        elsewhere = crumple.Mesh(*(OnDevice(array, device=99) for array in on_host))
        error = error_of(detector.intersections, elsewhere, **local.ids)
        assert "CUDA device 99, but the detector of this rank works on device " in str(error), error


def worlds_match_a_single_detector():
    one = crumple.Detector(**ONE)
    queries = [
        crumple.IntersectionQuery(output="contacts"),
        crumple.IntersectionQuery(
            weld=True, filter=crumple.PairFilter(bodies="between", excluded_bodies=[(0, 1), (2, 2)])
        ),
        crumple.IntersectionQuery(output="body_pairs", filter=crumple.PairFilter(groups="within")),
        crumple.IntersectionQuery(output="count", neighbours="skip"),
        crumple.IntersectionQuery(output="any"),
    ]
    for distribution in (bodies_by_turns, bodies_of_the_last):
        local = local_world(distribution)
        with crumple.mpi.Detector(COMM, **ONE) as detector:
            for query in queries:
                output = query.output
                expected = one.find(local.whole, query)
                found = detector.find(local, query)
                assert found.any == expected.any == bool(found) == detector.any(local, query)
                assert repr(found).startswith("<crumple.mpi.Intersections: ")
                assert (f"{len(found)} colliding pairs of bodies on this rank" in repr(found)) == (
                    output == "body_pairs"
                )
                if output in ("count", "pairs", "contacts"):
                    assert found.count == expected.count > 0
                else:
                    assert 'output="count"' in str(error_of(getattr, found, "count"))
                if output in ("body_pairs", "pairs", "contacts"):
                    mine = local.rows(expected.bodies)
                    np.testing.assert_array_equal(found.bodies, expected.bodies[mine])
                    assert len(found) == mine.sum() and not (len(found) and found.bodies.flags.writeable)
                if output in ("pairs", "contacts"):
                    np.testing.assert_array_equal(found.pairs, expected.pairs[mine])
                assert (found.contacts is None) == (output != "contacts")
                for points, row in zip(found.contacts or [], np.flatnonzero(mine) if found.contacts else []):
                    assert points.tobytes() == expected.contacts[row].tobytes()


def moving_worlds_match_a_single_detector():
    one = crumple.Detector(**ONE)
    for distribution in (bodies_by_turns, bodies_of_the_last):
        local = local_world(distribution, self_collisions=[True, False] * 4)
        world, ids = local.world, dict(body_ids=local.body_ids)
        with crumple.mpi.Detector(COMM, **ONE) as detector:
            searches = [
                (detector.impacts(world, **ids), one.impacts(local.whole), ("toi", "start")),
                (
                    detector.proximities(world, radius=0.1, closest=True, **ids),
                    one.proximities(local.whole, radius=0.1, closest=True),
                    ("squared_distance", "touching", "type", "at"),
                ),
            ]
            for found, expected, columns in searches:
                for kind in ("vertex_face", "edge_edge"):
                    mine = local.rows(getattr(expected, f"{kind}_bodies"))
                    for name in (f"{kind}s", f"{kind}_bodies", *(f"{kind}_{column}" for column in columns)):
                        rows = np.ascontiguousarray(getattr(expected, name)[mine])
                        assert getattr(found, name).tobytes() == rows.tobytes(), name
                first = expected.first_edge[found.edge_bodies]
                np.testing.assert_array_equal(found.edges, expected.edges[first + found.edge_ids])
                assert found.count == expected.count > 0 and found.any
            assert searches[0][0].first == searches[0][1].first
            assert detector.impacts(world, output="first", **ids).first == searches[0][1].first
            found = detector.intersections(world.at(world.end_poses), **ids)
            expected = one.intersections(local.whole.at(local.whole.end_poses))
            np.testing.assert_array_equal(found.pairs, expected.pairs[local.rows(expected.bodies)])
            found = detector.intersections(world, **ids)
            assert found.statistics.moved
            of_mesh = detector.proximities(np.zeros((0, 3)), np.zeros((0, 3), np.int32), radius=1)
            assert "the scene is one mesh" in str(error_of(getattr, of_mesh, "edge_bodies"))


def triangles_are_numbered_by_rank_without_ids():
    mesh = soup(90, size=0.4)
    local = RankMesh(mesh, blocks(mesh))
    vertices, faces, _ = local.mesh
    expected = crumple.Detector(**ONE).intersections(mesh)
    with crumple.mpi.Detector(COMM, **ONE) as detector:
        check_rows(detector.intersections(vertices, faces), local, expected)
        check_rows(detector.intersections((vertices, faces.ravel())), local, expected)
        check_rows(detector.intersections(vertices.tolist(), faces.tolist()), local, expected)
        check_rows(detector.find(crumple.mpi.LocalMesh((vertices, faces))), local, expected)


def results_of_earlier_frames_stay_valid():
    held = []
    with crumple.mpi.Detector(COMM, **ONE) as detector:
        for frame in range(60, 70):
            mesh = cloth(frame)
            local = RankMesh(mesh, round_robin(mesh))
            result = detector.intersections(local.mesh, output="contacts", **local.ids)
            held.append((result, local, crumple.Detector(**ONE).intersections(mesh, output="contacts")))
            assert result.statistics.moved == (frame > 60) == detector.statistics.moved
    del detector
    for found, local, expected in held:
        check_rows(found, local, expected)
    pairs = found.pairs
    before = pairs.copy()
    del found, result, held
    np.testing.assert_array_equal(pairs, before)


def statistics_have_phase_times_members_and_bytes_sent():
    mesh = cloth()
    with crumple.mpi.Detector(COMM, **ONE) as detector:
        statistics = detector.find(RankMesh(mesh, round_robin(mesh))).statistics
        assert list(statistics.phase_milliseconds) == "query input ids place members memory search rows output".split()
        assert 0 < sum(statistics.phase_milliseconds.values()) <= statistics.milliseconds * 1.01
        assert COMM.allreduce(statistics.members) >= len(mesh.faces)
        assert (statistics.bytes_sent > 0) == (COMM.size > 1)
        assert statistics.largest_work >= statistics.mean_work > 0
        assert isinstance(statistics.search, crumple.Statistics) and statistics.search.threads == 1
        assert "members=" in repr(statistics)


def progress_is_reported_for_each_part():
    mesh = cloth()
    local = RankMesh(mesh, round_robin(mesh))
    with crumple.mpi.Detector(COMM, parts=6, **ONE) as detector:
        seen = []
        detector.set_progress(lambda *progress: seen.append(progress))
        statistics = detector.find(local).statistics
        parts = [(phase, done, of) for phase, done, of in seen if phase == "search"]
        assert parts == [("search", done, statistics.parts) for done in range(statistics.parts + 1)]
        begun = [phase for phase, done, _ in seen if done == 0]
        assert begun == list(statistics.phase_milliseconds), begun
        assert all((done, of) == (0, 0) for phase, done, of in seen if phase != "search")
        assert "show must be callable or None, not int" in str(error_of(detector.set_progress, 3))
        detector.set_progress(None)
        seen.clear()
        detector.find(local)
        assert seen == []


def groups_of_ranks_can_search_their_own_scenes():
    half = COMM.Split(COMM.rank % 2)
    mesh = soup(60, size=0.4, seed=COMM.rank % 2)
    local = RankMesh(mesh, np.arange(60) % half.size, half.rank)
    with crumple.mpi.Detector(half, **ONE) as detector:
        assert (detector.rank, detector.ranks) == (half.rank, half.size)
        check_rows(detector.find(local), local, crumple.Detector(**ONE).intersections(mesh))
    half.Free()


if __name__ == "__main__":
    run(globals())
