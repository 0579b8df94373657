# SPDX-License-Identifier: GPL-3.0-or-later
"""What may be wrong with a cache. No ``bpy``."""

import errno
import os

# What the system says -> what to do about it. The native module has the system's own words too.
_REMEDIES = (
    ((errno.ENOSPC, errno.EDQUOT), "What is done is kept: make room, then resume"),
    (
        (errno.ENOENT, errno.ENOTDIR, errno.ESTALE),
        "The folder is gone: put it back and resume, or bake again",
    ),
    ((errno.EACCES, errno.EPERM, errno.EROFS), "What is done is kept: allow writing there, then resume"),
)


def remedy_for(error):
    """What to do about a file that could not be written, as a sentence."""
    for codes, remedy in _REMEDIES:
        if any(os.strerror(code) in str(error) for code in codes):
            return remedy
    return "What is done is kept: see to the disk, then resume"


class CacheError(RuntimeError):
    """The cache cannot be written or read; says where and why."""


class CacheBusy(CacheError):
    """Another bake holds the lock."""


class LockLost(CacheError):
    """The lock of a running bake was removed or replaced; it writes nothing more."""


class CacheFinished(CacheError):
    """The receiver is finished in this version; nothing may write there."""


class NoCheckpoint(CacheError):
    """A bake was to start in the middle, and the checkpoint before it is not there."""


class InputsChanged(CacheError):
    """The bake's settings or scene are not those that the cache was baked from; says what changed."""
