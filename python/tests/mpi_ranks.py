"""What ranks of MPI do in test_mpi.py: mpirun -n 3 python -m mpi4py mpi_ranks.py CASE. A rank that fails ends all.

Every rank makes the answer of one machine itself and looks for its own rows in it.
"""

import ctypes
import os
import signal
import sys
import threading
import time

import numpy as np
from mpi4py import MPI

import crumple
import crumple.mpi
from conftest import OnDevice, soup

COMM = MPI.COMM_WORLD
ONE = {"backend": "cpu", "threads": 1}


class Share:
    """The faces of a mesh that a rank has, and the vertices that they name."""

    def __init__(self, mesh, triangles, rank=COMM.rank):
        self.rank, self.mesh, self.triangle_ids = rank, mesh, np.flatnonzero(triangles == rank)
        faces = np.asarray(mesh.faces).reshape(-1, 3)[self.triangle_ids]
        self.vertex_ids, faces = np.unique(faces, return_inverse=True)
        self.faces = faces.reshape(-1, 3).astype(np.int32)
        self.groups = None if mesh.groups is None else np.asarray(mesh.groups)[self.triangle_ids]
        # Vertices that no face names have to be somewhere, too.
        unnamed = np.setdiff1d(np.arange(len(mesh.vertices)), mesh.faces)
        if rank == 0:
            self.vertex_ids = np.append(self.vertex_ids, unnamed)
        self.vertices = np.asarray(mesh.vertices)[self.vertex_ids]

    def arguments(self):
        return (self.vertices, self.faces, self.groups), dict(
            triangle_ids=self.triangle_ids, vertex_ids=self.vertex_ids
        )

    def call(self, call, **question):
        arrays, ids = self.arguments()
        return call(*arrays, **ids, **question)


def round_robin(mesh):
    return np.arange(len(mesh.faces)) % COMM.size


def blocks(mesh):
    return np.arange(len(mesh.faces)) * COMM.size // max(1, len(mesh.faces))


def all_on_the_last(mesh):
    return np.full(len(mesh.faces), COMM.size - 1)


def cloth(frame=60, triangles=3000):
    return crumple.make_scene("cloth", triangles=triangles, frame=frame)


def grouped():
    mesh = soup(300, size=0.4)
    return mesh._replace(groups=np.arange(300) % 3)


def check_rows(found, share, expected):
    """That these are the rows of the whole answer whose first triangle is this rank's."""
    mine = np.isin(expected.pairs[:, 0], share.triangle_ids)
    assert found.pairs.dtype == np.int32 and not (len(found) and found.pairs.flags.writeable)
    np.testing.assert_array_equal(found.pairs, expected.pairs[mine])
    assert len(found) == mine.sum() and found.total == len(expected) and bool(found) == mine.any()
    assert (found.contacts is None) == (expected.contacts is None)
    if expected.contacts is not None:
        np.testing.assert_array_equal(found.contacts.kinds, expected.contacts.kinds[mine])
        assert len(found.contacts) == mine.sum()
        for points, row in zip(found.contacts, np.flatnonzero(mine)):
            assert points.tobytes() == expected.contacts[row].tobytes()


def lowest_triangles(faces, corners):
    """Of each vertex, or of each edge (two vertices), the lowest of the faces that name it."""
    lowest = {}
    for triangle, face in enumerate(np.asarray(faces).reshape(-1, 3).tolist()):
        names = face if corners == 1 else [tuple(sorted((face[k], face[k - 1]))) for k in range(3)]
        for name in names:
            lowest.setdefault(name, triangle)
    return lowest


def check_features(found, share, expected, columns):
    """That these are the rows of the whole answer whose first feature is owned by one of this rank's triangles."""
    vertices, edges = (lowest_triangles(share.mesh.faces, corners) for corners in (1, 2))
    ends = [tuple(edge) for edge in expected.edges.tolist()]
    owners = {
        "vertex_face": [vertices[v] for v in expected.vertex_faces[:, 0].tolist()],
        "edge_edge": [edges[ends[e]] for e in expected.edge_edges[:, 0].tolist()],
    }
    for kind, triangles in owners.items():
        mine = np.isin(triangles, share.triangle_ids) if triangles else np.zeros(0, bool)
        for name in (kind + "s", *(f"{kind}_{column}" for column in columns)):
            rows, all_rows = getattr(found, name), getattr(expected, name)
            assert rows.dtype == all_rows.dtype and not (len(rows) and rows.flags.writeable), name
            assert rows.tobytes() == np.ascontiguousarray(all_rows[mine]).tobytes(), name
    np.testing.assert_array_equal(found.edge_ids, np.unique(found.edge_edges))
    np.testing.assert_array_equal(found.edges, expected.edges[found.edge_ids])
    assert found.total == expected.count and found.any == expected.any == bool(found)
    assert COMM.allreduce(len(found)) == found.total


def error_of(call, *arguments, **named):
    try:
        call(*arguments, **named)
    except crumple.Error as error:
        return error
    raise AssertionError("no error was raised")


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
        (cloth(60), np.asarray(cloth(61).vertices, np.float64), dict(separation=1e-3, separation_share=0.1, weld=True)),
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


class WorldShare:
    """The bodies of a world that a rank has."""

    def __init__(self, shapes, distribution, poses, end_poses=None, self_collisions=True):
        count = len(shapes)
        self.body_ids = np.flatnonzero(distribution(count))
        all_self = np.broadcast_to(self_collisions, count)
        self.whole = crumple.World(shapes, poses=poses, end_poses=end_poses, self_collisions=all_self)
        mine = self.body_ids
        self.world = crumple.World(
            [shapes[b] for b in mine],
            poses=poses[mine],
            end_poses=None if end_poses is None else end_poses[mine],
            self_collisions=all_self[mine],
        )

    def rows(self, bodies):
        return np.isin(bodies[:, 0], self.body_ids)


def world_share(distribution, **named):
    shapes = [crumple.Shape(soup(20, size=0.5)), crumple.Shape(soup(30, size=0.3, seed=2, dtype=np.float64))] * 4
    random = np.random.default_rng(3)
    poses = np.tile(np.eye(3, 4), (8, 1, 1))
    poses[:, :, 3] = 0.4 * random.random((8, 3))
    end_poses = poses.copy()
    end_poses[:, :, 3] += 0.2 * random.random((8, 3))
    return WorldShare(shapes, distribution, poses, end_poses, **named)


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


def bodies_by_turns(count):
    return np.arange(count) % COMM.size == COMM.rank


def bodies_of_the_last(count):
    return np.full(count, COMM.rank == COMM.size - 1)


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


def bodies_are_refused_together():
    share = world_share(bodies_by_turns)
    one = crumple.Detector(**ONE)
    with crumple.mpi.Detector(COMM, **ONE) as detector:
        for failing in range(COMM.size):
            here = COMM.rank == failing
            listed = crumple.World([crumple.Shape(soup(2), points=[0])] * len(share.body_ids))
            for message, world, question in (
                ("world must be a crumple.World, not str", "world" if here else share.world, {}),
                ("body_ids must be one for each of the ", share.world, dict(body_ids=[1] * 99 if here else None)),
                ("excluded must be (n, 2) integers", share.world, dict(excluded=[0, 1] if here else None)),
                ("wants must be one of", share.world, dict(wants="some" if here else "any")),
                ("do not read a shape's list of edges or points", listed if here else share.world, {}),
            ):
                ids = dict(body_ids=share.body_ids) if "body_ids" not in question else {}
                error = error_of(detector.find, world, **ids, **question)
                assert error.rank == failing and message in str(error), error
        error = error_of(detector.find, share.world, body_ids=np.zeros_like(share.body_ids))
        assert "body 0 is brought 8 times" in str(error) and (error.element, error.index) == ("body", 0), error
        error = error_of(detector.find, share.world, body_ids=share.body_ids, excluded=[(0, 8)])
        assert "excluded_bodies names body 8 of 8" in str(error), error
        found = detector.find(share.world, body_ids=share.body_ids)
        expected = one.find(share.whole)
        np.testing.assert_array_equal(found.pairs, expected.pairs[share.rows(expected.bodies)])


def features_are_refused_together():
    mesh = soup(60, size=0.4)
    share = Share(mesh, round_robin(mesh))
    _, ids = share.arguments()
    with crumple.mpi.Detector(COMM, **ONE) as detector:
        for failing in range(COMM.size):
            here = COMM.rank == failing
            end = share.vertices.copy()
            end[3, 0] = np.nan if here else end[3, 0]
            error = error_of(detector.find_impacts, share.vertices, end, share.faces, **ids)
            assert (error.code, error.rank) == ("not_finite", failing), error
            for message, end in {
                "end vertices must be as many as those at the start": share.vertices[:-1],
                "end vertices must have shape (n, 3)": "no",
            }.items():
                end = end if here else share.vertices
                error = error_of(detector.find_impacts, share.vertices, end, share.faces, **ids)
                assert error.rank == failing and message in str(error), error
            for message, question in {
                "wants must be one of": dict(radius=0.1, wants="some" if here else "any"),
                "asked of a world": dict(radius=0.1, wants="any_by_world" if here else "any"),
                "find_near needs a radius": dict(radius=None if here else 0.1),
                "radius must be a number": dict(radius="far" if here else 0.1),
            }.items():
                error = error_of(share.call, detector.find_near, **question)
                assert error.rank == failing and message in str(error), error
        if COMM.size > 1:
            error = error_of(share.call, detector.find_near, radius=0.1 + COMM.rank)
            assert "the ranks ask different questions" in str(error)
        check_features(
            share.call(detector.find_near, radius=0.1),
            share,
            crumple.Detector(**ONE).find_near(mesh, radius=0.1),
            ("squared_distance", "touching"),
        )


def a_misspelt_argument_ends_the_call_on_all_ranks():
    mesh = soup(60, size=0.4)
    share = Share(mesh, round_robin(mesh))
    arrays, ids = share.arguments()

    def check(failing, call, *given, known, unknown, suggestion):
        try:
            call(*given, **(unknown if COMM.rank == failing else known))
            raise AssertionError("no error was raised")
        except TypeError as error:
            assert COMM.rank == failing and suggestion in str(error), error
        except crumple.Error as error:
            assert COMM.rank != failing and (error.code, error.rank) == ("cancelled", failing)
            assert "TypeError" in str(error), error

    with crumple.mpi.Detector(COMM, **ONE) as detector:
        for failing in range(COMM.size):
            for call in (detector.find_self, detector.count, detector.has_collision):
                check(failing, call, *arrays, known=ids, unknown=ids | {"welt": True}, suggestion="mean 'weld'")
            near = ids | {"radius": 0.1}
            check(failing, detector.find_near, *arrays, known=near, unknown=near | {"radios": 1}, suggestion="'radius'")
            step = (share.vertices, *arrays)
            check(failing, detector.is_free, *step, known=ids, unknown={"wanting": 1}, suggestion="'wanted'")
            check(
                failing,
                detector.count,
                known={"vertices": arrays[0], "faces": arrays[1]} | ids,
                unknown={},
                suggestion="missing",
            )
            check(failing, crumple.mpi.Detector, COMM, known=ONE, unknown={"thread": 1}, suggestion="mean 'threads'")
        check_rows(share.call(detector.find_self), share, crumple.Detector(**ONE).find_self(mesh))


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


def ranks_fail_together_and_go_on():
    mesh = soup(60, size=0.4)
    share = Share(mesh, round_robin(mesh))
    expected = crumple.Detector(**ONE).find_self(mesh)

    def differing(rank, **changed):
        arrays, ids = share.arguments()
        given = dict(zip(("vertices", "faces", "groups"), arrays), **ids)
        return given | (changed if COMM.rank == rank else {})

    with crumple.mpi.Detector(COMM, **ONE) as detector:
        for failing in range(COMM.size):
            vertices = share.vertices.copy()
            vertices[7, 1] = np.nan
            place = COMM.bcast(int(share.vertex_ids[7]), failing)
            error = error_of(detector.find_self, **differing(failing, vertices=vertices))
            assert type(error) is crumple.InvalidInput and error.code == "not_finite", error
            assert (error.rank, error.element, error.index) == (failing, "vertex", place)
            assert str(error).startswith(f"rank {failing}: ")

            # What Python finds, and before the library is called.
            for message, changed in {
                "vertices must be float32 or float64, not int32": dict(vertices=share.faces),
                "neighbours must be one of": dict(neighbours="none"),
                "weld must be True or False, not str": dict(weld="no"),
                "triangle_ids must be one for each of the": dict(triangle_ids=[0]),
                "vertex_ids must be integers, not float64": dict(vertex_ids=np.zeros(len(share.vertices))),
                "a mesh must be crumple.Mesh, a tuple": dict(vertices="mesh", faces=None),
            }.items():
                given = differing(failing, **changed)
                for call in (detector.find_self, detector.count, detector.has_collision):
                    error = error_of(call, **given)
                    assert type(error) is crumple.InvalidInput and error.rank == failing, error
                    assert str(error).startswith(f"rank {failing}: {message}"), error

            # What is no error of the library's.
            class Interrupting:
                def __array__(self, *_, **__):
                    raise KeyboardInterrupt

            try:
                detector.find_self(**differing(failing, vertices=Interrupting()))
                raise AssertionError("no error was raised")
            except KeyboardInterrupt:
                assert COMM.rank == failing
            except crumple.Error as error:
                assert COMM.rank != failing and (error.code, error.rank) == ("cancelled", failing)
                assert "the call was interrupted: KeyboardInterrupt" in str(error)
            check_rows(share.call(detector.find_self), share, expected)

        error = error_of(detector.count, [[0.0, 0, 0]], [[0, 0, 1]])
        assert error.code == "index_out_of_range" and error.rank == 0
        if COMM.size > 1:
            error = error_of(share.call, detector.count, weld=COMM.rank == 1)
            assert "the ranks ask different questions" in str(error)
        check_rows(share.call(detector.find_self), share, expected)

    for options, what in (dict(threads="two"), "threads must be an integer"), (dict(parts=-1), "parts must be 0"):
        error = error_of(crumple.mpi.Detector, COMM, **(options if COMM.rank == 0 else {}))
        assert error.rank == 0 and what in str(error), error
    assert type(error_of(crumple.mpi.Detector, 1)) is crumple.InvalidType
    assert "not MPI.COMM_NULL" in str(error_of(crumple.mpi.Detector, MPI.COMM_NULL))


class Alarm(Exception):
    """What the handler of SIGALRM raises."""


def ring(*_):
    raise Alarm


def a_signal_ends_the_call_on_all_ranks():
    mesh = soup(60, size=0.4)
    share = Share(mesh, round_robin(mesh))
    signal.signal(signal.SIGALRM, ring)
    with crumple.mpi.Detector(COMM, **ONE) as detector:
        for failing in range(COMM.size):
            try:
                if COMM.rank == failing:
                    signal.setitimer(signal.ITIMER_REAL, 0.1)  # while it waits for the others
                else:
                    time.sleep(0.5)
                share.call(detector.find_self)
                raise AssertionError("no error was raised")
            except Alarm:
                assert COMM.rank == failing
            except crumple.Error as error:
                assert COMM.rank != failing and (error.code, error.rank) == ("cancelled", failing)
                assert str(error) == f"rank {failing}: the call was interrupted: Alarm"
        check_rows(share.call(detector.find_self), share, crumple.Detector(**ONE).find_self(mesh))


def a_signal_is_seen_within_a_search():
    signal.signal(signal.SIGALRM, ring)
    mesh = soup(20_000, size=0.05)

    def seconds(detector):
        start = time.perf_counter()
        try:
            detector.find_self(mesh)
            rang = False
        except Alarm:
            rang = True
        return time.perf_counter() - start, rang

    with crumple.mpi.Detector(COMM, backend="reference", threads=1) as detector:
        whole, _ = seconds(detector)
        cut_short = []
        for _ in range(3):
            signal.setitimer(signal.ITIMER_REAL, whole / 10)
            took, rang = seconds(detector)
            assert rang
            cut_short.append(took)
        assert min(cut_short) < whole / 2


def one_call_at_a_time():
    mesh = soup(60, size=0.4)
    share = Share(mesh, round_robin(mesh))
    with crumple.mpi.Detector(COMM, **ONE) as detector:
        if COMM.rank == 0:
            results = []
            thread = threading.Thread(target=lambda: results.append(share.call(detector.find_self)))
            thread.start()
            time.sleep(0.2)  # it waits for the others
            for call in (lambda: share.call(detector.find_self), detector.close):
                assert "takes one at a time" in str(error_of(call))
            COMM.barrier()
            thread.join()
            result = results[0]
        else:
            COMM.barrier()
            result = share.call(detector.find_self)
        check_rows(result, share, crumple.Detector(**ONE).find_self(mesh))


def a_closed_detector_says_so():
    detector = crumple.mpi.Detector(COMM, parts=3, **ONE)
    assert (detector.rank, detector.ranks) == (COMM.rank, COMM.size)
    assert detector.options["threads"] == 1 and detector.options["parts"] == 3
    assert repr(detector).startswith("crumple.mpi.Detector(parts=3, round_bytes=67108864, backend='cpu', threads=1")
    result = detector.find_self(soup(30, size=0.5))
    assert repr(result).startswith(f"<crumple.mpi.Result: {len(result)} colliding pairs here, {result.total} over all")
    detector.close()
    detector.close()
    for call in (lambda: detector.rank, lambda: detector.statistics, lambda: detector.find_self([], [])):
        error = error_of(call)
        assert error.code == "communication" and str(error) == "the detector is closed"
    assert result.pairs.shape == (len(result), 2)
    try:
        with crumple.mpi.Detector(COMM, **ONE) as other:
            raise LookupError
    except LookupError:
        assert "closed" in str(error_of(lambda: other.rank))
    assert crumple.mpi.Detector(COMM).options["threads"] >= 1  # left to the end of MPI


def some_ranks_have_a_scene_of_their_own():
    half = COMM.Split(COMM.rank % 2)
    mesh = soup(60, size=0.4, seed=COMM.rank % 2)
    share = Share(mesh, np.arange(60) % half.size, half.rank)
    with crumple.mpi.Detector(half, **ONE) as detector:
        assert (detector.rank, detector.ranks) == (half.rank, half.size)
        check_rows(share.call(detector.find_self), share, crumple.Detector(**ONE).find_self(mesh))
    half.Free()


if __name__ == "__main__":
    globals()[sys.argv[1]]()
    COMM.barrier()
    if COMM.rank == 0:
        print("passed")
