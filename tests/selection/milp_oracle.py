# SPDX-License-Identifier: BSL-1.0
"""Compares the example `select_graph` with scipy's integer programming (HiGHS).

    milp_oracle.py select_graph                                    on clustered random graphs
    milp_oracle.py select_graph graph.metis ...
    milp_oracle.py select_graph candidate_graph CELLS:FLOOR ...    on benchmark balls, written by the program candidate_graph

Exits with 77 when scipy is not there.
"""
import os
import re
import subprocess
import sys
import tempfile
import time

try:
    import numpy as np
    from scipy.optimize import Bounds, LinearConstraint, milp
    from scipy.sparse import csr_matrix
except ImportError:
    sys.exit(77)


def random_graph(path, n, radius, seed):
    rng = np.random.default_rng(seed)
    points = rng.random((n, 3))
    weights = rng.integers(5000, 10000, n)
    near = np.linalg.norm(points[:, None] - points[None], axis=2) < radius
    np.fill_diagonal(near, False)
    with open(path, "w") as out:
        out.write(f"{n} {near.sum() // 2} 010\n")
        for v in range(n):
            out.write(" ".join(map(str, [weights[v], *(np.flatnonzero(near[v]) + 1)])) + "\n")


def read_graph(path):
    lines = [line.split() for line in open(path) if not line.startswith("%")]
    n, has_weights = int(lines[0][0]), len(lines[0]) > 2
    rows = [list(map(int, line)) for line in lines[1 : n + 1]]
    weights = np.array([row[0] if has_weights else 1 for row in rows], float)
    return weights, [[u - 1 for u in row[has_weights:]] for row in rows]


def cliques(neighbours):
    """One greedy clique for each conflict that no earlier one holds: far better rows than pairs."""
    sets = [set(row) for row in neighbours]
    covered = set()
    for v, row in enumerate(neighbours):
        for u in row:
            if u < v or (v, u) in covered:
                continue
            clique, common = [v, u], sets[v] & sets[u]
            while common:
                clique.append(min(common))
                common &= sets[clique[-1]]
            covered |= {(a, b) for a in clique for b in clique if a < b}
            yield clique


def optimum(path):
    weights, neighbours = read_graph(path)
    rows = list(cliques(neighbours))
    entries = [v for row in rows for v in row]
    offsets = np.cumsum([0] + [len(row) for row in rows])
    matrix = csr_matrix((np.ones(len(entries)), entries, offsets), shape=(len(rows), len(weights)))
    result = milp(-weights, constraints=LinearConstraint(matrix, -np.inf, 1), bounds=Bounds(0, 1),
                  integrality=np.ones(len(weights)), options={"mip_rel_gap": 0})
    return round(-result.fun)


def ours(program, path):
    run = subprocess.run([program, path, "exact"], capture_output=True, text=True, check=True)
    weight, status = re.search(r"weight (\d+), .* %, (\w+)", run.stderr).groups()
    return int(weight), status


def make_graphs(folder, arguments):
    """Paths of the graphs that the arguments ask for."""
    if not arguments:
        for seed, (n, radius) in enumerate([(200, 0.2), (300, 0.2), (400, 0.18)]):
            yield os.path.join(folder, f"{seed}.metis")
            random_graph(os.path.join(folder, f"{seed}.metis"), n, radius, seed)
    elif arguments[0].endswith(".metis"):
        yield from arguments
    else:
        for ball in arguments[1:]:
            path = os.path.join(folder, f"ball {ball}.metis")
            subprocess.run([arguments[0], *ball.split(":"), path], check=True)
            yield path


def main(program, *arguments):
    with tempfile.TemporaryDirectory() as folder:
        for path in list(make_graphs(folder, arguments)):
            start = time.process_time()
            expected = optimum(path)
            seconds = time.process_time() - start
            weight, status = ours(program, path)
            print(f"{os.path.basename(path)}: {len(read_graph(path)[0])} candidates, milp {expected} in {seconds:.0f} s, "
                  f"select {weight}, {status}", flush=True)
            if weight != expected or status != "optimal":
                return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
