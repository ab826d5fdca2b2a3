"""Times the peers that come from PyPI against crumple_benchmark, alternately.

Every contestant is a process that waits for requests: crumple_benchmark --serve, or a worker (peers/worker.py). All get the
same arrays. At each request a contestant makes calls during a slice of time and returns the milliseconds of each. Only work
inside the libraries is timed, not the conversion of arrays before and of results after it; contestants named "from Python"
include making Python objects of the result. The race follows race.h: medians over all calls, ratios computed for each round,
configurations of a peer left out after the warm-up if they are much slower than its fastest one.

    python peers_python.py --benchmark build/benchmarks/crumple_benchmark --json out.json
    python peers_python.py --on-device --benchmark build/benchmarks/crumple_cuda_benchmark --scene cloth:100000

With --on-device, crumple's cuda backend is timed against the peers that run on a device. All meshes and pairs stay on the
device; times are read from the host's clock once the result is complete.
"""

import argparse
import functools
import importlib
import importlib.metadata
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import median, quantiles

from figures import write

sys.dont_write_bytecode = True
PEERS = ["peers.ipc_toolkit", "peers.mesh_lib", "peers.libigl", "peers.true_form", "peers.coal", "peers.warp_boxes"]
ON_DEVICE = ["peers.warp_boxes"]
SCENES = ["cloth_ball92", "balls16_18", "227", "Generic_Twin_right", "ember_016", "ember_260", "ember_406", "bunny_69k",
          "armadillo_86k"]
PROCEDURAL = ["cloth", "bodies", "between:bodies", "any:shells"]
QUICK, QUICK_PROCEDURAL = ["227", "ember_406", "bunny_69k"], ["cloth:20000", "between:bodies:20000", "any:shells"]
HOPELESS = 1.5  # a configuration is left out if its warm-up takes so many times as long as that of the peer's fastest one
LEAST_ROUNDS = 3


class Ended(RuntimeError):
    """A process has ended instead of responding."""

    def __init__(self, process):
        super().__init__(f"{' '.join(map(str, process.args))} ended with {process.wait()}")
        self.process = process


class Process:
    """A process that responds to each line with a line of JSON."""

    def __init__(self, *command):
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def ask(self, request):
        try:
            print(request, file=self.process.stdin, flush=True)
        except BrokenPipeError:
            raise Ended(self.process) from None
        return self.answer()

    def answer(self):
        line = self.process.stdout.readline()
        if not line:
            raise Ended(self.process)
        return json.loads(line)

    def close(self):
        self.process.stdin.close()
        self.process.wait()


class Crumple:
    name, pairs, size = "crumple", None, None

    def __init__(self, process, threads, computes, way=""):
        self.process, self.threads, self.computes = process, threads, computes
        self.way = way or ("1 thread" if threads == 1 else "all threads")

    def turn(self, seconds):
        return self.process.ask(f"run {self.threads} {seconds}")


class Peer:
    size = None

    def __init__(self, module, kind, label, threads, folder):
        self.name, self.computes = kind.name, kind.computes
        self.way = ", ".join(filter(None, [label, "1 thread" if threads == 1 else "all threads"]))
        arguments = [module, kind.__name__, label, threads, folder]
        self.process = Process(sys.executable, __file__, "--work", *map(str, arguments))
        self.process.answer()
        self.pairs = (lambda: self.process.ask("pairs")) if getattr(kind, "pairs", None) else None

    def turn(self, seconds):
        answer = self.process.ask(f"run {seconds}")
        self.size = answer["size"]
        return answer["ms"]


# Maps each peer whose process ended instead of responding to a reason with the workload. This may happen with other versions of
# a peer, which lack a function that the worker calls.
ended = {}


def leave_out(name, workload, reason):
    ended.setdefault(name, f"ended on {workload}")
    print(f"{name} is left out of {workload}: {reason}", flush=True)


def without(reason, contestants, workload):
    """Returns the contestants without all configurations of the peer whose process has ended."""
    name = next(c.name for c in contestants if c.process.process is reason.process)
    if name == "crumple":
        raise reason
    leave_out(name, workload, reason)
    return [c for c in contestants if c.name != name]


@functools.cache
def peers_here(on_device):
    """Returns the classes of each module whose package is installed, and the reasons why other modules are left out."""
    here, left_out = {}, {}
    for module in ON_DEVICE if on_device else PEERS:
        try:
            here[module] = importlib.import_module(module).WORKERS
        except ImportError as error:
            left_out[module.removeprefix("peers.")] = f"not installed: {error}"
            print(f"{module} is left out: {error}")
    return here, left_out


def describe_peers(on_device):
    here, left_out = peers_here(on_device)
    peers = {}
    for kind in sum(here.values(), []):
        every = {threads for _, threads in kind.ways}
        peers[kind.name] = {
            "name": kind.name,
            "version": importlib.metadata.version(kind.package),
            "scalar": kind.scalar,
            "threads": "one or all" if 0 in every else "one",
            "computes": kind.describes,
        }
    return [*peers.values(), *({"name": name, "left_out": reason} for name, reason in {**left_out, **ended}.items())]


def enter(workload, benchmark, folder, quick, on_device):
    """Returns the contestants for a workload, crumple first, and the workload's description."""
    ours = Process(benchmark, "--scene", workload, "--serve")
    description = ours.ask(f"dump {folder}")
    (folder / "description").write_text(json.dumps(description))
    computes = "exact yes or no" if description["question"] == "any" else "exact pairs, sorted"
    if on_device:
        contestants = [Crumple(ours, 0, computes, "cuda")]
    else:
        contestants = [Crumple(ours, threads, computes) for threads in (1, 0)]
    left_out = description["left_out"] = {}
    for module, kinds in peers_here(on_device)[0].items():
        for kind in kinds:
            if kind.question != description["question"]:
                continue
            most = getattr(kind, "most_triangles", None)
            if most and (quick or description["triangles"] > most):
                left_out[kind.name] = "too slow"
            elif workload in getattr(kind, "too_much", {}):
                left_out[kind.name] = kind.too_much[workload]
            else:
                try:
                    contestants += [Peer(module, kind, label, threads, folder) for label, threads in kind.ways]
                except Ended as reason:
                    leave_out(kind.name, workload, reason)
    for name, reason in left_out.items():
        print(f"{name} is left out of {workload}: {reason}")
    return contestants, description


def race(contestants, rounds, seconds, budget):
    """Sets `rounds` of each contestant: milliseconds of each call in each round; empty if it is left out by HOPELESS."""
    for c in contestants:
        c.rounds, c.warm_up = [], min(c.turn(2 * seconds))
    fastest = {c.name: min(d.warm_up for d in contestants if d.name == c.name) for c in contestants}
    turns = [c for c in contestants if c.warm_up <= HOPELESS * fastest[c.name]]
    affordable = int(budget / sum(max(seconds, c.warm_up / 1000) for c in turns))
    for _ in range(min(rounds, max(LEAST_ROUNDS, affordable))):
        for c in turns:
            c.rounds.append(c.turn(seconds))
        turns.reverse()


def summary(values):
    lower, middle, upper = quantiles(values, method="inclusive") if len(values) > 1 else 3 * values
    return {"median": middle, "lower_quartile": lower, "upper_quartile": upper}


def judge(contestants):
    """Returns an entry for each contestant; the fastest configuration of each peer has a ratio and a difference."""
    entries = []
    for c in contestants:
        calls = [t for times in c.rounds for t in times]
        c.time = summary(calls or [c.warm_up])
    best = {}
    for c in contestants:
        if c.rounds and (c.name not in best or c.time["median"] < best[c.name].time["median"]):
            best[c.name] = c
    ours = best["crumple"]
    for c in contestants:
        entry = {"name": c.name, "way": c.way, "computes": c.computes, "milliseconds": c.time, "raced": bool(c.rounds)}
        entry["fastest_way"] = c is best[c.name]
        if c.size is not None:
            entry["size"] = c.size
        if entry["fastest_way"] and c is not ours:
            entry["ratio"] = summary([median(t) / median(o) for t, o in zip(c.rounds, ours.rounds)])
            entry.update(c.pairs() if c.pairs else {})
        entries.append(entry)
    return entries


def number(value):
    return f"{value:.0f}" if value >= 100 else f"{value:#.3g}"


def spread(figures):
    return [number(figures["median"]), f"{number(figures['lower_quartile'])} - {number(figures['upper_quartile'])}"]


def show(description, entries):
    pairs = f"{description['pairs']} pairs" if "pairs" in description else "yes or no"
    print("\n{workload} ({question}, {scalar}): {triangles} triangles, ".format(**description) + pairs)
    rows = [["", "fastest way", "computes", "ms", "quartiles", "ratio", "quartiles", "missing", "extra"]]
    for e in entries:
        if e["fastest_way"]:
            ratio = spread(e["ratio"]) if "ratio" in e else ["", ""]
            difference = [str(e.get("missing", "")), str(e.get("extra", ""))]
            rows.append([e["name"], e["way"], e["computes"], *spread(e["milliseconds"]), *ratio, *difference])
    widths = [max(map(len, column)) for column in zip(*rows)]
    for row in rows:
        cells = [text.ljust(w) if column < 3 else text.rjust(w) for column, (text, w) in enumerate(zip(row, widths))]
        print("  " + "  ".join(cells))
    at_hand, every = description["processors_at_hand"], os.cpu_count()
    busy = ": BUSY, figures are rough" if at_hand < 0.9 * every else ""
    print(f"  {at_hand:.1f} of {every} processors at hand{busy}", flush=True)


def contest(workload, benchmark, quick, on_device, rounds, seconds, budget):
    with tempfile.TemporaryDirectory() as folder:
        contestants, description = enter(workload, benchmark, Path(folder), quick, on_device)
        entries = None
        while entries is None:  # if a peer's process ends during the race, repeats the race without that peer
            try:
                before = contestants[0].process.ask("processors")
                race(contestants, rounds, seconds, budget)
                description["processors_at_hand"] = min(before, contestants[0].process.ask("processors"))
                entries = judge(contestants)
            except Ended as reason:
                contestants = without(reason, contestants, workload)
        for process in {c.process for c in contestants}:
            process.close()
    show(description, entries)
    return {**description, "contestants": entries}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--benchmark", help="the program crumple_benchmark")
    parser.add_argument("--on-device", action="store_true",
                        help="the program is crumple_cuda_benchmark: race on its device; needs --scene")
    parser.add_argument("--scene", action="append", help="workload, as for crumple_benchmark; may be repeated")
    parser.add_argument("--repetitions", type=int, help="rounds of a race")
    parser.add_argument("--json", help="file for the figures")
    parser.add_argument("--quick", action="store_true", help="few and short rounds, to check that everything works")
    parser.add_argument("--work", nargs=5, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.work:
        from peers.worker import work

        module, name, way, threads, folder = arguments.work
        return work(module, name, way, int(threads), Path(folder))
    if not arguments.benchmark:
        parser.error("--benchmark is needed")
    scenes = arguments.scene
    if arguments.on_device and not scenes:
        parser.error("--on-device needs --scene")
    if not scenes:
        listed = subprocess.run([arguments.benchmark, "--list"], capture_output=True, text=True, check=True).stdout
        real, procedural = (QUICK, QUICK_PROCEDURAL) if arguments.quick else (SCENES, PROCEDURAL)
        scenes = real if "cloth_ball92" in listed else procedural
    rounds, seconds, budget = (5, 0.02, 3) if arguments.quick else (15, 0.03, 40)
    rows = [contest(s, arguments.benchmark, arguments.quick, arguments.on_device, arguments.repetitions or rounds, seconds, budget)
            for s in scenes]
    if arguments.json:
        write(arguments.json, {"peers": describe_peers(arguments.on_device), "contests": rows})


if __name__ == "__main__":
    main()
