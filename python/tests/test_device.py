"""Arrays in CUDA memory: the cuda backend reads them where they lie and gives the bytes of every other backend.

On a machine without a device `scripts/test_python.sh --cuda` builds the module with the backend that the CPU plays,
whose device memory is the host's.
"""

import ctypes
import os

import numpy as np
import pytest

import crumple
from conftest import OnDevice, soup

ON_CPU = "CRUMPLE_CUDA_ON_CPU" in os.environ


def on_device(array):
    """A contiguous copy in device memory."""
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
    """What "automatic" would choose here is the cuda backend itself."""
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
def test_every_type(cuda, cpu, scalar, index):
    mesh = MESH.vertices.astype(scalar), MESH.faces.astype(index)
    expected = cpu.find_self(*mesh, contacts=True)
    assert len(expected.pairs) > 100
    assert_same(cuda.find_self(mesh_on_device(crumple.Mesh(*mesh)), contacts=True), expected)


@pytest.mark.skipif(ON_CPU, reason="their arrays need a device")
@pytest.mark.parametrize("place", [_cupy, _jax])
def test_other_packages(cuda, cpu, place):
    mesh = crumple.Mesh(*map(place, MESH[:2]))
    assert_same(cuda.find_self(mesh, contacts=True), cpu.find_self(MESH.vertices, MESH.faces, contacts=True))


def test_strides(cuda, cpu):
    columns, rows = on_device(MESH.vertices.T), on_device(np.repeat(MESH.faces, 2, axis=0))
    mesh = (OnDevice(columns.array.T), OnDevice(rows.array[::2])) if ON_CPU else (columns.T, rows[::2])
    assert_same(cuda.find_self(*mesh), cpu.find_self(*MESH[:2]))


@pytest.mark.parametrize("index", [np.int32, np.int64])
def test_flat_faces(cuda, cpu, index):
    flat = MESH.faces.ravel().astype(index)
    assert_same(cuda.find_self(on_device(MESH.vertices), on_device(flat)), cpu.find_self(*MESH[:2]))
    with pytest.raises(crumple.InvalidInput, match=r"^faces in CUDA memory must be \(m, 3\) or \(3m\) of int32"):
        cuda.find_self(on_device(MESH.vertices), on_device(flat[:-1]))


@pytest.mark.parametrize("query", [{}, {"wanted": "between"}, {"weld": True}, {"excluded_groups": [(0, 1)]}])
def test_queries(cuda, cpu, query):
    device = mesh_on_device(MESH)
    assert_same(cuda.find_self(device, **query), cpu.find_self(MESH, **query))
    assert_same(cuda.find_between(device, mesh_on_device(OTHER), **query), cpu.find_between(MESH, OTHER, **query))
    assert cuda.has_intersections(device, **query) == cpu.has_intersections(MESH, **query)


def test_parts(cuda, cpu):
    mesh = mesh_on_device(MESH)
    pairs = [cuda.find(part).pairs for part in cuda.partition(mesh, count=5)]
    joined = np.concatenate(pairs)
    np.testing.assert_array_equal(joined[np.lexsort(joined.T[::-1])], cpu.find_self(MESH).pairs)


def test_errors_name_the_place(cuda):
    vertices, faces = MESH.vertices.copy(), MESH.faces.copy()
    vertices[17, 1] = np.nan
    with pytest.raises(crumple.InvalidInput, match="vertex 17 is not finite"):
        cuda.find_self(on_device(vertices), on_device(faces))
    faces[4, 2] = 90_000
    with pytest.raises(crumple.InvalidInput, match="triangle 4 names vertex 90000 of 900"):
        cuda.find_self(on_device(MESH.vertices), on_device(faces))


def test_another_device_is_refused(cuda):
    mesh = OnDevice(MESH.vertices, 7), OnDevice(MESH.faces, 7)
    with pytest.raises(
        crumple.InvalidInput, match="in the memory of CUDA device 7, but the detector works on device 0"
    ):
        cuda.find_self(*mesh)


def test_both_meshes_lie_in_one_place(cuda):
    with pytest.raises(crumple.InvalidInput, match="the second mesh lies in host memory, the other one in device"):
        cuda.find_between(mesh_on_device(MESH), OTHER)


def test_files_and_pictures_want_the_host(cuda, tmp_path):
    result = cuda.find_self(mesh_on_device(MESH))
    for name in ("mesh.ply", "mesh.obj", "mesh.glb", "mesh.html"):
        with pytest.raises(crumple.InvalidInput, match="vertices lie in CUDA memory, but are wanted in the host's"):
            result.save(tmp_path / name)
    with pytest.raises(crumple.InvalidInput, match="vertices lie in CUDA memory, but are wanted in the host's"):
        crumple.write_mesh(tmp_path / "mesh.ply", mesh_on_device(MESH))
    result.save(tmp_path / "pairs.csv")
    assert len(crumple.read_pairs(tmp_path / "pairs.csv")) == len(result)


def test_devices_are_listed(cuda):
    devices, reason = crumple.list_devices()
    assert devices[0].number == 0 and devices[0].name and devices[0].memory_bytes > 0 and reason == ""
    assert cuda.fallback == ""


def test_arrays_in_host_memory_are_brought_there(cuda, cpu):
    assert cuda.backend == "cuda" and cpu.backend == "cpu"
    assert_same(cuda.find_self(MESH), cpu.find_self(MESH))


BALL = soup(60, size=0.5, seed=4)


def worlds_of(count, scalar):
    """Bodies of two shapes, two a world, and one that is in all."""
    poses = np.tile(np.eye(3, 4), (2 * count + 1, 1, 1))
    poses[:, :, 3] = np.random.default_rng(7).uniform(-0.5, 0.5, (2 * count + 1, 3))
    worlds = np.append(np.repeat(np.arange(count), 2), -1)
    shapes = [crumple.Shape(BALL.vertices, BALL.faces, name="ball of test_device"), crumple.Shape(*OTHER[:2])]
    bodies = np.append(np.tile([0, 1], count), 0)
    return crumple.World(shapes, bodies, worlds=worlds, self_collisions=False), poses.astype(scalar)


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
@pytest.mark.parametrize(
    ("wants", "told"),
    [
        ("any", ["any"]),
        ("any_by_world", ["world_hit"]),
        ("body_pairs", ["world_hit", "bodies"]),
        ("count", ["count", "world_counts"]),
        ("pairs", ["world_counts", "bodies", "pairs"]),
        ("contacts", ["bodies", "pairs"]),
    ],
)
def test_poses_of_worlds(cuda, cpu, scalar, wants, told):
    world, poses = worlds_of(5, scalar)
    expected = cpu.find(world, poses=poses, wants=wants)
    for _ in range(2):
        found = cuda.find(world, poses=on_device(poses), wants=wants)
        for name in told:
            np.testing.assert_array_equal(getattr(found, name), getattr(expected, name))
    world.poses = on_device(poses)
    assert cuda.find(world, wants="count").count == cpu.find(world, wants="count", poses=poses).count > 0


def test_poses_that_are_refused(cuda, cpu):
    world, poses = worlds_of(2, np.float64)
    there = on_device(poses)
    with pytest.raises(crumple.InvalidInput, match="lie in CUDA memory, which needs the cuda backend"):
        cpu.find(world, poses=there)
    with pytest.raises(crumple.InvalidInput, match=r"^poses lie in CUDA memory, where Detector\.find reads them"):
        cuda.find_near(world, radius=0.1, poses=there)
    four = np.tile(np.eye(4), (5, 1, 1))
    with pytest.raises(crumple.InvalidInput, match=r"^poses in CUDA memory must be \(n, 3, 4\)"):
        cuda.find(world, poses=on_device(four))
    poses[3, 1, 2] = np.inf
    with pytest.raises(crumple.InvalidInput, match="^body 3: its pose is not finite"):
        cuda.find(world, poses=on_device(poses))
