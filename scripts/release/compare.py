"""Compares the speed of a release's wheel with that of a local build: times of `import crumple` and of searches.

    python3 scripts/release/compare.py PYTHON_WITH_WHEEL PYTHON_WITH_LOCAL_BUILD [ROUNDS]

Both arguments are interpreters of environments: the wheel is installed in one, the local build in the other. Each round
measures both. Prints the medians of all rounds and, for each search, the median of the rounds' ratios (wheel / local
build). Fails if importing the wheel takes 100 ms or more, or if a search of the wheel takes over 5 % longer.
"""

import json
import subprocess
import sys
from statistics import median

IMPORT = "import time; t = time.perf_counter(); import crumple; print((time.perf_counter() - t) * 1e3)"
SEARCHES = """
import json, time
from statistics import median
import crumple

def time_of(call, calls):
    for _ in range(5):
        call()
    times = []
    for _ in range(calls):
        start = time.perf_counter()
        call()
        times.append((time.perf_counter() - start) * 1e3)
    return median(times)

mesh = crumple.make_scene("cloth", triangles=50_000, frame=60)
small = crumple.make_scene("cloth", triangles=2_000, frame=60)
detector = crumple.Detector(threads=1)
print(json.dumps({
    "self, 50,000 triangles": time_of(lambda: detector.intersections(mesh.vertices, mesh.faces), 60),
    "self, 2,000 triangles": time_of(lambda: detector.intersections(small.vertices, small.faces), 400),
    "near, 2,000 triangles": time_of(lambda: detector.proximities(small.vertices, small.faces, radius=0.01), 60),
}))
"""


def output(python: str, program: str) -> str:
    return subprocess.run([python, "-I", "-c", program], check=True, capture_output=True, text=True).stdout


def main(pythons: list[str], rounds: int) -> int:
    imports = [[], []]
    times: list[dict[str, list[float]]] = [{}, {}]
    for turn in range(rounds):
        for which in (0, 1) if turn % 2 else (1, 0):
            imports[which] += [float(output(pythons[which], IMPORT)) for _ in range(5)]
            for name, value in json.loads(output(pythons[which], SEARCHES)).items():
                times[which].setdefault(name, []).append(value)
    print(f"import: {median(imports[0]):.1f} ms, of the local build {median(imports[1]):.1f} ms")
    worst = 0.0
    for name, values in times[0].items():
        ratio = median(a / b for a, b in zip(values, times[1][name]))
        worst = max(worst, ratio)
        print(f"{name}: {median(values):.3f} ms, of the local build {median(times[1][name]):.3f} ms; ratio {ratio:.3f}")
    return int(median(imports[0]) >= 100 or worst > 1.05)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:3], int(sys.argv[3]) if len(sys.argv) > 3 else 11))
