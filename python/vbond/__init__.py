"""vbond: solids as rigid particles joined by elastic bonds that have an energy::

    case = vbond.Case.from_file("rod.toml", {"bonds[0].E": 2e9})
    run = vbond.Run(case)
    run.run()
    print(run.history["time"], run.state.positions)

Units are those of the case: reduced (a = m = c_A = 1) or SI. Particles and bonds are numbered from 0.
"""

from ._vbond import (
    CaseError,
    CriticalLoad,
    Diverged,
    Error,
    FractureEnergy,
    FractureResult,
    IoError,
    NaturalMode,
    NoEquilibrium,
    RunWarning,
    SpecialPoint,
    StageResult,
    State,
    StaticResult,
    __version__,
    better_blas_kernel,
    blas_kernel,
)
from . import plots
from .cases import Case, calibrate, list_keys
from .command import ProgramError, find_program
from .output import Frame, Output, open
from .program import calibrate_strengths, fit, laboratory_test, run, sweep
from .runs import Run
from .statics import StaticSolution, buckling, equilibrium, fracture, homogenise, homogenise_body, homogenise_sheet, modes, path

__all__ = [
    "Case", "CaseError", "CriticalLoad", "Diverged", "Error", "FractureEnergy", "FractureResult", "Frame", "IoError",
    "NaturalMode", "NoEquilibrium", "Output", "ProgramError", "Run", "RunWarning", "SpecialPoint", "StageResult", "State",
    "StaticResult", "StaticSolution", "__version__", "better_blas_kernel",
    "blas_kernel", "buckling", "calibrate", "calibrate_strengths", "equilibrium", "find_program",
    "fit", "fracture", "homogenise", "homogenise_body", "homogenise_sheet", "laboratory_test", "list_keys", "modes", "open", "path", "plots",
    "run", "sweep",
]
