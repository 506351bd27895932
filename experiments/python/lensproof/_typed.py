"""JSON as typed, frozen objects."""
import dataclasses
import typing

import numpy as np

from ._command import parsed


def _column(values):
    """A list of a JSON's as an array: null is NaN, also in the place of a list of numbers."""
    widths = {len(value) for value in values if isinstance(value, list)}
    if len(widths) == 1:
        width = widths.pop()
        values = [[np.nan] * width if value is None else value for value in values]
    if any(isinstance(value, str) for value in values):
        return np.array(["" if value is None else value for value in values])
    if values and all(isinstance(value, bool) for value in values):
        return np.array(values)
    return np.array(values, dtype=float)


def typed(kind, data):
    """`data` as `kind`: a dataclass, an array, a number, a text, or tuples, dicts and optional ones of these."""
    arguments = typing.get_args(kind)
    if arguments and type(None) in arguments:
        return None if data is None else typed(arguments[0], data)
    origin = typing.get_origin(kind)
    if origin is tuple:
        return tuple(typed(arguments[0], one) for one in data or ())
    if origin is dict:
        return {key: typed(arguments[1], one) for key, one in (data or {}).items()}
    if kind is float:
        return float("nan") if data is None else float(data)
    if kind is np.ndarray:
        return _column(data if data is not None else [])
    if dataclasses.is_dataclass(kind):
        return kind(**members(kind, data))
    return data


def members(kind, data):
    """The fields of the dataclass `kind` from a JSON object, or each a column of a list of objects."""
    hints = {name: hint for name, hint in typing.get_type_hints(kind).items() if name in kind.__dataclass_fields__}
    if isinstance(data, list):
        return {name: _column([row.get(name) for row in data]) for name in hints}
    data = data or {}
    return {name: typed(hint, data.get(name)) for name, hint in hints.items() if name not in ("json", "status")}


@dataclasses.dataclass(frozen=True)
class Result:
    """What a command found. `json`: the very bytes that the command line writes with `--json`; `status`: its exit
    status, 1 where a check or a threshold does not hold."""

    json: bytes = dataclasses.field(repr=False)
    status: int

    @classmethod
    def of(cls, outcome):
        status, json = outcome
        return cls(json=json, status=status, **members(cls, parsed(json)))

    @property
    def ok(self):
        """Whether every check and threshold held."""
        return self.status == 0

    def to_dict(self):
        """All that the command found, as the contract has it."""
        return parsed(self.json)
