"""Finds where a crumpled cloth passes through itself and through the ball below it, and paints it.

python quick_start.py [PICTURE]        .png (needs PyVista), .html, .glb, .ply
"""

import sys

import crumple


def main(picture="cloth.html"):
    # Works on any (n, 3) vertices and (m, 3) faces; this scene is procedural.
    vertices, faces, _ = crumple.make_scene("cloth", triangles=20_000, frame=60)

    detector = crumple.Detector()
    result = detector.intersections(vertices, faces, output="contacts")

    print(result.pairs[:3])
    print(f"{len(result)} pairs; {result.hit.sum()} of {len(faces)} triangles collide")
    print(f"the first pair meets in a {crumple.ContactKind(result.contacts.kinds[0]).name.lower()}:")
    print(result.contacts[0])
    result.save(picture)


if __name__ == "__main__":
    main(*sys.argv[1:])
