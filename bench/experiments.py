"""Results of an experiment: a compact JSON file, and the page that is made from it."""
import collections
import datetime
import json

MISSING = "not recorded"
DIGITS = 6  # significant digits of a measured number

# name of the files, title, command, and a function that makes the lines of the page from the data
Page = collections.namedtuple("Page", "name title command document")


def shortened(value):
    """Floats with a few digits; a list of dictionaries as its columns and rows."""
    if isinstance(value, float):
        short = float("%.*g" % (DIGITS, value))
        return int(short) if short.is_integer() and abs(short) < 1e15 else short
    if isinstance(value, dict):
        return {key: shortened(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        if value and all(isinstance(item, dict) for item in value):
            columns = list(dict.fromkeys(key for item in value for key in item))
            return {"columns": columns, "rows": [[shortened(item.get(key)) for key in columns] for item in value]}
        return [shortened(item) for item in value]
    return value


def expanded(value):
    """The inverse of shortened(), except for the digits. A key that a row lacks has the value None."""
    if isinstance(value, dict):
        if set(value) == {"columns", "rows"}:
            return [dict(zip(value["columns"], map(expanded, row))) for row in value["rows"]]
        return {key: expanded(item) for key, item in value.items()}
    return [expanded(item) for item in value] if isinstance(value, list) else value


def text_of(value, indent=""):
    """JSON with a line for each entry of a dictionary and for each row of a table."""
    dump = json.dumps
    if isinstance(value, dict) and value:
        inner = indent + " "
        if set(value) == {"columns", "rows"}:
            rows = (",\n" + inner).join(dump(row, separators=(",", ":"), ensure_ascii=False) for row in value["rows"])
            return '{"columns": %s, "rows": [\n%s%s]}' % (dump(value["columns"]), inner, rows)
        return "{\n" + ",\n".join("%s%s: %s" % (inner, dump(key), text_of(item, inner)) for key, item in value.items()) + "}"
    return dump(value, ensure_ascii=False)


def save(path, data):
    path.write_text(text_of(shortened(data)) + "\n")


def load(path):
    return expanded(json.loads(path.read_text()))


def origin(data):
    return "Processor: %s. Instruction set of the kernels: %s. Date: %s." % tuple(
        data.get(key) or MISSING for key in ("processor", "simd", "date"))


def text_of_page(page, data, picture):
    size = data.get("size") or "full"
    lines = ["# " + page.title, "", "Made by `%s`%s from [%s.json](%s.json). %s" % (
        page.command, "" if size == "full" else " (%s)" % size, page.name, page.name, origin(data)), ""]
    if picture:
        lines += ["![%s](%s.png)" % (page.title, page.name), ""]
    return "\n".join(lines + page.document(data)) + "\n"


def write(folder, page, data, picture=False):
    """Writes the JSON file with the date of today, and the page, which shows NAME.png if there is a picture."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / (page.name + ".json")
    save(path, {**data, "date": datetime.date.today().isoformat()})
    path.with_suffix(".md").write_text(text_of_page(page, load(path), picture))
