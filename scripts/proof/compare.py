"""Differences as short lines, and the list of those that are wanted."""

import fnmatch
import json

MOST_SHOWN = 12
# The part of the proof that an area belongs to.
PART_OF = {"frames": "frames", "openapi": "openapi", "answers": "catalogue", "later": "catalogue", "refusals": "words", "options": "words", "outputs": "words"}


def differences(old, new, path=""):
    """Paths at which two JSON values differ, with what stands there."""
    if isinstance(old, dict) and isinstance(new, dict):
        for key in sorted(old.keys() | new.keys()):
            below = f"{path}/{key}"
            if key not in new:
                yield below, "gone", old[key], None
            elif key not in old:
                yield below, "new", None, new[key]
            else:
                yield from differences(old[key], new[key], below)
    elif isinstance(old, list) and isinstance(new, list):
        yield from differences(keyed(old), keyed(new), path)
    elif old != new or type(old) is not type(new):
        yield path, "changed", old, new


def keyed(items):
    """A list as an object: by its members' names where they have some, so that one more member shifts nothing."""
    for name in ("name", "stage", "$ref", "kind"):
        names = [item.get(name) for item in items if isinstance(item, dict)]
        if items and len(names) == len(items) and None not in names and len(set(names)) == len(names):
            return dict(zip(names, items))
    if items and all(isinstance(item, str) for item in items) and len(set(items)) == len(items):
        return {item: True for item in items}
    return {str(index): item for index, item in enumerate(items)}


def shown(value):
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 90 else text[:87] + "…"


class Report:
    """Collects differences: wanted ones are counted under their reason, others fail the check."""

    def __init__(self, expected):
        self.expected = [[part.strip() for part in line.split(" | ", 3)] for line in expected.read_text().splitlines()
                         if line.strip() and not line.startswith("#")]
        for line in self.expected:
            if len(line) != 4 or not line[3]:
                raise SystemExit(f"{expected}: four parts are needed, the last is the reason: {' | '.join(line)}")
        self.used = [0] * len(self.expected)
        self.unexpected = []

    def keep_areas(self, parts):
        """Leaves out what is expected of parts that are not compared."""
        for area in PART_OF.keys() - {area for area, part in PART_OF.items() if part in parts}:
            self.leave_out(area)

    def leave_out(self, area):
        kept = [(line, used) for line, used in zip(self.expected, self.used) if line[0] != area]
        self.expected, self.used = [line for line, _ in kept], [used for _, used in kept]

    def add(self, area, place, what, text):
        """One difference: `area` and `place` say where, `what` says which column or kind of change."""
        for index, (in_area, pattern, kinds, _) in enumerate(self.expected):
            if in_area == area and fnmatch.fnmatchcase(place, pattern) and (kinds == "*" or what in kinds.split()):
                self.used[index] += 1
                return
        self.unexpected.append((area, place, what, text))

    def end(self):
        """Prints everything and returns the exit status."""
        for (area, pattern, kinds, reason), used in zip(self.expected, self.used):
            print(f"expected: {used:4} {area} {pattern} ({kinds}): {reason}" if used else
                  f"NOT NEEDED: no {area} {pattern} ({kinds}) differs any more: take the line out")
        areas = {}
        for area, place, what, text in self.unexpected:
            areas.setdefault(area, []).append(f"  {place} {what} {text}".rstrip())
        for area, lines in areas.items():
            print(f"UNEXPECTED in {area}: {len(lines)}")
            hidden = len(lines) - MOST_SHOWN
            print("\n".join(lines if len(lines) <= MOST_SHOWN + 3 else lines[:MOST_SHOWN] + [f"  … and {hidden} more: --all shows them"]))
        return 1 if self.unexpected or 0 in self.used else 0
