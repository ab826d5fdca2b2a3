"""Tests of arguments other than arrays, and of groups: errors name the wrong argument, in calls, options and files."""

import copy
import pickle
import platform
import re
from dataclasses import FrozenInstanceError, fields

import numpy as np
import pytest

import crumple
from conftest import soup, sufficient_limit
from crumple import FuzzyCMeans

MESH = soup(60, size=0.8)
EXPECTED = crumple.intersections(MESH).pairs.tolist()

OPTIONS = [
    ({"groups": [0] * 59}, r"^groups must be one for each of the 60 faces, not 59$"),
    ({"groups": []}, r"^groups must be one for each of the 60 faces, not 0$"),
    ({"groups": np.zeros(0, np.int32)}, r"^groups must be one for each of the 60 faces, not 0$"),
    ({"groups": np.zeros(61, np.int32)}, r"^groups must be one for each of the 60 faces, not 61$"),
    ({"groups": [[0] * 60]}, r"groups must have shape \(faces,\), not \(1, 60\)"),
    ({"groups": [0.5] * 60}, r"groups must be integers, not float64"),
    ({"groups": [0] * 59 + [2**31]}, r"groups: group id 2147483648 at 59 does not fit int32"),
    ({"neighbours": "none"}, r'neighbours must be one of "geometric", "skip", not "none"'),
    ({"kind": "some"}, r'kind must be one of "all", "proper", not "some"'),
    (
        {"filter": crumple.PairFilter(groups="neither")},
        r'groups must be one of "both", "between", "within", not "neither"',
    ),
    (
        {"filter": crumple.PairFilter(excluded_groups=[(1, 2, 3)])},
        r"excluded_groups must have shape \(n, 2\), not \(1, 3\)",
    ),
    (
        {"filter": crumple.PairFilter(groups="\udc80")},
        r"^groups must be text that can be encoded as UTF-8, not '\\udc80'$",
    ),
    (
        {"filter": crumple.PairFilter(excluded_groups=[(1, -(2**31) - 1)])},
        r"group id -2147483649 at 0 does not fit int32",
    ),
]


@pytest.mark.parametrize("query, message", OPTIONS)
def test_error_names_the_wrong_query_option(query, message, detector):
    with pytest.raises(crumple.InvalidInput, match=message):
        detector.intersections(MESH, **query)


WRONG_TYPES = [
    ({"neighbours": None}, 'neighbours must be one of "geometric", "skip", not None'),
    ({"kind": 1}, 'kind must be one of "all", "proper", not int'),
    ({"filter": crumple.PairFilter(groups=["both"])}, 'groups must be one of "both", "between", "within", not list'),
    ({"weld": 1}, "weld must be True or False, not int"),
    ({"weld": None}, "weld must be True or False, not None"),
    (
        {"output": None},
        'output must be one of "any", "any_by_world", "body_pairs", "count", "pairs", "contacts", not None',
    ),
    ({"filter": {"groups": "both"}}, "filter must be a crumple.PairFilter, not dict"),
    ({"copy": 0.0}, "copy must be True or False, not float"),
]


@pytest.mark.parametrize("query, message", WRONG_TYPES)
def test_error_names_the_query_option_of_wrong_type(query, message, detector):
    with pytest.raises(crumple.InvalidType, match=f"^{message}$") as caught:
        detector.intersections(MESH, **query)
    assert isinstance(caught.value, TypeError) and isinstance(caught.value, crumple.InvalidInput)
    if "copy" not in query:
        for call in (detector.any, detector.find):
            with pytest.raises(TypeError, match=f"^{message}$"):
                call(MESH, crumple.IntersectionQuery(**query))


@pytest.mark.parametrize(
    "options, message",
    [
        ({"threads": "2"}, "threads must be an integer, not str"),
        ({"threads": 2.0}, "threads must be an integer, not float"),
        ({"threads": None}, "threads must be an integer, not None"),
        ({"memory_limit": 1e9}, "memory_limit must be an integer, not float"),
        ({"fuzzy_c_means": 2.0}, "fuzzy_c_means must be a crumple.FuzzyCMeans, not float"),
        ({"fuzzy_c_means": FuzzyCMeans(fuzziness="2")}, "fuzziness must be a number, not str"),
        ({"fuzzy_c_means": FuzzyCMeans(stop=None)}, "stop must be a number, not None"),
        ({"method": "pca"}, "method must be a crumple.Method, not str"),
        ({"method": crumple.Method(sweep=3)}, 'sweep must be "pca", "x", "y", "z" or .* three numbers, not int'),
        ({"method": crumple.Method(sweep=(1, 2))}, 'sweep must be "pca", "x", "y", "z" or .* three numbers, not tuple'),
        ({"method": crumple.Method(sweep=(1, "2", 3))}, "sweep must be a number, not str"),
        ({"method": crumple.Method(membership=1)}, 'membership must be one of "ball", .*, not int'),
        ({"method": crumple.Method(threshold="1")}, "threshold must be a number, not str"),
        ({"backend": 3}, 'backend must be one of "automatic", "cpu", "cuda", "reference", not int'),
        ({"device": "0"}, "device must be an integer, not str"),
        ({"simd": b"avx2"}, 'simd must be one of "automatic", .*, not bytes'),
    ],
)
def test_error_names_the_detector_option_of_wrong_type(options, message):
    with pytest.raises(crumple.InvalidType, match=f"^{message}$"):
        crumple.Detector(**options)


@pytest.mark.parametrize("name", ["threads", "clusters", "leaf_size"])
def test_error_names_the_detector_option_with_a_huge_value(name):
    for value in (10**12, -(10**12), 10**30):
        with pytest.raises(crumple.InvalidInput, match=f"^{name} must be from -2147483648 to 2147483647, not {value}$"):
            crumple.Detector(**{name: value})
    with pytest.raises(crumple.InvalidInput, match="^memory_limit must be from .* not 1000000000000000000000$"):
        crumple.Detector(memory_limit=10**21)
    with pytest.raises(crumple.InvalidInput, match="^stop is outside the range of float64$"):
        crumple.Detector(fuzzy_c_means=FuzzyCMeans(stop=10**400))


def test_numpy_scalars_are_accepted_like_python_numbers():
    for integer in (np.int8, np.uint16, np.int64, np.uint64):
        detector = crumple.Detector(threads=integer(2), memory_limit=integer(0), leaf_size=integer(100))
        assert {"threads": 2, "memory_limit": 0, "leaf_size": 100}.items() <= detector.options.items()
    detector = crumple.Detector(
        threads=np.int32(2), fuzzy_c_means=FuzzyCMeans(np.float32(2), stop=np.float64(0.01), first_stop=0)
    )
    result = detector.intersections(MESH, weld=np.bool_(False), output="contacts", copy=np.True_)
    assert result.pairs.tolist() == EXPECTED and result.contacts and result.pairs.flags.writeable
    assert len(detector.partition(MESH, count=np.int64(3))) == 3
    assert len(crumple.make_scene("soup", triangles=np.int64(20), frame=np.uint8(0), seed=np.uint64(2**63)).faces)


def test_error_names_the_wrong_argument_of_a_call(detector, tmp_path):
    for call, message in [
        (lambda: detector.partition(MESH, count="3"), "count must be an integer, not str"),
        (lambda: detector.partition(MESH, count=0), "the number of parts must be 1 to 262144"),
        (lambda: crumple.read_mesh(7), "path must be a str, bytes or os.PathLike, not int"),
        (lambda: crumple.read_mesh(None), "path must be a str, bytes or os.PathLike, not None"),
        (lambda: crumple.read_mesh("a\0b"), "path cannot be the name of a file"),
        (lambda: crumple.read_mesh("a.ply", group_property=None), "group_property must be a str, not None"),
        (lambda: crumple.read_pairs(1.5), "path must be a str, bytes or os.PathLike, not float"),
        (lambda: crumple.write_mesh([], MESH), "path must be a str, bytes or os.PathLike, not list"),
        (lambda: detector.intersections(MESH).save(None), "path must be a str, bytes or os.PathLike, not None"),
        (lambda: detector.intersections(MESH).to_html(height="tall"), "height must be an integer, not str"),
        (lambda: crumple.make_scene("\ud800"), r"name must be text that can be encoded as UTF-8, not '\\ud800'"),
        (lambda: crumple.make_scene(3), "name must be a str, not int"),
        (lambda: crumple.make_scene("cloth", triangles="many"), "triangles must be an integer, not str"),
        (lambda: crumple.make_scene("cloth", seed=-1), "seed must be from 0 to 18446744073709551615, not -1"),
        (lambda: detector.intersections(MESH.vertices), "a mesh must be .*, not numpy.ndarray"),
        (lambda: detector.intersections((1, 2, 3, 4)), "a mesh must be .*, not a tuple of 4"),
        (lambda: detector.any([MESH]), "a scene of several meshes has two, not 1; pass one mesh alone, .*"),
        (lambda: detector.find([MESH] * 3), "a scene of several meshes has two, not 3; .* as a crumple.World"),
        (lambda: detector.intersections(None, MESH), "a mesh must be .*, not NoneType"),
        (
            lambda: detector.find(MESH, "pairs"),
            "query must be a query of crumple, such as crumple.ImpactQuery\\(\\), not str",
        ),
        (
            lambda: detector.find(MESH, crumple.ImpactQuery),
            "query must be a query of crumple, such as .*, not the type crumple._queries.ImpactQuery itself",
        ),
    ]:
        with pytest.raises(crumple.InvalidInput, match=f"^{message}$"):
            call()


def test_filter_between_groups_needs_groups(detector):
    between = crumple.IntersectionQuery(filter=crumple.PairFilter(groups="between"))
    for call in (detector.find, detector.any):
        with pytest.raises(crumple.InvalidInput, match="between needs groups, and the mesh has none"):
            call(MESH, between)
        with pytest.raises(crumple.InvalidInput, match="between needs groups, and neither mesh has any"):
            call([MESH, MESH], between)
    assert (
        len(detector.intersections(MESH, MESH._replace(groups=[1] * 60), filter=crumple.PairFilter(groups="between")))
        > 60
    )
    assert not detector.intersections((np.zeros((0, 3)), []), groups=[], filter=crumple.PairFilter(groups="between"))
    with pytest.raises(crumple.InvalidInput, match="^second mesh: groups must be one for each of the 60 faces, not 0$"):
        detector.intersections(MESH, MESH._replace(groups=[]))


def test_groups_of_every_integer_type_give_the_same_pairs(detector):
    mesh = soup(100, size=0.4)
    groups = np.arange(100) % 3
    expected = detector.intersections(
        mesh, groups=groups.astype(np.int32), filter=crumple.PairFilter(groups="between")
    ).pairs.tolist()
    assert 0 < len(expected) < len(detector.intersections(mesh))
    for dtype in ("i1", "u1", "i2", "u2", "u4", "i8", "u8"):
        assert (
            detector.intersections(
                mesh, groups=groups.astype(dtype), filter=crumple.PairFilter(groups="between")
            ).pairs.tolist()
            == expected
        )
    assert (
        detector.intersections(
            mesh, groups=np.repeat(groups, 2)[::2], filter=crumple.PairFilter(groups="between")
        ).pairs.tolist()
        == expected
    )
    assert (
        detector.intersections(
            crumple.Mesh(*mesh[:2], groups), filter=crumple.PairFilter(groups="between")
        ).pairs.tolist()
        == expected
    )
    between = {frozenset(p) for p in ((0, 1), (0, 2), (1, 2))}
    for excluded in (between, np.array([[1, 0], [2, 0], [2, 1]]), ((0, 1), (0, 2), (1, 2))):
        as_pairs = [tuple(p) for p in excluded] if isinstance(excluded, set) else excluded
        assert not detector.intersections(
            mesh, groups=groups, filter=crumple.PairFilter(groups="between", excluded_groups=as_pairs)
        )


def test_excluded_groups_can_be_sets_iterators_views_or_generators(detector):
    mesh = soup(100, size=0.4)._replace(groups=np.arange(100) % 3)
    pairs = [(0, 1), (0, 2)]
    expected = detector.intersections(mesh, filter=crumple.PairFilter(excluded_groups=pairs)).pairs.tolist()
    assert 0 < len(expected) < len(detector.intersections(mesh))
    keyed = dict.fromkeys(pairs)
    makers = [set, frozenset, iter, keyed.fromkeys, lambda p: keyed.keys(), lambda p: dict(enumerate(p)).values()]
    makers += [lambda p: zip(*zip(*p)), lambda p: (pair for pair in p), lambda p: memoryview(np.array(p, np.int32))]
    for make in makers:
        assert (
            detector.intersections(mesh, filter=crumple.PairFilter(excluded_groups=make(pairs))).pairs.tolist()
            == expected
        )
    for none in (set(), iter([]), {}):
        assert len(detector.intersections(mesh, filter=crumple.PairFilter(excluded_groups=none))) == len(
            detector.intersections(mesh)
        )


class Raising:
    """Argument that raises an error when it is converted to an integer, a float or a path."""

    def __init__(self, error):
        self.error = error

    def look(self):
        raise self.error

    __index__ = __float__ = __fspath__ = look


@pytest.mark.parametrize(
    "call",
    [
        lambda value: crumple.Detector(threads=value),
        lambda value: crumple.Detector(fuzzy_c_means=FuzzyCMeans(stop=value)),
        lambda value: crumple.read_mesh(value),
        lambda value: crumple.write_mesh(value, MESH),
        lambda value: crumple.Detector().intersections(MESH).save(value),
    ],
)
def test_exceptions_of_arguments_other_than_type_errors_propagate(call):
    for error in (KeyboardInterrupt(), MemoryError(), ZeroDivisionError("inside")):
        with pytest.raises(type(error)) as caught:
            call(Raising(error))
        assert caught.value is error
    with pytest.raises(crumple.InvalidType):
        call(Raising(TypeError()))


@pytest.mark.parametrize(
    "options, message",
    [
        ({"threads": -1}, "threads must be 0"),
        ({"clusters": 65}, "clusters must be 0 .automatic. to 64"),
        ({"leaf_size": 0}, "leaf_size must be at least 1"),
        ({"method": crumple.Method(sweep="w")}, 'sweep must be one of "pca", "x", "y", "z", not "w"'),
        ({"method": crumple.Method(sweep=(0, 0, 0))}, "the sweep direction must not be 0"),
        ({"method": crumple.Method(membership="threshold", threshold=2)}, "the membership threshold must be 0 to 1"),
        ({"method": crumple.Method(threshold=0.5)}, "a membership threshold needs the membership rule threshold"),
        ({"fuzzy_c_means": FuzzyCMeans(fuzziness=1.0)}, "fuzziness must be finite and above 1"),
        ({"memory_limit": -5}, "memory_limit must be 0"),
        ({"backend": "abacus"}, 'backend must be one of "automatic", "cpu", "cuda", "reference", not "abacus"'),
        ({"device": -1}, "device must be 0 or more"),
        ({"simd": "mmx"}, 'simd must be one of "automatic"'),
    ],
)
def test_error_names_the_wrong_detector_option(options, message):
    with pytest.raises(crumple.InvalidInput, match=message):
        crumple.Detector(**options)


def test_instruction_set_of_another_architecture_is_refused(detector):
    if detector.backend == "cuda":
        pytest.skip("instruction sets are the cpu backend's")
    foreign = "neon" if platform.machine() in ("x86_64", "AMD64") else "avx2"
    with pytest.raises(crumple.BackendUnavailable, match="instruction set is not supported by this build or by this"):
        crumple.Detector(simd=foreign)


def test_error_explains_why_the_cuda_backend_is_unavailable():
    try:
        detector = crumple.Detector(backend="cuda", device=1000)
    except crumple.BackendUnavailable as error:
        assert re.match("the cuda backend (was not built; configure with|is not available: )", str(error))
        assert error.code == "backend_unavailable"
    else:
        pytest.fail(f"{detector} has a thousand devices")


def test_memory_limit_error_states_a_lower_bound_of_the_needed_bytes():
    import pickle

    mesh = soup(3000)
    with pytest.raises(
        crumple.MemoryLimit, match=r"memory limit of 10000 bytes is too small; at least \d+ bytes are needed"
    ) as caught:
        crumple.Detector(memory_limit=10_000).intersections(mesh)
    least = caught.value
    assert isinstance(least, MemoryError) and least.code == "memory_limit"
    copy = pickle.loads(pickle.dumps(least))
    assert copy.bytes_needed == least.bytes_needed > 10_000
    with pytest.raises(crumple.MemoryLimit):
        crumple.Detector(memory_limit=least.bytes_needed - 1).intersections(mesh)
    limit = sufficient_limit(lambda detector: detector.intersections(mesh), 10_000)
    assert limit >= least.bytes_needed
    enough = crumple.Detector(memory_limit=limit)
    held = [enough.intersections(mesh).pairs for _ in range(3)]  # results in use do not count for the limit
    for pairs in held:
        np.testing.assert_array_equal(pairs, crumple.intersections(mesh).pairs)


ARRAYS_OF_NOTHING = (np.zeros((0, 3)), np.zeros((0, 3), np.int32), None, np.zeros(0, np.int32))


@pytest.mark.parametrize(
    "state",
    [
        (),
        (0,),
        (0, 1, ARRAYS_OF_NOTHING, None, []),
        (0, 1, (), None, [], None),
        ("0", 1, ARRAYS_OF_NOTHING, None, [], None),
        (0, 1, ARRAYS_OF_NOTHING, (), [], None),
        (0, 1, ARRAYS_OF_NOTHING, None, [1], None),
        (0, 1, ARRAYS_OF_NOTHING, None, [(0, np.zeros(1))], None),
        (0, 1, ([], [], None, []), None, [], None),
        [0, 1],
        None,
    ],
)
def test_malformed_state_of_a_part_is_refused(state):
    part = crumple.Part.__new__(crumple.Part)
    with pytest.raises(crumple.InvalidType, match="^the state of a Part must be a tuple"):
        part.__setstate__(state)


def test_part_with_inconsistent_state_is_refused(detector):
    part = crumple.Part.__new__(crumple.Part)
    part.__setstate__((0, 1, ARRAYS_OF_NOTHING, None, [], None))
    with pytest.raises(crumple.InvalidInput, match="a part needs 1 to 4 levels"):
        detector.intersections(part)
    with pytest.raises(TypeError, match="a mesh must be .*, not int"):
        detector.intersections(1)


def test_uninitialised_part_is_refused(detector):
    empty = crumple.Part.__new__(crumple.Part)
    for look in (
        lambda: empty.mesh,
        lambda: empty.second,
        lambda: empty.triangles,
        lambda: empty.triangles_second,
        lambda: detector.intersections(empty),
    ):
        with pytest.raises(crumple.InvalidInput, match="is an empty crumple.Part; get parts from Detector.partition$"):
            look()


def test_excluded_groups_that_change_between_calls_are_read_again(detector):
    mesh = soup(100, size=0.4)._replace(groups=np.arange(100) % 3)
    excluded = [(0, 1)]
    query = crumple.IntersectionQuery(filter=crumple.PairFilter(excluded_groups=excluded))
    few = len(detector.find(mesh, query))
    excluded.clear()
    assert few < len(detector.find(mesh, query)) == len(detector.intersections(mesh))


@pytest.mark.parametrize("query", [crumple.IntersectionQuery(output="count"), crumple.ProximityQuery(radius=0.125)])
def test_used_queries_can_be_copied_and_pickled(query, detector):
    found = detector.find(MESH, query)
    for same in (pickle.loads(pickle.dumps(query)), copy.copy(query), copy.deepcopy(query)):
        assert same == query and vars(same) == {field.name: getattr(query, field.name) for field in fields(query)}
        assert detector.find(MESH, same).count == found.count
    with pytest.raises(FrozenInstanceError):
        query.weld = True
