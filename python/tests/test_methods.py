"""Tests of the methods of Detector: signatures, documentation, calls and errors are as in plain Python."""

import copy
import dataclasses
import inspect
import os
import pickle
import re
import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import crumple
from conftest import soup

MESH = soup(60)
EXPECTED = crumple.intersections(MESH).pairs.tolist()
END = MESH.vertices + np.float32(0.1)
CALLS = {
    "intersections": (MESH,),
    "impacts": (MESH, END),
    "first_impact": (MESH, END),
    "free_step": (MESH, END),
    "proximities": (MESH,),
    "candidates": (MESH,),
    "distances": (MESH, MESH),
}
QUERIES = {
    "intersections": crumple.IntersectionQuery,
    "impacts": crumple.ImpactQuery,
    "first_impact": crumple.FirstImpactQuery,
    "free_step": crumple.FreeStepQuery,
    "proximities": crumple.ProximityQuery,
    "candidates": crumple.CandidateQuery,
    "distances": crumple.DistanceQuery,
}
NEEDED = {"proximities": {"radius": 0.1}}


@pytest.mark.parametrize("name", [*CALLS, "find", "any", "stream", "launch", "partition", "supports"])
def test_methods_have_names_signatures_and_documentation(name, detector):
    for method in (getattr(crumple.Detector, name), getattr(detector, name)):
        assert method.__name__ == name and method.__qualname__ == f"Detector.{name}"
        assert method.__module__ == crumple.Detector.__module__ and name in repr(method)
        assert inspect.isroutine(method) and len(inspect.getdoc(method)) > 100
    unbound, bound = (list(inspect.signature(getattr(d, name)).parameters) for d in (crumple.Detector, detector))
    assert unbound == ["self", *bound] and bound[0] in ("scene", "vertices", "start", "world")
    if name in CALLS:
        members = {field.name for field in dataclasses.fields(QUERIES[name])}
        assert members < set(bound) and name in crumple.__all__ and getattr(crumple, name).__name__ == name
    else:
        assert bound[1] == "query"


@pytest.mark.parametrize("name", CALLS)
def test_defaults_in_the_signature_are_the_real_ones(name, detector):
    method = getattr(detector, name)
    defaults = {
        parameter.name: parameter.default
        for parameter in inspect.signature(method).parameters.values()
        if parameter.default is not inspect.Parameter.empty
    }
    assert len(defaults) > 2
    assert {field.name: field.default for field in dataclasses.fields(QUERIES[name])}.items() <= defaults.items()
    given = CALLS[name]
    for place in list(inspect.signature(method).parameters)[: len(given)]:
        defaults.pop(place, None)
    whole = method(*given, **NEEDED.get(name, {}))
    assert (
        repr(whole).split(" ms")[0].rpartition(",")[0]
        == repr(method(*given, **{**defaults, **NEEDED.get(name, {})})).split(" ms")[0].rpartition(",")[0]
    )
    assert type(detector.find(scene_of(name), QUERIES[name](**NEEDED.get(name, {})))) is type(whole)


def scene_of(name):
    """Returns the scene that method `name` makes from its arguments in CALLS."""
    if name == "distances":
        return [MESH, MESH]
    return MESH.moving_to(END) if END is CALLS[name][-1] else MESH


def test_arguments_can_be_positional_or_named(detector):
    vertices, faces, _ = MESH
    names = dict(zip(("".join(["verti", "ces"]), "".join(["fa", "ces"])), (vertices, faces)))  # not interned str
    for answer in (
        detector.intersections(vertices, faces),
        detector.intersections(vertices, faces=faces),
        detector.intersections(faces=faces, vertices=vertices),
        detector.intersections(**names),
        detector.intersections(vertices=MESH),
        detector.intersections(MESH, None, groups=None, filter=crumple.PairFilter(excluded_groups=None)),
        detector.intersections(*(vertices, faces), **{"output": "contacts"}),
        crumple.Detector.intersections(detector, vertices, faces),
        crumple.Detector.intersections(self=detector, vertices=MESH),
        (lambda find: find(MESH))(detector.find),
    ):
        assert answer.pairs.tolist() == EXPECTED
    between = detector.intersections(MESH, MESH).pairs.tolist()
    assert detector.intersections(faces=MESH, vertices=(vertices, faces)).pairs.tolist() == between
    assert detector.find([MESH, (vertices, faces)]).pairs.tolist() == between


@pytest.mark.parametrize(
    ("arguments", "named", "message"),
    [
        ((), {}, "missing 1 required positional argument: 'vertices'"),
        ((1, 2, 3), {}, "takes from 2 to 3 positional arguments but 4 were given"),
        ((MESH,), {"neighbors": "skip"}, r"^Detector\.intersections.* 'neighbors'\. Did you mean 'neighbours'\?$"),
        ((MESH,), {"out_put": "any", "weld": True}, r"argument 'out_put'\. Did you mean 'output'\?$"),
        ((MESH,), {"colour": "red"}, r"unexpected keyword argument 'colour'$"),
        ((MESH,), {"vertices": MESH}, "multiple values for argument 'vertices'"),
    ],
)
def test_wrong_arguments_raise_the_type_errors_of_python(arguments, named, message, detector):
    with pytest.raises(TypeError, match=message) as caught:
        detector.intersections(*arguments, **named)
    assert not isinstance(caught.value, crumple.Error)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: crumple.Detector(thread=2), "'thread'. Did you mean 'threads'?"),
        (lambda: crumple.Detector(threads=2, memorylimit=2), "'memorylimit'. Did you mean 'memory_limit'?"),
        (lambda: crumple.Detector(colour=2), "'colour'"),
        (lambda: crumple.Detector().partition(MESH, counts=2), "'counts'. Did you mean 'count'?"),
        (lambda: crumple.intersections(MESH, neighbor="skip").pairs, "'neighbor'. Did you mean 'neighbours'?"),
        (lambda: crumple.read_mesh("mesh.ply", welding="no"), "'welding'. Did you mean 'weld'?"),
        (lambda: crumple.make_scene("cloth", triangle=9), "'triangle'. Did you mean 'triangles'?"),
    ],
)
def test_error_suggests_a_similar_argument_name(call, message):
    with pytest.raises(TypeError, match=f"got an unexpected keyword argument {re.escape(message)}$") as caught:
        call()
    assert not isinstance(caught.value, crumple.Error)


def test_error_of_converting_an_option_is_not_replaced():
    class Failing:
        def __index__(self):
            raise ZeroDivisionError

    for error, value in ((crumple.InvalidType, "2"), (ZeroDivisionError, Failing())):
        with pytest.raises(error):
            crumple.Detector(threads=value)
    assert list(inspect.signature(crumple.Detector).parameters)[:2] == ["backend", "threads"]
    assert list(inspect.signature(crumple.make_scene).parameters) == ["name", "triangles", "frame", "seed"]


def test_self_must_be_an_initialised_detector(detector):
    for call in (
        lambda: crumple._core.Detector.__init__(3, detector.options),
        lambda: crumple._core.Detector.cancel(3),
    ):
        with pytest.raises(crumple.InvalidType, match=r"^self must be a crumple\.Detector, not int$"):
            call()
    unmade = crumple.Detector.__new__(crumple.Detector)
    for look in (
        lambda: unmade.intersections(MESH),
        lambda: unmade.any([MESH, MESH]),
        lambda: unmade.partition(MESH, count=2),
        lambda: unmade.backend,
        lambda: unmade.options,
        lambda: unmade.fallback,
        lambda: unmade.cancel(),
    ):
        with pytest.raises(crumple.InvalidInput, match=r"^crumple\.Detector\.__init__ has not been called$"):
            look()
    assert repr(unmade) == "<crumple.Detector whose __init__ has not been called>"
    with pytest.raises(crumple.InvalidType, match="^threads must be an integer, not str$"):
        unmade.__init__(threads="2")
    assert "has not been called" in repr(unmade)
    unmade.__init__(threads=2)
    assert unmade.intersections(MESH).pairs.tolist() == EXPECTED and unmade.options["threads"] == 2


def test_detector_is_initialised_only_once(detector):
    with pytest.raises(crumple.InvalidInput, match=r"^crumple\.Detector\.__init__ has been called already$"):
        detector.__init__(threads=1)
    assert detector.options["threads"] == 2 and detector.intersections(MESH).pairs.tolist() == EXPECTED

    class Again:
        """Option that calls __init__ of the detector again, while its __init__ reads the option."""

        def __index__(self):
            nested.__init__(threads=1)
            return 2

    nested = crumple.Detector.__new__(crumple.Detector)
    with pytest.raises(crumple.InvalidInput, match="has been called already"):
        nested.__init__(threads=Again())
    assert nested.options["threads"] == 1 and nested.intersections(MESH).pairs.tolist() == EXPECTED


def test_detector_options_match_its_signature(detector):
    declared = inspect.signature(crumple.Detector).parameters.values()
    defaults = {parameter.name: parameter.default for parameter in declared}
    assert crumple.Detector().options == defaults and detector.options == {**defaults, "threads": 2}
    assert eval(repr(detector)).options == detector.options


def test_only_one_of_several_threads_initialises_a_detector():
    for _ in range(20):
        raw, start = crumple.Detector.__new__(crumple.Detector), threading.Barrier(4)

        def make(threads, raw=raw, start=start):
            start.wait()
            try:
                raw.__init__(threads=threads)
            except crumple.InvalidInput:
                return None
            raw.intersections(MESH)
            return threads

        with ThreadPoolExecutor(4) as pool:
            made = [threads for threads in pool.map(make, (1, 2, 3, 4)) if threads]
        assert made == [raw.options["threads"]]
        assert raw.intersections(MESH).statistics.threads == min(made[0], len(os.sched_getaffinity(0)))


def test_detector_can_be_subclassed():
    class Counting(crumple.Detector):
        calls = 0

        def intersections(self, *arguments, **named):
            self.calls += 1
            return super().intersections(*arguments, **named)

    detector = Counting(threads=1)
    assert detector.intersections(MESH).pairs.tolist() == EXPECTED and detector.calls == 1
    assert detector.options["threads"] == 1 and detector.any(MESH)


def test_results_cannot_be_constructed_nor_detectors_copied():
    for make in (crumple.Intersections, crumple._core.Intersections):
        with pytest.raises(TypeError):
            make()
    for duplicate in (copy.copy, copy.deepcopy, pickle.dumps):
        with pytest.raises(TypeError, match="pickle"):
            duplicate(crumple.Detector())


PART = crumple.Detector().partition(MESH, count=1)[0]
SCENES = {
    "mesh": MESH.moving_to(END),
    "two meshes": [MESH.moving_to(END), MESH],
    "world": crumple.World([crumple.Shape(MESH, end=END)], [0, 0]),
    "part": PART,
}
UNSUPPORTED = {
    ("mesh", "distances"): "distances need bodies: a world or two meshes",
    ("part", "distances"): "parts support only intersections, impacts, proximities and overlaps",
    ("part", "candidates"): "parts support only intersections, impacts, proximities and overlaps",
    ("part", "free_step"): "parts support only intersections, impacts, proximities and overlaps",
}


@pytest.mark.parametrize("name", QUERIES)
@pytest.mark.parametrize("scene", SCENES)
def test_find_refuses_exactly_the_scenes_that_are_not_supported(scene, name):
    detector = crumple.Detector(backend="cpu", threads=1)
    query = QUERIES[name](**NEEDED.get(name, {}))
    why = UNSUPPORTED.get((scene, name))
    assert detector.supports(SCENES[scene], query) == (why is None)
    if why:
        with pytest.raises(crumple.InvalidInput, match=why):
            detector.find(SCENES[scene], query)
    elif scene != "part" or name in ("intersections", "overlaps"):  # these parts are for pairs of triangles only
        detector.find(SCENES[scene], query)


def test_candidates_support_neither_any_nor_partition(detector):
    for deliver in (detector.any, lambda *given: detector.partition(*given, count=2)):
        with pytest.raises(crumple.InvalidInput, match="does not support CandidateQuery: see docs/supported.md"):
            deliver(MESH, crumple.CandidateQuery())


def test_int_is_refused_for_a_flag_after_an_equal_bool(detector):
    detector.intersections(MESH, weld=True)
    with pytest.raises(crumple.InvalidType, match="weld must be True or False, not int"):
        detector.intersections(MESH, weld=1)
    assert detector.proximities(MESH, radius=0).any == detector.proximities(MESH, radius=0.0).any
