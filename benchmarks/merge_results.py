"""Merges the figures of one benchmark run and says on what machine, by what compiler and from what commit they come.

python merge_results.py BENCHMARK OUT PART ...    parts that are not there are left out
"""

import datetime
import json
import os
import subprocess
import sys
from pathlib import Path


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


def main():
    benchmark, out, *parts = sys.argv[1:]
    top = Path(__file__).resolve().parent.parent
    changed = output("git", "status", "--porcelain", "--untracked-files=no", cwd=top)
    result = {
        "date": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds"),
        "commit": output("git", "rev-parse", "HEAD", cwd=top) + (" with changes" if changed else ""),
        "machine": machine(),
        "compiler": output(benchmark, "--compiler"),
        "peers": [],
        "contests": [],
        "studies": {},
    }
    for part in map(Path, parts):
        if part.exists():
            figures = json.loads(part.read_text())
            result["peers"] += figures.get("peers", [])
            result["contests"] += figures.get("contests", [])
            result["studies"].update(figures.get("studies", {}))
    Path(out).write_text(json.dumps(result, indent=1) + "\n")
    print(f"\nFigures: {out}")


if __name__ == "__main__":
    main()
