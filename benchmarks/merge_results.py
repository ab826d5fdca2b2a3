"""Merges the figures of one benchmark run, and adds the machine, the compiler and the commit.

python merge_results.py BENCHMARK OUT PART ...    missing parts are left out

CRUMPLE_BENCHMARK_SECONDS is the duration of the run, if known.

Parts may contain repeated measurements, for example because other load disturbed the first ones. Of two contests of the
same peers on the same workload, and of two runs of a study, the one during which more processors were free is kept. If
that is the later one, "measured_again" lists it.
"""

import datetime
import json
import os
import subprocess
import sys
from pathlib import Path

from figures import write


def output(*command, **arguments):
    run = subprocess.run(command, capture_output=True, text=True, **arguments)
    return run.stdout.strip() if run.returncode == 0 else ""


def machine():
    fields = dict(line.split(":", 1) for line in output("lscpu").splitlines() if ":" in line)
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    return {
        "cpu": fields.get("Model name", "unknown").strip(),
        "cpus": os.cpu_count(),
        "architecture": os.uname().machine,
        "avx512": "avx512f" in fields.get("Flags", ""),
        "memory_gib": round(memory / 2**30, 1),
        "load_at_end": os.getloadavg()[0],
    }


def origin():
    """Returns the date, commit and machine of a measurement."""
    top = Path(__file__).resolve().parent.parent
    changed = output("git", "status", "--porcelain", "--untracked-files=no", cwd=top)
    return {
        "date": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds"),
        "commit": output("git", "rev-parse", "HEAD", cwd=top) + (" with changes" if changed else ""),
        "machine": machine(),
    }


def contestants(contest):
    return contest["workload"], contest["question"], frozenset(way["name"] for way in contest["contestants"])


def at_hand(figures):
    return figures.get("processors_at_hand", 0)


def merge(result, figures):
    """Adds the figures of one part to the result. Replaces a measurement if the new one had more free processors."""
    known = {peer["name"] for peer in result["peers"]}
    result["peers"] += [peer for peer in figures.get("peers", []) if peer["name"] not in known]
    for contest in figures.get("contests", []):
        same = [i for i, other in enumerate(result["contests"]) if contestants(other) == contestants(contest)]
        if not same:
            result["contests"].append(contest)
        elif at_hand(contest) > at_hand(result["contests"][same[0]]):
            result["contests"][same[0]] = contest
            peers = sorted(contestants(contest)[2] - {"crumple"})
            result["measured_again"].append(f"{contest['workload']} with {', '.join(peers)}")
    for name, study in figures.get("studies", {}).items():
        known = result["studies"].get(name)
        if known is None or at_hand(study) > at_hand(known):
            result["studies"][name] = study
            result["measured_again"] += [] if known is None else [name]


def main():
    benchmark, out, *parts = sys.argv[1:]
    result = {
        **origin(),
        "compiler": output(benchmark, "--compiler"),
        "peers": [],
        "contests": [],
        "studies": {},
        "measured_again": [],
    }
    if seconds := int(os.environ.get("CRUMPLE_BENCHMARK_SECONDS", 0)):
        result["seconds"] = seconds
    for part in map(Path, parts):
        if part.exists():
            merge(result, json.loads(part.read_text()))
    write(out, result)
    print(f"\nFigures: {out}" + (f", after {seconds / 60:.0f} minutes" if seconds else ""))


if __name__ == "__main__":
    main()
