# SPDX-License-Identifier: MIT
# mypy: ignore-errors
"""Exceptions of the module."""

from ._palpate import Error, InputError

Error.__doc__ = """An error in one line. `place`, `reason` and `remedy` are its parts; `remedy` may be ""."""
InputError.__doc__ = """An Error due to an argument, a config or a file; also a ValueError. A failed run is an Error only."""


def make_error(place, reason, remedy, kind=InputError):
    error = kind(f"{place}: {reason}" + (f", {remedy}" if remedy else ""))
    error.place, error.reason, error.remedy = place, reason, remedy
    return error
