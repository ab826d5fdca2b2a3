"""Figures of one benchmark run, and access to them by name."""

import json
from pathlib import Path

TOP = Path(__file__).resolve().parents[3]
COMMITTED = TOP / "benchmarks/results/epyc-2-threads.json"
# Folder of figures from a GPU, beside the committed figures. Its name is made of the device and the driver's version.
DEVICE = "h200-580.159"

SCENES = {
    "cloth_ball92": "Cloth on Ball, frame 92",
    "balls16_18": "305 bodies, frame 18",
    "227": "Funnel, frame 227",
    "Generic_Twin_right": "CAD part, all needles",
    "ember_016": "Thingi10K 88566 and 58011",
    "ember_260": "Thingi10K 908460 and 73416",
    "ember_406": "Thingi10K 1063852 and 72214",
    "bunny_69k": "Bunny",
    "armadillo_86k": "Armadillo",
    "unc_cloth_ball": "UNC Cloth on Ball, frames 92 and 93",
    "unc_funnel": "UNC Funnel, frames 227 and 228",
    "kick": "Kick",
}

STAGES = ["bounds", "subdivide", "align", "sort", "sweep", "narrow", "output"]

# Least share of the processors that must have been free for a measurement; with a smaller share, it counts as disturbed.
QUIET = 0.85


def scene(workload):
    return SCENES.get(workload, f"`{workload}`")


def plain(workload):
    """Returns the title of a workload without Markdown."""
    return scene(workload).strip("`")


def digits(value):
    """Formats a number with three significant digits, from 100 on as an integer with all digits."""
    if abs(value) >= 99.95:
        return f"{value:,.0f}"
    return f"{value:.3g}"


class Results:
    def __init__(self, path=COMMITTED):
        self.path = Path(path)
        self.data = json.loads(self.path.read_text())
        self.studies = {name: study["figures"] for name, study in self.data["studies"].items()}
        self.cuda = self.device_figures()
        self.cuda_peers, self.cubql, self.machine = (self.of_device(f"{name}.json") for name in ("cuda_peers", "cubql", "machine"))

    def of_device(self, name):
        """Returns the content of a JSON file in the folder of the GPU's figures, or None if it does not exist."""
        path = self.path.parent / DEVICE / name
        return json.loads(path.read_text()) if path.exists() else None

    def device_figures(self):
        """Merges the benchmark's runs on the device, cuda*.json; returns None if there are none. Adds the run's number of
        frames to each row. If several runs measured a scene, takes the row of the run with the most frames."""
        paths = [path for path in sorted((self.path.parent / DEVICE).glob("cuda*.json")) if path.stem != "cuda_peers"]
        runs = [json.loads(path.read_text()) for path in paths]
        if not runs:
            return None

        def rows(found):
            return [row | {"frames": run["frames"]} for run in runs for row in found(run)]

        scenes = {}
        for row in rows(lambda run: run["scenes"]):
            if row["scene"] not in scenes or scenes[row["scene"]]["frames"] < row["frames"]:
                scenes[row["scene"]] = row
        first = max(runs, key=lambda run: run["frames"])
        return {name: first[name] for name in ("commit", "cuda_runtime", "device", "driver", "limits")} | {
            "scenes": [scenes[name] for name in sorted(scenes, key=list(SCENES).index)],
            "sizes": rows(lambda run: run.get("growth", {}).get("sizes", [])),
            "steps": rows(lambda run: run.get("steps", [])),
            "worlds": rows(lambda run: run.get("worlds", []))}

    def study(self, name):
        """Returns a study's figures; an empty list if it was not run."""
        return self.studies.get(name) or []

    def sizes(self):
        """Returns the rows of the study `growth`, one for each number of triangles."""
        return (self.study("growth") or {"sizes": []})["sizes"]

    def fastest(self, question, name):
        """Maps each workload of this query to (the first contest of the workload in which `name` took part, the entry of its
        fastest configuration in that contest)."""
        found = {}
        for contest in self.data["contests"]:
            for way in contest["contestants"]:
                if contest["question"] == question and way["name"] == name and way["fastest_way"]:
                    found.setdefault(contest["workload"], (contest, way))
        return found

    def peers(self, question):
        """Returns the names of the peers that ran this query, in the order of their first contest."""
        names = []
        for contest in self.data["contests"]:
            for way in contest["contestants"]:
                if contest["question"] == question and way["name"] not in (*names, "crumple") and way["fastest_way"]:
                    names.append(way["name"])
        return names

    def version(self, peer):
        for entry in self.data.get("peers", []):
            if entry["name"] == peer:
                return entry.get("version", "")
        return ""

    def in_one_process(self, contest):
        """True for the first contest of a workload, in which the peers ran in Crumple's own process. Peers from PyPI ran in a
        later contest, in processes of their own."""
        return self.fastest(contest["question"], "crumple").get(contest["workload"], (None,))[0] is contest

    def busy(self, question=None, studies=()):
        """Returns a sentence about the contests of this query and the studies that other load disturbed; empty if none was."""
        measured = [(contest, ("" if self.in_one_process(contest) else "peers from PyPI, ") + scene(contest["workload"]))
                    for contest in self.data["contests"] if contest["question"] == question]
        measured += [(self.data["studies"].get(study, {}), f"`{study}`") for study in studies]
        every = self.data["machine"]["cpus"]
        found = [f"{entry['processors_at_hand']:.1f} ({name})" for entry, name in measured
                 if entry.get("processors_at_hand", every) < QUIET * every]
        if not found:
            return ""
        return f"Other load left {' and '.join(found)} of {every} cores free, so multi-threaded times are pessimistic."

    def sequences(self, least=3):
        """Maps the names of sequences with at least `least` frames to their figures."""
        return {s["sequence"]: s for s in self.study("sequences") if len(s["frames"]) >= least}
