#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""Makes the tables of docs/results.md and README.md, and the sentences that quote them, from results.json, from what
paper_cube prints and from what viewer_pictures.py noted of the pictures.

    tables.py [--results FILE.json] [--cube FILE.json] [--pictures FILE.json] [--write | --check | --into PAGE]

Without an option they are printed. --write brings both pages up to date, --check fails when one is not, --into one page
alone. In a page each stands between <!-- NAME --> and <!-- end --> and is replaced.
"""
import argparse
import pathlib
import re
import statistics
import sys

from run import ABLATION, HERE, OUR_VARIANTS, PAPERS_VARIANTS, PLACEMENTS, SMALL
from shapes import SIZES as SHAPES
from storage import Failure, load, read_json

ROOT = HERE.parents[1]
PAGES = [ROOT / "docs" / "results.md", ROOT / "README.md"]
NAMES = ["dome", "bunny", "blade", "piece", "fuselage", "naca"]
PAPERS_TERMS = [*PAPERS_VARIANTS, *(v for v in OUR_VARIANTS if "paper's" in v)]
SHARES = {"number": "hex_number", "volume": "hex_volume"}


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
    return f"{s['background'] + s['field']:.1f} / {s['insertion']:.1f} / {s['tetrahedralization']:.1f} / {s['recombination']:.1f}"


def cpu(row):
    return f"{row['cpu']:.1f}" if row["cpu"] < 10 else f"{row['cpu']:.0f}"


def known(row, key):
    return f"{row[key]:,}" if key in row else "–"  # not known of early runs


def open_edges(row):
    """Early rows have but the sum of these and of other bad faces."""
    if "open_edges" in row or "bad_faces" not in row:
        return known(row, "open_edges")
    return f"≤ {row['bad_faces']}" if row["bad_faces"] else "0"


def kinds(row):
    return " / ".join(f"{row[kind]:,}" for kind in ("tetrahedra", "prisms", "pyramids", "hexahedra"))


def surface_of(results, model):
    """Of a model's rows, all of which are of one surface (run.py sees to it)."""
    rows = (row for key, row in results["runs"].items() if key.split(" | ")[0] == model)
    return next((row["surface"] for row in rows if "surface" in row), None)


def volume_off(results, model, row):
    """By how many % the mesh's volume differs from that of the surface that the row, or an early row's model, is of."""
    surface = row.get("surface") or surface_of(results, model)
    return 100 * abs(row["volume"] / surface["volume"] - 1) if surface else None


def papers_terms(results, paper, size, models):
    rows = []
    for model in models:
        for variant in PAPERS_TERMS:
            row = found(results, model, size, variant)
            if not row:
                continue
            theirs = paper.get(model, {}).get(variant)
            rows.append([f"{model}, {variant.split(',')[0]}", f"{row['cells']:,}", stages(row), cpu(row), f"**{shares(row)}**",
                         f"{row['least']:.3f} / {row['least_hexahedron']:.2f} / {row['mean']:.2f}", f"{row['open']:,}",
                         open_edges(row), known(row, "megabytes"),
                         *([f"{theirs[0]:,}", f"{theirs[4]:.0f}", f"{theirs[5]:g} / {theirs[6]:g}"] if theirs else ["", "", ""])])
    head = ("test case | elements | t_b / t_i / t_t / t_r, s | CPU s | hexahedra, number / volume % | SJ: least / hex / mean | "
            "open | open edges | MB | paper: elements | total, s | number / volume %")
    if not any(row[-1] for row in rows):
        head, rows = head.rsplit("|", 3)[0], [row[:-3] for row in rows]
    return table(head, rows)


def our_terms(results, size, models):
    rows, default = [], results["program"].get("default")
    for model in models:
        for variant in PLACEMENTS:
            row = found(results, model, size, variant)
            if not row:
                continue
            off = volume_off(results, model, row)
            rows.append([f"{model} {row['size']:g}, {variant}{' (default)' if variant == default else ''}", kinds(row), f"**{shares(row)}**",
                         f"{row['least']:.2f} / {row['least_hexahedron']:.2f} / {row['mean']:.2f}", f"{row['invalid']}",
                         f"{row['open']}", open_edges(row), "–" if off is None else f"{off:.2f}", cpu(row),
                         known(row, "megabytes")])
    return table("model, size, placement | tet / prism / pyramid / hex | hexahedra, number / volume % | SJ: least / hex / mean | "
                 "invalid | open | open edges | volume off, % | CPU s | MB", rows)


def over_models(results, variant, rows, more):
    """A line over the six models: shares of each, their means, then what `more` says of those there are."""
    there = [row for row in rows if row]
    means = " / ".join(f"{statistics.mean(row[share] for row in there):.1f}" for share in SHARES.values())
    return [variant, *(shares(row) if row else "–" for row in rows), means if all(rows) else "–", *more(there)]


SIX = " | ".join(f"{m} {SMALL[m]:g}" for m in NAMES)


def ablation(results):
    rows = {v: [found(results, model, "small", v) for model in NAMES] for v in ABLATION}
    return table(f"variant | {SIX} | mean | least SJ | open | CPU s",
                 [over_models(results, v, mine, lambda there: [f"{min(row['least'] for row in there):.2f}",
                                                               f"{sum(row['open'] for row in there):,}",
                                                               f"{sum(row['cpu'] for row in there):.0f}"])
                  for v, mine in rows.items() if any(mine)])


def steps(results):
    """Steps that the program has no option for: the columns of the ablation, and how many candidates there were."""
    variants = {m: row["variants"] for m, row in results.get("steps", {}).items() if m in NAMES}

    def more(there):
        candidates = sum(row.get("candidates", 0) for row in there)
        return [f"{candidates:,}" if candidates else "", f"{min(row['least'] for row in there):.2f}",
                f"{sum(row['cpu'] for row in there):.0f}"]

    names = dict.fromkeys(v for of in variants.values() for v in of)
    return table(f"variant | {SIX} | mean | candidates | least SJ | CPU s",
                 [over_models(results, v, [variants.get(m, {}).get(v) for m in NAMES], more) for v in names])


def papers_best(paper, model):
    return [max(row[k] for row in paper[model].values()) for k in (5, 6)]


def best_of_paper(results, paper):
    """The paper's best shares of each model, and the run of ours in the same terms that has most hexahedra by number."""
    rows = []
    for model in NAMES:
        runs = {f"{variant.split(',')[0]}, {size}": found(results, model, size, variant)
                for size in ("small", "full") for variant in PAPERS_TERMS}
        runs = {name: row for name, row in runs.items() if row}
        if not runs:
            continue
        name, best = max(runs.items(), key=lambda run: run[1]["hex_number"])
        theirs, mine = papers_best(paper, model), [best["hex_number"], best["hex_volume"]]
        rows.append([model, " / ".join(f"{x:g}" for x in theirs), shares(best), name,
                     " / ".join(f"{x - y:+.1f}" for x, y in zip(mine, theirs))])
    return table("model | paper's best, number / volume % | our best in the same terms | which | difference", rows)


def table_1(results, cube, paper):
    rows = []
    for n in (3, 4, 5):
        theirs = paper["table_1"][f"cube {n}"]
        rows.append([f"{n}^3, paper", f"{theirs['tetrahedra']:,}", f"{theirs['hexahedra']:,}", str(theirs["degree"])])
        for ties in ("chance", "half-way", "alike"):
            mine = [row for row in cube["table_1"] if row["cubes"] == n and row["ties"] == ties]
            spans = [sorted(row[key] for row in mine) for key in ("tetrahedra", "hexahedra", "degree")]
            rows.append([f"{n}^3, ties {ties}", *(f"{s[0]:,.0f} to {s[-1]:,.0f}" if len(s) > 1 else f"{s[0]:,.0f}" for s in spans)])
    theirs, graph = paper["table_1"]["dome"], results.get("steps", {}).get("graph")
    for name, row in (("dome, paper", theirs), ("dome, fronts", graph and graph["variants"])):
        if row:
            rows.append([name, f"{row['tetrahedra']:,}", f"{row['hexahedra']:,}", f"{row['degree']:.0f}"])
    return table("mesh | tetrahedra | potential hexahedra | mean degree", rows)


# Sentences. Each number is computed, so that none can differ from the tables.

def differences(results, first, second, sizes, models=NAMES, share="number"):
    """Points by which `second` is ahead of `first`, by model and size; both are variants."""
    out = {}
    for size in sizes:
        for model in models:
            a, b = (found(results, model, size, v) for v in (first, second))
            if a and b:
                out[model, size] = b[SHARES[share]] - a[SHARES[share]]
    return out


def span(values, digits=1, sign=False):
    values = list(values)
    if not values:
        return "–"
    low, high = (f"{x:{'+' if sign else ''}.{digits}f}" for x in (min(values), max(values)))
    return low if low == high else f"{low} to {high}"


def by_model(values, digits=1):
    """`dome +1.3, ...`, the greatest first."""
    return ", ".join(f"{key[0]} {x:+.{digits}f}" for key, x in sorted(values.items(), key=lambda item: -item[1])) or "none"


def against_paper(results, paper, variant, k, models=NAMES):
    """Points by which a full-size run of ours in the paper's terms is ahead of its best; k: 0 number, 1 volume."""
    rows = {m: found(results, m, "full", variant) for m in models}
    return {(m, "full"): row[list(SHARES.values())[k]] - papers_best(paper, m)[k] for m, row in rows.items() if row}


def say_against_paper(results, paper):
    lattice, fronts, same = ([against_paper(results, paper, v, k) for k in (0, 1)]
                             for v in ("lattice, paper's terms", "fronts, paper's terms", "Sm-FB"))
    cells, edges = {}, []
    for model in NAMES:
        pairs = [(found(results, model, "full", v), paper[model][v]) for v in PAPERS_VARIANTS]
        cells[model] = [row["cells"] / theirs[0] for row, theirs in pairs if row]
        edges += [mean_edge(row["hex_volume"], row["hexahedra"]) / mean_edge(theirs[6], theirs[0] * theirs[5] / 100)
                  for row, theirs in pairs if row]
    behind = [f"{m} ({shares(found(results, m, 'full', 'Sm-FB'))} against {' / '.join(f'{x:g}' for x in papers_best(paper, m))})"
              for m in NAMES if any(of.get((m, "full"), 0) < 0 for of in same)]
    elements = ", ".join(f"{m} {span(values, 2)}" for m, values in cells.items() if values)
    return [
        "**Against the paper's numbers**, in its terms and at full size: the lattice is ahead of the paper's best by "
        f"{span(lattice[0].values(), sign=True)} points by number and {span(lattice[1].values(), sign=True)} by volume, fronts with "
        f"our field by {span(fronts[0].values(), sign=True)} and {span(fronts[1].values(), sign=True)}. With the paper's own "
        f"variant, Sm-FB, alone we stay below its best on {', '.join(behind) or 'none'}.",
        f"**Sizes** are about the paper's: in its four variants the edge of a mean hexahedron (the cube root of the hexahedra's share of "
        f"the volume over their number) is {span(edges, 2)} of the paper's. Elements are mostly fewer, ours over theirs {elements}: a "
        "hexahedron stands for five or six tetrahedra, and we have more hexahedra."]


def say_claim(results, paper):
    def line(of, gains):
        return f"{of} by volume {by_model(gains['volume'])}; by number {by_model(gains['number'])}"

    gains = {size: {s: differences(results, "NN-Fr", "Sm-FB", [size], share=s) for s in SHARES} for size in ("full", "small")}
    theirs = {s: {(m, "paper"): paper[m]["Sm-FB"][k] - paper[m]["NN-Fr"][k] for m in NAMES} for s, k in (("number", 5), ("volume", 6))}
    volume = gains["full"]["volume"]
    clear = [m for m, _ in sorted((key for key, x in volume.items() if x >= noise(key[0])), key=lambda key: -volume[key])]
    start = [row["hex_volume"] - paper[m]["NN-Fr"][6] for m in NAMES if (row := found(results, m, "full", "NN-Fr"))]
    return ["**The paper's own claim**, that a smoothed field and the smoothest region first (Sm-FB) gain over NN-Fr, in points: "
            + ". ".join([line("Paper", theirs), line("Ours at full size", gains["full"]), line("At small size", gains["small"])])
            + f". So there is a gain at full size that is beyond what any small change does (0.3 points by volume, 1 on naca and the "
            f"fuselage, see [insertion](insertion.md)) on {', '.join(clear) or 'none'}, and it is a fraction of the paper's: with the complete search and "
            f"relaxed points NN-Fr itself is {span(start, sign=True)} points from the paper's by volume."]


def mean_edge(share, number):
    """Of hexahedra, up to a factor that is the body's."""
    return (share / number) ** (1 / 3)


def noise(model):
    """Points by volume by which a small change of tolerance or order moves a figure: docs/insertion.md."""
    return 1 if model in ("naca", "fuselage") else 0.3


def say_validity(results):
    parts = []
    for placement in PLACEMENTS:
        number, volume = (differences(results, placement, f"{placement}, open", ["small"], share=s).values()
                          for s in ("number", "volume"))
        parts.append(f"with {placement} {span(number)} points by number and {span(volume, 2)} by volume")
    return ["**What validity costs.** At small size, closing the interfaces takes " + ", ".join(parts) + " (each quadrilateral that "
            "faces two triangles becomes a pyramid or a split cell, and small cells count as much as large ones): read shares by "
            "volume where meshes are conforming."]


def say_lattice(results):
    gains = [differences(results, "fronts", "lattice", ["small", "full"], share=s).values() for s in SHARES]
    pairs = [(m, found(results, m, size, "fronts"), found(results, m, size, "lattice")) for m in NAMES for size in ("small", "full")]
    pairs = [(m, a, b) for m, a, b in pairs if a and b]
    off = [[x for m, *pair in pairs if (x := volume_off(results, m, pair[i])) is not None] for i in (0, 1)]
    return [f"**The lattice** is ahead of fronts on the six models by {span(gains[0])} points by number and {span(gains[1])} by "
            f"volume, takes {span(b['cpu'] / a['cpu'] for _, a, b in pairs)} times the CPU's time, and its volume is off by "
            f"{span(off[1], 2)} %, that of fronts by {span(off[0], 2)} %."]


def say_shapes(results):
    rows = {v: {m: found(results, m, "shapes", v) for m in SHAPES} for v in PLACEMENTS}
    whole = {v: [m for m, row in of.items() if row and row["hexahedra"] == row["cells"]] for v, of in rows.items()}
    rest = {v: [100 - row["hex_volume"] for m, row in of.items() if row and m not in whole[v]] for v, of in rows.items()}
    return [f"**Bodies of known blocks**: with the lattice {' and '.join(whole['lattice']) or 'none'} come out as hexahedra alone, "
            f"the others miss {span(rest['lattice'])} % of their volume. Fronts do so on "
            f"{' and '.join(whole['fronts']) or 'none'} and miss {span(rest['fronts'])} % on the others."]


def say_promises(results):
    rows = [(m, found(results, m, size, v)) for v in PLACEMENTS for size in ("small", "full", "shapes") for m in [*NAMES, *SHAPES]]
    rows = [(m, row) for m, row in rows if row]
    full = [(m, row) for m in NAMES for v in PLACEMENTS if (row := found(results, m, "full", v))]
    off = [x for m, row in full if (x := volume_off(results, m, row)) is not None]
    memory = {m: max((row.get("megabytes", 0) for v in (*PAPERS_TERMS, *PLACEMENTS) if (row := found(results, m, "full", v))),
                     default=0) for m in NAMES}
    most = max(memory, key=memory.get)
    over = sorted((m for m, mb in memory.items() if mb > 800), key=memory.get)
    return [f"**What must hold in our terms**: over all {len(rows)} rows {sum(row['invalid'] for _, row in rows)} invalid cells, "
            f"{sum(row['open'] for _, row in rows)} open interfaces, {sum(row.get('open_edges', row.get('bad_faces', 0)) for _, row in rows)} open edges of "
            f"the boundary; at full size the volume is off by {span(off, 2)} %.",
            f"**Memory.** The paper stays below 800 MB. Ours takes up to {memory[most]} MB ({most}); "
            + (f"more than the paper's on {' and '.join(over)}." if over else "less than that on all.")]


def sentences(results, paper):
    lines = [*say_against_paper(results, paper), *say_claim(results, paper), *say_validity(results), *say_lattice(results),
             *say_shapes(results), *say_promises(results)]
    return "\n".join(f"* {line}" for line in lines)


def made(results):
    """Of which program rows are, and since when."""
    groups = {}
    for key, row in [*results["runs"].items(), *((f"{m} | steps", row) for m, row in results.get("steps", {}).items())]:
        size = key.split(" | ")[1]
        groups.setdefault((size, row.get("program"), row.get("version")), []).append(row)
    order = {"small": 0, "shapes": 1, "full": 2, "steps": 3}
    rows = []
    for (size, program, version), of in sorted(groups.items(), key=lambda item: (order[item[0][0]], str(item[0][1]))):
        days = sorted({row["day"] for row in of if "day" in row})
        rows.append([size, str(len(of)), f"`{program}`" if program else "not noted", version or "",
                     " to ".join(dict.fromkeys((days[0], days[-1]))) if days else "before that was noted"])
    return table("rows of size | how many | program (start of its SHA-256) | version | measured", rows)


def surfaces(results):
    rows = []
    for model in NAMES:
        if s := surface_of(results, model):
            rows.append([model, f"{s['triangles']:,}", f"{s['volume']:.5g}", f"`{s['sha256']}`"])
    return table("model | triangles | volume | start of the file's SHA-256", rows)


def readme(results):
    rows = []
    for model in NAMES:
        cells = []
        for variant in PLACEMENTS:
            row = found(results, model, "small", variant)
            cells += [f"{row['cells']:,}", shares(row), f"{row['least']:.2f} / {row['least_hexahedron']:.2f}", cpu(row)] if row else ["–"] * 4
        rows.append([f"{model} {SMALL[model]:g}", *cells])
    text = table("model, size | fronts: cells | hexahedra % | least SJ | CPU s | lattice: cells | hexahedra % | least SJ | CPU s", rows)
    bunny, dome = found(results, "bunny", "small", "lattice"), found(results, "dome", "full", "lattice")
    if bunny and dome:
        text += (f"\n\nWith the lattice the bunny takes {bunny['megabytes']} MB, the dome at half the size ({dome['cells']:,} cells) "
                 f"{dome['megabytes']} MB.")
    return text


def demo(results):
    rows = []
    for name, variant in (("nearest + fifo", "fronts, fifo, nearest field"), ("smoothed + smoothness", "fronts, smoothed field")):
        row = found(results, "bunny", "small", variant)
        if row:
            rows.append([name, kinds(row), shares(row), cpu(row)])
    return table("bunny, size 0.26 | tet / prism / pyramid / hex | hex % by number / volume | CPU s", rows)


def captions(pictures):
    """What the pictures show, as the pages they are of say it."""
    rows = []
    for name, picture in pictures.items():
        for panel in picture["panels"]:
            if "number" in panel:
                rows.append([f"`{name}.png`", panel["caption"], f"{panel['cells']:,}", f"{panel['number']} / {panel['volume']}"])
    return table("picture | panel | cells | hexahedra, number / volume %", rows)


def make(options):
    results, paper = load(options.results), read_json(HERE / "paper.json")
    cube, pictures = read_json(options.cube), read_json(options.pictures)
    return {
        "best": best_of_paper(results, paper),
        "sentences": sentences(results, paper),
        "made": made(results),
        "surfaces": surfaces(results),
        "paper full": papers_terms(results, paper, "full", NAMES),
        "paper small": papers_terms(results, paper, "small", NAMES),
        "ours full": our_terms(results, "full", NAMES),
        "ours small": our_terms(results, "small", NAMES),
        "shapes": our_terms(results, "shapes", SHAPES),
        "paper shapes": papers_terms(results, paper, "shapes", SHAPES),
        "ablation": ablation(results),
        "steps": steps(results),
        "table 1": table_1(results, cube, paper),
        "captions": captions(pictures),
        "readme": readme(results),
        "demo": demo(results),
    }


MARK = r"<!-- (%s) -->\n.*?<!-- end -->"


def filled(path, tables):
    """The page with its tables as they are now."""
    try:
        page = path.read_text()
    except OSError as error:
        raise Failure(f"{path} cannot be read: {error.strerror}") from None
    names = re.findall(MARK % "[^\n]*", page, flags=re.S)
    unknown = [name for name in names if name not in tables]
    if not names or unknown:
        raise Failure(f"{path} has no place for a table" if not names else f'{path}: there is no table "{unknown[0]}"')
    return re.sub(MARK % "[^\n]*", lambda m: f"<!-- {m[1]} -->\n\n{tables[m[1]]}\n\n<!-- end -->", page, flags=re.S)


def run(options):
    tables = make(options)
    pages = [options.into] if options.into else PAGES
    if not (options.into or options.write or options.check):
        print("\n\n".join(f"{name}\n\n{text}" for name, text in tables.items()))
        return 0
    texts = {page: filled(page, tables) for page in pages}
    if options.check:
        old = [str(page) for page, text in texts.items() if page.read_text() != text]
        if old:
            raise Failure(f"not up to date: {', '.join(old)} (tables.py --write)")
        return 0
    for page, text in texts.items():
        try:
            page.write_text(text)
        except OSError as error:
            raise Failure(f"{page} cannot be written: {error.strerror}") from None
    return 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--results", type=pathlib.Path, default=HERE / "results.json")
    parser.add_argument("--cube", type=pathlib.Path, default=HERE / "cube.json")
    parser.add_argument("--pictures", type=pathlib.Path, default=HERE / "pictures.json")
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--write", action="store_true")
    what.add_argument("--check", action="store_true")
    what.add_argument("--into", type=pathlib.Path)
    try:
        return run(parser.parse_args())
    except Failure as failure:
        print(f"tables.py: {failure}", file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())
