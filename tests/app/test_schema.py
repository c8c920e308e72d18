"""The JSON Schema of case files: every case of the project fits it, and no longer does with a key, word or number that is
wrong. Skipped where Python has no jsonschema; Debian: apt-get install python3-jsonschema."""
import copy
import json

import pytest
from program import ROOT, vbond

jsonschema, tomllib = (pytest.importorskip(name) for name in ("jsonschema", "tomllib"))
CASES = [path for folder in ("examples", "bench/cases", "tests/fuzz/corpus") for path in sorted((ROOT / folder).glob("*.toml"))]


@pytest.fixture(scope="module")
def validators(work):
    schema = json.loads(vbond("schema").out)
    assert schema["$schema"] == "http://json-schema.org/draft-07/schema#"
    drafts = [jsonschema.Draft7Validator, jsonschema.Draft4Validator]  # what some editors read, with the same meaning
    for draft in drafts:
        draft.check_schema(schema)
    return [draft(schema) for draft in drafts]


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_fits_and_mistakes_do_not(validators, path):
    case = tomllib.loads(path.read_text())
    for validator in validators:
        assert not [f"{list(error.path)}: {error.message}" for error in validator.iter_errors(case)]
    edits = {
        "a wrong table": lambda c: c.update(stages=[]),
        "a wrong key": lambda c: c["specimen"][0].update(colour=1),
        "a wrong word": lambda c: c["stage"][0].update(kind="dynamic"),
        "a list that is too short": lambda c: c["stage"][0].update(gravity=[0, 1]),
        "a number out of range": lambda c: c["specimen"][0].update(radius=-1),
        "an open bound": lambda c: c.setdefault("time", {}).update(fraction=0),
        "a key is missing": lambda c: c["specimen"][0].pop("kind"),
        "a table is missing": lambda c: c.pop("stage")}
    if case.get("bonds"):
        edits["two of a choice"] = lambda c: c["bonds"][0].update(distance=1.0, pairs=[[0, 1]])
    for name, edit in edits.items():
        other = copy.deepcopy(case)
        edit(other)
        mistakes = {len(list(validator.iter_errors(other))) for validator in validators}
        assert len(mistakes) == 1, f"{name}: drafts 4 and 7 differ: {mistakes}"
        assert mistakes.pop() > 0, f"fits with {name}"


def test_there_are_cases():
    assert len(CASES) > 40
