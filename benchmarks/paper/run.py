#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""Meshes the paper's six models and shapes of a known block structure in all variants, and keeps what comes of it.

    run.py PROGRAM [--sizes small full shapes] [--only MODEL...] [--variants NAME...] [--ablation]
           [--again | --renew | --mix] [--models FOLDER] [--results FILE.json] [--meshes FOLDER]
    run.py PROGRAM --quick
    run.py --steps PAPER_STEPS [--only MODEL...] [--again | --renew | --mix]

PROGRAM is `framehex`, PAPER_STEPS what the target of that name builds: the small models with steps switched off that the
program has no option for. Each run is added to the results (results.json beside this file) as soon as it ends, so that the
command can be interrupted and goes on where it stopped. tables.py makes the tables.

Each row says by what program (the start of its file's SHA-256), of what surface and on what day it was measured. Where
rows of another program are there, the command refuses to go on: --renew measures those anew (and goes on where it stopped,
too), --again every row that was asked for, --mix leaves them as they are. Rows of another surface are never replaced: name
another file with --results.

--quick meshes a few small models and compares them with the stored results: exit status 1 when a share of hexahedra has
fallen by more than half a point, a cell is invalid or an interface open. It writes nothing.
"""
import argparse
import datetime
import hashlib
import json
import pathlib
import subprocess
import sys
import tempfile
import time

import shapes
from processes import Stopped, find_program, run_program, stop_by_exception
from storage import Failure, load, read_json, save, writing_to

HERE = pathlib.Path(__file__).resolve().parent
MODELS = HERE.parents[1] / "tests" / "data"
SMALL = {"dome": 0.156, "bunny": 0.26, "blade": 0.026, "piece": 0.108, "fuselage": 0.156, "naca": 0.038}
SIZES = {"small": SMALL, "full": {model: size / 2 for model, size in SMALL.items()}, "shapes": shapes.SIZES}

PAPERS_TERMS = ["--floor", "0.25", "--interfaces", "open", "--no-improvement"]
FIELDS = {"NN": "nearest", "Sm": "smoothed"}
ORDERS = {"Fr": "fifo", "FB": "smoothness"}
PAPERS_VARIANTS = {f"{f}-{o}": ["--field", FIELDS[f], "--order", ORDERS[o], *PAPERS_TERMS] for f in FIELDS for o in ORDERS}
# The program's defaults, but for the placement of points, of which one is the default; the results say which.
PLACEMENTS = {"fronts": "smoothness", "lattice": "lattice"}
OUR_VARIANTS = {
    **{f"{name}, paper's terms": ["--order", order, *PAPERS_TERMS] for name, order in PLACEMENTS.items()},
    **{name: ["--order", order] for name, order in PLACEMENTS.items()},
}
ABLATION = {
    **{name: OUR_VARIANTS[name] for name in PLACEMENTS},
    "fronts, fifo": ["--order", "fifo"],
    "lattice, smoothed field": ["--order", "lattice", "--field", "smoothed"],
    "lattice, greedy": ["--order", "lattice", "--select", "greedy"],
    "lattice, open": ["--order", "lattice", "--interfaces", "open"],
    "lattice, no improvement": ["--order", "lattice", "--no-improvement"],
    "fronts, fifo, nearest field": ["--order", "fifo", "--field", "nearest"],
    "fronts, smoothed field": ["--order", "smoothness", "--field", "smoothed"],
    "fronts, greedy": ["--order", "smoothness", "--select", "greedy"],
    "fronts, open": ["--order", "smoothness", "--interfaces", "open"],
    "fronts, no improvement": ["--order", "smoothness", "--no-improvement"],
}
VARIANTS = {**PAPERS_VARIANTS, **OUR_VARIANTS, **ABLATION}

QUICK = [("naca", "NN-Fr"), ("naca", "Sm-FB"), ("naca", "fronts"), ("dome", "Sm-FB"), ("dome", "lattice")]
MOST_LOST = 0.5  # points by which a share may fall
GRAPH = ("dome", 0.23)  # of Table 1: about as many tetrahedra as the paper's


def surface_file(models, model, folder):
    if model in shapes.SIZES:
        path = folder / f"{model}.off"
        shapes.write(model, path)
        return path
    for path in sorted(models.glob(f"{model}.*")):
        if path.suffix in (".stl", ".ply", ".off", ".obj"):
            return path
    raise Failure(f"{models} has no surface {model}")


def fingerprint(path):
    """Enough of a file's SHA-256 to tell it from others."""
    return hashlib.sha256(path.read_bytes()).hexdigest()[:16]


def describe(surface):
    """What is kept of a surface: its fingerprint, number of triangles and volume."""
    command = [sys.executable, HERE / "surfaces.py", surface]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        raise Failure((done.stderr.strip().splitlines() or [f"{surface} cannot be read"])[-1])
    return {"sha256": fingerprint(surface), **json.loads(done.stdout)}


def percent(ratio):
    return round(100 * ratio, 4)  # the tables round once, from more than they show


def measure(program, surface, size, options, mesh):
    report = mesh.with_suffix(".json")
    status, cpu, peak = run_program([program, "mesh", surface, "-o", mesh, "--report", report, "--size", size, "--threads", 1,
                                     "--quiet", *options])
    if status != 0:
        raise Failure(f"{program.name} ended with exit status {status}")
    full = read_json(report)
    try:
        return row_of(full, size, cpu, peak)
    except (KeyError, TypeError) as missing:
        raise Failure(f"the report of {program} has no {missing}: it is not of this version") from None


def row_of(full, size, cpu, peak):
    """What is kept of a report."""
    counts, quality, conformity = full["counts"], full["quality"], full["conformity"]
    return {
        "size": size,
        "options": {key: full["options"][key] for key in ("field", "order", "floor", "select", "interfaces", "improvement")},
        "cells": counts["cells"],
        **{kind: counts[kind] for kind in ("tetrahedra", "prisms", "pyramids", "hexahedra")},
        "hex_number": percent(full["hex_ratio"]["number"]),
        "hex_volume": percent(full["hex_ratio"]["volume"]),
        "least": round(quality["least"], 4),
        "mean": round(quality["mean"], 4),
        "least_hexahedron": round(quality.get("hexahedra", {}).get("least", 1), 4),
        "invalid": len(quality["invalid_cells"]) + len(quality["inverted_cells"]),
        "open": conformity["open_quads"],
        "open_edges": conformity["open_boundary_edges"],
        "bad_faces": conformity["other_bad_faces"],
        "volume": quality["volume"],
        "second_tetrahedra": full["points"]["tetrahedra"],
        "candidates": full["candidates"],
        "seconds": {key: round(s, 3) for key, s in full["seconds"].items()},
        "cpu": round(cpu, 2),
        "megabytes": round(peak),
        "version": full["version"],
        "day": datetime.date.today().isoformat(),
    }


def line(key, row):
    return (f"{key}: {row['cells']:,} cells, {row['hex_number']:.1f} / {row['hex_volume']:.1f} % hexahedra, least "
            f"{row['least']:.2f}, {row['invalid']} invalid, {row['open']} open, {row['cpu']:.0f} s, {row['megabytes']} MB")


def about_program(program, folder):
    """Its version and which placement it takes when not told."""
    row = measure(program, surface_file(MODELS, "L", folder), 0.5, [], folder / "L.vtu")
    order = row["options"]["order"]
    return {"version": row["version"], "default": next((n for n, o in PLACEMENTS.items() if o == order), order)}


def wanted(options):
    variants = options.variants or [*PAPERS_VARIANTS, *OUR_VARIANTS]
    for size in options.sizes:
        for model, edge in SIZES[size].items():
            if options.only and model not in options.only:
                continue
            names = [v for v in variants if size != "shapes" or v in OUR_VARIANTS]
            if options.ablation and size == "small":
                names = [*ABLATION]
            for variant in names:
                yield size, model, edge, variant


def check_programs(rows, mine, options, where):
    """@param rows  of the results, by name. Refuses to mix programs unless told to."""
    others = {}
    for row in rows.values():
        if row.get("program") != mine:
            others.setdefault(row.get("program", "unknown"), []).append(row)
    if not others:
        return
    listed = ", ".join(f"{len(of)} of {name}" for name, of in sorted(others.items()))
    text = f"{where} has rows of another program than this ({mine}): {listed}"
    if not (options.again or options.renew or options.mix):
        raise Failure(f"{text}. Measure them anew (--renew), or all that is asked for (--again), or leave them (--mix)")
    print(f"run.py: {text}", file=sys.stderr)


def check_surface(rows, model, surface, options):
    """A model's rows are of one surface."""
    for key, row in rows.items():
        if key.split(" | ")[0] != model:
            continue
        known = row.get("surface", {}).get("sha256")
        if known != surface["sha256"] and (known or options.models.resolve() != MODELS):
            raise Failure(f'{options.results}: the row "{key}" is of another surface than this {model} '
                          f"({known or 'unknown'}, not {surface['sha256']}); name another file with --results")


def is_done(row, mine, options):
    return row is not None and not options.again and not (options.renew and row.get("program") != mine)


def run_all(options, folder):
    jobs = list(wanted(options))
    if not jobs:
        raise Failure("nothing to run: no such model has such a size or variant")
    mine, about = fingerprint(options.program), about_program(options.program, folder)
    rows = load(options.results, must_exist=False)["runs"]
    surfaces = {model: surface_file(options.models, model, folder) for model in dict.fromkeys(job[1] for job in jobs)}
    described = {model: describe(surface) for model, surface in surfaces.items()}
    for model, surface in described.items():
        check_surface(rows, model, surface, options)
    check_programs(rows, mine, options, options.results)
    failed = []
    for number, (size, model, edge, variant) in enumerate(jobs, 1):
        key = f"{model} | {size} | {variant}"
        if is_done(rows.get(key), mine, options):
            continue
        mesh = (options.meshes or folder) / f"{model}-{size}-{variant.replace(', ', '-').replace(' ', '-')}.vtu"
        started = time.monotonic()
        try:
            row = measure(options.program, surfaces[model], edge, VARIANTS[variant], mesh)
        except Failure as failure:
            print(f"{number}/{len(jobs)} {key}: {failure}", flush=True)
            failed.append(key)
            continue
        row |= {"program": mine, "surface": described[model]}
        results = load(options.results, must_exist=False)
        results["program"], results["runs"][key] = about, row
        results.setdefault("programs", {})[mine] = about
        save(results, options.results)
        print(f"{number}/{len(jobs)} {line(key, row)} ({time.monotonic() - started:.0f} s)", flush=True)
        if not options.meshes:
            mesh.unlink(missing_ok=True)
    if failed:
        raise Failure(f"{len(failed)} of {len(jobs)} runs failed: {', '.join(failed)}")


def run_steps(options, folder):
    """Variants of the small models, and the candidates of one for Table 1."""
    mine = fingerprint(options.steps)
    steps = load(options.results, must_exist=False).get("steps", {})
    check_programs(steps, mine, options, f"{options.results} (steps)")
    jobs = [(model, model, [size]) for model, size in SMALL.items()]
    jobs.append(("graph", GRAPH[0], ["--graph", GRAPH[1]]))
    jobs = [job for job in jobs if not options.only or job[1] in options.only]
    if not jobs:
        raise Failure("nothing to run: steps are those of the six models")
    for name, model, (*how, size) in jobs:
        if is_done(steps.get(name), mine, options):
            continue
        surface, printed = surface_file(options.models, model, folder), folder / "steps.json"
        about = describe(surface)
        check_surface({f"{model} | steps": steps[name]} if name in steps else {}, model, about, options)
        status, _, _ = run_program([options.steps, *how, surface, size], printed)
        if status != 0:
            raise Failure(f"{options.steps.name} ended with exit status {status} for {name}")
        row = {"program": mine, "surface": about, "day": datetime.date.today().isoformat(), "variants": read_json(printed)}
        results = load(options.results, must_exist=False)
        results.setdefault("steps", {})[name] = row
        save(results, options.results)
        print(f"{name}: {', '.join(row['variants'])}", flush=True)


def quick(options, folder):
    stored, failures = load(options.results)["runs"], []
    keys = [f"{model} | small | {variant}" for model, variant in QUICK]
    missing = [key for key in keys if key not in stored]
    if missing:
        raise Failure(f"{options.results} has nothing to compare with: no {', '.join(missing)}")
    for key, (model, variant) in zip(keys, QUICK):
        row = measure(options.program, surface_file(options.models, model, folder), SMALL[model], VARIANTS[variant],
                      folder / "mesh.vtu")
        print(line(key, row), flush=True)
        for share in ("hex_number", "hex_volume"):
            if row[share] < stored[key][share] - MOST_LOST:
                failures.append(f"{key}: {share} is {row[share]}, was {stored[key][share]}")
        if row["invalid"] or row["bad_faces"] or row["open_edges"]:
            failures.append(f"{key}: {row['invalid']} invalid cells, {row['bad_faces']} bad faces, "
                            f"{row['open_edges']} open edges of the boundary")
        if row["open"] and variant in PLACEMENTS:
            failures.append(f"{key}: {row['open']} open interfaces")
    print("\n".join(failures) if failures else "no share of hexahedra has fallen")
    return 1 if failures else 0


def read_options():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path, nargs="?")
    parser.add_argument("--steps", type=pathlib.Path, metavar="PAPER_STEPS")
    parser.add_argument("--sizes", nargs="+", choices=SIZES, default=["small", "shapes", "full"])
    parser.add_argument("--only", nargs="+", metavar="MODEL", choices=[*SMALL, *shapes.SIZES])
    parser.add_argument("--variants", nargs="+", choices=VARIANTS, metavar="NAME")
    parser.add_argument("--ablation", action="store_true", help="the small models with each step switched off in turn")
    stored = parser.add_mutually_exclusive_group()
    stored.add_argument("--again", action="store_true", help="measure anew what is there")
    stored.add_argument("--renew", action="store_true", help="measure anew what is there of another program")
    stored.add_argument("--mix", action="store_true", help="add to rows of another program")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--models", type=pathlib.Path, default=MODELS)
    parser.add_argument("--results", type=pathlib.Path, default=HERE / "results.json")
    parser.add_argument("--meshes", type=pathlib.Path, help="keep the meshes in this folder")
    options = parser.parse_args()
    if not options.program and not options.steps:
        parser.error("PROGRAM or --steps is needed")
    for folder in (options.models, options.meshes):
        if folder and not folder.is_dir():
            raise Failure(f"there is no folder {folder}")
    options.results = options.results.absolute()
    options.program = options.program and find_program(options.program)
    options.steps = options.steps and find_program(options.steps)
    return options


def run(options):
    with tempfile.TemporaryDirectory(prefix="framehex-paper-") as name:
        folder = pathlib.Path(name)
        if options.quick:
            return quick(options, folder)
        with writing_to(options.results):
            load(options.results, must_exist=False)
            if options.steps:
                run_steps(options, folder)
            if options.program:
                run_all(options, folder)
    return 0


def main():
    stop_by_exception()
    try:
        return run(read_options())
    except Failure as failure:
        print(f"run.py: {failure}", file=sys.stderr)
        return 1
    except Stopped as stopped:
        print(f"run.py: {stopped}; what was measured is kept, the same command goes on", file=sys.stderr)
        return 128 + stopped.number


if __name__ == "__main__":
    sys.exit(main())
