"""Every instruction set that this machine has leaves the same files, byte for byte, run.json but for wall times; a set that
it has not is refused."""
from pathlib import Path

import pytest
from program import HERE, expect_same, instruction_sets, values, vbond


@pytest.mark.parametrize("case", ["resume", "threads", "tops", "capsules"])
def test_the_same_bits(case):
    for simd in ("baseline", "avx2", "avx512"):
        there, folder = simd in instruction_sets(), f"{case}-{simd}"
        vbond("run", HERE / f"{case}.toml", "-o", folder, env={"VBOND_SIMD": simd}, status=0 if there else 2)
        if not there:
            assert not Path(folder).exists(), f"{simd}, which this machine cannot execute, was refused, and yet its folder was written"
            continue
        assert values(folder, "instruction_set") == [simd]
        expect_same(f"{case}-baseline", folder)


def test_an_unknown_set_is_refused():
    vbond("run", HERE / "resume.toml", "-o", "mmx", env={"VBOND_SIMD": "mmx"}, status=2)
    assert not Path("mmx").exists()
