"""A run in memory, step by step."""

from __future__ import annotations

from . import _vbond
from .cases import Case


class Run(_vbond.CheckedRun):
    """A case that runs in memory, through its stages; it writes no files (vbond.run does).

    Making it builds the body and checks all stages: CaseError, NoEquilibrium if there are mistakes. Results do not
    depend on `threads`. While it computes, other threads of Python go on, but may not use this run: ValueError.
    Ctrl-C raises KeyboardInterrupt, after which the run can go on. After Diverged or NoEquilibrium it can only be
    looked at.
    """

    def __init__(self, case: Case, threads: int = 1):
        if not isinstance(case, Case):
            raise TypeError(f"Run takes a vbond.Case, not {type(case).__name__}: see Case.from_file and Case.from_dict")
        super().__init__()
        self.case = case
        self._make(case._checked, threads, case._places)

    def __repr__(self) -> str:
        title = self.case.title or "without a title"
        try:
            where = "complete" if self.complete else f"stage {self.stage}, step {self.steps}"
        except ValueError as e:  # another thread is at work on it, or its case was refused
            where = str(e).removeprefix("complete: ")
        return f"<vbond.Run: {title}, {where}>"
