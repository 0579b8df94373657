# SPDX-License-Identifier: GPL-3.0-or-later
"""The state of a receiver before snow was added to it, stored as JSON in its property ``restore``.

Materials are stored by name, which survives undo, saving and loading. Originals get a fake user while copies replace
them, so that saving the file does not lose them.
"""

import json


def read(receiver):
    """The record of a receiver, a dict; empty if nothing was changed."""
    return json.loads(receiver.restore) if receiver.restore else {}


def write(receiver, record):
    """Stores the record; an empty one as an empty text."""
    receiver.restore = json.dumps(record, sort_keys=True) if record else ""
