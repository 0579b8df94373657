# SPDX-License-Identifier: GPL-3.0-or-later
"""The absolute folder that a text in the panel or on the command line means. No ``bpy``.

In the panel, ``//`` is the folder of the .blend, as everywhere in Blender. On the command line, a path is the system's.
"""

import os
from pathlib import Path


def from_panel(text, blend):
    """The absolute folder of a text in Blender's notation. blend: path of the file, empty if it was never saved. Raises
    ValueError with what to write instead."""
    if not text.strip():
        raise ValueError("The cache folder is empty: choose one in the Snowbough panel")
    if not text.startswith("//"):
        path = _of_system(text)
        if not os.path.isabs(path):
            raise ValueError(
                f"The cache folder '{text}' is not absolute: write //{text} for a folder beside the .blend"
            )
        return Path(path).resolve()
    beside = text[2:].replace("\\", "/").lstrip("/")
    if _is_share(beside, blend):
        return Path(text)
    if not blend:
        raise ValueError(
            "Save the .blend first: its cache lies beside it. Or choose an absolute cache folder in the panel"
        )
    return (Path(blend).parent / beside).resolve()


def from_command_line(text):
    """The absolute folder of a path of the system. Raises ValueError with what to write instead."""
    if not text.strip():
        raise ValueError("The cache folder is empty: write --cache with a folder")
    path = _of_system(text)
    if os.name == "posix" and path.startswith("//"):
        path = path[1:]  # pathlib keeps two slashes
    return Path(path).resolve()


def _of_system(text):
    """The text with the home folder in place of ~."""
    path = os.path.expanduser(text)
    if path.startswith("~"):
        raise ValueError(f"The cache folder '{text}' names no user of this computer: write an absolute path")
    if os.name == "posix" and path.startswith("\\\\"):
        raise ValueError(
            f"The cache folder '{text}' is a share of Windows: write the folder where this computer has it mounted"
        )
    return path


def _is_share(beside, blend):
    """Whether ``//SERVER/share/...`` is a share that Windows reaches, and not a folder beside the .blend."""
    server, _, rest = beside.partition("/")
    if os.name != "nt" or not rest or blend and (Path(blend).parent / server).exists():
        return False
    return os.path.isdir(f"//{server}/{rest.partition('/')[0]}")
