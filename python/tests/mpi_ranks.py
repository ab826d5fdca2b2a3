"""What ranks of MPI do in test_mpi.py: mpirun -n 3 python -m mpi4py mpi_ranks.py CASE. A rank that fails ends all.

Every rank makes the answer of one machine itself and looks for its own rows in it.
"""

import ctypes
import os

import numpy as np
from mpi_shares import (
    COMM,
    ONE,
    Share,
    all_on_the_last,
    blocks,
    bodies_by_turns,
    bodies_of_the_last,
    check_features,
    check_rows,
    cloth,
    error_of,
    grouped,
    round_robin,
    run,
    world_share,
)

import crumple
import crumple.mpi
from conftest import OnDevice, soup


def the_answer_is_that_of_one_detector():
    questions = [
        (cloth(), dict(contacts=True)),
        (soup(500, dtype=np.float64), dict(neighbours="skip")),
        (soup(500), dict(weld=True, intersections="proper")),
        (grouped(), dict(wanted="between", excluded_groups=[(0, 1)])),
        (grouped(), dict(wanted="within", contacts=True)),
        (crumple.Mesh(np.zeros((0, 3)), np.zeros((0, 3), np.int32)), dict(contacts=True)),
        (soup(2), {}),
    ]
    for mesh, question in questions:
        expected = crumple.Detector(**ONE).find_self(mesh, **question)
        without_contacts = {name: value for name, value in question.items() if name != "contacts"}
        for distribution in (round_robin, blocks, all_on_the_last):
            share = Share(mesh, distribution(mesh))
            for options in ({}, dict(parts=7, round_bytes=1024)):
                with crumple.mpi.Detector(COMM, **ONE, **options) as detector:
                    check_rows(share.call(detector.find_self, **question), share, expected)
                    assert share.call(detector.count, **without_contacts) == len(expected)
                    assert share.call(detector.has_collision, **without_contacts) is bool(expected)


def motion_is_that_of_one_detector():
    sheets = soup(200, size=0.3)
    questions = [
        (cloth(60), cloth(61).vertices, {}),
        (cloth(60), np.asarray(cloth(61).vertices, np.float64), dict(min_distance=1e-3, min_distance_share=0.1, weld=True)),
        (grouped(), np.flip(grouped().vertices, 1), dict(wanted="between", excluded_groups=[(0, 1)])),
        (sheets, sheets.vertices, {}),
        (soup(1), soup(1).vertices, {}),
    ]
    for mesh, end, question in questions:
        expected = crumple.Detector(**ONE).find_impacts(mesh, end, **question)
        for distribution in (round_robin, all_on_the_last):
            share = Share(mesh, distribution(mesh))
            moved = np.asarray(end)[share.vertex_ids]
            ids = dict(triangle_ids=share.triangle_ids, vertex_ids=share.vertex_ids)
            given = (share.vertices, moved, share.faces, share.groups)
            with crumple.mpi.Detector(COMM, **ONE) as detector:
                found = detector.find_impacts(*given, **ids, **question)
                check_features(found, share, expected, ("toi", "start"))
                assert found.first == expected.first
                first = detector.find_impacts(*given, **ids, wants="earliest", **question)
                assert first.first == expected.first and first.any == expected.any
                assert "earliest" not in repr(first) and "wants" in str(error_of(getattr, first, "vertex_faces"))
                time = detector.time_of_first_impact(*given, **ids, **question)
                assert time == (expected.first.toi if expected.any else None)
                assert detector.is_free(*given, **ids, **question) is not expected.any
                some = detector.find_impacts(*given, **ids, wants="any", **question)
                assert some.any == expected.any and 'wants="earliest"' in str(error_of(getattr, some, "first"))
                for answer in (found, first, some):
                    assert repr(answer).startswith("<crumple.mpi.Impacts: "), answer


def nearness_is_that_of_one_detector():
    questions = [
        (cloth(), dict(radius=0.02)),
        (cloth(), dict(radius=0.02, strict=True, closest=True, weld=True)),
        (grouped(), dict(radius=0.2, wanted="within", closest=True)),
        (soup(1), dict(radius=0.1)),
    ]
    for mesh, question in questions:
        expected = crumple.Detector(**ONE).find_near(mesh, **question)
        columns = ("squared_distance", "touching", *(("type", "at") if question.get("closest") else ()))
        for distribution in (round_robin, all_on_the_last):
            share = Share(mesh, distribution(mesh))
            with crumple.mpi.Detector(COMM, **ONE) as detector:
                found = share.call(detector.find_near, **question)
                check_features(found, share, expected, columns)
                if "closest" not in question:
                    assert "closest=True" in str(error_of(getattr, found, "edge_edge_type"))
                some = share.call(detector.find_near, wants="any", **question)
                assert some.any == expected.any and 'wants="pairs"' in str(error_of(getattr, some, "total"))
                for answer in (found, some):
                    assert repr(answer).startswith("<crumple.mpi.Nearby: "), answer


def on_device(array):
    """A copy in the memory of the device that the CPU plays for crumple.mpi."""
    allocate = ctypes.CDLL(crumple._mpi.__file__).crumple_test_device_memory
    allocate.restype, allocate.argtypes = ctypes.c_void_p, [ctypes.c_size_t]
    memory = (ctypes.c_byte * max(array.nbytes, 1)).from_address(allocate(max(array.nbytes, 1)))
    copy = np.frombuffer(memory, array.dtype, array.size).reshape(array.shape)
    copy[...] = array
    return OnDevice(copy)


def arrays_may_lie_on_a_device():
    mesh = grouped()
    share = Share(mesh, round_robin(mesh))
    ids = dict(triangle_ids=share.triangle_ids, vertex_ids=share.vertex_ids)
    on_host = (share.vertices, share.faces, share.groups.astype(np.int32))
    with crumple.mpi.Detector(COMM, **ONE) as detector:
        for failing in range(COMM.size):
            given = map(OnDevice, on_host) if COMM.rank == failing else on_host
            error = error_of(detector.find_self, *given, **ids)
            assert error.rank == failing and "CUDA memory, which needs the cuda backend" in str(error), error
        check_rows(share.call(detector.find_self), share, crumple.Detector(**ONE).find_self(mesh))
    if "CRUMPLE_CUDA_ON_CPU" not in os.environ:
        return
    one = crumple.Detector(**ONE)
    question = dict(wanted="between")
    with crumple.mpi.Detector(COMM, backend="cuda", threads=1) as detector:
        for some in (COMM.rank == 0, True):  # on one rank alone, and on all
            given = tuple(on_device(array) for array in on_host) if some else on_host
            found = detector.find_self(*given, **ids, **question)
            check_rows(found, share, one.find_self(mesh, **question))
            end = share.vertices[:, ::-1].copy()
            found = detector.find_impacts(given[0], on_device(end) if some else end, *given[1:], **ids, **question)
            expected = one.find_impacts(mesh, np.asarray(mesh.vertices)[:, ::-1].copy(), **question)
            check_features(found, share, expected, ("toi", "start"))
            found = detector.find_near(*given, **ids, radius=0.1, **question)
            expected = one.find_near(mesh, radius=0.1, **question)
            check_features(found, share, expected, ("squared_distance", "touching"))
        elsewhere = tuple(OnDevice(array, device=99) for array in on_host)
        error = error_of(detector.find_self, *elsewhere, **ids)
        assert "CUDA device 99, but the detector of this rank works on device " in str(error), error


def bodies_have_the_answer_of_one_detector():
    one = crumple.Detector(**ONE)
    questions = [
        dict(wants="contacts"),
        dict(wants="pairs", bodies="between", excluded=[(0, 1), (2, 2)], weld=True),
        dict(wants="body_pairs", groups="within"),
        dict(wants="count", neighbours="skip"),
        dict(wants="any"),
    ]
    for distribution in (bodies_by_turns, bodies_of_the_last):
        share = world_share(distribution)
        with crumple.mpi.Detector(COMM, **ONE) as detector:
            for question in questions:
                expected = one.find(share.whole, **question)
                found = detector.find(share.world, body_ids=share.body_ids, **question)
                assert found.any == expected.any == bool(found) and repr(found).startswith("<crumple.mpi.WorldResult: ")
                wants = question["wants"]
                if wants in ("count", "pairs", "contacts"):
                    assert found.count == expected.count > 0
                else:
                    assert 'wants="count"' in str(error_of(getattr, found, "count"))
                if wants in ("body_pairs", "pairs", "contacts"):
                    mine = share.rows(expected.bodies)
                    np.testing.assert_array_equal(found.bodies, expected.bodies[mine])
                    assert len(found) == mine.sum() and not (len(found) and found.bodies.flags.writeable)
                if wants in ("pairs", "contacts"):
                    np.testing.assert_array_equal(found.pairs, expected.pairs[mine])
                assert (found.contacts is None) == (wants != "contacts")
                for points, row in zip(found.contacts or [], np.flatnonzero(mine) if found.contacts else []):
                    assert points.tobytes() == expected.contacts[row].tobytes()


def moving_bodies_have_the_answer_of_one_detector():
    one = crumple.Detector(**ONE)
    for distribution in (bodies_by_turns, bodies_of_the_last):
        share = world_share(distribution, self_collisions=[True, False] * 4)
        ids = dict(body_ids=share.body_ids)
        with crumple.mpi.Detector(COMM, **ONE) as detector:
            searches = [
                (detector.find_impacts(share.world, **ids), one.find_impacts(share.whole), ("toi", "start")),
                (
                    detector.find_near(share.world, **ids, radius=0.1, closest=True),
                    one.find_near(share.whole, radius=0.1, closest=True),
                    ("squared_distance", "touching", "type", "at"),
                ),
            ]
            for found, expected, columns in searches:
                for kind in ("vertex_face", "edge_edge"):
                    mine = share.rows(getattr(expected, f"{kind}_bodies"))
                    for name in (f"{kind}s", f"{kind}_bodies", *(f"{kind}_{column}" for column in columns)):
                        rows = np.ascontiguousarray(getattr(expected, name)[mine])
                        assert getattr(found, name).tobytes() == rows.tobytes(), name
                first = expected.first_edge[found.edge_bodies]
                np.testing.assert_array_equal(found.edges, expected.edges[first + found.edge_ids])
                assert found.total == expected.count > 0 and found.any
            assert searches[0][0].first == searches[0][1].first
            earliest = detector.find_impacts(share.world, **ids, wants="earliest")
            assert earliest.first == searches[0][1].first
            found = detector.find(share.world, **ids, poses=share.world.end_poses)
            expected = one.find(share.whole, poses=share.whole.end_poses)
            np.testing.assert_array_equal(found.pairs, expected.pairs[share.rows(expected.bodies)])
            found = detector.find(share.world, **ids)
            assert found.statistics.moved
            of_mesh = detector.find_near(np.zeros((0, 3)), np.zeros((0, 3), np.int32), radius=1)
            assert "asked of a mesh" in str(error_of(getattr, of_mesh, "edge_bodies"))


def triangles_are_numbered_by_rank_without_ids():
    mesh = soup(90, size=0.4)
    share = Share(mesh, blocks(mesh))
    expected = crumple.Detector(**ONE).find_self(mesh)
    with crumple.mpi.Detector(COMM, **ONE) as detector:
        check_rows(detector.find_self(share.vertices, share.faces), share, expected)
        check_rows(detector.find_self((share.vertices, share.faces.ravel())), share, expected)
        check_rows(detector.find_self(share.vertices.tolist(), share.faces.tolist()), share, expected)


def frames_follow_one_another():
    held = []
    with crumple.mpi.Detector(COMM, **ONE) as detector:
        for frame in range(60, 70):
            mesh = cloth(frame)
            share = Share(mesh, round_robin(mesh))
            result = share.call(detector.find_self, contacts=True)
            held.append((result, share, crumple.Detector(**ONE).find_self(mesh, contacts=True)))
            assert result.statistics.moved == (frame > 60) == detector.statistics.moved
    del detector
    for found, share, expected in held:
        check_rows(found, share, expected)
    pairs = found.pairs
    before = pairs.copy()
    del found, result, held
    np.testing.assert_array_equal(pairs, before)


def statistics_tell_what_was_done():
    mesh = cloth()
    with crumple.mpi.Detector(COMM, **ONE) as detector:
        share = Share(mesh, round_robin(mesh))
        statistics = share.call(detector.find_self).statistics
        assert list(statistics.phase_milliseconds) == "question input ids place members room search rows output".split()
        assert 0 < sum(statistics.phase_milliseconds.values()) <= statistics.milliseconds * 1.01
        assert COMM.allreduce(statistics.members) >= len(mesh.faces)
        assert (statistics.bytes_sent > 0) == (COMM.size > 1)
        assert statistics.largest_work >= statistics.mean_work > 0
        assert isinstance(statistics.search, crumple.Statistics) and statistics.search.threads == 1
        assert "members=" in repr(statistics)


def progress_is_shown():
    mesh = cloth()
    share = Share(mesh, round_robin(mesh))
    with crumple.mpi.Detector(COMM, parts=6, **ONE) as detector:
        seen = []
        detector.set_progress(lambda *progress: seen.append(progress))
        statistics = share.call(detector.find_self).statistics
        parts = [(phase, done, of) for phase, done, of in seen if phase == "search"]
        assert parts == [("search", done, statistics.parts) for done in range(statistics.parts + 1)]
        begun = [phase for phase, done, _ in seen if done == 0]
        assert begun == list(statistics.phase_milliseconds), begun
        assert all((done, of) == (0, 0) for phase, done, of in seen if phase != "search")
        assert "show must be callable or None, not int" in str(error_of(detector.set_progress, 3))
        detector.set_progress(None)
        seen.clear()
        share.call(detector.find_self)
        assert seen == []


def some_ranks_have_a_scene_of_their_own():
    half = COMM.Split(COMM.rank % 2)
    mesh = soup(60, size=0.4, seed=COMM.rank % 2)
    share = Share(mesh, np.arange(60) % half.size, half.rank)
    with crumple.mpi.Detector(half, **ONE) as detector:
        assert (detector.rank, detector.ranks) == (half.rank, half.size)
        check_rows(share.call(detector.find_self), share, crumple.Detector(**ONE).find_self(mesh))
    half.Free()


if __name__ == "__main__":
    run(globals())
