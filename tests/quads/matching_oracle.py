# SPDX-License-Identifier: BSL-1.0
"""Compares LEMON's matchings with scipy's integer programming (HiGHS): matching_oracle.py matching_cases

Exits with 77 when scipy is not there.
"""
import subprocess
import sys

try:
    import numpy as np
    from scipy.optimize import Bounds, LinearConstraint, milp
    from scipy.sparse import csr_matrix
except ImportError:
    sys.exit(77)


def best(n, edges):
    """Greatest number of pairs, and the least cost among matchings with so many."""
    m = len(edges)
    rows = edges[:, :2].ravel()
    columns = np.repeat(np.arange(m), 2)
    incidence = csr_matrix((np.ones(2 * m), (rows, columns)), shape=(n, m))
    cost = edges[:, 2] - float(edges[:, 2].max() + 1) * (n // 2 + 1)
    found = milp(cost, constraints=LinearConstraint(incidence, -np.inf, 1), integrality=np.ones(m), bounds=Bounds(0, 1),
                 options={"mip_rel_gap": 0})
    chosen = found.x > 0.5
    return int(chosen.sum()), int(edges[chosen, 2].sum())


def main():
    numbers = iter(subprocess.run(sys.argv[1], check=True, capture_output=True, text=True).stdout.split())
    n_cases = 0
    for word in numbers:
        n, m, n_pairs, cost = int(word), int(next(numbers)), int(next(numbers)), int(next(numbers))
        edges = np.array([int(next(numbers)) for _ in range(3 * m)]).reshape(m, 3)
        if best(n, edges) != (n_pairs, cost):
            sys.exit(f"case {n_cases}: LEMON has {n_pairs} pairs at {cost}, scipy {best(n, edges)}")
        n_cases += 1
    print(f"{n_cases} matchings equal scipy's")
    return 0 if n_cases == 12 else 1


if __name__ == "__main__":
    sys.exit(main())
