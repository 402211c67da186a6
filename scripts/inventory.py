#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""What the library consists of: inventory.py [REVISION ...] [--longest 10]

Prints, for the working tree and each revision of git that is named, a Markdown table of headers, lines and public names by
folder, and the longest functions. A public name is one that a header outside of detail/ declares in no namespace called
detail; names that are overloaded count once.
"""
import argparse
import collections
import pathlib
import re
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent
TYPE = re.compile(r"^(?:template <.*> )?(?:class|struct|enum class|concept|using) (\w+)")
CALLABLE = re.compile(r"^[^=(]*?(\w+)\(")
NO_FUNCTION = re.compile(r"(if|for|while|switch|do|else|try|catch|namespace|class|struct|enum|union|return)\b")


def headers_of(revision):
    """Path below include/framehex -> text."""
    if not revision:
        folder = ROOT / "include" / "framehex"
        return {p.relative_to(folder).as_posix(): p.read_text() for p in sorted(folder.rglob("*.hpp"))}
    prefix = "include/framehex/"
    listed = subprocess.check_output(["git", "-C", ROOT, "ls-tree", "-r", "--name-only", revision, prefix], text=True)
    return {path.removeprefix(prefix): subprocess.check_output(["git", "-C", ROOT, "show", f"{revision}:{path}"], text=True)
            for path in listed.split() if path.endswith(".hpp")}


def declarations(text):
    """Declarations at namespace scope that are in no namespace called detail, each on one line."""
    text = re.sub(r"^namespace detail \{$.*?^\}  // namespace detail$", "", text, flags=re.M | re.S)
    if "namespace framehex::detail {" in text:
        return
    lines = [line for line in text.splitlines() if not re.match(r"\s*//|\s*#|$", line)]
    current = ""
    for line in lines:
        if line.startswith((" ", "}", "public:", "private:", "protected:")) and not current:
            continue
        current = f"{current} {line.strip()}".strip()
        if current.startswith("namespace"):
            current = ""
        elif line.endswith(("{", ";", "}")) and (not current.startswith("template") or current.count("<") > 0):
            yield current
            current = ""


def public_names(text):
    names = set()
    for declaration in declarations(text):
        plain = re.sub(r"^template <.*?> (?=\w|\[\[)|^\[\[\w+\]\] |\brequires\b.*?\)\s*", "", declaration)
        found = TYPE.match(plain) or TYPE.match(declaration) or CALLABLE.match(plain)
        if found:
            names.add(found[1])
        elif constant := re.match(r"inline constexpr .*?(\w+)(?:\{| =)", plain):
            names.add(constant[1])
    return names


def functions(text):
    """Name, first line (from 1) and number of lines of each function; lambdas belong to theirs."""
    lines = text.splitlines()
    i = first = 0  # the line looked at, and where its statement begins
    while i < len(lines):
        line = lines[i].strip()
        if line.startswith(("//", "#")) or line == "":
            first = i + 1
        elif line.endswith("{"):
            head = " ".join(l.strip() for l in lines[first:i + 1])
            indent = re.match(" *", lines[first])[0]
            end = next((j for j in range(i + 1, len(lines)) if lines[j].startswith(indent + "}")), i)
            name = re.search(r"(~?\w+|operator\S+)\(", re.sub(r"^template <.*?> (?=\w)", "", head))
            if name and not NO_FUNCTION.match(re.sub(r"^template <.*?> (?=\w)", "", head)):
                yield name[1], first + 1, end - first + 1
                i = end
            first = i + 1
        elif line.endswith((";", "}", ":")):
            first = i + 1
        i += 1


def report(revision, n_longest):
    headers = headers_of(revision)
    counts = collections.defaultdict(lambda: [0, 0, 0, set()])
    longest = []
    for path, text in headers.items():
        folder = path.split("/")[0] if "/" in path else "(top)"
        count = counts[folder]
        count[1 if "/detail/" in path else 0] += 1
        count[2] += text.count("\n")
        if "/detail/" not in path and path not in ("framehex.hpp", "io.hpp"):
            count[3] |= public_names(text)
        longest += [(n, f"{path}: {name}") for name, _, n in functions(text)]
    print(f"\n{revision or 'working tree'}\n\n| folder | headers | in detail/ | lines | public names |")
    print("| --- | ---: | ---: | ---: | ---: |")
    for folder, (n, n_detail, n_lines, names) in sorted(counts.items()):
        print(f"| {folder} | {n} | {n_detail} | {n_lines} | {len(names)} |")
    totals = [sum(c[i] for c in counts.values()) for i in range(3)]
    print(f"| all | {totals[0]} | {totals[1]} | {totals[2]} | {sum(len(c[3]) for c in counts.values())} |")
    print("\n| lines | function |\n| ---: | --- |")
    for n, name in sorted(longest, key=lambda f: (-f[0], f[1]))[:n_longest]:
        print(f"| {n} | {name} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("revisions", nargs="*")
    parser.add_argument("--longest", type=int, default=10)
    options = parser.parse_args()
    for revision in [*options.revisions, None]:
        report(revision, options.longest)


if __name__ == "__main__":
    main()
