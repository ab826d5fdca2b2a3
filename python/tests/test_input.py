"""What comes in: every layout is read for what it is, nothing is written to, and what is wrong is named."""

import re

import numpy as np
import pytest

import crumple
from conftest import OnDevice, peer, soup

MESH = soup(60, size=0.8)
EXPECTED = crumple.find_self_intersections(MESH).tolist()
EXPECTED_DOUBLE = crumple.find_self_intersections(MESH.vertices.astype(float), MESH.faces).tolist()


def interleaved(array, dtype):
    """A field of packed records whose size is no multiple of the numbers'."""
    records = np.zeros(len(array), [("name", "u1"), ("values", dtype, 3), ("flags", "u2")])
    records["values"] = array
    return records["values"]


LAYOUTS = {
    "C order": lambda a: np.ascontiguousarray(a),
    "Fortran order": lambda a: np.asfortranarray(a),
    "rows apart": lambda a: np.repeat(a, 3, axis=0)[::3],
    "columns apart": lambda a: np.repeat(a, 2, axis=1)[:, ::2],
    "part of a wider array": lambda a: np.hstack([a, a])[:, 3:],
    "backwards": lambda a: a[::-1].copy()[::-1],
    "columns backwards": lambda a: a[:, ::-1].copy()[:, ::-1],
    "packed records": lambda a: interleaved(a, a.dtype),
    "other byte order": lambda a: a.astype(a.dtype.newbyteorder()),
    "memoryview": lambda a: memoryview(np.ascontiguousarray(a)),
    "list": lambda a: a.tolist(),
    "tuple": lambda a: tuple(map(tuple, a.tolist())),
}


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("scalar", ["float32", "float64"])
@pytest.mark.parametrize(
    "index", ["int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "longlong"]
)
def test_every_layout_and_type(layout, scalar, index, detector):
    few = 40  # so many triangles name vertices that fit int8
    vertices, faces = LAYOUTS[layout](MESH.vertices.astype(scalar)), LAYOUTS[layout](MESH.faces[:few].astype(index))
    expected = [pair for pair in EXPECTED if max(pair) < few]
    assert detector.find_self(vertices, faces).pairs.tolist() == expected and len(expected) > 10


@pytest.mark.parametrize("index", ["int8", "int32", "uint32", "int64", "uint64"])
def test_faces_may_be_flat(index, tmp_path, detector):
    flat = MESH.faces.ravel()[:120].astype(index)
    expected = [pair for pair in EXPECTED if max(pair) < 40]
    every_third = np.repeat(flat, 3)[::3]
    for faces in (flat, every_third, flat[::-1].copy()[::-1], flat.tolist(), OnDevice(flat, kind=1), memoryview(flat)):
        result = detector.find_self(MESH.vertices, faces, groups=[0] * 40)
        assert result.pairs.tolist() == expected and len(result.hit) == 40
        assert detector.find_between((MESH.vertices, faces), MESH).offsets.shape == (41,)
        result.save(tmp_path / "page.html")
        crumple.write_mesh(tmp_path / "mesh.ply", (MESH.vertices, faces))
        assert crumple.read_mesh(tmp_path / "mesh.ply").faces.tolist() == MESH.faces[:40].tolist()
    with pytest.raises(crumple.InvalidInput, match="^groups must be one for each of the 40 faces, not 120$"):
        detector.find_self(MESH.vertices, flat, groups=[0] * 120)
    for none in ([], np.zeros(0, index)):
        assert not detector.find_self(MESH.vertices, none)


def test_flat_faces_are_not_copied(detector):
    """A broadcast index takes four bytes; a copy of sixty million would take 240 MB."""
    import resource

    faces = np.broadcast_to(np.int32(7), 60_000_000)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(crumple.InvalidInput, match="triangle 0 names vertex 7 of 3"):
        detector.has_intersections(np.zeros((3, 3)), faces)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 50_000  # KiB


def test_flat_faces_that_look_like_cells_can_be_given_as_rows(detector):
    tetrahedron = np.array([[3, 0, 1], [0, 3, 2], [1, 2, 3], [0, 1, 2]])
    with pytest.raises(crumple.InvalidInput, match="^faces look like cells"):
        detector.find_self(MESH.vertices[:4], tetrahedron.ravel())
    assert not detector.find_self(MESH.vertices[:4], tetrahedron)
    assert not detector.find_self(MESH.vertices[:4], tetrahedron[::-1].ravel())


def test_the_layouts_are_what_they_are_called():
    packed = LAYOUTS["packed records"](MESH.vertices)
    assert packed.strides[0] % packed.itemsize != 0
    assert LAYOUTS["backwards"](MESH.vertices).strides[0] < 0
    assert not LAYOUTS["columns apart"](MESH.vertices).flags.c_contiguous
    assert EXPECTED and EXPECTED == EXPECTED_DOUBLE


def test_read_only_inputs_are_read_and_no_input_is_written():
    vertices, faces, groups = MESH.vertices.copy(), MESH.faces.copy(), np.arange(60, dtype=np.int32)
    before = vertices.tobytes(), faces.tobytes(), groups.tobytes()
    for array in (vertices, faces, groups):
        array.flags.writeable = False
    result = crumple.Detector().find_self(vertices, faces, groups=groups, weld=True, contacts=True)
    assert result.pairs.tolist() == EXPECTED
    assert (vertices.tobytes(), faces.tobytes(), groups.tobytes()) == before


def test_a_strided_array_is_not_copied():
    """A broadcast array of 20 million rows takes 12 bytes; a copy would take 240 MB."""
    import resource

    vertices = np.broadcast_to(np.zeros(3, np.float32), (20_000_000, 3))
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(crumple.InvalidInput, match="triangle 0 names vertex 20000000 of 20000000"):
        crumple.has_intersections(vertices, [[0, 0, 20_000_000]])
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 50_000  # KiB


def test_empty_meshes_have_no_collisions(detector):
    none = np.zeros((0, 3))
    for vertices, faces in [([], []), (none, none.astype(int)), (MESH.vertices, []), (none.astype("f4"), [])]:
        result = detector.find_self(vertices, faces, contacts=True)
        assert result.pairs.shape == (0, 2) and not result
        assert result.contacts.points.shape == (0, 3) and result.contacts.offsets.tolist() == [0]
        assert detector.find_between((vertices, faces), MESH).pairs.shape == (0, 2)
        assert not detector.has_intersections(vertices, faces)


def bad_vertices(row, column, value):
    vertices = MESH.vertices.copy()
    vertices[row, column] = value
    return vertices


def bad_faces(row, column, value, dtype=np.int64):
    faces = MESH.faces.astype(dtype)
    faces[row, column] = value
    return faces


def holes(array, hole=None):
    objects = array.astype(object)
    objects[4, 1] = hole
    return objects


def rows(array, cut=None):
    """A one-dimensional array of rows, one of which is shorter."""
    objects = np.empty(len(array), object)
    for i, row in enumerate(array):
        objects[i] = row[:2] if i == cut else row
    return objects


def cells(faces):
    return np.insert(faces, 0, 3, axis=1).ravel()


V, F = MESH.vertices, MESH.faces
WRONG = [
    ("vertices of two columns", V[:, :2], F, r"^vertices must have shape \(n, 3\), not \(180, 2\)$"),
    ("flat vertices", V.ravel(), F, r"^vertices must have shape \(n, 3\), not \(540,\)$"),
    ("vertices of three dimensions", V[None], F, r"^vertices must have shape \(n, 3\), not \(1, 180, 3\)$"),
    ("no dimension", np.float32(1), F, r"^vertices must have shape \(n, 3\), not \(\)$"),
    ("faces of four columns", V, F[:45].reshape(-1, 1), r"^faces must have shape \(n, 3\)"),
    ("transposed", V, F.T, r"^faces must have shape \(n, 3\), not \(3, 60\)$"),
    ("half precision", V.astype("f2"), F, r"^vertices must be float32 or float64, not float16"),
    ("long double", V.astype("g"), F, r"^vertices must be float32 or float64, not float128"),
    ("integer vertices", V.astype("i4"), F, r"^vertices must be float32 or float64, not int32"),
    ("complex vertices", V.astype("c8"), F, r"^vertices must be float32 or float64, not complex64"),
    ("float faces", V, F.astype(float), r"^faces must be integers, not float64$"),
    ("boolean faces", V, F.astype(bool), r"^faces must be integers, not bool$"),
    ("words", [["a", "b", "c"]], F, r"^vertices must be float32 or float64, not <U1"),
    ("None", None, F, r"^vertices must be an array of numbers, not None$"),
    ("ragged", [[0, 0, 0], [1]], F, r"^vertices .* an array.*: row 1 has 1 elements, row 0 has 3 elements$"),
    ("a row that is none", [[0, 0, 0], 1], F, r"^vertices .* an array.*: row 1 is int, row 0 has 3 elements$"),
    ("a first row that is none", V, [1, [0, 0, 0]], r"^faces .* an array.*: row 1 has 3 elements, row 0 is int$"),
    ("objects", V.astype(object), F, r"^vertices must be .*, not of objects; .*\.astype\('float64'\)$"),
    ("integer objects", V, F.astype(object), r"^faces must be .*, not of objects; .*\.astype\('int64'\)$"),
    ("holes", holes(V), F, r"^vertices must be an array of numbers, but element \(4, 1\) is None$"),
    ("words among objects", holes(V, "x"), F, r"^vertices must be an array of numbers, but element \(4, 1\) is str$"),
    ("ragged objects", V, rows(F, cut=7), r"^faces must be .*, not of rows: row 7 has 2 elements, row 0 has 3 "),
    ("rows as objects", V, rows(F), r"^faces must be .*, not of rows: numpy.stack joins them$"),
    ("flat faces that are cut", V, F.ravel()[:-1], r"^faces must have .*, or be flat with .*, not \(179,\)$"),
    ("flat cells", V, cells(F), r"^faces look like cells .*: pass .reshape\(-1, 4\)\[:, 1:\] of them, or "),
    ("a list of cells", V, cells(F[:59]).tolist(), r"^faces look like cells .*: pass .reshape.* of them$"),
    ("flat indices out of range", V, bad_faces(4, 1, 180).ravel(), r"^triangle 4 names vertex 180 of 180$"),
    (
        "huge numbers",
        V,
        [[0, 1, 10**30]],
        r"^faces must be .*, but element \(0, 2\) is 10{30}, which no integer of 64 bits",
    ),
    ("NaN", bad_vertices(17, 2, np.nan), F, r"^vertex 17 is not finite$"),
    ("infinity", bad_vertices(3, 0, -np.inf), F, r"^vertex 3 is not finite$"),
    ("infinity, strided", np.asfortranarray(bad_vertices(3, 0, np.inf)), F, r"^vertex 3 is not finite$"),
    ("index too large", V, bad_faces(4, 1, 180), r"^triangle 4 names vertex 180 of 180$"),
    ("negative index", V, bad_faces(5, 2, -1), r"^triangle 5 names vertex -1 of 180$"),
    ("negative int8 index", V, np.array([[0, 1, -2]], "i1"), r"^triangle 0 names vertex -2 of 180$"),
    (
        "an index that int32 would truncate",
        V,
        bad_faces(6, 0, 2**32 + 1),
        r"^triangle 6 names vertex 4294967297 of 180$",
    ),
    ("uint32 beyond int32", V, bad_faces(6, 0, 2**32 - 1, np.uint32), r"^triangle 6 names vertex 4294967295 of 180$"),
    ("uint64 beyond int64", V, bad_faces(7, 0, 2**64 - 1, np.uint64), r"^triangle 7 names vertex 18446744073709551615"),
]


@pytest.mark.parametrize("vertices, faces, message", [w[1:] for w in WRONG], ids=[w[0] for w in WRONG])
def test_what_is_wrong_is_named(vertices, faces, message, detector):
    calls = [
        (lambda: detector.find_self(crumple.Mesh(vertices, faces)), ""),
        (lambda: detector.has_intersections(crumple.Mesh(vertices, faces)), ""),
        (lambda: detector.partition((vertices, faces), count=2), ""),
        (lambda: detector.find_between((vertices, faces), MESH), "first mesh: "),
        (lambda: detector.find_between(MESH, (vertices, faces)), "second mesh: "),
    ]
    for call, which in calls:
        with pytest.raises(crumple.InvalidInput, match="^" + which + message.removeprefix("^")) as caught:
            call()
        assert isinstance(caught.value, ValueError) and isinstance(caught.value, crumple.Error)
    assert detector.find_self(MESH).pairs.tolist() == EXPECTED, "the detector stays usable"


@pytest.mark.parametrize("name", ["vertices", "faces", "groups", "excluded_groups"])
@pytest.mark.parametrize("in_place", [True, False])
def test_masked_values_are_refused(name, in_place, detector):
    arrays = {
        "vertices": MESH.vertices,
        "faces": MESH.faces,
        "groups": np.zeros(60, np.int32),
        "excluded_groups": np.array([[1, 2]] * 6, np.int32),
    }
    expected = detector.find_self(**arrays).pairs.tolist()
    array = arrays[name] if in_place else arrays[name].astype(arrays[name].dtype.newbyteorder())
    for nothing in (np.ma.nomask, False, np.zeros(array.shape)):
        unmasked = np.ma.array(array, mask=nothing)
        assert detector.find_self(**{**arrays, name: unmasked}).pairs.tolist() == expected
    mask = np.zeros(array.shape, bool)
    mask[5] = True
    where = 5 if name == "groups" else (5, 0)
    masked = re.escape(f"{name} are masked at ({', '.join(map(str, np.atleast_1d(where)))}{',' * (name == 'groups')})")
    for given in (np.ma.array(array, mask=mask), GivesMasked(array, mask)):
        with pytest.raises(crumple.InvalidInput, match=f"^{masked}: .*numpy.ma.filled"):
            detector.find_self(**{**arrays, name: given})


class GivesMasked:
    def __init__(self, array, mask):
        self.array = np.ma.array(array, mask=mask)

    def __array__(self, dtype=None, copy=None):
        return self.array


def test_masks_are_looked_for_in_rows_and_meshes(detector):
    row = np.ma.array([0, 1, 2], mask=[0, 1, 0])
    with pytest.raises(crumple.InvalidInput, match=r"^faces: a row is masked at \(1,\): "):
        detector.find_self(MESH.vertices, [row, [0, 1, 2]])
    masked = np.ma.array(MESH.vertices, mask=MESH.vertices == MESH.vertices[17, 1])
    with pytest.raises(crumple.InvalidInput, match=r"^second mesh: vertices are masked at \(17, 1\): ") as caught:
        detector.find_between(MESH, MESH._replace(vertices=masked))
    assert (caught.value.element, caught.value.index) == ("vertex", 17)
    with pytest.raises(crumple.InvalidInput, match="^vertices are masked"):
        crumple.write_mesh("mesh.ply", MESH._replace(vertices=masked))


def test_other_kinds_of_numpy_arrays_are_read_in_place(tmp_path, detector):
    mapped = np.memmap(tmp_path / "vertices", np.float32, "w+", shape=MESH.vertices.shape)
    mapped[...] = MESH.vertices
    assert detector.find_self(mapped, MESH.faces.view(np.recarray)).pairs.tolist() == EXPECTED


def test_an_error_knows_the_place(detector):
    import pickle

    with pytest.raises(crumple.InvalidInput) as caught:
        detector.find_self(MESH.vertices, bad_faces(7, 0, 2**64 - 1, np.uint64))
    assert (caught.value.code, caught.value.element, caught.value.index) == ("index_out_of_range", "triangle", 7)
    with pytest.raises(crumple.InvalidInput) as caught:
        detector.find_self(bad_vertices(17, 2, np.nan), MESH.faces)
    assert (caught.value.code, caught.value.element, caught.value.index) == ("not_finite", "vertex", 17)
    copy = pickle.loads(pickle.dumps(caught.value))
    assert (str(copy), copy.index) == ("vertex 17 is not finite", 17)


OPTIONS = [
    ({"groups": [0] * 59}, r"^groups must be one for each of the 60 faces, not 59$"),
    ({"groups": []}, r"^groups must be one for each of the 60 faces, not 0$"),
    ({"groups": np.zeros(0, np.int32)}, r"^groups must be one for each of the 60 faces, not 0$"),
    ({"groups": np.zeros(61, np.int32)}, r"^groups must be one for each of the 60 faces, not 61$"),
    ({"groups": [[0] * 60]}, r"groups must have shape \(faces,\), not \(1, 60\)"),
    ({"groups": [0.5] * 60}, r"groups must be integers, not float64"),
    ({"groups": [0] * 59 + [2**31]}, r"groups: group id 2147483648 at 59 does not fit int32"),
    ({"neighbours": "none"}, r'neighbours must be one of "geometric", "skip", not "none"'),
    ({"intersections": "some"}, r'intersections must be one of "all", "proper", not "some"'),
    ({"wanted": "neither"}, r'wanted must be one of "both", "between", "within", not "neither"'),
    ({"excluded_groups": [(1, 2, 3)]}, r"excluded_groups must have shape \(n, 2\), not \(1, 3\)"),
    ({"wanted": "\udc80"}, r"^wanted must be text that UTF-8 can hold, not '\\udc80'$"),
    ({"excluded_groups": [(1, -(2**31) - 1)]}, r"group id -2147483649 at 0 does not fit int32"),
]


@pytest.mark.parametrize("query, message", OPTIONS)
def test_wrong_queries_are_named(query, message, detector):
    with pytest.raises(crumple.InvalidInput, match=message):
        detector.find_self(MESH, **query)


WRONG_TYPES = [
    ({"neighbours": None}, 'neighbours must be one of "geometric", "skip", not None'),
    ({"intersections": 1}, 'intersections must be one of "all", "proper", not int'),
    ({"wanted": ["both"]}, 'wanted must be one of "both", "between", "within", not list'),
    ({"weld": 1}, "weld must be True or False, not int"),
    ({"weld": None}, "weld must be True or False, not None"),
    ({"contacts": "no"}, "contacts must be True or False, not str"),
    ({"copy": 0.0}, "copy must be True or False, not float"),
    ({"part": 1}, "part must be a crumple.Part, not int"),
]


@pytest.mark.parametrize("query, message", WRONG_TYPES)
def test_wrong_types_in_a_query_are_named(query, message, detector):
    with pytest.raises(crumple.InvalidType, match=f"^{message}$") as caught:
        detector.find_self(MESH, **query)
    assert isinstance(caught.value, TypeError) and isinstance(caught.value, crumple.InvalidInput)
    if not set(query) & {"contacts", "copy", "part"}:
        for call in (detector.has_intersections, detector.find_self):
            with pytest.raises(TypeError, match=f"^{message}$"):
                call(MESH, **query)


@pytest.mark.parametrize(
    "options, message",
    [
        ({"threads": "2"}, "threads must be an integer, not str"),
        ({"threads": 2.0}, "threads must be an integer, not float"),
        ({"threads": None}, "threads must be an integer, not None"),
        ({"memory_limit": 1e9}, "memory_limit must be an integer, not float"),
        ({"count_bytes_needed": 1}, "count_bytes_needed must be True or False, not int"),
        ({"fuzziness": "2"}, "fuzziness must be a number, not str"),
        ({"stop": None}, "stop must be a number, not None"),
        ({"backend": 3}, 'backend must be one of "automatic", "cpu", "cuda", "reference", not int'),
        ({"device": "0"}, "device must be an integer, not str"),
        ({"simd": b"avx2"}, 'simd must be one of "automatic", .*, not bytes'),
    ],
)
def test_wrong_types_of_options_are_named(options, message):
    with pytest.raises(crumple.InvalidType, match=f"^{message}$"):
        crumple.Detector(**options)


@pytest.mark.parametrize("name", ["threads", "clusters", "leaf_size", "max_iterations", "first_iterations"])
def test_integers_that_are_too_large_are_named(name):
    for value in (10**12, -(10**12), 10**30):
        with pytest.raises(crumple.InvalidInput, match=f"^{name} must be from -2147483648 to 2147483647, not {value}$"):
            crumple.Detector(**{name: value})
    with pytest.raises(crumple.InvalidInput, match="^memory_limit must be from .* not 1000000000000000000000$"):
        crumple.Detector(memory_limit=10**21)
    with pytest.raises(crumple.InvalidInput, match="^stop is beyond float64$"):
        crumple.Detector(stop=10**400)


def test_numpy_scalars_do_where_python_s_do():
    for integer in (np.int8, np.uint16, np.int64, np.uint64):
        detector = crumple.Detector(threads=integer(2), memory_limit=integer(0), leaf_size=integer(100))
    detector = crumple.Detector(threads=np.int32(2), fuzziness=np.float32(2), stop=np.float64(0.01), first_stop=0)
    result = detector.find_self(MESH, weld=np.bool_(False), contacts=np.bool_(True), copy=np.True_)
    assert result.pairs.tolist() == EXPECTED and result.contacts and result.pairs.flags.writeable
    assert len(detector.partition(MESH, count=np.int64(3))) == 3
    assert len(crumple.make_scene("soup", triangles=np.int64(20), frame=np.uint8(0), seed=np.uint64(2**63)).faces)


def test_other_wrong_types_are_named(detector, tmp_path):
    for call, message in [
        (lambda: detector.partition(MESH, count="3"), "count must be an integer, not str"),
        (lambda: detector.partition(MESH, count=0), "the number of parts must be 1 to 64"),
        (lambda: crumple.read_mesh(7), "path must be a str, bytes or os.PathLike, not int"),
        (lambda: crumple.read_mesh(None), "path must be a str, bytes or os.PathLike, not None"),
        (lambda: crumple.read_mesh("a\0b"), "path cannot be the name of a file"),
        (lambda: crumple.read_mesh("a.ply", group_property=None), "group_property must be a str, not None"),
        (lambda: crumple.read_pairs(1.5), "path must be a str, bytes or os.PathLike, not float"),
        (lambda: crumple.write_mesh([], MESH), "path must be a str, bytes or os.PathLike, not list"),
        (lambda: detector.find_self(MESH).save(None), "path must be a str, bytes or os.PathLike, not None"),
        (lambda: detector.find_self(MESH).to_html(height="tall"), "height must be an integer, not str"),
        (lambda: crumple.make_scene("\ud800"), r"name must be text that UTF-8 can hold, not '\\ud800'"),
        (lambda: crumple.make_scene(3), "name must be a str, not int"),
        (lambda: crumple.make_scene("cloth", triangles="many"), "triangles must be an integer, not str"),
        (lambda: crumple.make_scene("cloth", seed=-1), "seed must be from 0 to 18446744073709551615, not -1"),
        (lambda: detector.find_self(MESH.vertices), "a mesh must be .*, not numpy.ndarray"),
        (lambda: detector.find_self((1, 2, 3, 4)), "a mesh must be .*, not a tuple of 4"),
        (lambda: detector.find_between(None, MESH), "a mesh must be .*, not NoneType"),
    ]:
        with pytest.raises(crumple.InvalidInput, match=f"^{message}$"):
            call()


def test_between_groups_needs_groups(detector):
    for call in (detector.find_self, detector.has_intersections):
        with pytest.raises(crumple.InvalidInput, match="wanted between needs groups, and the mesh has none"):
            call(MESH, wanted="between")
    for call in (detector.find_between, detector.has_intersections_between):
        with pytest.raises(crumple.InvalidInput, match="wanted between needs groups, and neither mesh has any"):
            call(MESH, MESH, wanted="between")
    assert len(detector.find_between(MESH, MESH._replace(groups=[1] * 60), wanted="between")) > 60
    assert not detector.find_self((np.zeros((0, 3)), []), groups=[], wanted="between")
    with pytest.raises(crumple.InvalidInput, match="^second mesh: groups must be one for each of the 60 faces, not 0$"):
        detector.find_between(MESH, MESH._replace(groups=[]))


def test_groups_of_every_integer_type(detector):
    mesh = soup(100, size=0.4)
    groups = np.arange(100) % 3
    expected = detector.find_self(mesh, groups=groups.astype(np.int32), wanted="between").pairs.tolist()
    assert 0 < len(expected) < len(detector.find_self(mesh))
    for dtype in ("i1", "u1", "i2", "u2", "u4", "i8", "u8"):
        assert detector.find_self(mesh, groups=groups.astype(dtype), wanted="between").pairs.tolist() == expected
    assert detector.find_self(mesh, groups=np.repeat(groups, 2)[::2], wanted="between").pairs.tolist() == expected
    assert detector.find_self(crumple.Mesh(*mesh[:2], groups), wanted="between").pairs.tolist() == expected
    between = {frozenset(p) for p in ((0, 1), (0, 2), (1, 2))}
    for excluded in (between, np.array([[1, 0], [2, 0], [2, 1]]), ((0, 1), (0, 2), (1, 2))):
        as_pairs = [tuple(p) for p in excluded] if isinstance(excluded, set) else excluded
        assert not detector.find_self(mesh, groups=groups, wanted="between", excluded_groups=as_pairs)


def test_pairs_of_groups_from_any_iterable(detector):
    mesh = soup(100, size=0.4)._replace(groups=np.arange(100) % 3)
    pairs = [(0, 1), (0, 2)]
    expected = detector.find_self(mesh, excluded_groups=pairs).pairs.tolist()
    assert 0 < len(expected) < len(detector.find_self(mesh))
    keyed = dict.fromkeys(pairs)
    makers = [set, frozenset, iter, keyed.fromkeys, lambda p: keyed.keys(), lambda p: dict(enumerate(p)).values()]
    makers += [lambda p: zip(*zip(*p)), lambda p: (pair for pair in p), lambda p: memoryview(np.array(p, np.int32))]
    for make in makers:
        assert detector.find_self(mesh, excluded_groups=make(pairs)).pairs.tolist() == expected
    for none in (set(), iter([]), {}):
        assert len(detector.find_self(mesh, excluded_groups=none)) == len(detector.find_self(mesh))


class Raising:
    """An argument of any kind that raises when it is looked at."""

    def __init__(self, error):
        self.error = error

    def look(self):
        raise self.error

    __index__ = __float__ = __fspath__ = look


@pytest.mark.parametrize(
    "call",
    [
        lambda value: crumple.Detector(threads=value),
        lambda value: crumple.Detector(stop=value),
        lambda value: crumple.read_mesh(value),
        lambda value: crumple.write_mesh(value, MESH),
        lambda value: crumple.Detector().find_self(MESH).save(value),
    ],
)
def test_what_is_not_about_the_argument_goes_on(call):
    for error in (KeyboardInterrupt(), MemoryError(), ZeroDivisionError("inside")):
        with pytest.raises(type(error)):
            call(Raising(error))
    with pytest.raises(crumple.InvalidType):
        call(Raising(TypeError()))


@pytest.mark.parametrize(
    "options, message",
    [
        ({"threads": -1}, "threads must be 0"),
        ({"clusters": 65}, "clusters must be 0 .chosen. to 64"),
        ({"leaf_size": 0}, "leaf_size must be at least 1"),
        ({"fuzziness": 1.0}, "fuzziness must be finite and above 1"),
        ({"memory_limit": -5}, "memory_limit must be 0"),
        ({"backend": "abacus"}, 'backend must be one of "automatic", "cpu", "cuda", "reference", not "abacus"'),
        ({"device": -1}, "device must be 0 or more"),
        ({"simd": "mmx"}, 'simd must be one of "automatic"'),
    ],
)
def test_wrong_options_are_named(options, message):
    with pytest.raises(crumple.InvalidInput, match=message):
        crumple.Detector(**options)


def test_a_missing_instruction_set_is_an_error(detector):
    if detector.backend == "cuda":
        pytest.skip("instruction sets are the cpu backend's")
    missing = []
    for simd in ("sse4", "avx2", "avx512", "neon"):
        try:
            crumple.Detector(simd=simd)
        except crumple.BackendUnavailable as error:
            missing.append((simd, str(error)))
    assert missing, "no machine has both AVX and NEON"


def test_the_cuda_backend_says_why_it_is_not_there():
    try:
        detector = crumple.Detector(backend="cuda", device=1000)
    except crumple.BackendUnavailable as error:
        assert re.match("the cuda backend (was not built; configure with|is not available: )", str(error))
        assert error.code == "backend_unavailable"
    else:
        pytest.fail(f"{detector} has a thousand devices")


def test_a_memory_limit_names_a_lower_bound_or_the_limit_that_suffices():
    import pickle

    mesh = soup(3000)
    with pytest.raises(
        crumple.MemoryLimit, match=r"memory limit of 10000 bytes is too small; at least \d+ bytes are needed"
    ) as caught:
        crumple.Detector(memory_limit=10_000).find_self(mesh)
    least = caught.value
    assert isinstance(least, MemoryError) and least.code == "memory_limit" and least.bytes_needed_at_least is True
    copy = pickle.loads(pickle.dumps(least))
    assert (copy.bytes_needed, copy.bytes_needed_at_least) == (least.bytes_needed, True)
    with pytest.raises(
        crumple.MemoryLimit, match=r"memory limit of 10000 bytes is too small; \d+ bytes suffice"
    ) as caught:
        crumple.Detector(memory_limit=10_000, count_bytes_needed=True).find_self(mesh)
    assert caught.value.bytes_needed_at_least is False and caught.value.bytes_needed >= least.bytes_needed
    enough = crumple.Detector(memory_limit=caught.value.bytes_needed)
    held = [enough.find_self(mesh).pairs for _ in range(3)]  # results in hand do not count
    for pairs in held:
        np.testing.assert_array_equal(pairs, crumple.find_self_intersections(mesh))


def test_device_arrays_are_told_what_to_do(detector):
    if detector.backend == "cuda":
        pytest.skip("this detector takes them")
    mesh = OnDevice(MESH.vertices), OnDevice(MESH.faces)
    with pytest.raises(crumple.InvalidInput, match=r"lie in CUDA memory, which needs the cuda backend.*\.cpu\(\)"):
        detector.find_self(*mesh)
    with pytest.raises(crumple.InvalidInput, match=r"lie in CUDA memory, which needs the cuda backend.*\.cpu\(\)"):
        detector.find_between((MESH.vertices, MESH.faces), mesh)


def test_a_mesh_lies_in_one_place(detector):
    with pytest.raises(
        crumple.InvalidInput, match="faces lie in host memory, but vertices in the memory of CUDA device 0"
    ):
        detector.find_self(OnDevice(MESH.vertices), MESH.faces)
    with pytest.raises(
        crumple.InvalidInput, match="faces lie in the memory of CUDA device 3, but vertices in host memory"
    ):
        detector.find_self(MESH.vertices, OnDevice(MESH.faces, 3))
    with pytest.raises(crumple.InvalidInput, match="groups lie in the memory of CUDA device 0, but vertices in host"):
        detector.find_self(*MESH[:2], groups=OnDevice(np.zeros(len(MESH.faces), np.int32)))


def test_nothing_is_converted_on_a_device(detector):
    faces = OnDevice(MESH.faces)
    with pytest.raises(crumple.InvalidInput, match=r"vertices in CUDA memory must be \(n, 3\) of float32 or float64"):
        detector.find_self(OnDevice(MESH.vertices.astype(np.float16)), faces)
    with pytest.raises(crumple.InvalidInput, match=r"faces in CUDA memory must be \(m, 3\) or \(3m\) of int32, uint32"):
        detector.find_self(OnDevice(MESH.vertices), OnDevice(MESH.faces.astype(np.int16)))
    with pytest.raises(crumple.InvalidInput, match="excluded_groups lie in CUDA memory, but are wanted in the host's"):
        detector.find_self(MESH, excluded_groups=OnDevice(np.zeros((1, 2), np.int32)))


def test_a_device_of_another_kind_is_named(detector):
    with pytest.raises(crumple.InvalidInput, match="vertices lie in Metal memory.*copy them to the host"):
        detector.find_self(OnDevice(MESH.vertices, kind=8), MESH.faces)


class Enumerator:
    """As Open3D's: a value, and no way to int."""

    def __init__(self, value):
        self.value = value


def test_a_device_may_be_an_enumerator(detector):
    narrow = MESH.faces.astype(np.int16)
    for kind, memory in (Enumerator(2), "CUDA"), (Enumerator(8), "Metal"):
        with pytest.raises(crumple.InvalidInput, match=f"faces (lie )?in {memory} memory"):
            detector.find_self(MESH.vertices, OnlyPlace(narrow, (kind, 0)))
    assert detector.find_self(MESH.vertices, OnlyPlace(narrow, (Enumerator(1), 0))).pairs.tolist() == EXPECTED


@pytest.mark.parametrize("place", [None, (), ("cpu", 0), (Enumerator(None), 0), ZeroDivisionError])
def test_a_device_that_makes_no_sense_is_refused(place, detector):
    with pytest.raises(crumple.InvalidType, match="^faces do not tell where they lie, by __dlpack_device__: "):
        detector.find_self(MESH.vertices, OnlyPlace(MESH.faces, place))


class OnlyPlace:
    """Says where it lies, but is read as NumPy reads it."""

    def __init__(self, array, place):
        self.array, self.place = array, place

    def __dlpack_device__(self):
        if self.place is ZeroDivisionError:
            raise self.place
        return self.place

    def __array__(self, dtype=None, copy=None):
        return self.array


def test_tensors_of_open3d(detector):
    core = peer("open3d").core
    for index in (np.int16, np.int32, np.uint8):
        faces = MESH.faces[:40].astype(index)
        result = detector.find_self(core.Tensor(MESH.vertices), core.Tensor(faces))
        assert result.pairs.tolist() == [pair for pair in EXPECTED if max(pair) < 40]
    with pytest.raises(crumple.InvalidInput, match="^faces must be integers, not float64$"):
        detector.find_self(core.Tensor(MESH.vertices), core.Tensor(MESH.faces.astype(float)))


@pytest.mark.parametrize(
    "state",
    [
        (),
        (0,),
        (0, 5, [], []),
        (0, [(1.0, 2.0)], [], []),
        ("0", [(1.0, 2.0, 3.0)], [], []),
        (0, [(1.0, 2.0, 3.0)], [2**40], []),
        (0, [(1.0, 2.0, 3.0)], [], None),
        [0, 1],
        None,
    ],
)
def test_the_state_of_a_part_is_checked(state):
    part = crumple.Part.__new__(crumple.Part)
    with pytest.raises(crumple.InvalidType, match="^the state of a Part must be a tuple"):
        part.__setstate__(state)


def test_a_part_that_nothing_was_put_into_is_refused(detector):
    empty = crumple.Part.__new__(crumple.Part)
    for look in (
        lambda: empty.centres,
        lambda: empty.triangles,
        lambda: empty.triangles_second,
        lambda: detector.find_self(MESH, part=empty),
    ):
        with pytest.raises(crumple.InvalidInput, match="is a crumple.Part that nothing was put into$"):
            look()


@pytest.mark.parametrize("package", ["torch", "jax", "warp"])
def test_arrays_of_other_packages(package, detector):
    module = peer("jax.numpy" if package == "jax" else package)
    if package == "torch":
        arrays = module.from_numpy(MESH.vertices.copy()), module.from_numpy(MESH.faces.copy())
    elif package == "warp":
        module.config.quiet = True
        arrays = module.from_numpy(MESH.vertices, device="cpu"), module.from_numpy(MESH.faces, device="cpu")
    else:
        arrays = module.asarray(MESH.vertices), module.asarray(MESH.faces)
    vertices, faces = arrays
    assert detector.find_self(vertices, faces).pairs.tolist() == EXPECTED
    assert detector.find_self(vertices, faces.flatten()).pairs.tolist() == EXPECTED
