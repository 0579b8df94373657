# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks every module in build/<system>/modules, for tools/check_packages.sh: it must link only libraries of the
system. On Linux and macOS it must export only its init function, and on macOS leave only Python's names open, be for
arm64, and be signed."""

import re
import subprocess
import sys
from pathlib import Path

from elftools.elf.elffile import ELFFile
from macholib.mach_o import LC_CODE_SIGNATURE
from macholib.MachO import MachO
from macholib.SymbolTable import SymbolTable

ROOT = Path(__file__).resolve().parent.parent

# libgcc_s unwinds the stacks of terminated threads, see cmake/Bundled.cmake.
LINUX = {"libc.so.6", "libm.so.6", "libdl.so.2", "libpthread.so.0", "ld-linux-x86-64.so.2", "libgcc_s.so.1"}
WINDOWS = {"kernel32.dll", "ntdll.dll", "opengl32.dll", "gdi32.dll", "user32.dll", "advapi32.dll", "python"}
MACOS = {"/usr/lib/libSystem.B.dylib"}
CPU_TYPE_ARM64 = 0x0100000C
# Names that the linker adds, and the operators new and delete of libc++, which programs may replace.
MACOS_LINKER = re.compile(r"___dso_handle|__mh_dylib_header|__Z(nw|na|dl|da)\w+")
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
        # The linker accepts undefined symbols, which the system's libraries and Python have. None of them is C++.
        missing = {
            f"missing {symbol.name}"
            for symbol in elf.get_section_by_name(".dynsym").iter_symbols()
            if symbol["st_shndx"] == "SHN_UNDEF" and symbol.name.startswith("_Z")
        }
    names = {name for name in shown if not name.startswith("PyInit_snowbough_native_")}
    return needed - LINUX, names | missing


def windows_module(path):
    listed = subprocess.run(["objdump", "-p", str(path)], check=True, capture_output=True, text=True).stdout
    needed = {line.split()[-1].lower() for line in listed.splitlines() if "DLL Name:" in line}
    foreign = {
        name for name in needed if name not in WINDOWS and not name.startswith((*WINDOWS_C, "python3"))
    }
    return foreign, set()


def macos_module(path):
    module = MachO(str(path))
    header = module.headers[0]
    foreign = {name for _, _, name in header.walkRelocatables()} - MACOS
    symbols = SymbolTable(module, header)
    shown = {name.decode() for _, name in symbols.extdefsyms}
    shown = {name for name in shown if not MACOS_LINKER.fullmatch(name)}
    names = {name for name in shown if not name.startswith("_PyInit_snowbough_native_")}
    # The high byte of n_desc is the number of the library that has the name; others are looked up in the whole process.
    loose = {name.decode() for entry, name in symbols.undefsyms if not 0 < entry.n_desc >> 8 < 0xFD}
    names |= {f"missing {name}" for name in loose if not name.startswith(("_Py", "__Py"))}
    if header.header.cputype != CPU_TYPE_ARM64:
        names.add("not for arm64")
    if not any(command.cmd == LC_CODE_SIGNATURE for command, _, _ in header.commands):
        names.add("not signed")
    return foreign, names


def main():
    failed = False
    checks = (("linux", linux_module), ("windows", windows_module), ("macos", macos_module))
    for system, check in checks:
        for path in sorted((ROOT / "build" / system / "modules").glob("snowbough_native_*.*")):
            libraries, symbols = check(path)
            print(
                f"{path.name}: {path.stat().st_size:,} bytes, {libraries or 'no'} foreign libraries, "
                f"{sorted(symbols) or 'no'} visible symbols or faults"
            )
            failed |= bool(libraries or symbols)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
