# SPDX-License-Identifier: BSL-1.0
"""Draws docs/images/selection_gap.png: proven gap against time, the fastest of several runs.

    bench_selection --benchmark_filter='trade_off' --benchmark_format=json > curve.json
    python3 docs/scripts/selection_plot.py docs/images/selection_gap.png curve.json [more.json ...]
"""
import re
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

FIELDS = ("cpu_time", "bound", "candidates", "weight")


def records(path):
    """Benchmarks of a file that may still be being written, hence not by a JSON parser."""
    text = open(path).read()
    for block in re.findall(r"\{[^{}]*\}", text):
        name = re.search(r'"name": "(\w+)/(\d+)(?:/(\d+))?/iterations', block)
        values = {f: re.search(rf'"{f}": ([-+.\de]+)', block) for f in FIELDS}
        if name and all(values.values()):
            numbers = {f: float(v.group(1)) for f, v in values.items()}
            yield name.group(1), int(name.group(2)), int(name.group(3) or 0), numbers


def main(image, paths):
    fastest = {}
    for path in paths:
        for kind, size, rounds, r in records(path):
            if kind == "trade_off" and rounds > 0:
                known = fastest.setdefault((size, rounds), r)
                fastest[size, rounds] = min(known, r, key=lambda x: x["cpu_time"])
    curves = {}
    for (size, _), r in fastest.items():
        curves.setdefault(size, []).append((r["cpu_time"] / 1000, r))
    figure, axes = plt.subplots(figsize=(6.4, 4.0), dpi=110)
    for size, points in sorted(curves.items()):
        points.sort(key=lambda p: p[0])
        gaps = [100 * (r["bound"] - r["weight"]) / r["bound"] for _, r in points]
        label = f"ball of {size} cells, {points[0][1]['candidates']:,.0f} candidates"
        axes.plot([t for t, _ in points], gaps, marker="o", markersize=3, label=label)
    axes.axhline(0.5, color="grey", linewidth=0.8, linestyle="--")
    axes.text(0.01, 0.52, "asked for by default", color="grey", fontsize=8, transform=axes.get_yaxis_transform())
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("CPU seconds, one thread")
    axes.set_ylabel("proven gap, %")
    axes.grid(True, which="both", alpha=0.25)
    axes.legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(image)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
