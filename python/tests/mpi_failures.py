"""What ranks of MPI do where one of them fails, in test_mpi.py: as mpi_ranks.py."""

import signal
import threading
import time

import numpy as np
from mpi4py import MPI
from mpi_shares import (
    COMM,
    ONE,
    Share,
    bodies_by_turns,
    check_features,
    check_rows,
    error_of,
    round_robin,
    run,
    world_share,
)

import crumple
import crumple.mpi
from conftest import soup


def bodies_are_refused_together():
    share = world_share(bodies_by_turns)
    one = crumple.Detector(**ONE)
    with crumple.mpi.Detector(COMM, **ONE) as detector:
        for failing in range(COMM.size):
            here = COMM.rank == failing
            listed = crumple.World([crumple.Shape(soup(2), points=[0])] * len(share.body_ids), self_collisions=True)
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
    """What the handler of SIGALRM raises, and what is called while a search goes on."""


def ring(*_):
    raise Alarm


def check_alarm(call, failing):
    """That the call raises Alarm on one rank, and that the others are told."""
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
    share = Share(mesh, round_robin(mesh))
    signal.signal(signal.SIGALRM, ring)
    with crumple.mpi.Detector(COMM, **ONE) as detector:
        for failing in range(COMM.size):
            if COMM.rank != failing:
                time.sleep(0.5)

            def search(rings=COMM.rank == failing):
                if rings:
                    signal.setitimer(signal.ITIMER_REAL, 0.1)  # while it waits for the others
                share.call(detector.find_self)

            check_alarm(search, failing)
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


def what_shows_progress_may_end_the_call():
    mesh = soup(60, size=0.4)
    share = Share(mesh, round_robin(mesh))
    expected = crumple.Detector(**ONE).find_self(mesh)
    with crumple.mpi.Detector(COMM, **ONE) as detector:
        for failing in range(COMM.size):

            def show(phase, *_):
                assert "takes one at a time" in str(error_of(detector.set_progress, None))
                if phase == "search" and COMM.rank == failing:
                    raise Alarm

            detector.set_progress(show)
            check_alarm(lambda: share.call(detector.find_self), failing)
            detector.set_progress(None)
            check_rows(share.call(detector.find_self), share, expected)


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


if __name__ == "__main__":
    run(globals())
