# SPDX-License-Identifier: GPL-3.0-or-later
"""What a receiver was like before snow was added to it, kept as JSON in its property ``restore``.

Materials are named, not pointed to: names are what survives undo, save and load. Originals get a fake
user while copies stand in for them, so that saving the file does not lose them.
"""

import json


def read(receiver):
    """The record of a receiver: a dictionary, empty where nothing was changed."""
    return json.loads(receiver.restore) if receiver.restore else {}


def write(receiver, record):
    """Stores the record; an empty one is stored as no text."""
    receiver.restore = json.dumps(record, sort_keys=True) if record else ""
