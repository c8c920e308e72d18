"""A disk that fills up, at three sizes between nothing and all that a run needs, in three cases; then as many limits of the
size of a file. Each time the run says so and ends with status 3, and goes on from its last checkpoint, once there is room,
to the same bytes as a run that was never disturbed."""
import resource
import shutil
from pathlib import Path

import pytest
from program import HERE, STATICS, contents, disk, edited, expect_same, vbond, write

SIZES = 3
resumed = []
# many files; a checkpoint that is most of what is written; static stages with swings of modes
CASES = {"resume": [], "threads": [("^duration = .*", 'duration = "1 T0"'), ("^frames = .*", 'checkpoint = {every = "0.1 T0"}')],
         **({"statics": []} if STATICS else {})}


@pytest.fixture(scope="module", params=CASES)
def name(request, work):
    """Of a case; its sizes in the folder of an undisturbed run."""
    name = request.param
    vbond("run", write(f"{name}.toml", edited((HERE / f"{name}.toml").read_text(), *CASES[name])), "-o", f"whole_{name}")
    return name


def goes_on(name, folder):
    """From its last checkpoint, if there is one."""
    if not Path(folder, "resolved.toml").exists():
        return
    if not Path(folder, "checkpoint.h5").exists():
        vbond("resume", folder, status=3, err="stopped before its first checkpoint")
        return
    vbond("resume", folder)
    expect_same(f"whole_{name}", folder)
    resumed.append(folder)


@pytest.mark.parametrize("k", range(1, SIZES + 1))
def test_a_disk_that_fills_up(name, k):
    checkpoint = Path(f"whole_{name}/checkpoint.h5").stat().st_size // 1024
    blocks = sum(path.lstat().st_blocks for path in [Path(f"whole_{name}"), *Path(f"whole_{name}").rglob("*")]) // 2
    with disk(f"{(blocks + checkpoint) * k // (SIZES + 1)}k") as resize:  # the new checkpoint beside the old one
        vbond(f"run {name}.toml -o disk/out", status=3, err="No space left on device", no_err="HDF5")
        # tried too early: what an older checkpoint needs is not harmed
        vbond("resume disk/out", status=(0, 3))
        resize("1g")
        goes_on(name, "disk/out")


@pytest.mark.parametrize("k", range(1, SIZES + 1))
def test_a_limit_of_the_size_of_a_file(name, k):
    shutil.rmtree("limited", ignore_errors=True)
    largest = max(len(text) for text in contents(f"whole_{name}").values())
    vbond(f"run {name}.toml -o limited", status=3, err="File too large", no_err="HDF5",
          limits={resource.RLIMIT_FSIZE: (1 + largest * k // (SIZES + 1) // 1024) * 1024})
    goes_on(name, "limited")


def test_some_had_a_checkpoint_to_go_on_from():
    assert resumed
