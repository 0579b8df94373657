# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks every module in build/<system>/modules, for tools/check_packages.sh: it must link only libraries of the
system, and on Linux export only its init function."""

import subprocess
import sys
from pathlib import Path

from elftools.elf.elffile import ELFFile

ROOT = Path(__file__).resolve().parent.parent

# libgcc_s unwinds the stacks of terminated threads, see cmake/Bundled.cmake.
LINUX = {"libc.so.6", "libm.so.6", "libdl.so.2", "libpthread.so.0", "ld-linux-x86-64.so.2", "libgcc_s.so.1"}
WINDOWS = {"kernel32.dll", "ntdll.dll", "opengl32.dll", "gdi32.dll", "user32.dll", "advapi32.dll", "python"}
# Prefixes of the C library's files in Windows 10.
WINDOWS_C = ("api-ms-win-crt-", "ucrtbase", "msvcrt.dll")


def linux_module(path):
    with path.open("rb") as stream:
        elf = ELFFile(stream)
        needed = {tag.needed for tag in elf.get_section_by_name(".dynamic").iter_tags("DT_NEEDED")}
        shown = {
            symbol.name
            for symbol in elf.get_section_by_name(".dynsym").iter_symbols()
            if symbol["st_shndx"] != "SHN_UNDEF" and symbol["st_info"]["bind"] != "STB_LOCAL"
        }
    return needed - LINUX, {name for name in shown if not name.startswith("PyInit_snowbough_native_")}


def windows_module(path):
    listed = subprocess.run(["objdump", "-p", str(path)], check=True, capture_output=True, text=True).stdout
    needed = {line.split()[-1].lower() for line in listed.splitlines() if "DLL Name:" in line}
    foreign = {
        name for name in needed if name not in WINDOWS and not name.startswith((*WINDOWS_C, "python3"))
    }
    return foreign, set()


def main():
    failed = False
    for system, check in (("linux", linux_module), ("windows", windows_module)):
        for path in sorted((ROOT / "build" / system / "modules").glob("snowbough_native_*.*")):
            libraries, symbols = check(path)
            print(
                f"{path.name}: {path.stat().st_size:,} bytes, {libraries or 'no'} foreign libraries, "
                f"{len(symbols)} visible symbols"
            )
            failed |= bool(libraries or symbols)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
