"""Tests of arrays in CUDA memory, which the cuda backend reads in place. Results must equal those of the cpu backend.

On a machine without a device, `scripts/test_python.sh --cuda` builds the module with a device that the CPU emulates.
The memory of that device is host memory.
"""

import ctypes
import gc
import os
import weakref

import numpy as np
import pytest

import crumple
import features
from conftest import OnDevice, soup

ON_CPU = "CRUMPLE_CUDA_ON_CPU" in os.environ


def on_device(array):
    """Returns a contiguous copy of an array in device memory."""
    if ON_CPU:
        allocate = ctypes.CDLL(crumple._core.__file__).crumple_test_device_memory
        allocate.restype, allocate.argtypes = ctypes.c_void_p, [ctypes.c_size_t]
        memory = (ctypes.c_byte * max(array.nbytes, 1)).from_address(allocate(max(array.nbytes, 1)))
        copy = np.frombuffer(memory, array.dtype, array.size).reshape(array.shape)
        copy[...] = array
        return OnDevice(copy)
    torch = pytest.importorskip("torch", reason="arrays on a device are PyTorch's")
    return torch.from_numpy(np.ascontiguousarray(array)).cuda()


def _cupy(array):
    return pytest.importorskip("cupy").asarray(array)


def _jax(array):
    jax = pytest.importorskip("jax")
    if not any(device.platform in ("gpu", "cuda") for device in jax.devices()):
        pytest.skip("JAX sees no device")
    return jax.device_put(array)


def mesh_on_device(mesh):
    return crumple.Mesh(*(None if array is None else on_device(array) for array in mesh))


@pytest.fixture(scope="module")
def cuda():
    try:
        return crumple.Detector(backend="cuda")
    except crumple.BackendUnavailable as error:
        pytest.skip(str(error))


@pytest.fixture
def cpu():
    """Detector of the cpu backend, for expected results: "automatic" would choose the cuda backend."""
    return crumple.Detector(backend="cpu")


MESH = soup(300, size=0.4)._replace(groups=np.arange(300, dtype=np.int32) % 4)
OTHER = soup(200, size=0.4, seed=2)


def assert_same(found, expected):
    np.testing.assert_array_equal(found.pairs, expected.pairs)
    np.testing.assert_array_equal(found.offsets, expected.offsets)
    np.testing.assert_array_equal(found.hit, expected.hit)
    if expected.contacts is not None:
        assert found.contacts.points.tobytes() == expected.contacts.points.tobytes()


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
@pytest.mark.parametrize("index", [np.int32, np.uint32, np.int64])
def test_intersections_of_device_arrays_of_several_types_match_the_cpu(cuda, cpu, scalar, index):
    mesh = MESH.vertices.astype(scalar), MESH.faces.astype(index)
    expected = cpu.intersections(*mesh, output="contacts")
    assert len(expected.pairs) > 100
    assert_same(cuda.intersections(mesh_on_device(crumple.Mesh(*mesh)), output="contacts"), expected)


def test_option_devices_accepts_a_list_of_one_device(cuda, cpu):
    """A list of one device works like the option `device`. C++ tests cover several devices, on emulated ones."""
    listed = crumple.Detector(backend="cuda", devices=[0])
    assert_same(listed.intersections(MESH), cpu.intersections(MESH))
    with pytest.raises(crumple.InvalidInput, match="all different"):
        crumple.Detector(backend="cuda", devices=(0, 0))
    with pytest.raises(TypeError, match="devices must be a sequence of integers"):
        crumple.Detector(backend="cuda", devices=1)
    with pytest.raises(TypeError, match="devices"):
        crumple.Detector(backend="cuda", devices=[0.5])


@pytest.mark.skipif(ON_CPU, reason="their arrays need a device")
@pytest.mark.parametrize("place", [_cupy, _jax])
def test_intersections_of_cupy_and_jax_arrays_match_the_cpu(cuda, cpu, place):
    mesh = crumple.Mesh(*map(place, MESH[:2]))
    assert_same(cuda.intersections(mesh, output="contacts"), cpu.intersections(*MESH[:2], output="contacts"))


def test_intersections_of_strided_device_arrays_match_the_cpu(cuda, cpu):
    columns, rows = on_device(MESH.vertices.T), on_device(np.repeat(MESH.faces, 2, axis=0))
    mesh = (OnDevice(columns.array.T), OnDevice(rows.array[::2])) if ON_CPU else (columns.T, rows[::2])
    assert_same(cuda.intersections(*mesh), cpu.intersections(*MESH[:2]))


@pytest.mark.parametrize("index", [np.int32, np.int64])
def test_faces_can_be_flat(cuda, cpu, index):
    flat = MESH.faces.ravel().astype(index)
    assert_same(cuda.intersections(on_device(MESH.vertices), on_device(flat)), cpu.intersections(*MESH[:2]))
    with pytest.raises(crumple.InvalidInput, match=r"^faces in CUDA memory must be \(m, 3\) or \(3m\) of int32"):
        cuda.intersections(on_device(MESH.vertices), on_device(flat[:-1]))


@pytest.mark.parametrize(
    "query",
    [
        crumple.IntersectionQuery(),
        crumple.IntersectionQuery(filter=crumple.PairFilter(groups="between")),
        crumple.IntersectionQuery(weld=True),
        crumple.IntersectionQuery(filter=crumple.PairFilter(excluded_groups=[(0, 1)])),
    ],
)
def test_intersection_queries_match_the_cpu(cuda, cpu, query):
    mesh, two = mesh_on_device(MESH), [mesh_on_device(MESH), mesh_on_device(OTHER)]
    assert_same(cuda.find(mesh, query), cpu.find(MESH, query))
    assert_same(cuda.find(two, query), cpu.find([MESH, OTHER], query))
    assert cuda.any(mesh, query) == cpu.any(MESH, query)
    assert cuda.any(two, query) == cpu.any([MESH, OTHER], query)


def test_parts_together_find_the_pairs_of_the_mesh(cuda, cpu):
    mesh = mesh_on_device(MESH)
    pairs = [cuda.find(part).pairs for part in cuda.partition(mesh, count=5)]
    joined = np.concatenate(pairs)
    np.testing.assert_array_equal(joined[np.lexsort(joined.T[::-1])], cpu.intersections(MESH).pairs)


def test_error_names_the_invalid_vertex_or_triangle(cuda):
    vertices, faces = MESH.vertices.copy(), MESH.faces.copy()
    vertices[17, 1] = np.nan
    with pytest.raises(crumple.InvalidInput, match="vertex 17 is not finite"):
        cuda.intersections(on_device(vertices), on_device(faces))
    faces[4, 2] = 90_000
    with pytest.raises(crumple.InvalidInput, match="triangle 4 names vertex 90000 of 900"):
        cuda.intersections(on_device(MESH.vertices), on_device(faces))


def test_arrays_on_another_device_are_refused(cuda):
    mesh = OnDevice(MESH.vertices, 7), OnDevice(MESH.faces, 7)
    with pytest.raises(
        crumple.InvalidInput, match="in the memory of CUDA device 7, but the detector works on device 0"
    ):
        cuda.intersections(*mesh)


def test_intersections_of_a_host_mesh_and_a_device_mesh_are_refused(cuda):
    for meshes, memory in (
        ([mesh_on_device(MESH), OTHER], "device memory, like the first mesh"),
        ([OTHER, mesh_on_device(MESH)], "host memory, not in device memory"),
    ):
        with pytest.raises(crumple.InvalidInput, match=f"^the second mesh must be in {memory}$"):
            cuda.intersections(*meshes)


def test_pairs_can_be_saved_but_device_meshes_cannot(cuda, tmp_path):
    result = cuda.intersections(mesh_on_device(MESH))
    for name in ("mesh.ply", "mesh.obj", "mesh.glb", "mesh.html"):
        with pytest.raises(crumple.InvalidInput, match="vertices lie in CUDA memory, but must be in host memory"):
            result.save(tmp_path / name)
    with pytest.raises(crumple.InvalidInput, match="vertices lie in CUDA memory, but must be in host memory"):
        crumple.write_mesh(tmp_path / "mesh.ply", mesh_on_device(MESH))
    result.save(tmp_path / "pairs.csv")
    assert len(crumple.read_pairs(tmp_path / "pairs.csv")) == len(result)


def test_first_device_is_listed_with_name_and_memory(cuda):
    devices, reason = crumple.list_devices()
    assert devices[0].number == 0 and devices[0].name and devices[0].memory_bytes > 0 and reason == ""
    assert cuda.fallback == ""


def test_host_arrays_give_the_same_pairs_on_the_device(cuda, cpu):
    assert cuda.backend == "cuda" and cpu.backend == "cpu"
    assert_same(cuda.intersections(MESH), cpu.intersections(MESH))


STEP = crumple.make_scene("cloth", triangles=300, frame=88), crumple.make_scene("cloth", triangles=300, frame=89)
START, END, FACES = STEP[0].vertices, STEP[1].vertices, np.asarray(STEP[0].faces, np.int32)


def to_host(array):
    """Returns the contents of a crumple.DeviceArray, read through the interface that CuPy, Numba and Warp use."""
    told = array.__cuda_array_interface__
    assert array.__dlpack_device__()[0] == 2 and told["shape"] == array.shape and told["version"] == 3
    if not ON_CPU:
        torch = pytest.importorskip("torch")
        return torch.from_dlpack(array).cpu().numpy()
    size = int(np.prod(array.shape)) * np.dtype(told["typestr"]).itemsize
    if size == 0:
        return np.empty(array.shape, told["typestr"])
    memory = (ctypes.c_byte * size).from_address(told["data"][0])
    return np.frombuffer(memory, told["typestr"]).reshape(array.shape).copy()


def assert_shows(there, expected, names):
    assert there.complete
    for name in names:
        np.testing.assert_array_equal(to_host(getattr(there, name)), getattr(expected, name), name)


IMPACTS = [f"{kind}{what}" for kind in ("vertex_face", "edge_edge") for what in ("s", "_toi", "_start")] + ["edges"]
NEAR = [f"{kind}{what}" for kind in ("vertex_face", "edge_edge") for what in ("s", "_squared_distance", "_touching")]


def test_feature_queries_of_device_arrays_match_the_cpu(cuda, cpu):
    start, end, faces = map(on_device, (START, END, FACES))
    radii = np.linspace(0, 0.1, len(START))
    edges, points = np.array([[0, 5], [7, 3]], np.int32), np.array([1, 9, 9], np.int32)
    for asked in ({"min_distance": 0.05}, {"weld": True}, {"triangle_pairs": True}):
        found, expected = cuda.impacts(start, end, faces, **asked), cpu.impacts(START, END, FACES, **asked)
        for name in IMPACTS + (features.TRIANGLES[:3] if "triangle_pairs" in asked else []):
            np.testing.assert_array_equal(getattr(found, name), getattr(expected, name), name)
    found = cuda.proximities(start, faces, radii=on_device(radii), rest=end, rest_radius=0.01)
    expected = cpu.proximities(START, FACES, radii=radii, rest=END, rest_radius=0.01)
    assert len(expected) > 0
    for name in NEAR:
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name))
    there = {"edges": on_device(edges), "points": on_device(points)}
    found = cuda.candidates(start, faces, end=end, kinds="vertex_edge", **there)
    expected = cpu.candidates(START, FACES, end=END, edges=edges, points=points, kinds="vertex_edge")
    np.testing.assert_array_equal(found.vertex_edges, expected.vertex_edges)
    assert cuda.first_impact(start, end, faces) == cpu.first_impact(START, END, FACES)
    assert cuda.free_step(start, end, faces).share == cpu.free_step(START, END, FACES).share


def test_end_radii_and_points_on_the_host_are_refused_for_a_device_mesh(cuda):
    start, end, faces = map(on_device, (START, END, FACES))
    with pytest.raises(crumple.InvalidInput, match="^end vertices lie in host memory, but vertices in"):
        cuda.impacts(start, END, faces)
    with pytest.raises(crumple.InvalidInput, match="^radii lie in host memory"):
        cuda.proximities(start, faces, radii=np.zeros(len(START)))
    with pytest.raises(crumple.InvalidInput, match="^points lie in host memory"):
        cuda.proximities(start, faces, points=[0], radius=1)
    with pytest.raises(crumple.InvalidInput, match=r"^edges in CUDA memory must be \(k, 2\) of int32 without gaps"):
        cuda.proximities(start, faces, edges=on_device(np.zeros((2, 2))), radius=1)
    with pytest.raises(crumple.InvalidInput, match="which needs the cuda backend"):
        crumple.Detector(backend="cpu").impacts(start, end, faces)


def test_results_of_launches_match_the_cpu(cuda, cpu):
    start, end, faces = map(on_device, (START, END, FACES))
    mesh = crumple.Mesh(start, faces)
    for _ in range(3):
        step = cuda.launch(mesh.moving_to(end), crumple.ImpactQuery(min_distance=0.05))
        near = cuda.launch(mesh, crumple.ProximityQuery(radius=0.1))
        impacts, expected = step.wait(), cpu.impacts(START, END, FACES, min_distance=0.05)
        assert_shows(impacts, expected, IMPACTS)
        assert impacts.any == expected.any and impacts.first == expected.first and impacts.count == len(expected) > 0
        assert_shows(near.wait(), cpu.proximities(START, FACES, radius=0.1), NEAR)
        candidates = crumple.CandidateQuery(kinds=["vertex_face", "face_face"])
        expected = cpu.find(crumple.Mesh(START, FACES).moving_to(END), candidates)
        assert_shows(cuda.launch(mesh.moving_to(end), candidates).wait(), expected, ["vertex_faces", "face_faces"])
        found = cuda.launch(mesh, crumple.IntersectionQuery(output="contacts")).wait()
        expected = cpu.intersections(START, FACES, output="contacts")
        assert_shows(found, expected, ["pairs", "offsets", "hit"])
        np.testing.assert_array_equal(to_host(found.contact_points), expected.contacts.points)
        two = cuda.launch([mesh_on_device(MESH), mesh_on_device(OTHER)]).wait()
        assert_shows(two, cpu.intersections(MESH, OTHER), ["pairs", "offsets", "hit", "hit_second"])
    assert "rows" in repr(found) and "pairs" in dir(found) and found.statistics.backend == "cuda"
    with pytest.raises(AttributeError, match="DeviceResult has no pear; it has complete"):
        found.pear


def test_launch_keeps_its_arrays_alive(cuda, cpu):
    """The detector keeps the arrays of a launch alive, even if the caller drops them."""
    arrays = [on_device(array) for array in (START, FACES, END)]
    mesh = crumple.Mesh(*arrays[:2]).moving_to(arrays[2])
    memory = [weakref.ref(array.array) for array in arrays] if ON_CPU else []
    launched = cuda.launch(mesh, crumple.ImpactQuery())
    del arrays, mesh
    gc.collect()
    assert all(of() is not None for of in memory)
    assert_shows(launched.wait(), cpu.impacts(START, END, FACES), IMPACTS)


class Producer:
    """Array in device memory that records the arguments of each call of its __dlpack__."""

    def __init__(self, array):
        self.array, self.calls = on_device(array), []

    def __dlpack_device__(self):
        return self.array.__dlpack_device__()

    def __dlpack__(self, **named):
        self.calls.append(named)
        return self.array.__dlpack__(**named)


def assert_each_was_ready_once(producers, stream):
    assert [producer.calls for producer in producers] == [[{"stream": stream}]] * len(producers)


RADII, EDGES, POINTS = np.linspace(0.01, 0.1, len(START)), np.array([[0, 5]], np.int32), np.array([1], np.int32)


@pytest.mark.parametrize(
    ("given", "search"),
    [
        (MESH, lambda cuda, v, f, g: cuda.intersections(v, f, groups=g)),
        (MESH, lambda cuda, v, f, g: cuda.any(crumple.Mesh(v, f, g))),
        (MESH, lambda cuda, v, f, g: cuda.partition(crumple.Mesh(v, f, g), count=2)),
        ((*MESH[:2], *OTHER[:2]), lambda cuda, v, f, w, g: cuda.intersections((v, f), (w, g))),
        ((START, END, FACES), lambda cuda, v, w, f: cuda.impacts(v, w, f)),
        ((START, END, FACES), lambda cuda, v, w, f: cuda.first_impact(v, w, f)),
        ((START, END, FACES), lambda cuda, v, w, f: cuda.free_step(v, w, f)),
        (
            (START, FACES, RADII, END),
            lambda cuda, v, f, r, w: cuda.proximities(v, f, radii=r, rest=w, rest_radius=0.01),
        ),
        (
            (START, FACES, END, EDGES, POINTS),
            lambda cuda, v, f, w, e, p: cuda.candidates(v, f, end=w, edges=e, points=p, kinds="vertex_edge"),
        ),
    ],
)
def test_searches_make_arrays_ready_once_on_the_default_stream(cuda, given, search):
    producers = [Producer(array) for array in given]
    search(cuda, *producers)
    assert_each_was_ready_once(producers, 1)


class PyTorchStream:
    def __init__(self, address):
        self.cuda_stream = address


class CuPyStream:
    def __init__(self, address):
        self.ptr = address


# Streams in the forms that launches accept, and the numbers that DLPack has for them: 1 is the legacy default stream, 2
# the per-thread default stream, which PyTorch does not have.
STREAMS = [(None, 1), (0, 1), (1, 1), (PyTorchStream(0), 1), (CuPyStream(1), 1)]
STREAMS += [(2, 2), (PyTorchStream(2), 2), (CuPyStream(2), 2)] if ON_CPU else []


@pytest.mark.parametrize(("stream", "number"), STREAMS)
def test_launches_make_arrays_ready_once_on_their_stream(cuda, cpu, stream, number):
    vertices, end, faces, radii, rest, edges, points = producers = [
        Producer(array) for array in (START, END, FACES, RADII, END, EDGES, POINTS)
    ]

    def launched(used, scene, query):
        """Launches a query and returns its result. Checks that the launch called each producer in `used` once."""
        for producer in producers:
            producer.calls.clear()
        launch = cuda.launch(scene, query, stream=stream)
        assert_each_was_ready_once(used, number)
        return launch.wait()

    mesh = crumple.Mesh(vertices, faces)
    found = launched([vertices, faces], mesh, crumple.IntersectionQuery())
    assert_shows(found, cpu.intersections(START, FACES), ["pairs"])
    found = launched([vertices, end, faces], mesh.moving_to(end), crumple.ImpactQuery())
    assert_shows(found, cpu.impacts(START, END, FACES), IMPACTS)
    query = crumple.ProximityQuery(radii=radii, rest=rest, rest_radius=0.01)
    found = launched([vertices, faces, radii, rest], mesh, query)
    assert_shows(found, cpu.proximities(START, FACES, radii=RADII, rest=END, rest_radius=0.01), NEAR)
    step = crumple.Mesh(vertices, faces, end=end, edges=edges, points=points)
    found = launched([vertices, faces, end, edges, points], step, crumple.CandidateQuery(kinds="vertex_edge"))
    expected = cpu.candidates(START, FACES, end=END, edges=EDGES, points=POINTS, kinds="vertex_edge")
    assert_shows(found, expected, ["vertex_edges"])


@pytest.mark.parametrize(("stream", "number"), STREAMS)
def test_launch_of_two_meshes_makes_their_arrays_ready_once_on_its_stream(cuda, cpu, stream, number):
    producers = [Producer(array) for array in (*MESH, *OTHER[:2])]
    launched = cuda.launch([crumple.Mesh(*producers[:3]), crumple.Mesh(*producers[3:])], stream=stream)
    assert_each_was_ready_once(producers, number)
    assert_shows(launched.wait(), cpu.intersections(MESH, OTHER), ["pairs"])


@pytest.mark.skipif(not ON_CPU, reason="PyTorch, which made the arrays, follows the address")
def test_stream_with_a_huge_address_is_passed_to_dlpack(cuda):
    address = 2**64 - 16
    producers = [Producer(array) for array in (START, FACES)]
    with pytest.raises(crumple.Error):  # no stream has this address
        cuda.launch(crumple.Mesh(*producers), stream=address)
    assert_each_was_ready_once(producers, address)


@pytest.mark.skipif(ON_CPU, reason="PyTorch has no device")
def test_launches_and_searches_wait_for_writes_on_a_pytorch_stream(cuda, cpu):
    torch = pytest.importorskip("torch")
    start, end, faces = map(on_device, (START, END, FACES))
    mesh, late, stream = crumple.Mesh(start, faces), torch.zeros_like(end), torch.cuda.Stream()
    expected = cpu.impacts(START, END, FACES)
    for launch_on in (stream, None):
        late.zero_()
        torch.cuda.synchronize()
        with torch.cuda.stream(stream):
            torch.cuda._sleep(50_000_000)
            late.copy_(end)
            launched = cuda.launch(mesh.moving_to(late), crumple.ImpactQuery(), stream=launch_on)
        assert_shows(launched.wait(), expected, IMPACTS)
    late.zero_()
    torch.cuda.synchronize()
    with torch.cuda.stream(stream):
        torch.cuda._sleep(50_000_000)
        late.copy_(end)
        found = cuda.impacts(start, late, faces)
    for name in IMPACTS:
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name))


def test_arrays_of_an_incomplete_result_are_refused(cuda):
    found = crumple.DeviceResult(cuda, (False, 5, 0, False, None), {}, crumple.Statistics)
    assert not found.complete and found.needed == 5 and "not complete" in repr(found)
    with pytest.raises(crumple.InvalidInput, match="edge_edges: the result is not complete; call launch outside"):
        found.edge_edges


def test_invalid_launches_and_waits_are_refused(cuda):
    start, end, faces = map(on_device, (START, END, FACES))
    mesh = crumple.Mesh(start, faces)
    with pytest.raises(crumple.InvalidType, match="stream must be None, an address, or a stream"):
        cuda.launch(mesh, stream="0")
    with pytest.raises(crumple.InvalidInput, match="launches need meshes in device memory"):
        cuda.launch((START, FACES), crumple.ProximityQuery(radius=1))
    with pytest.raises(crumple.InvalidInput, match="launch does not support DistanceQuery"):
        cuda.launch(mesh, crumple.DistanceQuery())
    with pytest.raises(TypeError, match="Did you mean 'stream'"):
        cuda.launch(mesh, steam=None)
    moving = mesh.moving_to(end)
    launched = cuda.launch(moving, crumple.ImpactQuery(), stream=0)
    launched.wait()
    with pytest.raises(crumple.InvalidInput, match="has already been called for this launch"):
        launched.wait()
    broken = START.copy()
    broken[7, 1] = np.nan
    launched = cuda.launch(crumple.Mesh(on_device(broken), faces).moving_to(end), crumple.ImpactQuery())
    with pytest.raises(crumple.InvalidInput, match="vertex 7 is not finite"):
        launched.wait()
    older, newer = cuda.launch(moving, crumple.ImpactQuery(), stream=0), cuda.launch(moving, crumple.ImpactQuery())
    with pytest.raises(crumple.InvalidInput, match="an older launch is in flight"):
        newer.wait()
    with pytest.raises(crumple.InvalidInput, match="two launches are in flight"):
        cuda.launch(mesh)
    older.wait()
    with pytest.raises(crumple.InvalidInput, match="another call of the detector came after this launch"):
        older.wait()
    newer.wait()
    launched = cuda.launch(mesh)
    cuda.intersections(mesh)
    with pytest.raises(crumple.InvalidInput, match="another call of the detector came after this launch"):
        launched.wait()


BALL = soup(60, size=0.5, seed=4)


def worlds_of(count, scalar):
    """Returns a world, and poses: `count` worlds of two bodies, and one body that is in all of them."""
    poses = np.tile(np.eye(3, 4), (2 * count + 1, 1, 1))
    poses[:, :, 3] = np.random.default_rng(7).uniform(-0.5, 0.5, (2 * count + 1, 3))
    worlds = np.append(np.repeat(np.arange(count), 2), -1)
    shapes = [crumple.Shape(BALL.vertices, BALL.faces, name="ball of test_device"), crumple.Shape(*OTHER[:2])]
    bodies = np.append(np.tile([0, 1], count), 0)
    return crumple.World(shapes, bodies, worlds=worlds, self_collisions=False), poses.astype(scalar)


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
@pytest.mark.parametrize(
    ("output", "names"),
    [
        ("any", ["any"]),
        ("any_by_world", ["world_hit"]),
        ("body_pairs", ["world_hit", "bodies"]),
        ("count", ["count", "world_counts"]),
        ("pairs", ["world_counts", "bodies", "pairs"]),
        ("contacts", ["bodies", "pairs"]),
    ],
)
def test_intersections_of_worlds_with_device_poses_match_the_cpu(cuda, cpu, scalar, output, names):
    world, poses = worlds_of(5, scalar)
    query = crumple.IntersectionQuery(output=output)
    expected = cpu.find(world.at(poses), query)
    for _ in range(2):
        found = cuda.find(world.at(on_device(poses)), query)
        for name in names:
            np.testing.assert_array_equal(getattr(found, name), getattr(expected, name))
        if output == "contacts":
            assert found.contacts.points.tobytes() == expected.contacts.points.tobytes()
    counts = crumple.IntersectionQuery(output="count")
    world.poses = on_device(poses)
    assert cuda.find(world, counts).count == cpu.find(world.at(poses), counts).count > 0


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
def test_launches_of_worlds_match_the_cpu(cuda, cpu, scalar):
    world, poses = worlds_of(5, scalar)
    there = world.at(on_device(poses))
    for output, arrays in (
        ("any_by_world", ["world_hit"]),
        ("count", ["world_hit", "world_counts"]),
        ("pairs", ["world_hit", "world_counts", "bodies", "pairs"]),
    ):
        query = crumple.IntersectionQuery(output=output)
        expected = cpu.find(world.at(poses), query)
        for _ in range(2):
            found = cuda.launch(there, query).wait()
            assert_shows(found, expected, arrays)
            assert found.any == expected.any
    assert isinstance(cuda.launch(there).wait(), crumple.DeviceResult)
    with pytest.raises(crumple.InvalidInput, match="^launches of worlds need poses in device memory"):
        cuda.launch(world.at(poses))


def test_searches_make_poses_ready_once_on_the_default_stream(cuda):
    world, poses = worlds_of(3, np.float64)
    start, end = Producer(poses), Producer(poses)
    posed, moving = world.at(start), world.at(start, end)
    for search, producers in (
        (lambda: cuda.intersections(posed), [start]),
        (lambda: cuda.impacts(moving), [start, end]),
        (lambda: cuda.proximities(posed, radius=0.1), [start]),
        (lambda: cuda.candidates(moving), [start, end]),
    ):
        for producer in producers:
            producer.calls.clear()
        search()
        assert_each_was_ready_once(producers, 1)


def test_each_search_makes_the_poses_of_a_world_ready_anew(cuda):
    """Each search makes the poses ready anew, because they may be written to between searches, on any stream."""
    world, poses = worlds_of(3, np.float64)
    world.poses = producer = Producer(poses)
    assert producer.calls == [{"stream": -1}], "only its shape is read"
    for _ in range(2):
        producer.calls.clear()
        cuda.find(world)
        assert_each_was_ready_once([producer], 1)


@pytest.mark.parametrize(("stream", "number"), STREAMS)
def test_launches_of_worlds_make_poses_ready_once_on_their_stream(cuda, cpu, stream, number):
    world, poses = worlds_of(3, np.float64)
    expected = cpu.intersections(world.at(poses))
    world.poses = own = Producer(poses)
    other = Producer(poses)
    for producer, scene in ((own, world), (other, world.at(other))):
        producer.calls.clear()
        launched = cuda.launch(scene, stream=stream)
        assert_each_was_ready_once([producer], number)
        assert_shows(launched.wait(), expected, ["pairs"])


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
def test_feature_queries_with_device_poses_match_the_cpu(cuda, cpu, scalar):
    world, poses = worlds_of(5, scalar)
    ends = poses.copy()
    ends[:, :, 3] += np.random.default_rng(8).uniform(-0.3, 0.3, (len(ends), 3))
    start, end = on_device(poses), on_device(ends)
    expected = cpu.impacts(world.at(poses, ends))
    assert expected.count > 0
    features.assert_same(cuda.impacts(world.at(start, end)), expected, features.BODIES)
    near = cpu.proximities(world.at(poses), radius=0.2)
    assert near.count > 0
    features.assert_same(cuda.proximities(world.at(start), radius=0.2), near, features.BODIES)
    found = cuda.candidates(world.at(start, end), kinds="edge_edge")
    candidates = cpu.candidates(world.at(poses, ends), kinds="edge_edge")
    for name in ("edge_edges", "edge_edge_bodies"):
        np.testing.assert_array_equal(getattr(found, name), getattr(candidates, name), name)


def test_invalid_device_poses_are_refused(cuda, cpu):
    world, poses = worlds_of(2, np.float64)
    there = on_device(poses)
    with pytest.raises(crumple.InvalidInput, match="lie in CUDA memory, which needs the cuda backend"):
        cpu.intersections(world.at(there))
    with pytest.raises(crumple.InvalidInput, match="^poses must be in device memory or in host memory, not in both"):
        cuda.impacts(world.at(there, poses))
    with pytest.raises(crumple.InvalidInput, match="^poses at the start must be in device memory, like those"):
        cuda.impacts(world.at(None, there))
    four = np.tile(np.eye(4), (5, 1, 1))
    with pytest.raises(crumple.InvalidInput, match=r"^poses in CUDA memory must be \(n, 3, 4\)"):
        cuda.intersections(world.at(on_device(four)))
    poses[3, 1, 2] = np.inf
    with pytest.raises(crumple.InvalidInput, match="^body 3: its pose is not finite"):
        cuda.intersections(world.at(on_device(poses)))
