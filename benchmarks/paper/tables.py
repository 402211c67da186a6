#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""Makes the tables of docs/results.md from results.json and, for Table 1, from what paper_cube prints.

    tables.py [--results FILE.json] [--cube FILE.json] [--into docs/results.md]

Without --into they are printed. In the page each stands between <!-- NAME --> and <!-- end --> and is replaced.
"""
import argparse
import json
import pathlib
import re
import statistics
import tempfile

import meshio

from run import ABLATION, HERE, MODELS, OUR_VARIANTS, PAPERS_VARIANTS, PLACEMENTS, SMALL, load, surface_file
from shapes import SIZES as SHAPES

NAMES = ["dome", "bunny", "blade", "piece", "fuselage", "naca"]
PAPERS_TERMS = [*PAPERS_VARIANTS, *(v for v in OUR_VARIANTS if "paper's" in v)]


def table(head, rows):
    cells = head.split("|")
    right = ["---" if i == 0 else "---:" for i in range(len(cells))]
    return "\n".join("| " + " | ".join(row) + " |" for row in [[c.strip() for c in cells], right, *rows])


def found(results, model, size, variant):
    return results["runs"].get(f"{model} | {size} | {variant}")


def shares(row):
    return f"{row['hex_number']:.1f} / {row['hex_volume']:.1f}"


def stages(row):
    """Seconds of the clock, brought to the sum of the CPU's: the machine may have been busy with other things."""
    scale = row["cpu"] / max(row["seconds"]["total"], 1e-9)
    s = {stage: scale * seconds for stage, seconds in row["seconds"].items()}
    return f"{s['background'] + s['field']:.1f} / {s['insertion']:.1f} / {s['recombination']:.1f}"


def cpu(row):
    return f"{row['cpu']:.1f}" if row["cpu"] < 10 else f"{row['cpu']:.0f}"


def megabytes(row):
    return str(row.get("megabytes", "–"))  # not known of early runs


def kinds(row):
    return " / ".join(f"{row[kind]:,}" for kind in ("tetrahedra", "prisms", "pyramids", "hexahedra"))


def enclosed_volume(model):
    """Of the surface, summed over the triangles of its file."""
    with tempfile.TemporaryDirectory() as folder:
        path = surface_file(MODELS, model, pathlib.Path(folder))
        surface, total = meshio.read(path), 0.0
    for block in surface.cells:
        for i in range(1, block.data.shape[1] - 1):
            a, b, c = (surface.points[block.data[:, k]].astype(float) for k in (0, i, i + 1))
            total += float((a[:, 0] * (b[:, 1] * c[:, 2] - b[:, 2] * c[:, 1]) + a[:, 1] * (b[:, 2] * c[:, 0] - b[:, 0] * c[:, 2])
                            + a[:, 2] * (b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0])).sum()) / 6
    return total


def papers_terms(results, paper, size):
    rows = []
    for model in NAMES:
        for variant in PAPERS_TERMS:
            row = found(results, model, size, variant)
            if not row:
                continue
            theirs = paper[model].get(variant)
            rows.append([f"{model}, {variant.split(',')[0]}", f"{row['cells']:,}", stages(row),
                         cpu(row), f"**{shares(row)}**", f"{row['least_hexahedron']:.2f} / {row['mean']:.2f}",
                         f"{row['open']:,}", megabytes(row),
                         *([f"{theirs[0]:,}", f"{theirs[4]:.0f}", f"{theirs[5]:g} / {theirs[6]:g}"] if theirs else ["", "", ""])])
    return table("test case | elements | t_b / t_i / t_r, s | CPU s | hexahedra, number / volume % | least hex / mean SJ | "
                 "open | MB | paper: elements | t_t, s | number / volume %", rows)


def our_terms(results, size, models):
    rows, default = [], results["program"]["default"]
    for model in models:
        surface_volume = enclosed_volume(model)
        for variant in PLACEMENTS:
            row = found(results, model, size, variant)
            if not row:
                continue
            off = 100 * abs(row["volume"] / surface_volume - 1)
            rows.append([f"{model} {row['size']:g}, {variant}{' (default)' if variant == default else ''}", kinds(row), f"**{shares(row)}**",
                         f"{row['least']:.2f} / {row['least_hexahedron']:.2f} / {row['mean']:.2f}", f"{row['invalid']}",
                         f"{row['open']}", f"{off:.2f}", cpu(row), megabytes(row)])
    return table("model, size, placement | tet / prism / pyramid / hex | hexahedra, number / volume % | least SJ: all / hex / mean | "
                 "invalid | open | volume off, % | CPU s | MB", rows)


def ablation(results):
    rows = []
    for variant in ABLATION:
        mine = [found(results, model, "small", variant) for model in NAMES]
        known = [row for row in mine if row]
        if not known:
            continue
        means = [f"{statistics.mean(row[share] for row in mine):.1f}" for share in ("hex_number", "hex_volume") if all(mine)]
        rows.append([variant, *(shares(row) if row else "–" for row in mine), " / ".join(means),
                     f"{min(row['least'] for row in known):.2f}", f"{sum(row['open'] for row in known):,}",
                     f"{sum(row['cpu'] for row in known):.0f}"])
    return table("variant | " + " | ".join(f"{m} {SMALL[m]:g}" for m in NAMES) + " | mean | least SJ | open | CPU s", rows)


def steps(results):
    """Steps that the program has no option for: the columns of the ablation, and how many candidates there were."""
    found = results.get("steps", {})
    known = [found[model] for model in NAMES if model in found]
    rows = []
    for variant in known[0] if known else []:
        mine = [found.get(model, {}).get(variant) for model in NAMES]
        there = [row for row in mine if row]
        means = " / ".join(f"{statistics.mean(row[share] for row in there):.1f}" for share in ("hex_number", "hex_volume"))
        candidates = sum(row.get("candidates", 0) for row in there)
        rows.append([variant, *(shares(row) if row else "–" for row in mine), means, f"{candidates:,}" if candidates else "",
                     f"{min(row['least'] for row in there):.2f}", f"{sum(row['cpu'] for row in there):.0f}"])
    return table("variant | " + " | ".join(f"{m} {SMALL[m]:g}" for m in NAMES) + " | mean | candidates | least SJ | CPU s", rows)


def best_of_paper(results, paper):
    """The paper's best shares of each model, and the run of ours in the same terms that has most hexahedra by number."""
    rows = []
    for model in NAMES:
        runs = {f"{variant.split(',')[0]}, {size}": found(results, model, size, variant)
                for size in ("small", "full") for variant in PAPERS_TERMS}
        name, best = max(((n, row) for n, row in runs.items() if row), key=lambda run: run[1]["hex_number"])
        theirs = [max(row[k] for row in paper[model].values()) for k in (5, 6)]
        mine = [best["hex_number"], best["hex_volume"]]
        rows.append([model, " / ".join(f"{x:g}" for x in theirs), shares(best), name,
                     " / ".join(f"{x - y:+.1f}" for x, y in zip(mine, theirs))])
    return table("model | paper's best, number / volume % | our best in the same terms | which | difference", rows)


def table_1(cube, paper):
    rows = []
    for n in (3, 4, 5):
        theirs = paper["table_1"][f"cube {n}"]
        rows.append([f"{n}^3, paper", str(theirs["tetrahedra"]), str(theirs["hexahedra"]), str(theirs["degree"])])
        for ties in ("chance", "half-way", "alike"):
            mine = [row for row in cube["table_1"] if row["cubes"] == n and row["ties"] == ties]
            spans = [sorted(row[key] for row in mine) for key in ("tetrahedra", "hexahedra", "degree")]
            rows.append([f"{n}^3, ties {ties}", *(f"{s[0]:.0f} to {s[-1]:.0f}" if len(s) > 1 else f"{s[0]:.0f}" for s in spans)])
    return table("cubes | tetrahedra | potential hexahedra | mean degree", rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--results", type=pathlib.Path, default=HERE / "results.json")
    parser.add_argument("--cube", type=pathlib.Path, default=HERE / "cube.json")
    parser.add_argument("--into", type=pathlib.Path)
    options = parser.parse_args()
    results, paper = load(options.results), json.loads((HERE / "paper.json").read_text())
    tables = {
        "best": best_of_paper(results, paper),
        "paper full": papers_terms(results, paper, "full"),
        "paper small": papers_terms(results, paper, "small"),
        "ours full": our_terms(results, "full", NAMES),
        "ours small": our_terms(results, "small", NAMES),
        "shapes": our_terms(results, "shapes", SHAPES),
        "ablation": ablation(results),
        "steps": steps(results),
        "table 1": table_1(json.loads(options.cube.read_text()), paper),
    }
    if not options.into:
        print("\n\n".join(f"{name}\n\n{text}" for name, text in tables.items()))
        return
    page = options.into.read_text()
    for name, text in tables.items():
        page, n = re.subn(rf"<!-- {name} -->\n.*?<!-- end -->", lambda _: f"<!-- {name} -->\n\n{text}\n\n<!-- end -->", page,
                          flags=re.S)
        if n != 1:
            raise SystemExit(f"tables.py: {options.into} has no place for the table \"{name}\"")
    options.into.write_text(page)


if __name__ == "__main__":
    main()
