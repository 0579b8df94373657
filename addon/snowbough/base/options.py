# SPDX-License-Identifier: GPL-3.0-or-later
"""Options of operators, declared once as Blender properties in a mix-in. A dataclass of plain values (options_class)
and the arguments of a command line (add_options) are made from it.
"""

import argparse
from dataclasses import fields, make_dataclass

from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

_TYPES = {FloatProperty: float, IntProperty: int}


def declared(properties):
    """[(name, type of property, its keyword arguments)] of the options of a mix-in, in order."""
    return [(name, option.function, option.keywords) for name, option in properties.__annotations__.items()]


def options_class(name, properties):
    """A dataclass whose fields are the options of the mix-in, with their defaults."""
    options = []
    for option, kind, keywords in declared(properties):
        default = keywords.get("default", "" if kind is StringProperty else 0)
        options.append((option, type(default), default))
    made = make_dataclass(name, options)
    made.__doc__ = "The values of the properties with the same names."
    return made


def options_of(made, source):
    """The options that `source`, an operator or an object with the same attributes, holds. made: an options_class."""
    return made(**{option.name: getattr(source, option.name) for option in fields(made)})


def add_options(parser, properties, flags=None):
    """Adds the options of a mix-in to an argparse parser. flags: {name: flag} of options with another flag."""
    for name, kind, keywords in declared(properties):
        flag = (flags or {}).get(name, "--" + name.replace("_", "-"))
        parser.add_argument(flag, dest=name, **_argument(kind, keywords))


def _argument(kind, keywords):
    """The argparse settings for a property."""
    text = keywords["description"].replace("%", "%%")
    default = keywords.get("default", "")
    if kind is BoolProperty:
        return (
            {"action": "store_false", "help": f"turn off: {text}"}
            if default
            else {"action": "store_true", "help": text}
        )
    if kind is EnumProperty:
        return {"default": default, "help": text, "choices": [item[0] for item in keywords["items"]]}
    if kind is StringProperty:
        return {"default": default, "help": text, "metavar": "NAMES"}
    return {"default": default, "help": text, "metavar": "N", "type": _within(_TYPES[kind], keywords)}


def _within(number, keywords):
    """A converter from text to a number within the limits of the property."""
    least, most = keywords.get("min", float("-inf")), keywords.get("max", float("inf"))

    def convert(text):
        value = number(text)
        if not least <= value <= most:
            raise argparse.ArgumentTypeError(f"{text} is not from {least} to {most}")
        return value

    convert.__name__ = number.__name__  # argparse shows it in its error message
    return convert
