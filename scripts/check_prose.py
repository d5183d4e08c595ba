#!/usr/bin/env python3
"""Counts phrases and names that make sources and pages hard to read, and fails above the limits below.

    scripts/check_prose.py            the counts and the worst files
    scripts/check_prose.py FILE...    the lines of these files with their phrases

A phrase can be right where it is. The limits are a ratchet: lower them whenever a count falls.
"""

import re
import subprocess
import sys
from collections import Counter

# Most phrases per 1 000 comment lines and per 1 000 words of Markdown, most names, most named closures per 1 000 lines of code.
# The goals are 40, 4, 0 and 3.
LIMITS = {"comments": 40, "markdown": 2, "names": 94, "closures": 5.7}
# Most words of a page. Generated pages and the changelog have no limit.
PAGE_WORDS = {"README.md": 600}
DEFAULT_PAGE_WORDS = 1500
UNLIMITED_PAGES = {"CHANGELOG.md", "docs/reference/command-line.md", "proto/job/FIELDS.md", "proto/job/ERRORS.md", "services/api/ERRORS.md"}

PHRASES = {
    "noun clause": r"what (?:is|are|was|were|it|they|a|an|the|of|no|may|has|holds|can|needs|must|[a-z]+s)",
    "preposition and pronoun": r"(?:of|from|in|to|by|through|with|on|at|under|over|after|before|for) (?:which|whom|whose)",
    "none as absence": r"none (?:where|of|without|in|with|if|as|was|is|for|on|before|at|that)",
    "relative clause for a participle": r"that (?:is|are|was|were) [a-z]+(?:ed|en|wn|lt|ut|ld|nt)",
    "absence as actor": r"nobody|somebody|no one|nothing",
    "position for being": r"stands?(?! for a)|stood|lies|lie",
    "programs that talk": r"tells?|told|hears?|heard|says?|said|asks?|asked|asking|answers?",
    "own": r"own",
    "comparison": r"as far as|so many|so much|as often as|as near|as many as|as much",
    "movement for change": r"(?:goes|go|gone|comes|come) (?:on|back|with|into|by|to|from|apart|under|out|of)",
    "old adverb": r"beside|anew|once more|at once|by itself|by themselves|alike|afresh",
    "negated being": r"(?:is|are|was) (?:no|none) [a-z]+",
    "hands, takes, gives": r"hands?|handed|gives|given to|takes",
    "whatever": r"whatever|whoever|whichever|however (?:many|large|far|dark|much)",
}
PATTERNS = {name: re.compile(rf"\b(?:{phrase})\b", re.IGNORECASE) for name, phrase in PHRASES.items()}
COMMENT = re.compile(r"^\s*//[/!]?\s?(.*)")
# A function, closure or value that is called by a preposition or pronoun. `from` of the trait `From` is none.
NAME = re.compile(r"\b(?:fn|let)\s+(?:of|at|by|to|one|each|there|here|these|those|(?<!fn )from|with|than)\s*[(<=|]")
# A closure that should be a function or an argument.
CLOSURE = re.compile(r"\blet (?:mut )?\w+ = (?:move )?\|")


def find_phrases(text: str) -> list[str]:
    """Return the kind of each phrase."""
    return [name for name, pattern in PATTERNS.items() for _ in pattern.finditer(text)]


def prose(path: str, line: str) -> str:
    """Return the part of a line that is prose."""
    if path.endswith(".md"):
        return line
    comment = COMMENT.match(line)
    return comment.group(1) if comment else ""


def tracked_files() -> list[str]:
    """Return the pages and the sources of the product."""
    listed = subprocess.run(["git", "ls-files"], check=True, capture_output=True, text=True).stdout.split("\n")
    is_source = re.compile(r"(?!fuzz/|tests/).*/src/.*\.rs$")
    return [path for path in listed if path.endswith(".md") or is_source.match(path)]


def read_lines(path: str) -> list[str]:
    """Return the lines of a file."""
    with open(path, encoding="utf-8") as file:
        return file.read().split("\n")


def count(files: list[str]) -> tuple[dict[str, float], Counter[str]]:
    """Return the counts by limit and the phrases of each file."""
    sizes: Counter[str] = Counter()
    phrases: Counter[str] = Counter()
    by_file: Counter[str] = Counter()
    names = closures = code = 0
    for path in files:
        is_page = path.endswith(".md")
        kind = "markdown" if is_page else "comments"
        for line in read_lines(path):
            text = prose(path, line)
            by_file[path] += len(find_phrases(text))
            sizes[kind] += len(text.split()) if is_page else bool(COMMENT.match(line))
            names += not is_page and bool(NAME.search(line))
            closures += not is_page and bool(CLOSURE.search(line))
            code += not is_page and bool(line.strip()) and not COMMENT.match(line)
        phrases[kind] += by_file[path]
    rates = {kind: 1000 * phrases[kind] / max(1, sizes[kind]) for kind in ("comments", "markdown")}
    return rates | {"names": names, "closures": 1000 * closures / max(1, code)}, by_file


def find_long_pages(files: list[str]) -> list[str]:
    """Return a message for each page above its limit of words."""
    messages = []
    for path in files:
        if path.endswith(".md") and path not in UNLIMITED_PAGES:
            words = len(" ".join(read_lines(path)).split())
            limit = PAGE_WORDS.get(path, DEFAULT_PAGE_WORDS)
            if words > limit:
                messages.append(f"{path} has {words} words, at most {limit}; split it or delete repetition")
    return messages


def check_patterns() -> None:
    """Fail if a pattern has stopped to match its example, or matches good prose."""
    assert find_phrases("What it holds stands beside them.") == ["noun clause", "position for being", "old adverb"]
    assert find_phrases("Returns the transmittance along the ray.") == []
    assert prose("a.rs", "    /// Errors if it is empty.") == "Errors if it is empty."
    assert prose("a.rs", "let told = 1;") == ""
    assert NAME.search("let of = |x| x")
    assert NAME.search("fn at(&self)")
    assert not NAME.search("fn attach(&self)")
    assert not NAME.search("fn from(error: Error)") and NAME.search("let from = 1")
    assert CLOSURE.search("let f = |x| x") and not CLOSURE.search("let f = g(|x| x)")


def report(files: list[str]) -> bool:
    """Print the counts and return whether all are within their limits."""
    counts, by_file = count(files)
    excess = [kind for kind, limit in LIMITS.items() if counts[kind] > limit]
    for kind, limit in LIMITS.items():
        print(f"{kind}: {counts[kind]:.1f}, at most {limit}")
    if excess:
        print(f"too many in {', '.join(excess)}; the worst files:")
        for path, found in by_file.most_common(15):
            print(f"{found:5d}  {path}")
    long_pages = find_long_pages(files)
    print("\n".join(long_pages), end="\n" if long_pages else "")
    return not excess and not long_pages


def show_phrases(path: str) -> None:
    """Print the lines of a file that have phrases."""
    for number, line in enumerate(read_lines(path), 1):
        if found := find_phrases(prose(path, line)):
            print(f"{path}:{number}: {line.strip()[:120]} [{', '.join(found)}]")


def main() -> int:
    """Return the exit status."""
    check_patterns()
    for path in sys.argv[1:]:
        show_phrases(path)
    return 0 if sys.argv[1:] or report(tracked_files()) else 1


if __name__ == "__main__":
    sys.exit(main())
