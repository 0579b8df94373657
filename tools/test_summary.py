#!/usr/bin/env python3
"""Adds up the layers' JUnit reports and gives the reasons for skips.

    test_summary.py FOLDER LAYER...

Reads FOLDER/LAYER.xml, the layer's exit status FOLDER/LAYER.exit and its time FOLDER/LAYER.seconds. Writes the times of
the layers and of their tests, slowest first, to FOLDER/times.txt and prints the ten slowest tests. A layer that ended
with an error without naming a failed test (a crash, a missing report) counts as one failure. The last line is
`N passed, N failed, N skipped`; the exit status is 1 if anything failed.
"""

import re
import sys
import xml.etree.ElementTree as ElementTree
from collections import Counter
from pathlib import Path


def skip_reason(case, skipped):
    """pytest puts the reason into the message; ctest leaves GTEST_SKIP's text in the test's output."""
    output = case.findtext("system-out") or ""
    said = re.search(r": Skipped\n(.*?)\n\s*(?:\n|\[)", output, re.DOTALL)
    if said:
        return " ".join(said.group(1).split())
    return (skipped.get("message") or "no reason given").strip()


def read_layer(folder, layer):
    """Returns the numbers of passed and failed tests and a Counter of reasons for skips."""
    report = folder / f"{layer}.xml"
    status = int((folder / f"{layer}.exit").read_text())
    passed, failed, reasons = 0, 0, Counter()
    if report.is_file():
        for case in ElementTree.parse(report).getroot().iter("testcase"):
            skipped = case.find("skipped")
            if case.find("failure") is not None or case.find("error") is not None:
                failed += 1
                print(f"failed: {layer}: {case.get('classname')} {case.get('name')}")
            elif skipped is not None:
                reasons[skip_reason(case, skipped)] += 1
            else:
                passed += 1
    else:
        print(f"failed: {layer}: no report was written")
        status = status or 1
    if status != 0 and failed == 0:
        print(f"failed: {layer}: ended with status {status}")
        failed = 1
    return passed, failed, reasons


def read_times(folder, layers):
    """Returns (seconds, layer, test) of all tests, slowest first."""
    times = []
    for layer in layers:
        report = folder / f"{layer}.xml"
        cases = ElementTree.parse(report).getroot().iter("testcase") if report.is_file() else ()
        for case in cases:
            names = dict.fromkeys((case.get("classname"), case.get("name")))
            times.append((float(case.get("time") or 0.0), layer, " ".join(filter(None, names))))
    return sorted(times, reverse=True)


def write_times(folder, layers):
    """Writes times.txt and prints the ten slowest tests."""
    times = read_times(folder, layers)
    lines = [f"{seconds:8.1f} s  {layer}: {test}" for seconds, layer, test in times]
    wholes = [f"{(folder / f'{layer}.seconds').read_text().strip():>8} s  {layer}" for layer in layers]
    (folder / "times.txt").write_text("\n".join([*wholes, *lines]) + "\n")
    print("\n".join(["slowest tests:", *lines[:10]]))


def main(folder, layers):
    passed = failed = skipped = 0
    write_times(Path(folder), layers)
    for layer in layers:
        layer_passed, layer_failed, reasons = read_layer(Path(folder), layer)
        for reason, count in sorted(reasons.items()):
            print(f"skipped: {layer}: {count} x {reason}")
        passed += layer_passed
        failed += layer_failed
        skipped += sum(reasons.values())
    print(f"{passed} passed, {failed} failed, {skipped} skipped")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2:]))
