# SPDX-License-Identifier: GPL-3.0-or-later
"""Options that a mix-in of operators declares once, as Blender's properties: what else has them is made from it, a
dataclass of plain values (options_class) and the arguments of a command line (add_options).
"""

import argparse
from dataclasses import fields, make_dataclass

from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

_TYPES = {FloatProperty: float, IntProperty: int}


def declared(properties):
    """[(name, kind of property, what it was declared with: a dict)] of every option of a mix-in, in their order."""
    return [(name, option.function, option.keywords) for name, option in properties.__annotations__.items()]


def options_class(name, properties):
    """A dataclass with the mix-in's options as fields, under their names and with their defaults."""
    options = []
    for option, kind, keywords in declared(properties):
        default = keywords.get("default", "" if kind is StringProperty else 0)
        options.append((option, type(default), default))
    made = make_dataclass(name, options)
    made.__doc__ = "What the properties of the same names say."
    return made


def options_of(made, source):
    """The options that an operator, or another object with all of them as attributes, holds. made: an
    options_class."""
    return made(**{option.name: getattr(source, option.name) for option in fields(made)})


def add_options(parser, properties, flags=None):
    """Adds each option of a mix-in to an argparse parser, as it was declared. flags: those whose names on the
    command line are not their own."""
    for name, kind, keywords in declared(properties):
        flag = (flags or {}).get(name, "--" + name.replace("_", "-"))
        parser.add_argument(flag, dest=name, **_argument(kind, keywords))


def _argument(kind, keywords):
    """What argparse takes for a property."""
    text = keywords["description"].replace("%", "%%")
    default = keywords.get("default", "")
    if kind is BoolProperty:
        return (
            {"action": "store_false", "help": f"not: {text}"}
            if default
            else {"action": "store_true", "help": text}
        )
    if kind is EnumProperty:
        return {"default": default, "help": text, "choices": [item[0] for item in keywords["items"]]}
    if kind is StringProperty:
        return {"default": default, "help": text, "metavar": "NAMES"}
    return {"default": default, "help": text, "metavar": "N", "type": _within(_TYPES[kind], keywords)}


def _within(number, keywords):
    """A converter of texts into numbers of that type, inside the limits that the property was declared with."""
    least, most = keywords.get("min", float("-inf")), keywords.get("max", float("inf"))

    def convert(text):
        value = number(text)
        if not least <= value <= most:
            raise argparse.ArgumentTypeError(f"{text} is not from {least} to {most}")
        return value

    convert.__name__ = number.__name__  # argparse names it for what is no number at all
    return convert
