#!/usr/bin/env python3
"""Lists import circles under src/: two siblings in one folder, files or folders, each of which uses the other.

    tests/circles.py [FOLDER]

A module uses a sibling where a path in it begins with `crate::` or with `super::` and leads into that
sibling, in a `use` or elsewhere. Doc comments, `mod tests` blocks, `tests.rs` files and `tests/` folders
are left out. Prints one line a circle, with the first place of each direction, and exits with 1 if there
is any. Standard library only.
"""

import re
import sys
from pathlib import Path

WORD = r"[A-Za-z_][A-Za-z0-9_]*"
PATH = re.compile(rf"(?<![A-Za-z0-9_:])(?:pub\(in )?((?:crate|super|self)(?:::{WORD})*)(::\{{)?")


def module(file, root):
    """The module path of a file: `a/b.rs` and `a/b/mod.rs` are (a, b); `lib.rs` and `main.rs` are ()."""
    parts = list(file.relative_to(root).with_suffix("").parts)
    if parts[-1] in ("mod", "lib", "main"):
        parts.pop()
    return tuple(parts)


def code(text):
    """The text with comments, strings and test modules blanked, its lines kept."""
    blank = lambda match: "".join(c if c == "\n" else " " for c in match.group())
    text = re.sub(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\])*"', blank, text, flags=re.S)
    for match in re.finditer(r"#\[cfg\(test\)\]\s*(?:pub )?mod \w+\s*\{", text):
        depth, end = 1, match.end()
        while depth and end < len(text):
            depth += {"{": 1, "}": -1}.get(text[end], 0)
            end += 1
        body = text[match.start() : end]
        text = text[: match.start()] + re.sub(r"[^\n]", " ", body) + text[end:]
    return text


def inner(text, start):
    """The comma-separated entries of a brace group that opens just before `start`, braces inside kept."""
    entries, depth, at, begin = [], 1, start, start
    while at < len(text) and depth:
        c = text[at]
        depth += {"{": 1, "}": -1}.get(c, 0)
        if (c == "," and depth == 1) or depth == 0:
            entries.append(text[begin:at].strip())
            begin = at + 1
        at += 1
    return entries


def leads(base, entry):
    """The module paths an entry of a group under `base` leads to."""
    names = re.match(rf"(?:{WORD}(?:::)?)*", entry).group().split("::")
    path = base + tuple(name for name in names if name and name != "self")
    group = entry.find("{")
    if group < 0:
        return [path]
    return [found for each in inner(entry, group + 1) for found in leads(path, each)]


def uses(own, text):
    """Every module path that this text mentions, with its line."""
    for match in PATH.finditer(text):
        first, *rest = match.group(1).split("::")
        base = {"crate": (), "self": own, "super": own[:-1]}[first]
        while rest and rest[0] == "super":
            base, rest = base[:-1], rest[1:]
        path = base + tuple(rest)
        line = text.count("\n", 0, match.start()) + 1
        entries = inner(text, match.end()) if match.group(2) else [""]
        for entry in entries:
            for found in leads(path, entry):
                yield found, line


def circles(root):
    """Pairs of siblings that use each other, each with one place a direction."""
    files = sorted(root.rglob("*.rs"))
    files = [f for f in files if f.stem != "tests" and "tests" not in f.relative_to(root).parts]
    modules = {module(f, root) for f in files}
    modules |= {m[:n] for m in modules for n in range(1, len(m))}
    found = {}
    for file in files:
        own = module(file, root)
        for path, line in uses(own, code(file.read_text())):
            # Where the two paths part, if both sides are modules: a parent and its own are no siblings.
            same = 0
            while same < min(len(own), len(path)) and own[same] == path[same]:
                same += 1
            if same < min(len(own), len(path)):
                pair = own[: same + 1], path[: same + 1]
                if all(side in modules for side in pair):
                    found.setdefault(pair, f"{file.relative_to(root)}:{line}")
    return [(a, b, found[a, b], found[b, a]) for a, b in sorted(found) if a < b and (b, a) in found]


def main():
    folder = sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent.parent / "src"
    all_circles = circles(Path(folder))
    for a, b, there, back in all_circles:
        print(f"{'/'.join(a)} <-> {'/'.join(b)}   {there}, {back}")
    return 1 if all_circles else 0


if __name__ == "__main__":
    sys.exit(main())
