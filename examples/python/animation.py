"""Searches an animation with one detector for all frames, so that each call but the first is warm-started.

python animation.py [PICTURE]          of the last frame
"""

import sys

import crumple


def main(picture="animation.html"):
    detector = crumple.Detector()
    for frame in range(0, 60, 6):
        bodies = crumple.make_scene("bodies", triangles=20_000, frame=frame)
        # The scene's groups are its bodies: finds only pairs between two bodies.
        result = detector.intersections(bodies, filter=crumple.PairFilter(groups="between"))
        colliding = {frozenset(pair) for pair in bodies.groups[result.pairs].tolist()}
        print(f"frame {frame:2}: {len(result):5} pairs of triangles, {len(colliding):3} pairs of bodies")
    result.save(picture)


if __name__ == "__main__":
    main(*sys.argv[1:])
