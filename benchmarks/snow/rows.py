# SPDX-License-Identifier: GPL-3.0-or-later
"""The table that acceptance.py prints: item, required, measured, holds."""

ROWS = []


def row(item, asked, measured, holds):
    """Prints a row at once and keeps it for the summary."""
    ROWS.append({"item": item, "asked": asked, "measured": measured, "holds": bool(holds)})
    print(f"{item:<52} {asked:<26} {measured:<46} {'yes' if holds else 'NO'}", flush=True)
