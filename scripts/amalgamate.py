#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""Writes the library as one header: amalgamate.py OUT.hpp [HEADER ...]

HEADERs (framehex/framehex.hpp unless given) are paths below include/; each header of the library that they reach is put
in once, before the first that needs it. Headers of other libraries stay includes, in front. What is made is the same
code: include either it or the headers in all units of a program.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent / "include"
OWN = re.compile(r'^\s*#\s*include\s+"(framehex/[^"]+)"\s*$')
FOREIGN = re.compile(r"^#\s*include\s+(<[^>]+>)\s*$")


class Amalgamation:
    def __init__(self):
        self.done, self.foreign, self.lines = set(), [], []

    def add(self, header):
        if header in self.done:
            return
        self.done.add(header)
        body, bodies = [], []
        for line in (ROOT / header).read_text().splitlines():
            own, foreign = OWN.match(line), FOREIGN.match(line)
            if own and own[1].endswith("_impl.hpp") and not header.endswith("_impl.hpp"):
                bodies.append(own[1])  # of what this header declares
            elif own:
                self.add(own[1])
            elif foreign:
                if foreign[1] not in self.foreign:
                    self.foreign.append(foreign[1])
            elif line != "#pragma once" and not line.startswith("// SPDX-License-Identifier"):
                body.append(line)
        text = "\n".join(body).strip()
        if text:
            self.lines.append(f"\n// ---- {header}\n\n{text}\n")
        for implementation in bodies:
            self.add(implementation)

    def text(self):
        version = re.search(r'FRAMEHEX_VERSION "(.*)"', (ROOT / "framehex/version.hpp").read_text())[1]
        includes = "\n".join(f"#include {name}" for name in sorted(self.foreign))
        return (f"// SPDX-License-Identifier: BSL-1.0\n// framehex {version} in one header, made by scripts/amalgamate.py.\n"
                f"#pragma once\n\n{includes}\n" + "".join(self.lines))


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    amalgamation = Amalgamation()
    for header in sys.argv[2:] or ["framehex/framehex.hpp"]:
        amalgamation.add(header)
    pathlib.Path(sys.argv[1]).write_text(amalgamation.text())


if __name__ == "__main__":
    main()
