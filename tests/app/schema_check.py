"""schema_check.py SCHEMA CASE...: every case fits the schema, and no longer does with a key, word or number that is wrong.
Exit status 77 if Python has no jsonschema or no TOML reader."""
import copy
import json
import sys

try:
    import tomllib
    from jsonschema import Draft4Validator, Draft7Validator
except ImportError:
    sys.exit(77)

with open(sys.argv[1], encoding="utf-8") as f:
    schema = json.load(f)
assert schema["$schema"] == "http://json-schema.org/draft-07/schema#", schema["$schema"]
Draft7Validator.check_schema(schema)
Draft4Validator.check_schema(schema)  # what some editors read, with the same meaning
validators = [Draft7Validator(schema), Draft4Validator(schema)]


def mistakes(case):
    counts = {len(list(v.iter_errors(case))) for v in validators}
    assert len(counts) == 1, f"drafts 4 and 7 differ: {counts}"
    return counts.pop()


for path in sys.argv[2:]:
    with open(path, "rb") as f:
        case = tomllib.load(f)
    for v in validators:
        for error in v.iter_errors(case):
            sys.exit(f"{path}: {list(error.path)}: {error.message}")

    def edited(edit):
        other = copy.deepcopy(case)
        edit(other)
        return mistakes(other)

    assert edited(lambda c: c.update(stages=[])) > 0, "a wrong table"
    assert edited(lambda c: c["specimen"][0].update(colour=1)) > 0, "a wrong key"
    assert edited(lambda c: c["stage"][0].update(kind="dynamic")) > 0, "a wrong word"
    assert edited(lambda c: c["stage"][0].update(gravity=[0, 1])) > 0, "a list that is too short"
    assert edited(lambda c: c["specimen"][0].update(radius=-1)) > 0, "a number out of range"
    assert edited(lambda c: c.setdefault("time", {}).update(fraction=0)) > 0, "an open bound"
    assert edited(lambda c: c["specimen"][0].pop("kind")) > 0, "a key is missing"
    assert edited(lambda c: c.pop("stage")) > 0, "a table is missing"
    for bonds in case.get("bonds", [])[:1]:
        assert edited(lambda c: c["bonds"][0].update(distance=1.0, pairs=[[0, 1]])) > 0, "two of a choice"
print(f"{len(sys.argv) - 2} cases fit the schema")
