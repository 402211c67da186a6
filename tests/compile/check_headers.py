#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""Checks what a compiler does not: check_headers.py SOURCE_DIR [--write-umbrella]

Includes point up the list of layers only; the core includes the standard library, Eigen and Boost, and one header alone
Boost.Geometry; every header has its licence line and guard and at most 500 lines; framehex.hpp has every header of the
core, io.hpp those of io/, and neither an adapter; every number of a public options struct has its range in `each_number`.
Bodies that users of framehex::compiled need not read are in detail/X_impl.hpp: X.hpp ends with it where FRAMEHEX_COMPILED
is not defined, and a file of src/ includes it; its functions are FRAMEHEX_INLINE. Headers do not include each other in a ring.
"""
import pathlib
import re
import sys

LAYERS = ["", "geometry", "mesh", "surface", "tetrahedralization", "field", "sizing", "lattice", "insertion", "recombination",
          "selection", "verify", "assembly", "parts", "quads", "pipeline", "io", "adapters", "distributed"]
CORE = LAYERS[:LAYERS.index("io")]
# Offered for comparison with the paper, at a cost that other users need not pay: included by name only.
OPT_IN = {"geometry/spatial_index.hpp", "insertion/rtree_filter.hpp", "recombination/pattern_search.hpp"}
MAX_LINES = 500
COLUMNS = 120
UMBRELLAS = {"framehex.hpp": CORE, "io.hpp": ["io"]}
FIRST_LINES = {"framehex.hpp": "// The core: no readers or writers (io.hpp), no adapters to foreign libraries.",
               "io.hpp": "// Readers and writers that need no foreign library."}


def layer(path):
    return path.parts[0] if len(path.parts) > 1 else ""


def umbrella_text(umbrella, headers):
    listed = [h for h in headers if layer(h) in UMBRELLAS[umbrella] and "detail" not in h.parts
              and h.as_posix() not in OPT_IN and h.as_posix() not in UMBRELLAS]
    listed.sort(key=lambda h: (LAYERS.index(layer(h)), h.as_posix()))
    lines = ["// SPDX-License-Identifier: BSL-1.0", "#pragma once", "", FIRST_LINES[umbrella], "// clang-format off", ""]
    lines += [f'#include "framehex/{h.as_posix()}"' for h in listed]
    return "\n".join(lines) + "\n"


def check_options(header, text, errors):
    number = r"^\s+(?:std::optional<)?(?:double|int|index_t|std::size_t|std::uint64_t)>? (\w+) ?="
    for name, body in re.findall(r"^struct (\w*Options) \{\n(.*?)^\};", text, re.M | re.S):
        for member in re.findall(number, body, re.M):
            if f'visit("{name}::{member}", o.{member},' not in body:
                errors.append(f"{header}: {name}::{member} has no range in each_number")


def check(header, text, errors):
    lines = text.splitlines()
    if not lines or lines[0] != "// SPDX-License-Identifier: BSL-1.0" or "#pragma once" not in lines[:3]:
        errors.append(f"{header}: does not start with the licence line and #pragma once")
    if len(lines) > MAX_LINES:
        errors.append(f"{header}: {len(lines)} lines")
    if re.search(r"^\s*using namespace", text, re.M):
        errors.append(f"{header}: using namespace")
    if "detail" not in header.parts:
        check_options(header, text, errors)
    mine = layer(header)
    for included in re.findall(r'^\s*#\s*include\s+"([^"]+)"', text, re.M):
        if not included.startswith("framehex/"):
            errors.append(f'{header}: includes "{included}", not by its path from framehex/')
            continue
        other = layer(pathlib.PurePosixPath(included).relative_to("framehex"))
        if other not in LAYERS or LAYERS.index(other) > LAYERS.index(mine):
            errors.append(f"{header}: includes {included}, which is further down the list of layers")
    if mine == "adapters":
        return
    for included in re.findall(r"^\s*#\s*include\s+<([^>]+)>", text, re.M):
        standard = "/" not in included and "." not in included
        posix = included in ("fcntl.h", "signal.h", "sys/mman.h", "sys/stat.h", "unistd.h") and mine == "io"
        mpi = included == "mpi.h" and mine == "distributed"
        if not (standard or posix or mpi or included.startswith(("Eigen/", "boost/"))):
            errors.append(f"{header}: the core includes <{included}>")


def check_bodies(texts, sources, errors):
    """X.hpp, its bodies in detail/X_impl.hpp, and the file of src/ that compiles them."""
    for body in (h for h in texts if h.endswith("_impl.hpp")):
        folder, name = body.rsplit("/", 1)
        own = name.replace("_impl.hpp", ".hpp")
        header = next((h for h in (f"{folder}/{own}", f"{folder.removesuffix('/detail')}/{own}") if h in texts), None)
        guarded = f'#ifndef FRAMEHEX_COMPILED\n#include "framehex/{body}"\n#endif\n'
        if not folder.endswith("/detail") or not header or not texts[header].endswith(guarded):
            errors.append(f"{body}: no header ends with its guarded include")
        if f'"framehex/{body}"' not in sources:
            errors.append(f"{body}: no file of src/ compiles it")
        for above, line in zip(texts[body].split("\n"), texts[body].split("\n")[1:]):
            if re.match(r"(?!FRAMEHEX_INLINE |inline constexpr )\w[\w:<>,&*\[\] ]* [\w:]+\(", line) and "template" not in above:
                errors.append(f"{body}: '{line.split('(')[0]}' is not FRAMEHEX_INLINE")


def check_rings(texts, errors):
    """No header includes itself by way of others, but for the pair of a header and its bodies."""
    includes = {h: [i for i in re.findall(r'^#include "framehex/([^"]+)"', text, re.M) if i in texts]
                for h, text in texts.items()}
    for body in (h for h in texts if h.endswith("_impl.hpp")):
        includes[body] = [i for i in includes[body] if body not in includes[i]]
    done = set()

    def visit(header, above):
        if header in above:
            errors.append("headers include each other: " + " > ".join(above[above.index(header):] + [header]))
        elif header not in done:
            for other in includes[header]:
                visit(other, above + [header])
            done.add(header)

    for header in texts:
        visit(header, [])


def broken_comments(header, text):
    """Lines that a formatter tore: a word or two left over from a line too long, before an indented continuation."""
    lines = text.split("\n")
    for above, line, below in zip(lines, lines[1:], lines[2:]):
        left_over = re.match(r"\s*//[/!]? ([^\s@].{0,39})$", line)
        continued = re.match(r"\s*//[/!]?\s{3,}\S", below)
        if left_over and continued and above.lstrip().startswith("//"):
            if len(above) + 1 + len(left_over[1].split()[0]) > COLUMNS:
                yield f"{header}: the comment is broken at '{line.strip()}'"


def main():
    root = pathlib.Path(sys.argv[1]) / "include" / "framehex"
    headers = sorted(pathlib.PurePosixPath(p.relative_to(root).as_posix()) for p in root.rglob("*.hpp"))
    if "--write-umbrella" in sys.argv:
        for umbrella in UMBRELLAS:
            (root / umbrella).write_text(umbrella_text(umbrella, headers))
    errors, geometry = [], []
    for header in headers:
        if layer(header) not in LAYERS:
            errors.append(f"{header}: in no layer")
            continue
        text = (root / header).read_text()
        if header.as_posix() in UMBRELLAS:
            continue
        check(header, text, errors)
        errors.extend(broken_comments(header, text))
        if "boost/geometry" in text:
            geometry.append(str(header))
    texts = {h.as_posix(): (root / h).read_text() for h in headers}
    check_bodies(texts, "".join(p.read_text() for p in (root.parent.parent / "src").glob("*.cpp")), errors)
    check_rings(texts, errors)
    if len(geometry) > 1:
        errors.append(f"Boost.Geometry is included by more than one header: {', '.join(geometry)}")
    for umbrella in UMBRELLAS:
        if (root / umbrella).read_text() != umbrella_text(umbrella, headers):
            errors.append(f"{umbrella} does not list its headers; run check_headers.py . --write-umbrella")
    print("\n".join(errors) if errors else f"{len(headers)} headers keep the rules")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
