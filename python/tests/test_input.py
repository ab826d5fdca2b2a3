"""Tests of input arrays: every layout is read correctly, no array is written to, and errors name the wrong array."""

import re

import numpy as np
import pytest

import crumple
from conftest import OnDevice, peer, soup

MESH = soup(60, size=0.8)
EXPECTED = crumple.intersections(MESH).pairs.tolist()
EXPECTED_DOUBLE = crumple.intersections(MESH.vertices.astype(float), MESH.faces).pairs.tolist()


def interleaved(array, dtype):
    """Returns the array as a field of packed records, whose size is no multiple of the size of the field's numbers."""
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
def test_layout_and_type_of_arrays_do_not_change_the_pairs(layout, scalar, index, detector):
    few = 40  # the vertex indices of so many triangles fit in int8
    vertices, faces = LAYOUTS[layout](MESH.vertices.astype(scalar)), LAYOUTS[layout](MESH.faces[:few].astype(index))
    expected = [pair for pair in EXPECTED if max(pair) < few]
    assert detector.intersections(vertices, faces).pairs.tolist() == expected and len(expected) > 10


@pytest.mark.parametrize("index", ["int8", "int32", "uint32", "int64", "uint64"])
def test_faces_may_be_flat(index, tmp_path, detector):
    flat = MESH.faces.ravel()[:120].astype(index)
    expected = [pair for pair in EXPECTED if max(pair) < 40]
    every_third = np.repeat(flat, 3)[::3]
    for faces in (flat, every_third, flat[::-1].copy()[::-1], flat.tolist(), OnDevice(flat, kind=1), memoryview(flat)):
        result = detector.intersections(MESH.vertices, faces, groups=[0] * 40)
        assert result.pairs.tolist() == expected and len(result.hit) == 40
        assert detector.intersections((MESH.vertices, faces), MESH).offsets.shape == (41,)
        result.save(tmp_path / "page.html")
        crumple.write_mesh(tmp_path / "mesh.ply", (MESH.vertices, faces))
        assert crumple.read_mesh(tmp_path / "mesh.ply").faces.tolist() == MESH.faces[:40].tolist()
    with pytest.raises(crumple.InvalidInput, match="^groups must be one for each of the 40 faces, not 120$"):
        detector.intersections(MESH.vertices, flat, groups=[0] * 120)
    for none in ([], np.zeros(0, index)):
        assert not detector.intersections(MESH.vertices, none)


def test_flat_faces_of_int32_are_not_copied(detector):
    """A broadcast index takes four bytes; a copy of sixty million would take 240 MB."""
    import resource

    faces = np.broadcast_to(np.int32(7), 60_000_000)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(crumple.InvalidInput, match="triangle 0 names vertex 7 of 3"):
        detector.any((np.zeros((3, 3)), faces))
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 50_000  # KiB


def test_flat_faces_that_look_like_cells_are_refused_but_faces_in_rows_are_not(detector):
    tetrahedron = np.array([[3, 0, 1], [0, 3, 2], [1, 2, 3], [0, 1, 2]])
    with pytest.raises(crumple.InvalidInput, match="^faces look like cells"):
        detector.intersections(MESH.vertices[:4], tetrahedron.ravel())
    assert not detector.intersections(MESH.vertices[:4], tetrahedron)
    assert not detector.intersections(MESH.vertices[:4], tetrahedron[::-1].ravel())


def test_tested_layouts_include_packed_negative_and_gapped_strides():
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
    result = crumple.Detector().intersections(vertices, faces, groups=groups, weld=True, output="contacts")
    assert result.pairs.tolist() == EXPECTED
    assert (vertices.tobytes(), faces.tobytes(), groups.tobytes()) == before


def test_a_strided_array_is_not_copied():
    """A broadcast array of 20 million rows takes 12 bytes; a copy would take 240 MB."""
    import resource

    vertices = np.broadcast_to(np.zeros(3, np.float32), (20_000_000, 3))
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(crumple.InvalidInput, match="triangle 0 names vertex 20000000 of 20000000"):
        crumple.Detector().any((vertices, [[0, 0, 20_000_000]]))
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 50_000  # KiB


def test_empty_meshes_have_no_collisions(detector):
    none = np.zeros((0, 3))
    for vertices, faces in [([], []), (none, none.astype(int)), (MESH.vertices, []), (none.astype("f4"), [])]:
        result = detector.intersections(vertices, faces, output="contacts")
        assert result.pairs.shape == (0, 2) and not result
        assert result.contacts.points.shape == (0, 3) and result.contacts.offsets.tolist() == [0]
        assert detector.intersections((vertices, faces), MESH).pairs.shape == (0, 2)
        assert not detector.any((vertices, faces))


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
    """Returns a one-dimensional array of row objects. Row `cut`, if given, is shorter."""
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
        r"^faces must be .*, but element \(0, 2\) is 10{30}, which does not fit in 64 bits",
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
def test_error_names_the_wrong_array_and_element(vertices, faces, message, detector):
    calls = [
        (lambda: detector.intersections(crumple.Mesh(vertices, faces)), ""),
        (lambda: detector.any(crumple.Mesh(vertices, faces)), ""),
        (lambda: detector.partition((vertices, faces), count=2), ""),
        (lambda: detector.intersections((vertices, faces), MESH), "first mesh: "),
        (lambda: detector.intersections(MESH, (vertices, faces)), "second mesh: "),
    ]
    for call, which in calls:
        with pytest.raises(crumple.InvalidInput, match="^" + which + message.removeprefix("^")) as caught:
            call()
        assert isinstance(caught.value, ValueError) and isinstance(caught.value, crumple.Error)
    assert detector.intersections(MESH).pairs.tolist() == EXPECTED, "the detector stays usable"


@pytest.mark.parametrize("name", ["vertices", "faces", "groups", "excluded_groups"])
@pytest.mark.parametrize("in_place", [True, False])
def test_masked_values_are_refused(name, in_place, detector):
    arrays = {
        "vertices": MESH.vertices,
        "faces": MESH.faces,
        "groups": np.zeros(60, np.int32),
        "excluded_groups": np.array([[1, 2]] * 6, np.int32),
    }

    def search(excluded_groups, **mesh):
        return detector.intersections(**mesh, filter=crumple.PairFilter(excluded_groups=excluded_groups))

    expected = search(**arrays).pairs.tolist()
    array = arrays[name] if in_place else arrays[name].astype(arrays[name].dtype.newbyteorder())
    for nothing in (np.ma.nomask, False, np.zeros(array.shape)):
        unmasked = np.ma.array(array, mask=nothing)
        assert search(**{**arrays, name: unmasked}).pairs.tolist() == expected
    mask = np.zeros(array.shape, bool)
    mask[5] = True
    where = 5 if name == "groups" else (5, 0)
    masked = re.escape(f"{name} are masked at ({', '.join(map(str, np.atleast_1d(where)))}{',' * (name == 'groups')})")
    for given in (np.ma.array(array, mask=mask), GivesMasked(array, mask)):
        with pytest.raises(crumple.InvalidInput, match=f"^{masked}: .*numpy.ma.filled"):
            search(**{**arrays, name: given})


class GivesMasked:
    def __init__(self, array, mask):
        self.array = np.ma.array(array, mask=mask)

    def __array__(self, dtype=None, copy=None):
        return self.array


def test_masked_rows_and_meshes_are_refused(detector):
    row = np.ma.array([0, 1, 2], mask=[0, 1, 0])
    with pytest.raises(crumple.InvalidInput, match=r"^faces: a row is masked at \(1,\): "):
        detector.intersections(MESH.vertices, [row, [0, 1, 2]])
    masked = np.ma.array(MESH.vertices, mask=MESH.vertices == MESH.vertices[17, 1])
    with pytest.raises(crumple.InvalidInput, match=r"^second mesh: vertices are masked at \(17, 1\): ") as caught:
        detector.intersections(MESH, MESH._replace(vertices=masked))
    assert (caught.value.element, caught.value.index) == ("vertex", 17)
    with pytest.raises(crumple.InvalidInput, match="^vertices are masked"):
        crumple.write_mesh("mesh.ply", MESH._replace(vertices=masked))


def test_memory_maps_and_record_arrays_are_accepted(tmp_path, detector):
    mapped = np.memmap(tmp_path / "vertices", np.float32, "w+", shape=MESH.vertices.shape)
    mapped[...] = MESH.vertices
    assert detector.intersections(mapped, MESH.faces.view(np.recarray)).pairs.tolist() == EXPECTED


def test_error_has_the_kind_and_index_of_the_element(detector):
    import pickle

    with pytest.raises(crumple.InvalidInput) as caught:
        detector.intersections(MESH.vertices, bad_faces(7, 0, 2**64 - 1, np.uint64))
    assert (caught.value.code, caught.value.element, caught.value.index) == ("index_out_of_range", "triangle", 7)
    with pytest.raises(crumple.InvalidInput) as caught:
        detector.intersections(bad_vertices(17, 2, np.nan), MESH.faces)
    assert (caught.value.code, caught.value.element, caught.value.index) == ("not_finite", "vertex", 17)
    copy = pickle.loads(pickle.dumps(caught.value))
    assert (str(copy), copy.index) == ("vertex 17 is not finite", 17)


def test_device_arrays_need_the_cuda_backend(detector):
    if detector.backend == "cuda":
        pytest.skip("this detector takes them")
    mesh = OnDevice(MESH.vertices), OnDevice(MESH.faces)
    with pytest.raises(crumple.InvalidInput, match=r"lie in CUDA memory, which needs the cuda backend.*\.cpu\(\)"):
        detector.intersections(*mesh)
    with pytest.raises(crumple.InvalidInput, match=r"lie in CUDA memory, which needs the cuda backend.*\.cpu\(\)"):
        detector.intersections((MESH.vertices, MESH.faces), mesh)


def test_arrays_of_a_mesh_must_be_in_the_same_memory(detector):
    with pytest.raises(
        crumple.InvalidInput, match="faces lie in host memory, but vertices in the memory of CUDA device 0"
    ):
        detector.intersections(OnDevice(MESH.vertices), MESH.faces)
    with pytest.raises(
        crumple.InvalidInput, match="faces lie in the memory of CUDA device 3, but vertices in host memory"
    ):
        detector.intersections(MESH.vertices, OnDevice(MESH.faces, 3))
    with pytest.raises(crumple.InvalidInput, match="groups lie in the memory of CUDA device 0, but vertices in host"):
        detector.intersections(*MESH[:2], groups=OnDevice(np.zeros(len(MESH.faces), np.int32)))


def test_device_arrays_of_unsupported_types_are_refused(detector):
    faces = OnDevice(MESH.faces)
    with pytest.raises(crumple.InvalidInput, match=r"vertices in CUDA memory must be \(n, 3\) of float32 or float64"):
        detector.intersections(OnDevice(MESH.vertices.astype(np.float16)), faces)
    with pytest.raises(crumple.InvalidInput, match=r"faces in CUDA memory must be \(m, 3\) or \(3m\) of int32, uint32"):
        detector.intersections(OnDevice(MESH.vertices), OnDevice(MESH.faces.astype(np.int16)))
    with pytest.raises(crumple.InvalidInput, match="excluded_groups lie in CUDA memory, but must be in host memory"):
        detector.intersections(MESH, filter=crumple.PairFilter(excluded_groups=OnDevice(np.zeros((1, 2), np.int32))))


class Producer(OnDevice):
    """Array that records the arguments of each call of its __dlpack__. The first calls raise `errors`, one each."""

    def __init__(self, array, kind=2, errors=()):
        super().__init__(array, kind=kind)
        self.calls, self.errors = [], list(errors)

    def __dlpack__(self, **named):
        self.calls.append(named)
        if self.errors:
            raise self.errors.pop(0)
        return super().__dlpack__(**named)


class Unannounced(Producer):
    """Array in CUDA memory without __dlpack_device__, so that its memory is not known before __dlpack__ is called."""

    __dlpack_device__ = None


@pytest.mark.parametrize("kind", [1, 3])
def test_arrays_in_host_memory_are_read_without_a_stream(detector, kind):
    vertices, faces = Producer(MESH.vertices, kind), Producer(MESH.faces, kind)
    assert detector.intersections(vertices, faces).pairs.tolist() == EXPECTED
    assert vertices.calls == faces.calls == [{}]


@pytest.mark.parametrize("kind", [2, 13])
def test_arrays_in_cuda_memory_are_made_ready_on_the_default_stream(detector, kind):
    vertices, faces = Producer(MESH.vertices, kind), Producer(MESH.faces.astype(np.int16), kind)
    with pytest.raises(crumple.InvalidInput, match="^faces in CUDA memory must be"):
        detector.intersections(vertices, faces)
    assert vertices.calls == faces.calls == [{"stream": 1}]


@pytest.mark.parametrize(("kind", "stream"), [(1, {}), (2, {"stream": 1})])
def test_read_only_arrays_are_requested_again_as_versioned_dlpack(detector, kind, stream):
    vertices = Producer(MESH.vertices, kind, [BufferError("read-only")])
    faces = MESH.faces if kind == 1 else Producer(MESH.faces.astype(np.int16))
    if kind == 1:
        assert detector.intersections(vertices, faces).pairs.tolist() == EXPECTED
    else:
        with pytest.raises(crumple.InvalidInput, match="^faces in CUDA memory must be"):
            detector.intersections(vertices, faces)
    first, second = vertices.calls
    assert first == stream and second.pop("max_version") >= (1, 0) and second == stream


@pytest.mark.parametrize(
    ("errors", "told"),
    [
        ([TypeError("no argument 'stream'")], "TypeError: no argument 'stream'"),
        ([ZeroDivisionError("division by zero")], "ZeroDivisionError: division by zero"),
        ([BufferError("read-only"), BufferError("no such stream")], "BufferError: no such stream"),
        ([BufferError("no such stream"), TypeError("no argument 'max_version'")], "BufferError: no such stream"),
    ],
)
def test_errors_of_arrays_in_cuda_memory_name_the_argument(detector, errors, told):
    message = rf"in CUDA memory cannot be read: __dlpack__\(stream=1\), which makes .*, raised {told}$"
    vertices, faces = OnDevice(MESH.vertices), OnDevice(MESH.faces)
    failing = Producer(MESH.vertices, errors=errors)
    with pytest.raises(crumple.InvalidInput, match=f"^vertices {message}") as caught:
        detector.intersections(failing, faces)
    assert caught.value.__cause__ in errors
    assert failing.calls[0] == {"stream": 1} and len(failing.calls) == len(errors)
    with pytest.raises(crumple.InvalidInput, match=f"^second mesh: faces {message}"):
        detector.intersections((vertices, faces), (vertices, Producer(MESH.faces, errors=errors)))
    with pytest.raises(crumple.InvalidInput, match=f"^end vertices {message}"):
        detector.impacts(MESH.vertices, Producer(MESH.vertices, errors=errors), MESH.faces)
    with pytest.raises(crumple.InvalidInput, match=f"^end_poses {message}".replace("=1", "=-1")):
        crumple.World([MESH], end_poses=Producer(np.eye(4)[None, :3], errors=errors), self_collisions=True)


@pytest.mark.parametrize("error", [MemoryError, KeyboardInterrupt])
def test_memory_errors_of_dlpack_stay_memory_errors_and_interrupts_propagate(detector, error):
    raised = error()
    with pytest.raises(error) as caught:
        detector.intersections(Producer(MESH.vertices, errors=[raised]), OnDevice(MESH.faces))
    assert type(caught.value) is error
    assert raised is (caught.value.__cause__ if error is MemoryError else caught.value)


def test_cuda_arrays_without_a_dlpack_device_are_refused(detector):
    silent = Unannounced(MESH.vertices)
    with pytest.raises(crumple.InvalidInput, match="^vertices lie in CUDA memory, but have no __dlpack_device__ that"):
        detector.intersections(silent, MESH.faces)
    assert silent.calls == [{}]


def test_host_arrays_need_no_dlpack_device(detector):
    silent = Unannounced(MESH.vertices)
    silent.place = (1, 0)
    assert detector.intersections(silent, MESH.faces).pairs.tolist() == EXPECTED


def test_error_names_an_unsupported_kind_of_device(detector):
    with pytest.raises(crumple.InvalidInput, match="vertices lie in Metal memory.*copy them to the host"):
        detector.intersections(OnDevice(MESH.vertices, kind=8), MESH.faces)


class Enumerator:
    """Enumerator like those of Open3D: it has a value, but cannot be converted to int."""

    def __init__(self, value):
        self.value = value


def test_dlpack_device_can_be_an_enumerator(detector):
    narrow = MESH.faces.astype(np.int16)
    for kind, memory in (Enumerator(2), "CUDA"), (Enumerator(8), "Metal"):
        with pytest.raises(crumple.InvalidInput, match=f"faces (lie )?in {memory} memory"):
            detector.intersections(MESH.vertices, OnlyPlace(narrow, (kind, 0)))
    assert detector.intersections(MESH.vertices, OnlyPlace(narrow, (Enumerator(1), 0))).pairs.tolist() == EXPECTED


@pytest.mark.parametrize("place", [None, (), ("cpu", 0), (Enumerator(None), 0), ZeroDivisionError])
def test_malformed_dlpack_device_is_refused(place, detector):
    with pytest.raises(crumple.InvalidType, match="^faces cannot be read: __dlpack_device__ failed: "):
        detector.intersections(MESH.vertices, OnlyPlace(MESH.faces, place))


class OnlyPlace:
    """Array that has __dlpack_device__ but no __dlpack__, so that it is read through __array__."""

    def __init__(self, array, place):
        self.array, self.place = array, place

    def __dlpack_device__(self):
        if self.place is ZeroDivisionError:
            raise self.place
        return self.place

    def __array__(self, dtype=None, copy=None):
        return self.array


def test_tensors_of_open3d_are_accepted(detector):
    core = peer("open3d").core
    for index in (np.int16, np.int32, np.uint8):
        faces = MESH.faces[:40].astype(index)
        result = detector.intersections(core.Tensor(MESH.vertices), core.Tensor(faces))
        assert result.pairs.tolist() == [pair for pair in EXPECTED if max(pair) < 40]
    with pytest.raises(crumple.InvalidInput, match="^faces must be integers, not float64$"):
        detector.intersections(core.Tensor(MESH.vertices), core.Tensor(MESH.faces.astype(float)))


@pytest.mark.parametrize("package", ["torch", "jax", "warp"])
def test_arrays_of_torch_jax_and_warp_are_accepted(package, detector):
    module = peer("jax.numpy" if package == "jax" else package)
    if package == "torch":
        arrays = module.from_numpy(MESH.vertices.copy()), module.from_numpy(MESH.faces.copy())
    elif package == "warp":
        module.config.quiet = True
        arrays = module.from_numpy(MESH.vertices, device="cpu"), module.from_numpy(MESH.faces, device="cpu")
    else:
        arrays = module.asarray(MESH.vertices), module.asarray(MESH.faces)
    vertices, faces = arrays
    assert detector.intersections(vertices, faces).pairs.tolist() == EXPECTED
    assert detector.intersections(vertices, faces.flatten()).pairs.tolist() == EXPECTED


@pytest.mark.parametrize("dtype", [np.float16, complex, bool])
def test_a_wrong_dtype_is_a_type_error(dtype):
    with pytest.raises(TypeError, match="vertices must be float32 or float64"):
        crumple.intersections(np.zeros((3, 3), dtype), [[0, 1, 2]]).pairs
    with pytest.raises(TypeError, match="faces must be integers"):
        crumple.intersections(np.zeros((3, 3)), np.zeros((1, 3), float)).pairs
    with pytest.raises(TypeError, match="poses must be float64 or float32"):
        crumple.World([crumple.Mesh(np.zeros((3, 3)), [[0, 1, 2]])], poses=np.zeros((1, 3, 4), np.float16))
