#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""Compiles every C++ snippet of the documentation: check_snippets.py SOURCE_DIR [--compiler CXX] [--flags ...] [--write]

A block after `<!-- file: PATH -->` must be that file without its licence line (--write puts it there); such files are
built as examples. Any other block of language cpp is compiled after the includes of PREAMBLE and the declarations of
tests/docs/context/PAGE.hpp: at namespace scope when it defines a type or a function, else as the body of a template,
which is checked but spares the compiler all that it calls.
Links to files must lead somewhere, and so must their anchors. Every public concept has a section of docs/concepts.md.
"""
import argparse
import pathlib
import re
import subprocess
import sys
import tempfile

PREAMBLE = """#include <framehex/framehex.hpp>
#include <framehex/io.hpp>
#include <framehex/adapters/eigen_matrices.hpp>
#include <framehex/adapters/tetgen_process.hpp>
#include <framehex/pipeline/recombine_into.hpp>
#include <iostream>
"""
BLOCK = re.compile(r"(?:^<!-- file: (?P<file>\S+) -->\n)?^```cpp\n(?P<code>.*?)^```$", re.M | re.S)
DEFINITION = re.compile(r"^(template\b|struct\b|class\b|namespace\b|static_assert\b|inline\b|[\w:<>]+ \w+\(.*\) \{$)", re.M)


def without_licence(text):
    return re.sub(r"\A// SPDX-License-Identifier: .*\n", "", text)


def pages_of(root):
    return [root / "README.md", root / "CONTRIBUTING.md", *sorted((root / "docs").rglob("*.md"))]


def write_files(root, page):
    def fresh(match):
        if not match["file"]:
            return match[0]
        return f"<!-- file: {match['file']} -->\n```cpp\n{without_licence((root / match['file']).read_text())}```"
    page.write_text(BLOCK.sub(fresh, page.read_text()))


def page_name(root, page):
    return page.relative_to(root).with_suffix("").as_posix().removeprefix("docs/").replace("/", "_").replace("-", "_")


def snippets_of(root, page, errors):
    """The page's snippets: what they include, and their declarations and bodies; nothing where there are none."""
    text = page.read_text()
    includes, parts = [], []
    for n, match in enumerate(BLOCK.finditer(text)):
        line = text.count("\n", 0, match.start("code")) + 1
        if match["file"]:
            if match["code"] != without_licence((root / match["file"]).read_text()):
                errors.append(f"{page}: the block is not {match['file']}; run check_snippets.py . --write")
            continue
        code = match["code"]
        includes += re.findall(r"^#include.*$", code, re.M)
        code = re.sub(r"^#include.*$", "", code, flags=re.M)
        at = f'#line {line} "{page}"\n'
        parts.append(at + code if DEFINITION.search(code) else f"template <int>\nvoid snippet_{page_name(root, page)}_{n}() {{\n{at}{code}}}\n")
    if not parts:
        return includes, ""
    context = root / "tests" / "docs" / "context" / f"{page_name(root, page)}.hpp"
    body = (f'#include "{context}"\n' if context.exists() else "") + "".join(parts)
    # A specialisation of the library's templates cannot stand in a namespace of the page's own.
    scope = "" if re.search(r"^template <>", body, re.M) else f"namespace snippets_{page_name(root, page)} "
    return includes, f"{scope}{{\n{body}}}\n" if scope else body


def compile_snippets(snippets, command, errors):
    """All at once: the library's headers take longer than any snippet."""
    with tempfile.TemporaryDirectory() as name:
        source = pathlib.Path(name) / "snippets.cpp"
        includes = "\n".join(line for lines, _ in snippets for line in lines)
        source.write_text(PREAMBLE + includes + "\n" + "".join(body for _, body in snippets))
        result = subprocess.run([*command, "-fsyntax-only", source], capture_output=True, text=True)
        if result.returncode:
            errors.append(result.stderr.strip())


def anchors_of(text):
    titles = re.findall(r"^#+ (.*)$", re.sub(r"^```.*?^```", "", text, flags=re.M | re.S), re.M)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


def check_links(page, errors):
    text = re.sub(r"^```.*?^```", "", page.read_text(), flags=re.M | re.S)
    for link in re.findall(r"\]\(([^)\s]+)\)", text):
        if re.match(r"\w+:", link):
            continue
        path, _, anchor = link.partition("#")
        target = (page.parent / path) if path else page
        if not target.exists():
            errors.append(f"{page}: the link {link} leads nowhere")
        elif anchor and target.suffix == ".md" and anchor not in anchors_of(target.read_text()):
            errors.append(f"{page}: {link} has no such heading")


def check_concepts(root, errors):
    sections = set(re.findall(r"\w+", " ".join(re.findall(r"^## (.*)$", (root / "docs" / "concepts.md").read_text(), re.M))))
    for header in sorted((root / "include").rglob("*.hpp")):
        if {"detail", "adapters"} & set(header.parts):
            continue
        text = re.sub(r"^namespace detail \{$.*?^\}  // namespace detail$", "", header.read_text(), flags=re.M | re.S)
        for concept in re.findall(r"^concept (\w+)", text, re.M):
            if concept not in sections:
                errors.append(f"{header}: the concept {concept} has no section in docs/concepts.md")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("root", type=pathlib.Path)
    parser.add_argument("--compiler", default="g++")
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--flags", nargs=argparse.REMAINDER, default=[])
    options = parser.parse_args()
    root = options.root.resolve()
    pages, errors, snippets = pages_of(root), [], []
    for page in pages:
        if options.write:
            write_files(root, page)
        check_links(page, errors)
        snippets.append(snippets_of(root, page, errors))
    check_concepts(root, errors)
    if not options.write:
        compile_snippets(snippets, [options.compiler, "-std=c++20", f"-I{root}/include", *options.flags], errors)
    print("\n".join(errors) if errors else f"{len(pages)} pages, {sum(bool(body) for _, body in snippets)} of them with snippets")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
