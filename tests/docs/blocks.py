"""Extracts the shell, Python and SQL blocks of a page of Markdown, and the jobs that it shows as JSON."""

import dataclasses
import json
import re

SHELLS = {"sh", "bash", "shell", "console"}
PYTHONS = {"python", "py"}
SQL = "sql"
# Kinds of scenes that a job can have without uploads.
LOCAL_SCENES = {"procedural", "files"}
# Requirements that the test does not have; a block that is marked with another word is an error.
NEEDS = {
    "account", "broker", "bucket", "build", "colmap", "docker", "gpu", "kubernetes", "mujoco", "nerfstudio",
    "pybullet", "ros", "slurm", "ultralytics",
}

FENCE = re.compile(r"^(?P<indent>[ \t]*)(?P<fence>`{3,}|~{3,})[ \t]*(?P<language>[\w+-]*)")
MARK = re.compile(r"^[ \t]*<!--\s*needs:\s*(?P<needs>.*?)\s*-->\s*$")


@dataclasses.dataclass(frozen=True)
class Block:
    """A fenced block: `line` is that of its first line of code, `needs` are its requirements."""

    line: int
    language: str
    code: str
    needs: tuple[str, ...] = ()

    @property
    def is_python(self) -> bool:
        """Whether Python runs the block."""
        return self.language in PYTHONS


def read_needs(line: str) -> tuple[str, ...]:
    """Return the requirements in a marking comment, none for another line."""
    mark = MARK.match(line)
    needs = tuple(word.strip() for word in mark["needs"].split(",")) if mark else ()
    if unknown := [word for word in needs if word not in NEEDS]:
        raise ValueError(f"`needs: {', '.join(unknown)}` is unknown; use one of {', '.join(sorted(NEEDS))}")
    return needs


def read_commands(lines: list[str]) -> list[str]:
    """Return the lines of a console block after the prompt; other lines are output."""
    return [line[2:] if line.startswith(("$ ", "> ")) else "" for line in lines]


def is_job(code: str) -> bool:
    """Whether JSON is a complete job that needs no uploads; parts of jobs and other documents are not."""
    try:
        document = json.loads(code)
    except ValueError:
        return False
    if not isinstance(document, dict):
        return False
    scene = document.get("scene")
    return "site" in document or (isinstance(scene, dict) and scene.get("kind") in LOCAL_SCENES)


def extract_blocks(text: str) -> list[Block]:
    """Return the blocks that a reader would run, in the order of the page."""
    blocks: list[Block] = []
    lines = text.split("\n")
    number = 0
    while number < len(lines):
        opening = FENCE.match(lines[number])
        if not opening:
            number += 1
            continue
        end = next((n for n in range(number + 1, len(lines)) if closes(lines[n], opening["fence"])), None)
        if end is None:
            raise ValueError(f"the block of line {number + 1} has no end")
        language = opening["language"].lower()
        code = [line.removeprefix(opening["indent"]) for line in lines[number + 1 : end]]
        if language in SHELLS | PYTHONS | {SQL} or (language == "json" and is_job("\n".join(code))):
            code = read_commands(code) if language == "console" else code
            needs = read_needs(lines[number - 1]) if number else ()
            blocks.append(Block(number + 2, language, "\n".join(code) + "\n", needs))
        number = end + 1
    return blocks


def closes(line: str, fence: str) -> bool:
    """Whether a line ends the block that this fence began."""
    stripped = line.strip()
    return len(stripped) >= len(fence) and set(stripped) == {fence[0]}
