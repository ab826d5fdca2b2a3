"""Scenes distributed over MPI ranks, and checks that each rank gets its own rows of a result."""

import sys

import numpy as np
from mpi4py import MPI

import crumple
import crumple.mpi
from conftest import soup

COMM = MPI.COMM_WORLD
ONE = {"backend": "cpu", "threads": 1}


class RankMesh(crumple.mpi.LocalMesh):
    """Local mesh of a rank: the faces of a mesh that belong to this rank, with their vertices.

    Args:
        whole: the mesh of all ranks.
        ranks: (m,) the rank of each face.
        rank: this rank.
    """

    def __init__(self, whole, ranks, rank=COMM.rank):
        self.whole = whole
        triangle_ids = np.flatnonzero(ranks == rank)
        vertex_ids, faces = np.unique(np.asarray(whole.faces).reshape(-1, 3)[triangle_ids], return_inverse=True)
        if rank == 0:  # rank 0 also gets the vertices without a face
            vertex_ids = np.append(vertex_ids, np.setdiff1d(np.arange(len(whole.vertices)), whole.faces))
        vertices, end, groups = (
            None if array is None else np.asarray(array)[ids]
            for array, ids in ((whole.vertices, vertex_ids), (whole.end, vertex_ids), (whole.groups, triangle_ids))
        )
        mesh = crumple.Mesh(vertices, faces.reshape(-1, 3).astype(np.int32), groups, end=end)
        super().__init__(mesh, triangle_ids, vertex_ids)

    @property
    def ids(self):
        """Ids of triangles and vertices, as keyword arguments."""
        return {"triangle_ids": self.triangle_ids, "vertex_ids": self.vertex_ids}


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


def check_rows(found, local, expected):
    """Checks that `found` has those rows of the whole result `expected` whose first triangle belongs to this rank."""
    mine = np.isin(expected.pairs[:, 0], local.triangle_ids)
    assert found.pairs.dtype == np.int32 and not (len(found) and found.pairs.flags.writeable)
    np.testing.assert_array_equal(found.pairs, expected.pairs[mine])
    assert len(found) == mine.sum() and found.count == len(expected)
    assert found.any == bool(found) == expected.any
    assert (found.contacts is None) == (expected.contacts is None)
    if expected.contacts is not None:
        np.testing.assert_array_equal(found.contacts.kinds, expected.contacts.kinds[mine])
        assert len(found.contacts) == mine.sum()
        for points, row in zip(found.contacts, np.flatnonzero(mine)):
            assert points.tobytes() == expected.contacts[row].tobytes()


def lowest_triangles(faces, corners):
    """Returns, for each vertex (`corners` 1) or each edge (`corners` 2, as two vertices), its lowest face."""
    lowest = {}
    for triangle, face in enumerate(np.asarray(faces).reshape(-1, 3).tolist()):
        names = face if corners == 1 else [tuple(sorted((face[k], face[k - 1]))) for k in range(3)]
        for name in names:
            lowest.setdefault(name, triangle)
    return lowest


def check_features(found, local, expected, columns):
    """Checks that `found` has those rows of `expected` whose first feature belongs to a triangle of this rank."""
    vertices, edges = (lowest_triangles(local.whole.faces, corners) for corners in (1, 2))
    ends = [tuple(edge) for edge in expected.edges.tolist()]
    owners = {
        "vertex_face": [vertices[v] for v in expected.vertex_faces[:, 0].tolist()],
        "edge_edge": [edges[ends[e]] for e in expected.edge_edges[:, 0].tolist()],
    }
    for kind, triangles in owners.items():
        mine = np.isin(triangles, local.triangle_ids) if triangles else np.zeros(0, bool)
        for name in (kind + "s", *(f"{kind}_{column}" for column in columns)):
            rows, all_rows = getattr(found, name), getattr(expected, name)
            assert rows.dtype == all_rows.dtype and not (len(rows) and rows.flags.writeable), name
            assert rows.tobytes() == np.ascontiguousarray(all_rows[mine]).tobytes(), name
    np.testing.assert_array_equal(found.edge_ids, np.unique(found.edge_edges))
    np.testing.assert_array_equal(found.edges, expected.edges[found.edge_ids])
    assert found.count == expected.count and found.any == expected.any == bool(found)
    assert COMM.allreduce(len(found)) == found.count


def error_of(call, *arguments, **named):
    try:
        call(*arguments, **named)
    except crumple.Error as error:
        return error
    raise AssertionError("no error was raised")


class RankWorld(crumple.mpi.LocalWorld):
    """Bodies of a world that belong to a rank; `whole` is the world of all ranks."""

    def __init__(self, shapes, distribution, poses, end_poses, self_collisions=True):
        count = len(shapes)
        mine = np.flatnonzero(distribution(count))
        all_self = np.broadcast_to(self_collisions, count)
        self.whole = crumple.World(shapes, poses=poses, end_poses=end_poses, self_collisions=all_self)
        world = crumple.World(
            [shapes[b] for b in mine], poses=poses[mine], end_poses=end_poses[mine], self_collisions=all_self[mine]
        )
        super().__init__(world, mine)

    def rows(self, bodies):
        """Returns flags of the rows whose first body belongs to this rank."""
        return np.isin(bodies[:, 0], self.body_ids)


def local_world(distribution, **named):
    shapes = [crumple.Shape(soup(20, size=0.5)), crumple.Shape(soup(30, size=0.3, seed=2, dtype=np.float64))] * 4
    random = np.random.default_rng(3)
    poses = np.tile(np.eye(3, 4), (8, 1, 1))
    poses[:, :, 3] = 0.4 * random.random((8, 3))
    end_poses = poses.copy()
    end_poses[:, :, 3] += 0.2 * random.random((8, 3))
    return RankWorld(shapes, distribution, poses, end_poses, **named)


def bodies_by_turns(count):
    return np.arange(count) % COMM.size == COMM.rank


def bodies_of_the_last(count):
    return np.full(count, COMM.rank == COMM.size - 1)


def run(cases):
    """Runs the case that the first command line argument names."""
    cases[sys.argv[1]]()
    COMM.barrier()
    if COMM.rank == 0:
        print("passed")
