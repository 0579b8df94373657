"""Each header that another room includes compiles alone. Most are the first include of the source beside them, which
the preset `dev` compiles by itself; the others are compiled here."""

import shutil
import subprocess
from concurrent.futures import ThreadPoolExecutor

import pytest
import test_rooms

ROOT = test_rooms.ROOT
SOURCES = sorted((ROOT / "native").rglob("*.cpp"))


def public_headers():
    """Those of native/python need the headers of Python, and have one user."""
    arrows = [arrow for arrow in test_rooms.includes(ROOT) if arrow.file.parent != arrow.target.parent]
    return sorted({arrow.target for arrow in arrows if "python" not in arrow.target.parts})


def test_a_source_includes_its_own_header_first():
    for source in SOURCES:
        own = source.with_suffix(".h")
        if own.exists():
            first = next(line for line in source.read_text().splitlines() if line.startswith("#include"))
            assert own.name in first, f"{source.relative_to(ROOT)}: {first}"


@pytest.mark.skipif(not shutil.which("g++"), reason="g++ is not installed")
def test_headers_without_a_source_compile_alone():
    headers = [path for path in public_headers() if not (ROOT / path).with_suffix(".cpp").exists()]
    assert len(headers) > 20

    def complaints(header):
        command = ["g++", "-std=c++20", "-fsyntax-only", "-w", "-Inative", "-I.", "-x", "c++", header]
        return subprocess.run(command, cwd=ROOT, capture_output=True, text=True).stderr

    with ThreadPoolExecutor(2) as pool:
        assert [text for text in pool.map(complaints, headers) if text] == []
