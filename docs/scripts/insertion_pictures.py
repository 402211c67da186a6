#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""docs/images/insertion-orders.png from the output of insertion_orders.cpp: insertion_pictures.py POINTS.txt OUT.png"""
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.collections import LineCollection

points, links = {}, {}
for line in open(sys.argv[1]):
    kind, order, *numbers = line.split()
    row = [float(x) for x in numbers]
    (points if kind == "p" else links).setdefault(order, []).append(row)

figure, axes = plt.subplots(1, 2, figsize=(10, 4))
for axis, order in zip(axes, ["fifo", "smoothness"]):
    segments = [[(a, b), (c, d)] for a, b, c, d in links[order]]
    axis.add_collection(LineCollection(segments, colors="0.6", linewidths=0.6))
    index, x, y = zip(*points[order])
    axis.scatter(x, y, c=index, s=7, cmap="viridis", zorder=2)
    axis.set_title({"fifo": "FIFO", "smoothness": "smoothest first"}[order])
    axis.set_aspect("equal")
    axis.axis("off")
figure.tight_layout()
figure.savefig(sys.argv[2], dpi=80)
