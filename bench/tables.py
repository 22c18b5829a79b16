"""Tables as plain text, markdown and CSV."""
import csv
import json


def cell(value, form):
    return form % value if value is not None else "-"


def plain(columns, lines):
    """Lines of text with right-aligned columns."""
    lines = [columns] + lines
    widths = [max(len(line[k]) for line in lines) for k in range(len(columns))]
    return ["  ".join(text.rjust(width) for text, width in zip(line, widths)) for line in lines]


def markdown(columns, lines):
    rows = [columns, ["---"] * len(columns)] + lines
    return ["| %s |" % " | ".join(row) for row in rows]


def write_csv(path, rows):
    """Writes rows, which are dictionaries; a missing key leaves its cell empty."""
    fields = list(dict.fromkeys(key for row in rows for key in row))
    with open(path, "w", newline="") as stream:
        writer = csv.DictWriter(stream, fields, restval="", lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def write_json(path, data):
    path.write_text(json.dumps(data, indent=1) + "\n")
