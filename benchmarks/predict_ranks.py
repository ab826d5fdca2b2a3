"""Predicts the time of a frame on 64 to 4,096 ranks from the work and messages of simulated ranks.

python predict_ranks.py RESULTS [--latency SECONDS] [--overhead SECONDS] [--bandwidth BYTES_PER_SECOND] [--cores N]

RESULTS is the JSON of `crumple_benchmark --study scaling`. Each quantity is fitted over the rows of 16 ranks and more,
as a function of the triangles per rank (n) and the number of ranks (P), with constants a, b, c of its own. Fitted are
values of the rank with the largest value, except for work and bytes, of which means over all ranks are fitted:

    work        a n^b milliseconds of searches, times the ratio of the slowest rank to the mean
    rest        n (a + min(b sqrt(P), LOOK)) + c milliseconds of other computation. The more ranks, the smaller are
                their parts, and the more triangles may have moved into another part since the last frame and must be
                checked; a check takes LOOK milliseconds
    messages    a P^b: a rank sends to the owners of all parts that have some of its triangles
    bytes       a n^b P^c, but at most n times the largest measured number of bytes per triangle, since no more than all
                coordinates are sent

Machines have N ranks of one core each and one full-duplex link, which their ranks share. A frame then takes work, rest,
and

    messages x overhead + exchanges x latency + (2 reductions + broadcasts + all-to-alls) x log2(P) x latency
    + (N x mean bytes + largest bytes + 2 x bytes reduced + all-to-alls x log2(P) x 4 P bytes) / bandwidth

Needs NumPy. docs/scaling.md shows the tables.
"""

import argparse
import json
from pathlib import Path

import numpy as np

SMALLEST = 16  # least number of ranks of the rows that are fitted
LOOK = 300e-6  # milliseconds to find the parts of one triangle, if parts are found on three levels


def fit(columns, values):
    """Fits values by a linear combination of the columns, with the least sum of squared relative errors. Returns the
    factors of the columns, and the largest relative error."""
    columns, values = np.array(columns, float).T, np.array(values, float)
    factors = np.linalg.lstsq(columns / values[:, None], np.ones(len(values)), rcond=None)[0]
    return factors, np.max(np.abs(columns @ factors / values - 1))


def fit_power(bases, values):
    """Fits log(value) = log(a) + b log(base) + ...; returns log(a), the exponents, and the largest relative error."""
    columns = np.array([np.ones(len(values)), *(np.log(base) for base in bases)]).T
    logs = np.log(np.array(values, float))
    factors = np.linalg.lstsq(columns, logs, rcond=None)[0]
    return factors, np.max(np.abs(np.exp(columns @ factors - logs) - 1))


class Model:
    def __init__(self, rows):
        self.rows = [row for row in rows if row["ranks"] >= SMALLEST]
        n, ranks = self.column("members"), self.column(None)
        slowest = self.column("work", "largest") / self.column("work")
        self.imbalance = float(np.median(slowest))
        self.work, self.work_error = fit_power([n], self.column("work"))
        self.rest, self.rest_error = fit([n, n * np.sqrt(ranks), np.ones(len(n))], self.column("rest", "largest"))
        self.messages, self.messages_error = fit_power([ranks], self.column("messages", "largest"))
        self.bytes, self.bytes_error = fit_power([n, ranks], self.column("bytes"))
        self.most_bytes = float(np.max(self.column("bytes") / n))
        self.largest_bytes = float(np.median(self.column("bytes", "largest") / self.column("bytes")))
        # Bytes that are reduced in a frame, divided by the number of ranks: eight bytes per part.
        self.reduced = float(np.median(self.column("reduced") / ranks))
        self.counts = {name: float(np.median(self.column(name)))
                       for name in ("reductions", "broadcasts", "all_to_alls", "exchanges")}

    def column(self, name, which="mean"):
        return np.array([row["frame"][name][which] if name else row["ranks"] for row in self.rows], float)

    def frame(self, n, ranks, network):
        """Returns the milliseconds that the slowest rank spends on work, rest, latency, and sending bytes."""
        log = np.log2(ranks)
        work = self.imbalance * np.exp(self.work @ [1, np.log(n)])
        rest = min(self.rest @ [n, n * np.sqrt(ranks), 1], LOOK * n + self.rest @ [n, 0, 1])
        messages = np.exp(self.messages @ [1, np.log(ranks)])
        sent = min(np.exp(self.bytes @ [1, np.log(n), np.log(ranks)]), self.most_bytes * n)
        count = self.counts
        latency = (messages * network.overhead + count["exchanges"] * network.latency
                   + (2 * count["reductions"] + count["broadcasts"] + count["all_to_alls"]) * log * network.latency)
        of_machine = (network.cores + self.largest_bytes) * sent
        volume = of_machine + 2 * self.reduced * ranks + count["all_to_alls"] * log * 4 * ranks
        return work, rest, 1e3 * latency, 1e3 * volume / network.bandwidth


def number(x):
    return f"{x:,.0f}" if x >= 1000 else f"{x:.3g}"


def table(title, model, sizes, network):
    print(f"\n{title}\n")
    print("| ranks | triangles a rank | in all | work ms | rest ms | messages ms | bytes ms | frame ms | of it work |")
    print("|---|---|---|---|---|---|---|---|---|")
    for ranks, n in sizes:
        work, rest, latency, volume = model.frame(n, ranks, network)
        frame = work + rest + latency + volume
        print(f"| {ranks:,} | {n:,.0f} | {n * ranks / 1e6:,.0f}M | {number(work)} | {number(rest)} | {number(latency)} "
              f"| {number(volume)} | {number(frame)} | {100 * work / frame:.0f} % |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", type=Path)
    parser.add_argument("--latency", type=float, default=2e-6, help="seconds of a message from one rank to another")
    parser.add_argument("--overhead", type=float, default=1e-6, help="seconds that a rank spends on a message")
    parser.add_argument("--bandwidth", type=float, default=12.5e9, help="bytes per second of a machine")
    parser.add_argument("--cores", type=int, default=64, help="ranks per machine")
    network = parser.parse_args()
    figures = json.loads(network.results.read_text())
    model = Model(figures["studies"]["scaling"]["figures"])
    print(f"largest errors of the fits: work {model.work_error:.0%}, rest {model.rest_error:.0%}, "
          f"messages {model.messages_error:.0%}, bytes {model.bytes_error:.0%}; "
          f"the slowest rank's work is {model.imbalance:.2f} times the mean")
    counts = [64, 128, 256, 512, 1024, 2048, 4096]
    for n in (100_000, 400_000):
        table(f"Weak: {n:,} triangles a rank", model, [(ranks, n) for ranks in counts], network)
    for all_triangles in (100_000_000, 1_000_000_000):
        table(f"Strong: {all_triangles // 1_000_000:,} million triangles", model,
              [(ranks, all_triangles / ranks) for ranks in counts], network)


if __name__ == "__main__":
    main()
