"""The figures of one benchmark run, and how to find them by name."""

import json
from pathlib import Path

TOP = Path(__file__).resolve().parents[3]
COMMITTED = TOP / "benchmarks/results/xeon-2-threads.json"

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

# Share of the processors below which a measurement counts as disturbed.
QUIET = 0.85


def scene(workload):
    return SCENES.get(workload, f"`{workload}`")


def plain(workload):
    """The same without Markdown."""
    return scene(workload).strip("`")


def digits(value):
    """Three significant digits."""
    if abs(value) >= 99.95:
        return f"{value:,.0f}"
    return f"{value:.3g}"


class Results:
    def __init__(self, path=COMMITTED):
        self.path = Path(path)
        self.data = json.loads(self.path.read_text())
        self.studies = {name: study["figures"] for name, study in self.data["studies"].items()}
        # What scripts/gpu_check.sh leaves beside them, where there was a device.
        self.cuda, self.cuda_peers = (self.beside(name) for name in ("cuda.json", "cuda_peers.json"))

    def beside(self, name):
        """The figures of another file in the same folder, or None."""
        path = self.path.with_name(name)
        return json.loads(path.read_text()) if path.exists() else None

    def study(self, name):
        """A study's figures, an empty list if it was not run."""
        return self.studies.get(name) or []

    def sizes(self):
        """Those of the growth curve."""
        return (self.study("growth") or {"sizes": []})["sizes"]

    def fastest(self, question, name):
        """Of each workload with this question: the contest and the peer's fastest way, if it was raced."""
        found = {}
        for contest in self.data["contests"]:
            for way in contest["contestants"]:
                if contest["question"] == question and way["name"] == name and way["fastest_way"]:
                    found.setdefault(contest["workload"], (contest, way))
        return found

    def peers(self, question):
        """Names of those that answered this question, in the order of their first contest."""
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
        """Whether peers ran in Crumple's own process; those from PyPI, in a later contest, do not."""
        return self.fastest(contest["question"], "crumple").get(contest["workload"], (None,))[0] is contest

    def busy(self, question=None, studies=()):
        """A sentence about what was measured while others used the machine, or nothing."""
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
        """Those of at least so many frames, by name."""
        return {s["sequence"]: s for s in self.study("sequences") if len(s["frames"]) >= least}
