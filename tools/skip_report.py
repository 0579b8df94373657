#!/usr/bin/env python3
"""Writes a JUnit report with one skipped test, for a layer that this machine cannot run.

skip_report.py REPORT NAME REASON
"""

import sys
import xml.etree.ElementTree as ElementTree


def write_skip(report, name, reason):
    suite = ElementTree.Element("testsuite", name=name, tests="1", skipped="1")
    case = ElementTree.SubElement(suite, "testcase", classname=name, name="all")
    ElementTree.SubElement(case, "skipped", message=reason)
    ElementTree.ElementTree(suite).write(report, encoding="unicode", xml_declaration=True)


if __name__ == "__main__":
    write_skip(*sys.argv[1:])
