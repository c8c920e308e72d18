"""Cases: from a file, from text, or from a dict of the keys that case files have."""

from __future__ import annotations

import json
import math
import os
import re
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from . import _vbond


def _place(path: str, key: str | int) -> str:
    if isinstance(key, int):
        return f"{path}[{key}]"
    return f"{path}.{key}" if path else key


def _check(value: bool | int | float | str, path: str) -> None:
    if isinstance(value, int) and not -(2**63) <= value < 2**63:
        raise ValueError(f"{path}: {value} has more than the 64 bits of a whole number; write it as a float")
    if isinstance(value, str) and any("\ud800" <= c <= "\udfff" for c in value):
        raise ValueError(f"{path}: {value!r} has half a character (a lone surrogate), which no file can hold")


def _plain(value: Any, path: str) -> Any:
    """The value as TOML can say it: numpy's numbers and arrays, tuples and paths become plain ones."""
    if hasattr(value, "tolist"):  # arrays and scalars of numpy
        value = value.tolist()
    if isinstance(value, os.PathLike):
        value = os.fspath(value)
    if isinstance(value, Mapping):
        for key in value:
            if not isinstance(key, str):
                raise TypeError(f"{path or 'case'}: keys are texts, not {key!r}")
            _check(key, path or "case")
        return {key: _plain(item, _place(path, key)) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item, _place(path, k)) for k, item in enumerate(value)]
    if isinstance(value, (bool, int, float, str)):
        _check(value, path)
        return value
    hint = "; leave the key out" if value is None else ""
    kind = type(value).__name__
    raise TypeError(f"{path}: {kind} has no place in a case: numbers, texts, lists and dicts have{hint}")


def _quoted(text: str) -> str:
    """As a string of TOML, which unlike JSON has no pairs of surrogates and no bare delete."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _toml(value: Any) -> str:
    """A plain value as it stands behind = in TOML, on one line."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        if math.isnan(value):
            return "nan"
        return repr(value) if math.isfinite(value) else "inf" if value > 0 else "-inf"
    if isinstance(value, int):
        return repr(value)
    if isinstance(value, str):
        return _quoted(value)
    if isinstance(value, list):
        return "[" + ", ".join(map(_toml, value)) + "]"
    return "{" + ", ".join(f"{_quoted(key)} = {_toml(item)}" for key, item in value.items()) + "}"


def _change(key: str, value: Any) -> str:
    if not isinstance(key, str):
        raise TypeError(f"changes: a key is a text such as 'bonds[0].E', not {key!r}")
    if "=" in key:
        raise ValueError(f"changes: {key!r}: a key has no =, the value stands apart: {{'bonds[0].E': 1e9}}")
    return f"{key}={_toml(_plain(value, key))}"


def _put(keys: dict[str, Any], path: str, value: Any) -> None:
    """As --set does it, which has checked the path: tables that are not there are made, items of lists are there."""
    *before, last = re.findall(r"[^.\[\]]+", path)
    at: Any = keys
    for name in before:
        at = at[_item(at, name)] if isinstance(at, list) else at.setdefault(name, {})
    at[_item(at, last) if isinstance(at, list) else last] = value


def _item(items: list, name: str) -> int:
    """By its name, else by its place."""
    named = [k for k, item in enumerate(items) if isinstance(item, dict) and item.get("name") == name]
    return named[0] if named else int(name)


def _from_folder(value: Any, folder: Path) -> Any:
    """The same with the whole paths of the files that it names."""
    if isinstance(value, list):
        return [_from_folder(item, folder) for item in value]
    if not isinstance(value, dict):
        return value
    return {key: str(folder.absolute() / item) if key in ("file", "bonds_file") and isinstance(item, str)
            else _from_folder(item, folder) for key, item in value.items()}


def _lines(keys: Mapping[str, Any]) -> str:
    return "".join(f"{_quoted(key)} = {_toml(value)}\n" for key, value in keys.items())


class Case:
    """A case: what is computed, every key checked. It never changes; `changed` and `with_stages` make others.

    Mistakes are a CaseError with all of them at once, in the words of the program.
    """

    def __init__(self, text: str, file: Path, changes: Mapping[str, Any] | None = None, *, places: bool = True):
        """Use from_file, from_text or from_dict."""
        self._text = text
        self._file = file
        self._changes = dict(changes or {})
        self._places = places  # whether line and column mean something to the reader
        self._checked = _vbond.parse_case(text, file, [_change(k, v) for k, v in self._changes.items()], places)

    @classmethod
    def from_file(cls, file: str | os.PathLike, changes: Mapping[str, Any] | None = None) -> Case:
        """Reads a case file. changes: other values of keys, as {"bonds[0].E": 1e9, "stage[push].duration": "2 T0"};
        an item of a list is meant by its place from 0 or by its name. Throws IoError if it cannot be read."""
        path = Path(file)
        try:
            text = path.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as e:
            raise _vbond.IoError(f"{path}: cannot be read: {e}") from None
        return cls(text, path, changes)

    @classmethod
    def from_text(cls, text: str, folder: str | os.PathLike = ".", changes: Mapping[str, Any] | None = None) -> Case:
        """A case file's text; files that it names are looked for in `folder`."""
        return cls(text, Path(folder) / "text", changes)

    @classmethod
    def from_dict(cls, keys: Mapping[str, Any], folder: str | os.PathLike = ".") -> Case:
        """The keys of a case file as dicts and lists: {"specimen": [{"kind": "rod", ...}], "bonds": [...], ...}.
        Arrays and numbers of numpy may stand for lists and numbers. See docs/case-reference.md for the keys."""
        try:
            plain = _plain(keys, "")
        except RecursionError:
            raise ValueError("the dict of a case is nested too deep, or stands in itself") from None
        if not isinstance(plain, dict):
            raise TypeError(f"a case is a dict of its keys, not {type(keys).__name__}")
        return cls(_lines(plain), Path(folder) / "dict", places=False)

    @property
    def title(self) -> str:
        return self._checked.title

    @property
    def keys(self) -> dict[str, Any]:
        """The keys as they were given, without changes and defaults: a new dict at each call."""
        return tomllib.loads(self._text)

    @property
    def text(self) -> str:
        """The case with all defaults written out, as in resolved.toml: from_text gives the same run bit for bit."""
        return self._checked.to_toml()

    def changed(self, changes: Mapping[str, Any]) -> Case:
        """The same with other values of these keys, see from_file."""
        before = {key: value for key, value in self._changes.items() if key not in changes}  # the last one wins
        return Case(self._text, self._file, {**before, **changes}, places=self._places)

    def with_stages(self, stages: Sequence[Mapping[str, Any]]) -> Case:
        """The same body with these stages in place of its own, each a dict of keys."""
        return Case.from_dict({**self._given(), "stage": list(stages)}, self._file.parent)

    def _given(self) -> dict[str, Any]:
        """The keys as they were given, with the changes: values that follow from others are not among them."""
        keys = tomllib.loads(self._text)
        for key, value in self._changes.items():
            _put(keys, key, _plain(value, key))
        return _from_folder(keys, self._file.parent)

    def _to_vary(self) -> str:
        """A case file that says the same, for other values of its keys: not `text`, in which defaults stand that follow
        from them. The text as it was given, if that is one."""
        given = self._given()
        return self._text if given == tomllib.loads(self._text) else _lines(given)

    def __repr__(self) -> str:
        return f"<vbond.Case: {self.title or 'without a title'}>"


def list_keys() -> list[dict[str, str]]:
    """All keys of case files: path, type, default, meaning, and the choice that each belongs to (condition)."""
    return _vbond.list_keys()


def calibrate(E: float | str, length: float | str, *, theory: str = "all", **given: float | str) -> dict[str, dict]:
    """Stiffnesses of a bond and coefficients of the laws from material and section, as `vbond calibrate`: by theory
    c_A, c_D, c_B, c_T, and a dict of coefficients for each law ("v-model", "evm"). Theories that cannot say are left
    out.

    given: nu (0.2), a section (diameter, with inner_diameter; side; or A, J and J_p), kappa; or, for theory "shell", a
    thickness instead of both. Values are numbers, or texts with units such as "2 GPa". theory: "bernoulli-euler",
    "timoshenko", "short-cylinder", "shell" or "all"."""
    known = ("nu", "diameter", "inner_diameter", "side", "A", "J", "J_p", "kappa", "thickness")
    for name in given:
        if name not in known:
            raise TypeError(f"calibrate: there is no {name!r}; there are {', '.join(known)}")
    if theory not in (theories := ("bernoulli-euler", "timoshenko", "short-cylinder", "shell", "all")):
        raise ValueError(f"calibrate: theory {theory!r} is none of {', '.join(theories)}")
    options = {"E": E, "length": length, "theory": theory, **given}
    return _vbond.calibrate({name: str(value) for name, value in options.items()})
