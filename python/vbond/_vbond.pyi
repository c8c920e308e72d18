"""Types of the extension. Its functions without a docstring belong to the package."""

from os import PathLike
from pathlib import Path
from typing import Any, Callable, Sequence

from numpy import ndarray

__version__: str

class Error(Exception): ...

class CaseError(Error, ValueError):
    problems: list[dict[str, Any]]

class Diverged(Error):
    step: int
    time: float

class NoEquilibrium(Error): ...
class IoError(Error, OSError): ...
class RunWarning(UserWarning): ...

class CheckedCase:
    @property
    def title(self) -> str: ...
    def to_toml(self) -> str: ...

class State:
    positions: ndarray
    velocities: ndarray
    angular_velocities: ndarray
    orientations: ndarray
    temperatures: ndarray
    displacements: ndarray
    masses: ndarray
    radii: ndarray
    there: ndarray
    time: float
    step: int
    groups: dict[str, ndarray]
    bonds: dict[str, ndarray]
    contacts: dict[str, ndarray]
    cell: ndarray | None
    cell_rates: ndarray | None
    cell_stress: ndarray | None
    def __len__(self) -> int: ...

class CriticalLoad:
    kind: str
    load_factor: float
    force: float
    displacement: float | None
    reaction: float | None
    estimate: float | None
    gap: float
    translation: ndarray
    rotation: ndarray
    wave: int
    translation_out_of_phase: ndarray
    rotation_out_of_phase: ndarray

class NaturalMode:
    omega: float
    omega2: float
    frequency: float
    rigid: bool
    translation: ndarray
    rotation: ndarray
    wave: int
    translation_out_of_phase: ndarray
    rotation_out_of_phase: ndarray

class SpecialPoint:
    kind: str
    load_factor: float
    point: int
    unstable_before: int | None
    unstable_after: int | None
    gap: float

class FractureEnergy:
    initial: float
    work: float
    stored: float
    dissipated: float
    released: float
    error: float

class FractureResult:
    reason: str
    avalanches: int
    peak_load: float
    peak_load_factor: float
    energy: FractureEnergy
    breaks: dict[str, ndarray]

class StaticResult:
    ended: str
    load_factor: float
    points: int
    iterations: int
    residuals: list[float]
    unstable: int | None
    neutral: bool
    free_turns: int
    jumped: bool
    left_saddle: bool
    smallest_eigenvalue: float | None
    special_points: list[SpecialPoint]
    critical_loads: list[CriticalLoad]
    searched_to: float
    modes: list[NaturalMode]
    waves: ndarray
    fracture: FractureResult

class StageResult:
    name: str
    kind: str
    stop: str
    steps: int
    time: float
    critical_force: float | None
    statics: StaticResult | None
    failure: str

class CheckedRun:
    state: State
    energies: dict[str, float]
    loads: tuple[ndarray, ndarray]
    history: dict[str, ndarray]
    complete: bool
    time: float
    steps: int
    stage: str | None
    time_step: float
    results: list[StageResult]
    notes: list[str]
    reports: list[str]
    def __init__(self) -> None: ...
    def _make(self, case: CheckedCase, threads: int, places: bool) -> None: ...
    def step(self, n: int = 1) -> int: ...
    def run_stage(self) -> StageResult: ...
    def run(self) -> list[StageResult]: ...
    def end_stage(self) -> None: ...
    def on_step(self, every: int, call: Callable[[Any], bool | None]) -> None: ...
    def set_velocities(self, velocities: Any, angular_velocities: Any = None) -> None: ...
    def add_load(self, particles: str | Sequence[int], force: Any = (0, 0, 0), moment: Any = (0, 0, 0)) -> None: ...

class IsotropicConstants:
    K: float
    G: float
    E: float
    nu: float

class ElasticConstants:
    C: ndarray
    S: ndarray
    voigt: IsotropicConstants
    reuss: IsotropicConstants
    hill: IsotropicConstants
    anisotropy: float
    def __init__(self, C: Any) -> None: ...
    def youngs_modulus(self, along: Any) -> float: ...
    def poissons_ratio(self, along: Any, across: Any) -> float: ...
    def shear_modulus(self, a: Any, b: Any) -> float: ...
    def shear_moduli(self, along: Any) -> tuple[tuple[float, tuple[float, float, float]], tuple[float, tuple[float, float, float]]]: ...
    def poissons_ratios(self, along: Any) -> tuple[tuple[float, tuple[float, float, float]], tuple[float, tuple[float, float, float]]]: ...
    def least_youngs_modulus(self) -> tuple[float, tuple[float, float, float]]: ...
    def largest_youngs_modulus(self) -> tuple[float, tuple[float, float, float]]: ...
    def wave_speeds(self, along: Any, density: float) -> list[tuple[float, tuple[float, float, float]]]: ...

class Homogenised:
    C: ndarray
    constants: ElasticConstants
    stress: list[float]
    volume: float
    density: float
    particles: int
    bonds: int
    floating: int
    moved: bool
    solver: str
    derivatives: dict[int, dict[str, ndarray]]

def homogenise(state: State, derivatives: bool) -> Homogenised: ...

class HomogenisedSheet:
    A: ndarray
    B: ndarray
    D: ndarray
    axes: list[list[float]]
    plane: float
    area: float
    density: float
    particles: int
    bonds: int
    floating: int
    parts: int
    solver: str

def homogenise_sheet(state: State) -> HomogenisedSheet: ...

class HomogenisedBody:
    by_displacement: ElasticConstants
    by_traction: ElasticConstants
    volume: float
    density: float
    particles: int
    bonds: int
    surface: int
    floating: int
    moved: bool
    solver: str

def homogenise_body(state: State, surface: list[int] | None, volume: float | None) -> HomogenisedBody: ...
def read_case(file: str | PathLike, changes: Sequence[str]) -> CheckedCase: ...
def parse_case(text: str, file: str | PathLike, changes: Sequence[str], places: bool) -> CheckedCase: ...
def blas_kernel() -> str: ...
def better_blas_kernel() -> str: ...
def list_keys() -> list[dict[str, str]]: ...
def calibrate(given: dict[str, str]) -> dict[str, dict[str, Any]]: ...
def read_particles(path: str | PathLike) -> dict[str, ndarray]: ...
def read_bonds(path: str | PathLike) -> dict[str, ndarray]: ...
def read_pvd(path: str | PathLike) -> list[tuple[float, Path]]: ...
def read_history(path: str | PathLike) -> dict[str, ndarray]: ...
