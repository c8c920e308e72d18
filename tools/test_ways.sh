# Sourced by ./test and by tests/house/ways_test: the ways to test, and what each builds and selects.
# shellcheck shell=bash disable=SC2034

# test_way [OPTION]: sets preset, targets (none: all) and select, the options of ctest. Fails for another option.
# targets must hold all that the selected tests start: ways_test compares them.
test_way() {
  preset=release targets=() select=()
  case ${1-} in
    "") select=(--label-exclude "slow|validation") ;;
    --quick) select=(--label-regex quick) ;;
    --slow) select=(--label-regex slow) ;;
    --validation) select=(--label-regex validation) ;;
    --sanitize) preset=sanitize select=(--label-regex quick --label-exclude scripts) ;;
    --petsc) preset=petsc targets=(vbond_program test_multigrid) select=(--label-regex petsc) ;;
    --lammps)
      preset=lammps targets=(vbond_program vbond_lammps compare_frames no_memory_to_compress)
      select=(--label-regex lammps)
      ;;
    --python) targets=(vbond_program _vbond rod_of_python_tests) select=(--label-regex python) ;;
    *) return 1 ;;
  esac
}
