# SPDX-License-Identifier: GPL-3.0-or-later
"""The engine and driver of a bake, as shown in logs, checkpoints and the check. No ``bpy``."""

from ..cache.errors import InputsChanged
from .request import NoGpu


def driver_text(engine):
    """Everything that affects the last bit of a map: ``CPU, processor, x86-64``. engine: the dict in native.Engine's
    info or SnowSimulation's engine."""
    return f"{engine['name']}, {engine['driver']}"


def engine_info(engine, mapping):
    """The info of a native.Engine for that mapping. Raises NoGpu, saying what to do, if it needs OpenGL and there is
    none."""
    try:
        return engine.info
    except RuntimeError as error:
        instead = "engine CPU, which needs none" if mapping == "COMPUTE" else "mapping COMPUTE"
        raise NoGpu(
            f"Engine GL needs OpenGL, which is unavailable here: {error}. Or choose {instead}"
        ) from error


def probe_engine(native, wanted, mapping):
    """engine_info of the engine that a bake would use. Raises NoGpu, and ValueError for a mapping that the engine does
    not support."""
    with native.Engine(engine=wanted, mapping=mapping) as engine:
        return engine_info(engine, mapping)


def other_engine(before, now):
    """The error for a checkpoint of another engine or driver. before, now: as from driver_text."""
    return InputsChanged(
        f"The checkpoint was made with another engine or driver ({before}; this is {now}), so the maps would differ by "
        "rounding: resume on that machine, choose that engine, or allow another driver"
    )
