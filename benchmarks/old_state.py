"""Times an old state of Crumple against the present one, in turn, and compares their results byte for byte.

    git worktree add --detach ../old COMMIT        then build crumple_benchmark there and here
    python benchmarks/old_state.py --old ../old/build/benchmarks/crumple_benchmark \\
        --new build/benchmarks/crumple_benchmark --scene cloth_ball92 --scene 227 --json out.json

    python benchmarks/old_state.py --old ../old/build/cli/crumple --new build/cli/crumple --command "info part.stl"

Both programs are processes that serve requests (crumple_benchmark --serve). In each round, each program makes calls for a
slice of time; the order is reversed after each round. With --command, both are the command line instead, and each runs the
command once in each round. A time is the processor time of the program per call, summed over its threads, which other load
on the machine affects less than wall-clock time. A round's ratio is the old time divided by the new one. The median and the
quartiles of the ratios over all rounds are reported. Linux only.
"""

import argparse
import datetime
import os
import platform
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import median, quantiles

sys.dont_write_bytecode = True
from figures import write
from peers_python import Process

SCENES = ["Generic_Twin_right", "fans", "needles", "cloth_ball92", "balls16_18", "227", "ember_016", "ember_260", "ember_406"]


def processor_seconds(pid):
    """Returns the processor time of all threads of a process."""
    folder = Path(f"/proc/{pid}/task")
    return sum(int((task / "schedstat").read_text().split()[0]) for task in folder.iterdir()) * 1e-9


class State:
    def __init__(self, benchmark, scene, threads, seconds):
        self.server = Process(benchmark, "--scene", scene, "--serve")
        self.request = f"run {threads} {seconds}"

    def turn(self):
        """Returns milliseconds of processor time per call."""
        pid = self.server.process.pid
        begin = processor_seconds(pid)
        calls = len(self.server.ask(self.request))
        return 1e3 * (processor_seconds(pid) - begin) / calls

    def close(self):
        self.server.close()

    def result(self):
        with tempfile.TemporaryDirectory() as folder:
            self.server.ask(f"dump {folder}")
            return {path.name: path.read_bytes() for path in sorted(Path(folder).iterdir())}


class Command:
    def __init__(self, program, command):
        self.words = [program, *shlex.split(command)]

    def turn(self):
        with subprocess.Popen(self.words, stdout=subprocess.DEVNULL) as process:
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
        return 1e3 * (usage.ru_utime + usage.ru_stime)

    def result(self):
        return subprocess.run(self.words, capture_output=True, check=False).stdout

    def close(self):
        pass


def summary(values):
    low, middle, high = quantiles(values, n=4)
    return {"median": middle, "lower_quartile": low, "upper_quartile": high}


def race(states, rounds):
    """Races two states, "old" and "new"."""
    same = states["old"].result() == states["new"].result()
    times = {name: [] for name in states}
    for state in states.values():
        state.turn()
    for r in range(rounds):
        for name in list(states)[:: 1 if r % 2 else -1]:
            times[name].append(states[name].turn())
    for state in states.values():
        state.close()
    ratios = [a / b for a, b in zip(times["old"], times["new"])]
    return {"rounds": rounds, "same_result": same,
            "old_milliseconds": median(times["old"]), "new_milliseconds": median(times["new"]), **summary(ratios)}


def commit_of(benchmark):
    """Returns the commit of the checkout that contains a program, with a plus sign if files were changed."""
    git = ["git", "-C", Path(benchmark).resolve().parent]
    run = lambda *words: subprocess.run([*git, *words], capture_output=True, text=True, check=True).stdout.strip()
    return run("rev-parse", "HEAD") + ("+" if run("status", "--porcelain", "--untracked-files=no") else "")


def processor():
    for line in Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.split(":")[1].strip()
    return platform.machine()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--old", required=True, help="program of the old state")
    parser.add_argument("--new", required=True, help="program of the present state")
    parser.add_argument("--scene", action="append", help="workload (workload.h); may be repeated")
    parser.add_argument("--command", help="arguments of the command line, for old and new programs `crumple`")
    parser.add_argument("--threads", type=int, default=1, help="threads of a call; 0: all")
    parser.add_argument("--rounds", type=int, default=30)
    parser.add_argument("--seconds", type=float, default=0.1, help="slice of a program in one round")
    parser.add_argument("--json", help="file for the figures")
    settings = parser.parse_args()
    begin = os.getloadavg()[0]
    rows = []
    print(f"{'scene':24}{'old ms':>9}{'new ms':>9}{'old / new':>11}  quartiles       same result")
    programs = {"old": settings.old, "new": settings.new}
    for name in [settings.command] if settings.command else settings.scene or SCENES:
        if settings.command:
            states = {age: Command(program, name) for age, program in programs.items()}
            row = {"command": name}
        else:
            states = {age: State(program, name, settings.threads, settings.seconds) for age, program in programs.items()}
            row = {"scene": name, "threads": settings.threads or os.cpu_count()}
        row |= race(states, settings.rounds)
        rows.append(row)
        print(f"{name:24}{row['old_milliseconds']:9.3g}{row['new_milliseconds']:9.3g}{row['median']:11.3f}"
              f"  {row['lower_quartile']:.3f} to {row['upper_quartile']:.3f}  {'yes' if row['same_result'] else 'NO'}",
              flush=True)
    if settings.json:
        write(settings.json, {"date": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds"),
                              "old": commit_of(settings.old), "new": commit_of(settings.new),
                              "machine": {"cpu": processor(), "cpus": os.cpu_count(), "load_at_begin": begin,
                                          "load_at_end": os.getloadavg()[0]},
                              "unit": "milliseconds of processor time per call", "rows": rows})
    return 0 if all(row["same_result"] for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
