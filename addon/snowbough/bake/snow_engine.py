# SPDX-License-Identifier: GPL-3.0-or-later
"""Which engine and driver compute a bake's snow, as log, checkpoints and the check before it say. No ``bpy``."""

from ..cache.errors import InputsChanged
from .request import NoGpu


def driver_text(engine):
    """What decides about the last bit of a map: ``CPU, processor, x86-64``. engine: the dict that native.Engine's
    info and SnowSimulation's engine are."""
    return f"{engine['name']}, {engine['driver']}"


def engine_info(engine, mapping):
    """The info of a native.Engine made for that mapping. Raises NoGpu, saying what to do, where it needs OpenGL
    and there is none."""
    try:
        return engine.info
    except RuntimeError as error:
        instead = "mapping COMPUTE" if mapping == "GEOMETRY" else "engine CPU, which needs none"
        raise NoGpu(
            f"Engine GL computes snow with OpenGL, which is not to be had here: {error}. Or choose {instead}"
        ) from error


def probe_engine(native, wanted, mapping):
    """engine_info of the engine that a bake would have. Raises NoGpu, and ValueError for a mapping that the
    wanted engine does not have."""
    with native.Engine(engine=wanted, mapping=mapping) as engine:
        return engine_info(engine, mapping)


def other_engine(before, now):
    """The error of a bake that another engine or driver began: both as driver_text says them."""
    return InputsChanged(
        f"The checkpoint was made with another engine or driver ({before}; this is {now}), so the bake would not "
        "end with the same bytes: resume there, choose that engine, or allow another driver"
    )
