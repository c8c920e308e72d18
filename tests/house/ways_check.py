"""ways_check BUILD WAY TARGET...: the tests on stdin, as ctest --show-only=json-v1 tells them, start only what these
targets bring. What a test starts stands in its command or its properties, by its place in the build tree; of a folder
that is named there, all that is linked into it counts."""
import json
import os
import re
import subprocess
import sys

build, way, *targets = sys.argv[1:]
tests = json.load(sys.stdin)["tests"]
if not tests:
    sys.exit(f"FAILED: {way} selects no test of {build}, or of test programs that are not built yet")


def ninja(*words):
    return subprocess.run(["ninja", "-C", build, "-t", *words], check=True, capture_output=True, text=True).stdout.splitlines()


rules = dict(line.rsplit(": ", 1) for line in ninja("targets", "all") if ": " in line)
linked = {file for file, rule in rules.items() if re.search("EXECUTABLE|MODULE|SHARED", rule)}
brought = set(re.findall(r'\[label="([^"]+)"', "\n".join(ninja("graph", *targets)))) & rules.keys()


def words(value):
    return [word for part in value for word in words(part)] if isinstance(value, list) else re.split("[=;:]", str(value))


def started(test):
    texts = [test.get("command", [])] + [p["value"] for p in test["properties"] if p["name"] != "WORKING_DIRECTORY"]
    for word in words(texts):
        if word.startswith(build + "/") or word == build:
            place = os.path.relpath(word, build)
            yield from {place} & rules.keys() or {file for file in linked if place == "." or file.startswith(place + "/")}


failed, files = 0, set()
for test in tests:
    missing = set(started(test)) - brought
    files |= set(started(test))
    failed += bool(missing)
    if missing and failed <= 5:
        print(f"FAILED: {way}: {test['name']} starts {', '.join(sorted(missing))}, not among what is built: {' '.join(targets)}")
print(f"{way}: {len(tests)} tests start {len(files)} files")
if not files:
    sys.exit(f"FAILED: {way}: its tests start nothing of {build}")
sys.exit(f"FAILED: {way}: {failed} of its tests start what it does not build" if failed else 0)
