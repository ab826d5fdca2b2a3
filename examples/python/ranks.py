"""Searches some frames of a sheet of cloth, in blocks of rows on MPI ranks: each rank gets the pairs of its triangles.
At the end it also finds impacts of the motion to the next frame, and near pairs.

mpirun -n 2 python ranks.py
"""

import numpy as np
from mpi4py import MPI

import crumple
import crumple.mpi

ROWS, COLUMNS = 160, 120


def vertices_of(ids, frame):
    """Returns positions of vertices of the sheet: it hangs from a bar, in folds that move along it and intersect it."""
    row, column = np.divmod(ids, COLUMNS + 1)
    along, across = row / ROWS, column / COLUMNS
    wave = 40 * along - 0.3 * frame
    return np.stack([across, along + 0.03 * np.sin(wave + 3 * across), 0.01 * np.cos(wave + 2 * across)], axis=1)


def main():
    comm = MPI.COMM_WORLD
    first, last = ROWS * comm.rank // comm.size, ROWS * (comm.rank + 1) // comm.size

    # The block's quadrilaterals, two triangles each, and their vertices. Vertices of the last row also belong to the
    # next block, under the same ids.
    row, column = np.divmod(np.arange(first * COLUMNS, last * COLUMNS), COLUMNS)
    corner = row * (COLUMNS + 1) + column
    faces = np.stack([corner, corner + 1, corner + COLUMNS + 1, corner + 1, corner + COLUMNS + 2, corner + COLUMNS + 1])
    faces = faces.T.reshape(-1, 3)
    vertex_ids, faces_here = np.unique(faces, return_inverse=True)
    faces_here = faces_here.reshape(-1, 3)
    triangle_ids = np.arange(2 * first * COLUMNS, 2 * last * COLUMNS)

    with crumple.mpi.Detector(comm) as detector:
        for frame in range(4):
            here = vertices_of(vertex_ids, frame)
            result = detector.intersections(here, faces_here, triangle_ids=triangle_ids, vertex_ids=vertex_ids)
            lines = comm.gather(f"{len(result)} on rank {comm.rank}")
            if comm.rank == 0:
                print(f"frame {frame}: {result.count} pairs, {', '.join(lines)}")

        ids = dict(triangle_ids=triangle_ids, vertex_ids=vertex_ids)
        impacts = detector.impacts(here, vertices_of(vertex_ids, frame + 1), faces_here, **ids)
        near = detector.proximities(here, faces_here, radius=1e-4, **ids)
        if comm.rank == 0:
            print(f"to frame {frame + 1}: {impacts.count} impacts; {near.count} pairs of features are near")

    # A single process finds the same pairs.
    all_faces = comm.gather(faces)
    if comm.rank == 0:
        whole = vertices_of(np.arange((ROWS + 1) * (COLUMNS + 1)), frame)
        one = crumple.Detector().intersections(whole, np.concatenate(all_faces))
        assert (one.pairs[: len(result)] == result.pairs).all()
        print(f"one process alone: {len(one)} pairs")


if __name__ == "__main__":
    main()
