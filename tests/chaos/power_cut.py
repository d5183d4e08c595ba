#!/usr/bin/env python3
"""Takes back what a disk would have lost at a power cut, from the log that power.c wrote.

    power_cut.py LOG SEED

Every write, new length, new name, rename and removal that no sync made safe is in danger. With an even seed all of it is lost. With
an odd one each write is lost, kept, or torn at a sector of 512 bytes, in any order, as disks with a cache do it; of the changes of
names those up to some moment are kept, as file systems with a journal do it.
"""

import os
import random
import sys

SECTOR = 512


class Event:
    def __init__(self, line):
        self.kind, *self.words = line.rstrip("\n").split("\t")
        self.path = self.words[0] if self.words else ""

    def is_data(self):
        return self.kind in "WT"


def unsafe(lines):
    """What no sync has made safe, in order."""
    events = []
    for line in lines:
        event = Event(line)
        if event.kind == "S":
            events = [old for old in events if not (old.is_data() and old.path == event.path)]
        elif event.kind == "D":
            inside = lambda path: os.path.dirname(path) == event.path
            events = [old for old in events if old.is_data() or not inside(old.words[-2] if old.kind == "R" else old.path)]
        elif event.kind == "R":
            # From now on its writes are those of another name.
            for old in events:
                if old.is_data() and old.path == event.path:
                    old.path = event.words[1]
            events.append(event)
        elif event.kind in "WTCU":
            events.append(event)
    return events


def undo(event):
    """Takes an event back; returns what would make it happen again."""
    if event.kind == "W":
        offset, length, size = int(event.words[1]), int(event.words[2]), int(event.words[3])
        if not os.path.exists(event.path):
            return None
        with open(event.path, "r+b") as file:
            file.seek(offset)
            new = file.read(length)
            file.seek(offset)
            file.write(bytes.fromhex(event.words[4]))
            if os.path.getsize(event.path) > size:
                file.truncate(size)
        return new
    if event.kind == "T":
        if os.path.exists(event.path):
            with open(event.path, "r+b") as file:
                file.seek(int(event.words[1]))
                file.write(bytes.fromhex(event.words[4]))
                file.truncate(int(event.words[3]))
        return b""
    if event.kind == "C" and os.path.exists(event.path):
        os.rename(event.path, event.path + ".cut-new")
    if event.kind == "R":
        source, target, kept = event.words
        if os.path.exists(target):
            os.rename(target, source)
        if kept and os.path.exists(kept):
            os.rename(kept, target)
    if event.kind == "U" and event.words[1] and os.path.exists(event.words[1]):
        os.rename(event.words[1], event.path)
    return b""


def again(event, new, dice):
    """Makes a write happen, whole or in sectors, unless its file or the whole of it is lost."""
    chance = dice.random()
    if event.kind == "T" or not new or not os.path.exists(event.path) or chance < 0.4:
        return
    offset = int(event.words[1])
    with open(event.path, "r+b") as file:
        at = 0
        while at < len(new):
            end = min(len(new), at + SECTOR - (offset + at) % SECTOR)
            if chance > 0.7 or dice.random() < 0.5:
                file.seek(offset + at)
                file.write(new[at:end])
            at = end


def main():
    log, seed = sys.argv[1], int(sys.argv[2])
    dice = random.Random(seed)
    events = unsafe(open(log))
    names = [event for event in events if not event.is_data()]
    kept_names = set(map(id, names[: dice.randint(0, len(names))])) if seed % 2 else set()
    lost = []
    for event in reversed(events):
        if event.is_data():
            lost.append((event, undo(event)))
        elif id(event) not in kept_names:
            undo(event)
            if event.kind == "R":
                for old in events:
                    if old.is_data() and old.path == event.words[1]:
                        old.path = event.path
    if seed % 2:
        for event, new in reversed(lost):
            again(event, new, dice)
    for folder, _, files in os.walk(sys.argv[3]):
        for name in files:
            if ".cut-" in name:
                os.remove(os.path.join(folder, name))
    print(f"{len(events) - len(names)} writes and {len(names)} names were not safe")


main()
