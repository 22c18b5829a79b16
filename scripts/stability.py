#!/usr/bin/python3
"""Writes docs/stability.md's tables from the margins that the torture suite measured (scripts/torture.sh).

Usage: stability.py MARGINS.csv DOCUMENT.md
"""
import collections
import csv
import sys

# Column heads of what every case is held to, by the criterion's name in the margins.
COMMON = {"energy gained / turned over": "energy gained", "made by a mesh change / turned over": "mesh change",
          "made by turning normals / turned over": "normals",
          "largest strain": "strain", "fastest particle": "speed, m/s", "failed steps": "failed", "crossings": "crossings"}
Margin = collections.namedtuple("Margin", "case criterion measured limit unit unchecked")


def number(value):
    return "0" if value == 0 else f"{value:.2g}" if abs(value) < 1e4 else f"{value:.1e}"


def pair(margin):
    return f"{number(margin.measured)} ({'not checked' if margin.unchecked else number(margin.limit)})"


def common_table(margins):
    """A row a case: measured (limit) of what every case is held to, then what is its own."""
    cases = collections.defaultdict(dict)
    for margin in margins:
        cases[margin.case][margin.criterion] = margin
    lines = ["| case | " + " | ".join(COMMON.values()) + " | its own |", "| --- " * (len(COMMON) + 2) + "|"]
    for case, own in cases.items():
        if not any(criterion in own for criterion in COMMON):
            continue
        cells = [pair(own[criterion]) if criterion in own else "" for criterion in COMMON]
        rest = [f"{criterion} {pair(m)}" for criterion, m in own.items() if criterion not in COMMON]
        rest += [f"{COMMON[criterion]}: not checked, because {own[criterion].unchecked}"
                 for criterion in COMMON if criterion in own and own[criterion].unchecked]
        lines.append(f"| {case} | " + " | ".join(cells) + f" | {'; '.join(rest)} |")
    return lines


def swing_table(margins):
    """Amplitude lost in a period beside the exact value, a row a time step."""
    swings = collections.defaultdict(list)
    for margin in margins:
        if margin.unit == "=":
            swings[margin.case].append(margin)
    lines = ["| swing | exact | measured | at the default tolerance |", "| --- " * 4 + "|"]
    for case, (tight, loose) in swings.items():
        lines.append(f"| {case} | {tight.limit:.5f} | {tight.measured:.5f} | {loose.measured:.5f} |")
    return lines


def put(text, name, lines):
    begin, end = f"<!-- {name}: scripts/torture.sh -->", f"<!-- end of {name} -->"
    if begin not in text or end not in text:
        sys.exit(f"no markers for {name}")
    head, tail = text.split(begin)[0], text.split(end)[1]
    return head + begin + "\n" + "\n".join(lines) + "\n" + end + tail


def main():
    with open(sys.argv[1], newline="") as file:
        margins = [Margin(row[0], row[1], float(row[2]), float(row[3]), row[4], row[5])
                   for row in csv.reader(file)]
    with open(sys.argv[2], encoding="utf-8") as file:
        text = file.read()
    text = put(text, "cases", common_table(margins))
    text = put(text, "swing", swing_table(margins))
    with open(sys.argv[2], "w", encoding="utf-8") as file:
        file.write(text)


if __name__ == "__main__":
    if {"-h", "--help"} & set(sys.argv):
        print(__doc__)
        sys.exit(0)
    main()
