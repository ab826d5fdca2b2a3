"""Cases for test_mpi.py in which an MPI rank fails. All other cases are in mpi_ranks.py."""

import signal
import threading
import time

import numpy as np
from mpi4py import MPI
from mpi_local_meshes import (
    COMM,
    ONE,
    RankMesh,
    bodies_by_turns,
    check_features,
    check_rows,
    error_of,
    local_world,
    round_robin,
    run,
)

import crumple
import crumple.mpi
from conftest import soup


def invalid_bodies_are_refused_on_all_ranks():
    local = local_world(bodies_by_turns)
    world, body_ids = local.world, local.body_ids
    with crumple.mpi.Detector(COMM, **ONE) as detector:
        for failing in range(COMM.size):
            failed = COMM.rank == failing
            listed = crumple.World([crumple.Shape(soup(2), points=[0])] * len(body_ids), self_collisions=True)
            for message, brought, ids, members in (
                ("world must be a crumple.World, not str", "world", body_ids, {}),
                ("body_ids must be one for each of the ", world, [1] * 99, {}),
                ("excluded_bodies must be (n, 2) integers", world, body_ids, dict(filter=excluding([0, 1]))),
                ("filter must be a crumple.PairFilter, not str", world, body_ids, dict(filter="between")),
                ("output must be one of", world, body_ids, dict(output="some")),
                ("do not support a shape's list of edges or points", listed, body_ids, {}),
            ):
                share = crumple.mpi.LocalWorld(brought, ids) if failed else local
                error = error_of(detector.find, share, crumple.IntersectionQuery(**(members if failed else {})))
                assert error.rank == failing and message in str(error), error
            for message, share, query in (
                ("local must be a LocalMesh or a LocalWorld, not crumple.", world, crumple.IntersectionQuery()),
                ("query must be a query of crumple, such as", local, "intersections"),
                ("CandidateQuery is not supported on ranks", local, crumple.CandidateQuery()),
            ):
                for call in (detector.find, detector.any):
                    error = error_of(call, *((share, query) if failed else (local,)))
                    assert error.rank == failing and message in str(error), error
            for message, ids in (
                ("triangle_ids and vertex_ids are for meshes", {"triangle_ids": body_ids}),
                ("body_ids must be one for each of the ", {"body_ids": [1] * 99}),
            ):
                error = error_of(detector.intersections, world, **(ids if failed else {"body_ids": body_ids}))
                assert error.rank == failing and message in str(error), error
        error = error_of(detector.intersections, world, body_ids=np.zeros_like(body_ids))
        assert "body 0 is provided 8 times" in str(error) and (error.element, error.index) == ("body", 0), error
        error = error_of(detector.intersections, world, body_ids=body_ids, filter=excluding([(0, 8)]))
        assert "excluded_bodies names body 8 of 8" in str(error), error
        expected = crumple.Detector(**ONE).intersections(local.whole)
        np.testing.assert_array_equal(detector.find(local).pairs, expected.pairs[local.rows(expected.bodies)])


def excluding(bodies):
    return crumple.PairFilter(excluded_bodies=bodies)


def invalid_feature_queries_are_refused_on_all_ranks():
    mesh = soup(60, size=0.4)
    local = RankMesh(mesh, round_robin(mesh))
    vertices, faces, _ = local.mesh
    with crumple.mpi.Detector(COMM, **ONE) as detector:
        for failing in range(COMM.size):
            failed = COMM.rank == failing
            broken = vertices.copy()
            broken[3, 0] = np.nan
            error = error_of(detector.impacts, vertices, broken if failed else vertices, faces, **local.ids)
            assert (error.code, error.rank) == ("not_finite", failing), error
            for message, end in {
                "end vertices must be as many as those at the start": vertices[:-1],
                "end vertices must have shape (n, 3)": "no",
            }.items():
                error = error_of(detector.impacts, vertices, end if failed else vertices, faces, **local.ids)
                assert error.rank == failing and message in str(error), error
            for message, members in {
                "output must be one of": dict(radius=0.1, output="some"),
                "a ProximityQuery needs a radius": dict(radius=None),
                "radius must be a number": dict(radius="far"),
                "radii and rest are not supported on ranks": dict(radii=np.ones(len(vertices))),
                "rings must be 0": dict(radius=0.1, rings=1),
                "least must be false": dict(radius=0.1, least=True),
                "index must be false": dict(radius=0.1, index=True),
            }.items():
                members = members if failed else dict(radius=0.1)
                error = error_of(detector.proximities, local.mesh, **local.ids, **members)
                assert error.rank == failing and message in str(error), error
        if COMM.size > 1:
            error = error_of(detector.find, local, crumple.ProximityQuery(radius=0.1 + COMM.rank))
            assert "the query and the options must be the same on all ranks" in str(error)
        check_features(
            detector.find(local, crumple.ProximityQuery(radius=0.1)),
            local,
            crumple.Detector(**ONE).proximities(mesh, radius=0.1),
            ("squared_distance", "touching"),
        )


def a_misspelt_argument_ends_the_call_on_all_ranks():
    mesh = soup(60, size=0.4)
    local = RankMesh(mesh, round_robin(mesh))
    ids = local.ids

    def check(failing, call, *given, known, unknown, message):
        try:
            call(*given, **(unknown if COMM.rank == failing else known))
            raise AssertionError("no error was raised")
        except TypeError as error:
            assert COMM.rank == failing and message in str(error), error
        except crumple.Error as error:
            assert COMM.rank != failing and (error.code, error.rank) == ("cancelled", failing)
            assert "TypeError" in str(error), error

    with crumple.mpi.Detector(COMM, **ONE) as detector:
        for failing in range(COMM.size):
            for call, given, changed, message in (
                (detector.intersections, ids, {"welt": True}, "mean 'weld'"),
                (detector.intersections, ids, {"triangle_id": [0]}, "mean 'triangle_ids'"),
                (detector.proximities, ids | {"radius": 0.1}, {"radios": 1}, "mean 'radius'"),
                (detector.impacts, ids | {"end": local.mesh.vertices}, {"outputs": "first"}, "mean 'output'"),
            ):
                check(failing, call, local.mesh, known=given, unknown=given | changed, message=message)
            for call in (detector.find, detector.any):
                query = crumple.IntersectionQuery()
                check(failing, call, local, known={"query": query}, unknown={"querry": query}, message="mean 'query'")
                check(failing, call, known={"local": local}, unknown={}, message="missing")
            check(failing, detector.intersections, known={"vertices": local.mesh} | ids, unknown={}, message="missing")
            check(failing, crumple.mpi.Detector, COMM, known=ONE, unknown={"thread": 1}, message="mean 'threads'")
        check_rows(detector.find(local), local, crumple.Detector(**ONE).intersections(mesh))


def all_ranks_fail_together_and_stay_usable():
    mesh = soup(60, size=0.4)
    local = RankMesh(mesh, round_robin(mesh))
    expected = crumple.Detector(**ONE).intersections(mesh)

    def any_of(detector, vertices, faces, triangle_ids, vertex_ids, **members):
        brought = vertices if faces is None else (vertices, faces)
        share = crumple.mpi.LocalMesh(brought, triangle_ids, vertex_ids)
        return detector.any(share, crumple.IntersectionQuery(**members))

    def differing(rank, **changed):
        """Returns arguments of crumple.mpi.Detector.intersections, which are `changed` on one rank only."""
        given = dict(vertices=local.mesh.vertices, faces=local.mesh.faces, **local.ids)
        return given | (changed if COMM.rank == rank else {})

    with crumple.mpi.Detector(COMM, **ONE) as detector:
        for failing in range(COMM.size):
            vertices = local.mesh.vertices.copy()
            vertices[7, 1] = np.nan
            place = COMM.bcast(int(local.vertex_ids[7]), failing)
            error = error_of(detector.intersections, **differing(failing, vertices=vertices))
            assert type(error) is crumple.InvalidInput and error.code == "not_finite", error
            assert (error.rank, error.element, error.index) == (failing, "vertex", place)
            assert str(error).startswith(f"rank {failing}: ")

            # Errors that are raised in Python, before the library is called.
            for message, changed in {
                "vertices must be float32 or float64, not int32": dict(vertices=local.mesh.faces),
                "neighbours must be one of": dict(neighbours="none"),
                "weld must be True or False, not str": dict(weld="no"),
                "triangle_ids must be one for each of the": dict(triangle_ids=[0]),
                "vertex_ids must be integers, not float64": dict(vertex_ids=np.zeros(len(vertices))),
                "a mesh must be crumple.Mesh, a tuple": dict(vertices="mesh", faces=None),
            }.items():
                given = differing(failing, **changed)
                for error in (
                    error_of(detector.intersections, **given),
                    error_of(detector.intersections, **given, output="count"),
                    error_of(any_of, detector, **given),
                ):
                    assert type(error) is crumple.InvalidInput and error.rank == failing, error
                    assert str(error).startswith(f"rank {failing}: {message}"), error

            # An exception that is not a crumple.Error.
            class Interrupting:
                def __array__(self, *_, **__):
                    raise KeyboardInterrupt

            try:
                detector.intersections(**differing(failing, vertices=Interrupting()))
                raise AssertionError("no error was raised")
            except KeyboardInterrupt:
                assert COMM.rank == failing
            except crumple.Error as error:
                assert COMM.rank != failing and (error.code, error.rank) == ("cancelled", failing)
                assert "the call was interrupted: KeyboardInterrupt" in str(error)
            check_rows(detector.find(local), local, expected)

        error = error_of(detector.intersections, [[0.0, 0, 0]], [[0, 0, 1]], output="count")
        assert error.code == "index_out_of_range" and error.rank == 0
        if COMM.size > 1:
            for call in (detector.find, detector.any):
                error = error_of(call, local, crumple.IntersectionQuery(weld=COMM.rank == 1))
                assert "the query and the options must be the same on all ranks" in str(error)
        check_rows(detector.find(local), local, expected)

    for options, what in (dict(threads="two"), "threads must be an integer"), (dict(parts=-1), "parts must be 0"):
        error = error_of(crumple.mpi.Detector, COMM, **(options if COMM.rank == 0 else {}))
        assert error.rank == 0 and what in str(error), error
    assert type(error_of(crumple.mpi.Detector, 1)) is crumple.InvalidType
    assert "not MPI.COMM_NULL" in str(error_of(crumple.mpi.Detector, MPI.COMM_NULL))


class Alarm(Exception):
    """Exception that the handler of SIGALRM raises, and a function that is called during a search."""


def ring(*_):
    raise Alarm


def check_alarm(call, failing):
    """Checks that the call raises Alarm on one rank, and an error that names this rank on the others."""
    try:
        call()
        raise AssertionError("no error was raised")
    except Alarm:
        assert COMM.rank == failing
    except crumple.Error as error:
        assert COMM.rank != failing and (error.code, error.rank) == ("cancelled", failing)
        assert str(error) == f"rank {failing}: the call was interrupted: Alarm"


def a_signal_ends_the_call_on_all_ranks():
    mesh = soup(60, size=0.4)
    local = RankMesh(mesh, round_robin(mesh))
    signal.signal(signal.SIGALRM, ring)
    with crumple.mpi.Detector(COMM, **ONE) as detector:
        for failing in range(COMM.size):
            if COMM.rank != failing:
                time.sleep(0.5)

            def search(rings=COMM.rank == failing):
                if rings:
                    signal.setitimer(signal.ITIMER_REAL, 0.1)  # rings while this rank waits for the others
                detector.find(local)

            check_alarm(search, failing)
        check_rows(detector.find(local), local, crumple.Detector(**ONE).intersections(mesh))


def a_signal_ends_a_search_early():
    signal.signal(signal.SIGALRM, ring)
    mesh = soup(20_000, size=0.05)

    def seconds(detector):
        start = time.perf_counter()
        try:
            detector.intersections(mesh)
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


def error_of_the_progress_callback_ends_the_call_on_all_ranks():
    mesh = soup(60, size=0.4)
    local = RankMesh(mesh, round_robin(mesh))
    expected = crumple.Detector(**ONE).intersections(mesh)
    with crumple.mpi.Detector(COMM, **ONE) as detector:
        for failing in range(COMM.size):

            def show(phase, *_):
                assert "takes one at a time" in str(error_of(detector.set_progress, None))
                if phase == "search" and COMM.rank == failing:
                    raise Alarm

            detector.set_progress(show)
            check_alarm(lambda: detector.find(local), failing)
            detector.set_progress(None)
            check_rows(detector.find(local), local, expected)


def second_call_at_the_same_time_is_refused():
    mesh = soup(60, size=0.4)
    local = RankMesh(mesh, round_robin(mesh))
    with crumple.mpi.Detector(COMM, **ONE) as detector:
        if COMM.rank == 0:
            results = []
            thread = threading.Thread(target=lambda: results.append(detector.find(local)))
            thread.start()
            time.sleep(0.2)  # the thread now waits for the other ranks
            for call in (lambda: detector.find(local), detector.close):
                assert "takes one at a time" in str(error_of(call))
            COMM.barrier()
            thread.join()
            result = results[0]
        else:
            COMM.barrier()
            result = detector.find(local)
        check_rows(result, local, crumple.Detector(**ONE).intersections(mesh))


def closed_detector_refuses_calls():
    detector = crumple.mpi.Detector(COMM, parts=3, **ONE)
    assert (detector.rank, detector.ranks) == (COMM.rank, COMM.size)
    assert detector.options["threads"] == 1 and detector.options["parts"] == 3
    assert repr(detector).startswith("crumple.mpi.Detector(parts=3, batch_bytes=67108864, backend='cpu', threads=1")
    result = detector.intersections(soup(30, size=0.5))
    assert repr(result).startswith(f"<crumple.mpi.Intersections: {len(result)} colliding pairs on this rank, ")
    detector.close()
    detector.close()
    local = crumple.mpi.LocalMesh(([], []))
    for call in (
        lambda: detector.rank,
        lambda: detector.statistics,
        lambda: detector.intersections([], []),
        lambda: detector.impacts([], [], []),
        lambda: detector.proximities([], [], radius=1),
        lambda: detector.find(local),
        lambda: detector.any(local),
    ):
        error = error_of(call)
        assert error.code == "communication" and str(error) == "the detector is closed"
    assert result.pairs.shape == (len(result), 2)
    try:
        with crumple.mpi.Detector(COMM, **ONE) as other:
            raise LookupError
    except LookupError:
        assert "closed" in str(error_of(lambda: other.rank))
    assert crumple.mpi.Detector(COMM).options["threads"] >= 1  # not closed: MPI frees it at its end


if __name__ == "__main__":
    run(globals())
