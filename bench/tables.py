"""Tables as plain text and markdown."""


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
