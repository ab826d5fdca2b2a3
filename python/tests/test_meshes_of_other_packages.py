"""Tests of meshes of other packages as input, with the packages themselves."""

import importlib.util

import numpy as np
import pytest

import crumple
from conftest import peer, soup

MESH = soup(60, size=0.4, dtype=np.float64)
EXPECTED = crumple.intersections(MESH).pairs.tolist()


def trimesh_mesh():
    return peer("trimesh").Trimesh(MESH.vertices, MESH.faces, process=False)


def meshio_mesh():
    return peer("meshio").Mesh(MESH.vertices, [("line", [[0, 1]]), ("triangle", MESH.faces)])


def open3d_mesh():
    o3d = peer("open3d")
    return o3d.geometry.TriangleMesh(o3d.utility.Vector3dVector(MESH.vertices), o3d.utility.Vector3iVector(MESH.faces))


def open3d_tensor_mesh():
    o3d = peer("open3d")
    return o3d.t.geometry.TriangleMesh(o3d.core.Tensor(MESH.vertices), o3d.core.Tensor(MESH.faces))


def pyvista_mesh():
    return peer("pyvista").PolyData.from_regular_faces(MESH.vertices, MESH.faces)


BRIDGES = [trimesh_mesh, meshio_mesh, open3d_mesh, open3d_tensor_mesh, pyvista_mesh]


@pytest.mark.parametrize("make", BRIDGES)
def test_meshes_of_other_packages_give_the_same_pairs(make, detector):
    mesh = make()
    assert detector.intersections(mesh).pairs.tolist() == EXPECTED
    assert crumple.intersections(mesh).pairs.tolist() == EXPECTED
    assert detector.intersections(mesh, MESH).pairs.tolist() == detector.intersections(MESH, MESH).pairs.tolist()
    assert detector.any(mesh)
    groups = np.arange(60)
    assert not detector.intersections(mesh, groups=groups, filter=crumple.PairFilter(groups="within"))


@pytest.mark.parametrize(
    "make, theirs",
    [
        (trimesh_mesh, lambda mesh: mesh.vertices),
        (meshio_mesh, lambda mesh: mesh.points),
        (open3d_mesh, lambda mesh: np.asarray(mesh.vertices)),
        (open3d_tensor_mesh, lambda mesh: mesh.vertex.positions.numpy()),
        (pyvista_mesh, lambda mesh: mesh.points),
    ],
)
def test_vertices_of_meshes_of_other_packages_are_not_copied(make, theirs):
    mesh = make()
    assert np.shares_memory(np.from_dlpack(crumple.as_mesh(mesh).vertices), theirs(mesh))


def test_meshio_quadrilaterals_are_split_and_tetrahedra_refused():
    meshio = peer("meshio")
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.7, 0.2, -1], [0.7, 0.2, 1], [0.9, 0.2, 1]])
    mesh = meshio.Mesh(points, [("quad", [[0, 1, 2, 3]]), ("triangle", [[4, 5, 6]])])
    faces = crumple.as_mesh(mesh).faces
    assert sorted(map(sorted, faces.tolist())) == [[0, 1, 2], [0, 2, 3], [4, 5, 6]]
    assert len(crumple.intersections(mesh).pairs) == 1
    with pytest.raises(crumple.InvalidInput, match="cells of type tetra: extract its surface"):
        crumple.as_mesh(meshio.Mesh(points, [("tetra", [[0, 1, 2, 4]])]))
    assert crumple.as_mesh(meshio.Mesh(points, [("vertex", [[0]])])).faces.shape == (0, 3)


def test_concave_quadrilaterals_of_meshio_are_cut_without_overlap(detector):
    meshio = peer("meshio")
    points = np.array([[0, 0, 0], [2, 0, 0], [0.4, 0.4, 0], [0, 2, 0]])
    for first in range(4):
        quad = np.roll([0, 1, 2, 3], -first)
        assert detector.intersections(meshio.Mesh(points, [("quad", [quad])])).pairs.tolist() == []
    crossing = crumple.as_mesh(meshio.Mesh(points[[0, 1, 3, 2]], [("quad", [[0, 1, 2, 3], [0, 1, 2, 9]])]))
    assert crossing.faces.tolist()[2:] == [[0, 1, 2], [0, 2, 9]], "what is not there is for the search to tell"


def test_meshio_cells_keep_their_order():
    meshio = peer("meshio")
    points = np.zeros((4, 3))
    blocks = [("triangle", [[0, 1, 2]]), ("quad", [[0, 1, 2, 3]]), ("line", [[0, 1]]), ("triangle", [[3, 2, 1]])]
    faces = crumple.as_mesh(meshio.Mesh(points, blocks)).faces
    assert faces.tolist() == [[0, 1, 2], [0, 1, 2], [0, 2, 3], [3, 2, 1]]


@pytest.mark.parametrize("name", ["UnstructuredGrid", "ImageData", "RectilinearGrid", "MultiBlock"])
def test_pyvista_data_other_than_surfaces_is_refused(name):
    mesh = getattr(peer("pyvista"), name)()
    with pytest.raises(crumple.InvalidType, match=rf"must be PolyData, not pyvista\..*{name}: call .extract_surface"):
        crumple.as_mesh(mesh)


def test_empty_meshes_of_other_packages_have_no_collisions(detector):
    empty = [peer("trimesh").Trimesh(), peer("meshio").Mesh(np.zeros((0, 3)), [])]
    for package, makers in {
        "open3d": [lambda o3d: o3d.geometry.TriangleMesh(), lambda o3d: o3d.t.geometry.TriangleMesh()],
        "pyvista": [lambda pv: pv.PolyData(), lambda pv: pv.PolyData(MESH.vertices)],
    }.items():
        if importlib.util.find_spec(package):
            empty += [make(peer(package)) for make in makers]
    for mesh in empty:
        assert not detector.intersections(mesh) and not detector.any([mesh, MESH])


def test_pyvista_strips_are_refused():
    strips = peer("pyvista").Sphere().strip()
    with pytest.raises(crumple.InvalidInput, match="triangulate"):
        crumple.as_mesh(strips)


def test_pyvista_polygons_are_refused():
    pyvista = peer("pyvista")
    with pytest.raises(crumple.InvalidInput, match="triangulate"):
        crumple.as_mesh(pyvista.Plane(i_resolution=1, j_resolution=1))
    sphere = pyvista.Sphere()
    assert len(crumple.intersections(sphere).pairs) == 0


def test_as_mesh_accepts_meshes_and_tuples_but_no_number_path_or_lone_array():
    assert crumple.as_mesh(MESH) is MESH
    assert crumple.as_mesh((MESH.vertices, MESH.faces)).groups is None
    vertices, faces, groups = crumple.Mesh(1, 2, 3)
    assert (vertices, faces, groups) == (1, 2, 3)
    for wrong in (5, "mesh.ply", (1, 2, 3, 4), np.zeros((3, 3))):
        with pytest.raises(crumple.InvalidInput, match="a mesh must be crumple.Mesh, a tuple"):
            crumple.as_mesh(wrong)
