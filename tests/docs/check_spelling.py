#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""Checks the spelling of the pages and of the headers' comments by aspell: check_spelling.py SOURCE_DIR [--write]

Words of the field, names and abbreviations that aspell does not know are in words.txt beside this script; --write makes it
anew, to be read before it is kept. Code and links are left out.
"""
import argparse
import pathlib
import re
import subprocess
import sys

WORDS = pathlib.Path(__file__).with_name("words.txt")


def prose_of_page(text):
    text = re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)
    return re.sub(r"`[^`]*`|\]\([^)]*\)|<[^>]*>", " ", text)


def prose_of_header(text):
    comments = "\n".join(line.partition("//")[2] for line in text.splitlines())
    comments = re.sub(r"`[^`]*`", " ", re.sub(r"@code.*?@endcode", "", comments, flags=re.S))
    return re.sub(r"SPDX.*|@(tparam|param|throws|pre|par)\b|\S*[_()\\/<>=]\S*|\S*\w[.:]+\w\S*", " ", comments)


def aspell(text):
    return subprocess.run(["aspell", "--lang=en_GB", "--encoding=utf-8", "list"], input=text, capture_output=True, text=True,
                          check=True).stdout.split()


def unknown_words(text):
    """Each once, as it is written, without an ending in 's; names with capitals inside are taken for code."""
    text = re.sub(r"https?://\S+|\b\w*[a-z][A-Z]\w*", " ", text)
    return set(aspell("\n".join(word.removesuffix("'s") for word in aspell(text))))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("root", type=pathlib.Path)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    root = options.root
    texts = {p: prose_of_page(p.read_text()) for p in [*root.glob("*.md"), *sorted((root / "docs").rglob("*.md"))]}
    texts |= {p: prose_of_header(p.read_text()) for p in sorted((root / "include").rglob("*.hpp")) if p.name != "viewer_page.hpp"}
    unknown = unknown_words("\n".join(texts.values()))
    if options.write:
        WORDS.write_text("".join(f"{word}\n" for word in sorted(unknown)))
    known = set(WORDS.read_text().split())
    errors = [f"{word}: not a word, in " + ", ".join(str(p.relative_to(root)) for p, text in texts.items()
                                                     if re.search(rf"\b{re.escape(word)}\b", text))
              for word in sorted(unknown - known)]
    print("\n".join(errors) if errors else f"{len(texts)} files, {len(known)} words of our own")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
