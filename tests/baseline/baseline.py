#!/usr/bin/env python3
"""What every verb says of every shipped scene, recorded and compared.

    tests/baseline/baseline.py record target/release/springcheck before/
    ... change something, build ...
    tests/baseline/baseline.py record target/release/springcheck after/
    tests/baseline/baseline.py compare before/ after/

`record` runs every verb on every scene and keeps what goes to stdout and into files, with the exit code.
`compare` exits 1 where a key of `before` is missing or differs in `after`: text and counts must be equal,
numbers to 1e-12 of themselves. Keys that only `after` has are listed and allowed. Times, and what is chosen
by them, are left out.

Options: `--only TEXT` takes only the scenes whose path holds it; `--jobs N` (default: the cores).
"""

import argparse
import gzip
import json
import os
import re
import subprocess
import sys
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TOLERANCE = 1e-12
# Chosen by the clock, so different in every run.
CLOCKED = {"cheapest", "ranking", "extrapolated_wall_ratio", "nanoseconds"}
LISTS = ["integrators", "effects", "engines", "mistakes"]


def own(scene):
    """The integrator and timestep a scene names."""
    text = scene.read_text()
    method = re.search(r"\btype: *([\w]+)", text)
    step = re.search(r"\btimestep: *([\w.+-]+)", text)
    return (method and method[1]) or "rk4", float((step and step[1]) or 0.01)


def commands(scene, out):
    """What is run on a scene: a name, and the arguments."""
    path = str(scene.relative_to(ROOT))
    method, step = own(scene)
    yield "run", ["run", path, "--output", out / "run"]
    yield "run_json", ["run", path, "--truth", "none", "--engines", "rapier-converged", "--format", "json"]
    yield "save", ["run", path, "--integrators", method, "--engines", "none", "--truth", "none",
                   "--save", "npz", "--every", "3", "--output", out / "save", "--format", "json"]
    yield "stability", ["stability", path, "--output", out / "stability"]
    yield "cost", ["cost", path, "--budget", "1s", "--output", out / "cost"]
    yield "panels", ["cost", path, "--integrators", f"{method},rk4", "--timestep", f"{step},{step / 2}",
                     "--output", out / "panels"]
    if "oscillator" in path or "pa1/scene01" in path:
        yield "map", ["stability", path, "--vary", "springs.stiffness=1..1e5:4", "--steps", "1e-3..1e-1:4",
                      "--budget", "1e5", "--output", out / "map"]


def record(program, folder, scenes, jobs):
    program = str(Path(program).resolve())

    def run(name, arguments, out):
        out.mkdir(parents=True, exist_ok=True)
        done = subprocess.run([program, "--quiet", "--color", "never", *map(str, arguments)],
                              cwd=ROOT, capture_output=True, text=True, check=False)
        (out / f"{name}.out").write_text(done.stdout + done.stderr.replace(str(out), "OUT"))
        (out / f"{name}.code").write_text(f"{done.returncode}\n")

    def scene(path):
        out = folder / path.relative_to(ROOT).with_suffix("")
        for name, arguments in commands(path, out):
            run(name, arguments, out)
        saved = sorted((out / "save").rglob("*.npz"))
        for file in saved[:1]:
            # A report lies under its file's path, which must not name the folder it is recorded in.
            with tempfile.TemporaryDirectory(dir=ROOT / "target") as place:
                copy = Path(place) / "saved.npz"
                copy.write_bytes(file.read_bytes())
                run("compare", ["compare", copy, "--scene", path.relative_to(ROOT), "--format", "json"], out)
        print(path.relative_to(ROOT), flush=True)

    for kind in LISTS:
        run(kind, ["list", kind], folder / "list")
    with ThreadPoolExecutor(jobs) as pool:
        list(pool.map(scene, scenes))


def differs(path, before, after):
    """Every difference, as text."""
    if isinstance(before, dict) and isinstance(after, dict):
        for key, value in before.items():
            if key.startswith("wall") or key in CLOCKED:
                continue
            if key not in after:
                yield f"{path}.{key}: gone"
            else:
                yield from differs(f"{path}.{key}", value, after[key])
    elif isinstance(before, list) and isinstance(after, list):
        if len(before) != len(after):
            yield f"{path}: {len(before)} entries, now {len(after)}"
        for at, (one, two) in enumerate(zip(before, after)):
            yield from differs(f"{path}[{at}]", one, two)
    elif isinstance(before, float) and isinstance(after, (int, float)):
        if abs(before - after) > TOLERANCE * max(abs(before), abs(after)):
            yield f"{path}: {before!r}, now {after!r}"
    elif before != after or isinstance(before, bool) != isinstance(after, bool):
        yield f"{path}: {str(before)[:120]!r}, now {str(after)[:120]!r}"


def added(path, before, after):
    if isinstance(before, dict) and isinstance(after, dict):
        for key, value in after.items():
            if key in before:
                yield from added(f"{path}.{key}", before[key], value)
            else:
                yield re.sub(r"\[\d+\]", "[]", f"{path}.{key}")
    elif isinstance(before, list) and isinstance(after, list):
        for one, two in zip(before, after):
            yield from added(f"{path}[]", one, two)


def reports(text):
    """The reports of a JSON text, whatever envelope they come in."""
    value = json.loads(text)
    if isinstance(value, dict) and "reports" in value:
        value = value["reports"]
    value = value if isinstance(value, list) else [value]
    # The schema's version may rise.
    return [{k: v for k, v in report.items() if k != "schema_version"} for report in value]


# Numbers with a unit of time that may be wall time, ratios of times, and the table's columns of them.
TIMES = re.compile(r"(?<![\w.])[\d.,]+(e-?\d+)? ?(ns|µs|us|ms|s|min|h)\b( ±\d+ ?%)?|[\d.,]+ times|[\d.,]+x\b")


def plain(text, name):
    """Text without what the clock wrote, and with runs of blanks as one: its columns follow the times."""
    if name.startswith(("cost", "panels")) and not name.endswith(".code"):
        # Whole sentences name the cheapest, which the clock chooses.
        return ""
    # Where the report lies is not what it says.
    lines = [line for line in TIMES.sub("#", text).splitlines() if not line.startswith("report: ")]
    return "\n".join(re.sub(r"[ ─┄-]+", " ", line).strip() for line in lines)


def compare(before, after):
    counts, new, bad = Counter(), Counter(), 0
    for file in sorted(p for p in before.rglob("*") if p.is_file()):
        name = file.relative_to(before)
        other = after / name
        if not other.exists():
            print(f"{name}: gone")
            bad += 1
            continue
        if file.suffix == ".npz":
            found = [] if file.read_bytes() == other.read_bytes() else ["other bytes"]
        elif file.suffix == ".series":
            one, two = (json.loads(gzip.decompress(p.read_bytes()))["series"] for p in (file, other))
            found = list(differs("", one, two))
        elif file.suffix == ".json" or file.read_bytes()[:1] in (b"{", b"["):
            try:
                one, two = reports(file.read_text()), reports(other.read_text())
                found = list(differs("", one, two))
                new.update(added("", one, two))
            except json.JSONDecodeError:
                found = [] if file.read_text() == other.read_text() else ["other text"]
        else:
            one, two = (plain(p.read_text(), str(name.name)) for p in (file, other))
            lines = zip(one.splitlines(), two.splitlines())
            found = [f"`{a[:110]}`\n     now `{b[:110]}`" for a, b in lines if a != b]
            if len(one.splitlines()) != len(two.splitlines()):
                found.append(f"{len(one.splitlines())} lines, now {len(two.splitlines())}")
        counts[file.suffix] += 1
        for line in found[:4]:
            print(f"{name}{line if line.startswith(('.', '[')) else ': ' + line}")
        if len(found) > 4:
            print(f"{name}: {len(found) - 4} more")
        bad += bool(found)
    for key, count in sorted(new.items()):
        print(f"added {key} ({count})")
    print(f"{sum(counts.values())} files compared ({dict(counts)}), {bad} differ")
    return 1 if bad else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = parser.add_subparsers(dest="verb", required=True)
    one = verbs.add_parser("record")
    one.add_argument("program")
    one.add_argument("folder", type=Path)
    one.add_argument("--only", default="")
    one.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    two = verbs.add_parser("compare")
    two.add_argument("before", type=Path)
    two.add_argument("after", type=Path)
    args = parser.parse_args()
    if args.verb == "compare":
        sys.exit(compare(args.before, args.after))
    scenes = [s for s in sorted(ROOT.glob("scenes/**/*.yml")) if args.only in str(s)]
    record(args.program, args.folder.resolve(), scenes, args.jobs)


if __name__ == "__main__":
    main()
