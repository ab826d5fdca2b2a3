"""Crumple as a broad phase of the IPC Toolkit.

The IPC Toolkit lets Python derive a BroadPhase. This one hands out only edges and faces of triangles that truly
intersect, instead of those whose boxes overlap, so the narrow phase has next to nothing left to do. It serves questions
about one moment, such as ipctk.has_intersections. Continuous collision detection asks for whatever comes near between
two moments; that is another question, and it is refused.

Edges of no triangle, as of rods, are tested against faces, too. A triangle's edge that is not among `edges`, which
ipctk.CollisionMesh would refuse, has no number to hand out: it is left out.

    python ipc_broad_phase.py
"""

import ipctk
import numpy as np

import crumple


class CrumpleBroadPhase(ipctk.BroadPhase):
    """Candidates from exact intersections of triangles, at one moment."""

    def __init__(self):
        super().__init__()
        self.detector = crumple.Detector()
        self.edge_face = np.empty((0, 2), int)

    def name(self):
        return "Crumple"

    def build(self, vertices, edges, faces, *more):
        if len(more) > 1:
            raise NotImplementedError("CrumpleBroadPhase answers for one moment, not for motion between two")

        def key(ends):  # one number for an edge, whichever way round
            return ends.min(axis=-1) * np.int64(len(vertices)) + ends.max(axis=-1)

        self.clear()
        if not len(edges) or not len(faces):
            return
        edge_keys, sides = key(edges), faces[:, [[0, 1], [1, 2], [2, 0]]]

        # If two triangles intersect, an edge of one meets the other: each edge of each, with the other's face.
        pairs = self.detector.find_self(vertices, faces).pairs
        both = np.concatenate([pairs, pairs[:, ::-1]])
        wanted = key(sides[both[:, 0]])
        order = np.argsort(edge_keys)
        edge = order[np.searchsorted(edge_keys, wanted, sorter=order).clip(max=len(edges) - 1)]
        face = np.broadcast_to(both[:, 1:], edge.shape)
        listed = edge_keys[edge] == wanted
        candidates = np.unique(np.stack([edge[listed], face[listed]], axis=1), axis=0)

        # Edges of no triangle are searched as triangles without area.
        loose = np.flatnonzero(~np.isin(edge_keys, key(sides)))
        if len(loose):
            pairs = self.detector.find_between((vertices, edges[loose][:, [0, 1, 1]]), (vertices, faces)).pairs
            candidates = np.concatenate([candidates, np.stack([loose[pairs[:, 0]], pairs[:, 1]], axis=1)])

        # An edge that shares a vertex with the face always touches it.
        touching = (edges[candidates[:, 0]][:, :, None] == faces[candidates[:, 1]][:, None, :]).any(axis=(1, 2))
        self.edge_face = candidates[~touching]

    def clear(self):
        self.edge_face = self.edge_face[:0]

    def detect_edge_face_candidates(self):
        return [ipctk.EdgeFaceCandidate(edge, face) for edge, face in self.edge_face.tolist()]


def main():
    for frame in (0, 60):
        mesh = crumple.make_scene("cloth", triangles=20_000, frame=frame)
        vertices = np.asfortranarray(mesh.vertices, dtype=float)
        faces = np.asfortranarray(mesh.faces)
        edges = np.asfortranarray(ipctk.edges(faces))
        ipc_mesh = ipctk.CollisionMesh(vertices, edges, faces)
        print(f"frame {frame}")
        answers = []
        for broad_phase in (ipctk.LBVH(), CrumpleBroadPhase()):
            answers.append(ipctk.has_intersections(ipc_mesh, vertices, broad_phase))
            broad_phase.build(vertices, edges, faces)
            count = len(broad_phase.detect_edge_face_candidates())
            print(f"  {broad_phase.name():8} {count:8} candidates: {'intersects' if answers[-1] else 'clean'}")
        assert answers[0] == answers[1]


if __name__ == "__main__":
    main()
