#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""Names what is public and has no words in the reference: undocumented.py XML_FOLDER

Counted are functions, constants, concepts, enumerations and types (classes, structs, aliases) of framehex's namespaces, overloads one
by one. Members stand on the page of their class, and specialisations of traits are described by the concepts that they serve.
"""
import pathlib
import sys
import xml.etree.ElementTree as ElementTree


def has_words(node):
    return any("".join(node.find(part).itertext()).strip() for part in ("briefdescription", "detaileddescription")
               if node.find(part) is not None)


def is_ours(name):
    return name.startswith("framehex") and "detail" not in name and "@" not in name


def undocumented(folder):
    for path in sorted(folder.glob("*.xml")):
        if path.name in ("index.xml", "Doxyfile.xml"):
            continue
        for compound in ElementTree.parse(path).getroot().iter("compounddef"):
            name, kind = compound.findtext("compoundname"), compound.get("kind")
            if kind not in ("class", "struct", "concept", "namespace") or not is_ours(name) or "_traits<" in name.replace(" ", ""):
                continue
            if kind != "namespace" and compound.get("prot", "public") == "public" and not has_words(compound):
                yield f"{kind} {name}"
            for member in compound.iter("memberdef") if kind == "namespace" else ():
                what = member.findtext("name")
                if member.get("kind") in ("function", "enum", "typedef", "variable") and not what.startswith("operator") and not has_words(member):
                    yield f"{member.get('kind')} {name}::{what}"


def main():
    names = sorted(set(undocumented(pathlib.Path(sys.argv[1]))))
    print("\n".join(names))
    print(f"{len(names)} public names without words")
    return 1 if names else 0


if __name__ == "__main__":
    sys.exit(main())
