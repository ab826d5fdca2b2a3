"""Times overlaps of many bodies on MPI ranks, against one process with as many threads as there are ranks.

    mpirun -n 2 python overlap_ranks_python.py [--bodies N] [--rounds N] [--curves] [--json OUT]

Needs crumple's Python package with MPI, and mpi4py. Bodies are icospheres of several sizes and numbers of triangles at
random places, so that each overlaps some others; rank r provides bodies r, r + n, ... of n ranks. Each rank has one
thread. Calls of ranks and of one process alternate, and poses alternate between two states. A time of the ranks is the
longest of a rank; the table has medians, and the quartiles of the ratio. Rank 0 compares the numbers of rows.
"""

from __future__ import annotations

import argparse
import json
import time

import numpy as np
from mpi4py import MPI

import crumple
import crumple.mpi

COMM = MPI.COMM_WORLD


def icosphere(levels):
    golden = (1 + 5**0.5) / 2
    vertices = [v for a in (-1, 1) for b in (-golden, golden) for v in ((a, b, 0), (0, a, b), (b, 0, a))]
    points = np.array(vertices, float)
    near = np.linalg.norm(points[:, None] - points[None], axis=2) < 2.1
    faces = [
        (a, b, c)
        for a in range(12)
        for b in range(a + 1, 12)
        for c in range(b + 1, 12)
        if near[a, b] and near[b, c] and near[a, c]
    ]
    points, faces = list(points), np.array(faces)
    for _ in range(levels):
        middles, finer = {}, []
        for face in faces.tolist():
            ends = []
            for a, b in zip(face, face[1:] + face[:1]):
                key = (min(a, b), max(a, b))
                if key not in middles:
                    middles[key] = len(points)
                    points.append((points[a] + points[b]) / 2)
                ends.append(middles[key])
            (a, b, c), (x, y, z) = face, ends
            finer += [(a, x, z), (x, b, y), (z, y, c), (x, y, z)]
        faces = np.array(finer)
        points = [p / np.linalg.norm(p) for p in points]
    points = np.array(points)
    points /= np.linalg.norm(points, axis=1)[:, None]
    normals = np.cross(points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]])
    inward = np.einsum("ij,ij->i", normals, points[faces[:, 0]]) < 0
    faces[inward] = faces[inward][:, ::-1]
    return crumple.Mesh(points, faces)


def poses_of(count, random):
    poses = np.tile(np.eye(3, 4), (count, 1, 1))
    poses[:, :, :3] *= random.uniform(0.5, 1.5, (count, 1, 1))
    poses[:, :, 3] = random.uniform(0, 1.5 * count ** (1 / 3), (count, 3))
    return poses


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bodies", type=int, default=400)
    parser.add_argument("--rounds", type=int, default=20)
    parser.add_argument("--curves", action="store_true", help="also make curves and regions")
    parser.add_argument("--json", help="file for the results")
    arguments = parser.parse_args()
    random = np.random.default_rng(1)
    shapes = [crumple.Shape(icosphere(levels)) for levels in (2, 3, 4)]
    kinds = random.integers(0, len(shapes), arguments.bodies)
    states = [poses_of(arguments.bodies, random) for _ in range(2)]
    mine = np.arange(COMM.rank, arguments.bodies, COMM.size)
    query = crumple.OverlapQuery(curves=arguments.curves, regions=arguments.curves)
    wholes = [crumple.World(shapes, kinds, poses=poses) for poses in states]
    locals_ = [
        crumple.mpi.LocalWorld(crumple.World(shapes, kinds[mine], poses=poses[mine]), mine.astype(np.int64))
        for poses in states
    ]
    one = crumple.Detector(backend="cpu", threads=COMM.size) if COMM.rank == 0 else None
    times = {"one": [], "ranks": []}
    with crumple.mpi.Detector(COMM, backend="cpu", threads=1) as detector:
        for round_ in range(-2, arguments.rounds):
            whole, local = wholes[round_ % 2], locals_[round_ % 2]
            rows = seconds = 0
            if one:
                begin = time.perf_counter()
                rows = len(one.find(whole, query))
                seconds = time.perf_counter() - begin
            COMM.Barrier()
            begin = time.perf_counter()
            found = detector.find(local, query)
            longest = COMM.allreduce(time.perf_counter() - begin, MPI.MAX)
            assert one is None or found.count == rows, (found.count, rows)
            if round_ >= 0:
                times["one"].append(1000 * seconds)
                times["ranks"].append(1000 * longest)
        statistics = found.statistics
        sent = COMM.allreduce(statistics.bytes_sent)
    if COMM.rank:
        return
    ratio = np.quantile(np.divide(times["ranks"], times["one"]), [0.25, 0.5, 0.75])
    row = {
        "bodies": arguments.bodies,
        "ranks": COMM.size,
        "rows": rows,
        "ranks_ms": float(np.median(times["ranks"])),
        "one_process_ms": float(np.median(times["one"])),
        "ratio_quartiles": ratio.tolist(),
        "balance": statistics.largest_work / statistics.mean_work,
        "bytes_sent": sent,
    }
    print(
        f"{row['bodies']} bodies, {rows} rows, {COMM.size} ranks: {row['ranks_ms']:.1f} ms, one process "
        f"{row['one_process_ms']:.1f} ms, ratio {ratio[1]:.2f} ({ratio[0]:.2f} to {ratio[2]:.2f}), balance "
        f"{row['balance']:.2f}, {sent / 2**20:.1f} MiB sent"
    )
    if arguments.json:
        with open(arguments.json, "w") as file:
            json.dump(row, file, indent=1)


if __name__ == "__main__":
    main()
