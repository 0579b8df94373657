# SPDX-License-Identifier: GPL-3.0-or-later
"""Names within Blender's limits: at most 63 bytes of UTF-8, unique, the same for the same input."""

NAME_BYTES = 63


def clip_utf8(text, size):
    """The longest start of `text` with at most `size` bytes and without broken characters."""
    return text.encode("utf-8")[: max(size, 0)].decode("utf-8", errors="ignore")


def fitting_names(names, size=NAME_BYTES):
    """Shortens names longer than `size` bytes; returns a list as long as `names`, without repetitions.

    The part after the last dot (a bone's segment number) stays, and the branch's name before it is clipped. If two
    names become equal, a counter `~n` is inserted.
    """
    whole = {name for name in names if len(name.encode("utf-8")) <= size}
    seen = set()
    result = []
    for name in names:
        candidate = name
        if len(name.encode("utf-8")) > size or name in seen:
            stem, dot, tail = name.rpartition(".")
            if not dot:
                stem, tail = name, ""
            suffix = dot + clip_utf8(tail, size // 2)
            candidate = clip_utf8(stem, size - len(suffix.encode("utf-8"))) + suffix
            count = 1
            while candidate in whole or candidate in seen:
                count += 1
                mark = f"~{count}{suffix}"
                candidate = clip_utf8(stem, size - len(mark.encode("utf-8"))) + mark
        seen.add(candidate)
        result.append(candidate)
    return result
