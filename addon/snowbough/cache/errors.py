# SPDX-License-Identifier: GPL-3.0-or-later
"""What may be wrong with a cache. No ``bpy``."""


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
