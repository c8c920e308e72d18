"""The kernel of OpenBLAS: not older than the processor, the user's own if there is one, and told."""
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from program import EXAMPLES, processor_has, values, vbond, write

OWN = {"OPENBLAS_CORETYPE": None}


def kernel(said):
    """The one that `check` or a run has named."""
    found = re.search("^BLAS kernel +(.*)", said.out, re.M)
    assert found, f"no kernel is named: {said}"
    return found.group(1)


def is_as_new(name):
    """Whether it uses the newest vector instructions of this processor, as far as there are kernels of them."""
    newest = "SkylakeX|Cooperlake|Sapphirerapids|SapphireRapids"
    newest += "" if processor_has("avx512f", "avx512bw") else "|Haswell|Zen"
    newest += "" if processor_has("avx2") else "|Sandybridge|Bulldozer|Piledriver|Steamroller|Excavator"
    return re.fullmatch(newest if processor_has("avx") else ".*", name)


@pytest.fixture(scope="module", autouse=True)
def case(work):
    shutil.copy(EXAMPLES / "rod_buckling.toml", ".")


def check(**env):
    return kernel(vbond("check rod_buckling.toml", env={**OWN, **env}))


def test_kernel_is_as_new_as_the_processor():
    own = check()
    assert is_as_new(own), "it is older than this processor"
    vbond("run rod_buckling.toml -o own", env=OWN)
    assert values("own", "blas_kernel") == [own]


@pytest.mark.parametrize("name", ["Prescott", "Nehalem"] + ["Haswell"] * processor_has("avx2"))
def test_the_users_own(name):
    assert check(OPENBLAS_CORETYPE=name) == name


def test_dynamics_uses_no_blas():  # and says nothing of it
    vbond("run", EXAMPLES / "two_particles.toml", "-o", "swing", no_out="BLAS kernel")
    assert "blas_kernel" not in Path("swing/run.json").read_text(), "a kernel where none is used"


@pytest.mark.skipif(not (shutil.which("cc") and processor_has("avx")), reason="no compiler, or an old processor")
def test_a_library_that_does_not_know_this_processor():
    # It takes its oldest kernel: the program starts itself anew, once, with its arguments. What the library is told in the
    # environment it takes.
    write("unknowing.c", r"""#include <stdio.h>
#include <stdlib.h>
char* openblas_get_corename(void) {
  FILE* starts = fopen(getenv("STARTS"), "a");
  char* told = getenv("OPENBLAS_CORETYPE");
  fprintf(starts, "%s\n", told ? told : "none");
  fclose(starts);
  return told ? told : "Prescott";
}
""")
    subprocess.run("cc -shared -fPIC -o unknowing.so unknowing.c".split(), check=True)
    unknowing = {"STARTS": str(Path("starts").resolve()), "LD_PRELOAD": str(Path("unknowing.so").resolve())}
    assert is_as_new(check(**unknowing))
    starts = Path("starts").read_text().split()
    assert len(set(starts)) == 2 and starts.count("none") == 1
    assert check(**unknowing, OPENBLAS_CORETYPE="Nehalem") == "Nehalem"
