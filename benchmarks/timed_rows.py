"""Rows of the benchmarks that are called from Python. A row compares crumple with a peer; their calls alternate.

A row has one or more turns, for example one per pose, and each round measures all turns of all contestants. Times are
medians. A ratio is the peer's time divided by crumple's. It is computed for each turn from medians over rounds or, if a
row has only one turn, for each round. The median and the quartiles of the ratios are reported.
"""

from __future__ import annotations

import functools
import time
from statistics import median, quantiles

LEAST_ROUNDS = 3


def microseconds(call, clock):
    begin = clock()
    answer = call()
    end = clock()
    del answer
    return 1e6 * (end - begin)


class Row:
    """Row of the table. `ours` and each function of `theirs` (by the name of a peer's configuration) run the queries of
    a turn, whose number is their argument. compare(name) describes how results of that configuration differ."""

    def __init__(
        self, name, ours, theirs, turns, compare, a_turn=1, less=None, clock=time.thread_time, peer_a_turn=None
    ):
        self.name, self.ours, self.theirs, self.turns, self.compare = name, ours, theirs, turns, compare
        self.a_turn = a_turn  # queries per turn
        self.peer_a_turn = peer_a_turn or a_turn  # queries per turn of the peer, if they are fewer than crumple's
        self.clock = clock  # default: CPU time of the thread, which other load affects little; for rows on one thread
        self.less = less  # function that runs only the peer's loop; its time is subtracted from the peer's


def race(row, rounds, seconds):
    """Maps the name of each contestant to microseconds, [turn][round]. The order of contestants is reversed from round
    to round. Stops before `rounds` rounds if `seconds` have passed, but not before LEAST_ROUNDS rounds."""
    calls = {"crumple": row.ours, **row.theirs, **({"loop": row.less} if row.less else {})}
    times = {name: [[] for _ in range(row.turns)] for name in calls}
    for call in calls.values():
        call(0), call(row.turns - 1)
    begin = time.perf_counter()
    for r in range(rounds):
        if r >= LEAST_ROUNDS and time.perf_counter() - begin > seconds:
            break
        for turn in range(row.turns):
            for name in list(calls)[:: 1 if r % 2 else -1]:
                times[name][turn].append(microseconds(functools.partial(calls[name], turn), row.clock))
    return times


def judge(row, rounds, seconds=float("inf")):
    times = race(row, rounds, seconds)
    if row.turns == 1:  # values are those of rounds, otherwise medians of turns
        times = {name: times[name][0] for name in times}
    else:
        times = {name: [median(t) for t in times[name]] for name in times}
    ways = {name: median(times[name]) / row.peer_a_turn for name in row.theirs}
    way = min(ways, key=ways.get)
    loop = [t / row.peer_a_turn for t in times.get("loop", [0.0] * len(times[way]))]
    theirs = [t / row.peer_a_turn - u for t, u in zip(times[way], loop)]
    ours = [t / row.a_turn for t in times["crumple"]]
    lower, middle, upper = quantiles([t / o for t, o in zip(theirs, ours)], method="inclusive")
    answers = row.compare(way)
    if row.a_turn > 1:
        answers += f"; {1e6 / median(ours):,.0f} a second"
    return {
        "name": row.name,
        "crumple_us": median(ours),
        "peer": way,
        "peer_us": median(theirs),
        "loop_us": median(loop),
        "ratio": middle,
        "lower_quartile": lower,
        "upper_quartile": upper,
        "answers": answers,
    }


def show(figures):
    rows = [["microseconds a question", "crumple", "peer", "ratio", "quartiles", "peer", "answers"]]
    for f in figures:
        quartiles = f"{f['lower_quartile']:.2f} - {f['upper_quartile']:.2f}"
        numbers = [f"{f['crumple_us']:.3g}", f"{f['peer_us']:.3g}", f"{f['ratio']:.2f}", quartiles]
        rows.append([f["name"], *numbers, f["peer"], f["answers"]])
    widths = [max(map(len, column)) for column in zip(*rows)]
    for row in rows:
        print("  ".join(cell.ljust(w) for cell, w in zip(row, widths)).rstrip())
