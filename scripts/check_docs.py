#!/usr/bin/python3
"""Checks the documents: lines of at most 100 columns, links that lead somewhere. Usage: scripts/check_docs.py

A table row may have 160 columns, a URL and a generated table any number. A link must name an existing
file, and a heading of it where it has a fragment.
"""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROSE, ROW = 100, 160
LINK = re.compile(r"\]\(([^)\s]+)\)")
GENERATED = re.compile(r"<!-- (.*)-->")


def documents():
    listed = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard", "*.md", "*.rst"],
                            cwd=ROOT, check=True, capture_output=True, text=True).stdout.split()
    return [ROOT / name for name in listed if (ROOT / name).exists()]


def has_any_width(path):
    """Scripts write the pages beside docs/experiments/README.md; bench/peers has wide tables."""
    written = path.parent == ROOT / "docs" / "experiments" and path.name != "README.md"
    return written or ROOT / "bench" in path.parents


def prose(path):
    """Lines with their numbers, without code blocks."""
    fenced = False
    for number, line in enumerate(path.read_text().splitlines(), 1):
        if line.startswith("```"):
            fenced = not fenced
        elif not fenced and not line.startswith("    "):
            yield number, line


def anchors(path):
    found = set()
    for _, line in prose(path):
        if line.startswith("#"):
            text = line.lstrip("#").strip().lower().replace("`", "")
            found.add(re.sub(r"[^\w\- ]", "", text).replace(" ", "-"))
    return found


def too_long(path):
    generated = False
    for number, line in enumerate(path.read_text().splitlines(), 1):
        mark = GENERATED.match(line)
        if mark:
            generated = not mark[1].startswith("end of")
        most = ROW if line.lstrip().startswith("|") else PROSE
        if len(line) > most and not generated and "://" not in line:
            yield f"{number}: {len(line)} columns, at most {most}"


def broken(path):
    for number, line in prose(path):
        for target in LINK.findall(line):
            if "://" in target or target.startswith("mailto:"):
                continue
            name, _, fragment = target.partition("#")
            file = (path.parent / name).resolve() if name else path
            if not file.exists():
                yield f"{number}: no such file: {target}"
            elif fragment and file.suffix == ".md" and fragment not in anchors(file):
                yield f"{number}: no such heading: {target}"


def main():
    if len(sys.argv) > 1:
        print(__doc__)
        return 0
    faults = 0
    for path in documents():
        found = list(broken(path)) + ([] if has_any_width(path) else list(too_long(path)))
        for fault in found:
            print(f"{path.relative_to(ROOT)}:{fault}")
        faults += len(found)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
