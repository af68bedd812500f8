"""Answers questions by rliable: a JSON list of cases on standard input, a JSON list of answers on standard output.

A case holds two arms `x` and `y` (lists of runs, each a list of scores per task), thresholds `taus`, the target `gamma`,
and `reps`: the numbers of resamples for `aggregates`, `profiles` and `improvement` (0: no interval). An answer holds, by
name, a point and the ends of its 95 % interval; ends are null where none was asked for.
"""

import itertools
import json
import multiprocessing
import sys

import numpy as np
from rliable import library, metrics


def questions(case):
    """What is asked: the kind, the names of the figures, the scores they are of, and a function that gives their values."""
    x, y = np.array(case["x"]), np.array(case["y"])
    taus, gamma = np.array(case["taus"]), case["gamma"]
    aggregates = {
        "mean": metrics.aggregate_mean,
        "median": metrics.aggregate_median,
        "iqm": metrics.aggregate_iqm,
        "gap": lambda scores: metrics.aggregate_optimality_gap(scores, gamma),
    }
    yield "aggregates", list(aggregates), x, lambda scores: np.array([of(scores) for of in aggregates.values()])
    for name, of in ("runs", library.score_distributions), ("means", library.average_score_distributions):
        yield "profiles", [f"{name} {i}" for i in range(len(taus))], x, lambda scores, of=of: of(scores, taus)
    yield "improvement", ["improvement"], [x, y], lambda x, y: np.array([metrics.probability_of_improvement(x, y)])


def answer(place, case):
    # rliable draws from numpy's global stream, whatever random state it is given.
    np.random.seed(place)
    found = {}
    for kind, names, scores, function in questions(case):
        if reps := case["reps"][kind]:
            points, intervals = library.get_interval_estimates({"": scores}, function, reps=reps)
            rows = zip(points[""], *intervals[""])
        else:
            points = function(*scores) if isinstance(scores, list) else function(scores)
            rows = ((point, None, None) for point in points)
        for name, (point, low, high) in zip(names, rows):
            found[name] = {"point": float(point), "low": low, "high": high}
    return found


def main():
    asked = list(enumerate(json.load(sys.stdin)))
    try:
        with multiprocessing.Pool() as pool:
            answers = pool.starmap(answer, asked, chunksize=1)
    except FileNotFoundError:  # no shared memory here
        answers = list(itertools.starmap(answer, asked))
    json.dump(answers, sys.stdout)


if __name__ == "__main__":
    main()
