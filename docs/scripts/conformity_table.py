#!/usr/bin/python3
# SPDX-License-Identifier: BSL-1.0
"""Prints the table of docs/conformity.md: models, sizes and variants, meshed conforming and, for comparison, open.

    conformity_table.py MODELS PROGRAM [--sizes small|full] [--only MODEL ...] [--variants FIELD,ORDER ...]
                        [--audit COMMAND] [--no-open]

MODELS is a folder with dome.stl, naca.stl, blade.stl, piece.stl, fuselage.stl and bunny.stl; PROGRAM is `framehex`. What
`framehex inspect` says of the written file is checked: a row that breaks a promise ends with what it breaks. COMMAND, if
given, is a second opinion: it is called with the mesh, `--surface` and the model, and `--json`.
"""
import argparse
import json
import pathlib
import shlex
import subprocess
import sys
import tempfile

SIZES = {
    "small": {"dome": 0.156, "naca": 0.038, "blade": 0.026, "piece": 0.108, "fuselage": 0.156, "bunny": 0.26},
    "full": {"dome": 0.078, "naca": 0.019, "blade": 0.013, "piece": 0.054, "fuselage": 0.078, "bunny": 0.13},
}
VARIANTS = [f"{field},{order}" for field in ("nearest", "smoothed") for order in ("fifo", "smoothness")]
HEAD = """| model, size | field, order | tet / prism / pyramid / hex | hexahedra, volume % | lost | least SJ hex / others | cells >= 0.2 | off the surface | assembly / total, s |
| --- | --- | --- | ---: | ---: | --- | ---: | ---: | ---: |"""


def run(program, *arguments):
    done = subprocess.run([program, *map(str, arguments), "--quiet"], capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"exit status {done.returncode}: {done.stderr.strip()}")


def mesh(options, model, size, field, order, folder, interfaces):
    out, report = folder / "mesh.vtu", folder / "mesh.json"
    run(options.program, "mesh", options.models / f"{model}.stl", "--size", size, "--field", field, "--order", order,
        "--select", "greedy", "--interfaces", interfaces, "-o", out, "--report", report)
    return out, json.loads(report.read_text())


def faults(report, audit):
    """What the written mesh breaks, by the library's own checkers and by the other program."""
    found = []
    conformity, quality = report["conformity"], report["quality"]
    for name in ("open_quads", "other_bad_faces", "open_boundary_edges"):
        if conformity[name]:
            found.append(f"{conformity[name]} {name}")
    for name in ("invalid_cells", "inverted_cells"):
        if quality[name]:
            found.append(f"{len(quality[name])} {name}")
    difference = abs(quality["volume"] / conformity["boundary_volume"] - 1)
    if difference > 1e-9:
        found.append(f"volume off by {difference:.1e}")
    if audit is not None:
        found += [f"{audit[key]} {key} (audit)" for key in audit if audit[key]
                  and key.endswith(("_inverted", "_invalid", "_degenerate", "over_twice", "same_side", "twisted"))]
        found += [f"{audit[key]} {key} (audit)" for key in ("nonconforming_quads", "boundary_edges_open") if audit[key]]
        found += [f"not {key} (audit)" for key in ("valid", "fills_surface") if not audit[key]]
    return found


def row(options, model, size, field, order, folder):
    out, made = mesh(options, model, size, field, order, folder, "conforming")
    inspected = folder / "inspected.json"
    run(options.program, "inspect", out, "--report", inspected)
    report = json.loads(inspected.read_text())
    audit = None
    if options.audit:
        command = [*shlex.split(options.audit), str(out), "--surface", str(options.models / f"{model}.stl"), "--json"]
        audit = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    volume = 100 * report["hex_ratio"]["volume"]
    lost = ""
    if not options.no_open:
        lost = f"{100 * mesh(options, model, size, field, order, folder, 'open')[1]['hex_ratio']['volume'] - volume:.2f}"
    kinds = ("tetrahedra", "prisms", "pyramids", "hexahedra")
    quality, seconds = report["quality"], made["seconds"]
    others = min(quality[kind]["least"] for kind in kinds[:3] if report["counts"][kind])
    off = f"{audit['mesh_to_surface_max_pct']:.2f} %" if audit else ""
    found = faults(report, audit)
    return " | ".join([f"| {model} {size}", f"{field}, {order}",
                       " / ".join(str(report["counts"][kind]) for kind in kinds), f"{volume:.2f}", lost,
                       f"{quality['hexahedra']['least']:.2f} / {others:.2f}",
                       f"{100 * quality['fraction_above_0.2']:.2f} %", off,
                       f"{seconds['assembly']:.1f} / {seconds['total']:.1f}"]) + " |" + "".join(f" {f};" for f in found)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", type=pathlib.Path)
    parser.add_argument("program")
    parser.add_argument("--sizes", choices=SIZES, default="small")
    parser.add_argument("--only", nargs="+", default=None, metavar="MODEL")
    parser.add_argument("--variants", nargs="+", default=VARIANTS, choices=VARIANTS, metavar="FIELD,ORDER")
    parser.add_argument("--audit", metavar="COMMAND")
    parser.add_argument("--no-open", action="store_true", help="leave the column `lost` empty, which takes a second run")
    options = parser.parse_args()
    print(HEAD, flush=True)
    failed = False
    for model, size in SIZES[options.sizes].items():
        if options.only and model not in options.only:
            continue
        for variant in options.variants:
            field, order = variant.split(",")
            with tempfile.TemporaryDirectory() as folder:
                try:
                    line = row(options, model, size, field, order, pathlib.Path(folder))
                except (RuntimeError, subprocess.CalledProcessError) as e:
                    line = f"| {model} {size} | {field}, {order} | {e}"
            failed |= not line.endswith("|")
            print(line, flush=True)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
