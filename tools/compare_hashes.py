#!/usr/bin/env python3
"""Compares the hashes that two bakes wrote for each pass of each step, and names the first difference.

    SNOWBOUGH_PASS_HASHES=A.txt blender -b shot.blend -P addon/snowbough/cli.py -- bake
    SNOWBOUGH_PASS_HASHES=B.txt ...            another machine, engine or Blender, or a resumed bake
    compare_hashes.py A.txt B.txt

Steps that only one file has are skipped, such as those before a resumed bake's first frame. The exit status is 0 if all
others are equal, 1 if not, 2 if the files have no step in common.
"""

import sys
from pathlib import Path


def read_hashes(path):
    """{(frame, step, pass, object): hash} in the order of the file."""
    rows = (line.split("\t") for line in Path(path).read_text(encoding="utf-8").splitlines())
    return {tuple(row[:4]): row[4] for row in rows}


def main(a, b):
    first, second = read_hashes(a), read_hashes(b)
    common = [key for key in first if key in second]
    if not common:
        print("no step is in both files")
        return 2
    different = [key for key in common if first[key] != second[key]]
    if not different:
        print(f"{len(common)} hashes are equal")
        return 0
    frame, step, name, of = different[0]
    print(f"frame {frame}, step {step}: the pass {name} differs on {of}")
    print(f"{len(different)} of {len(common)} hashes differ")
    return 1


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
