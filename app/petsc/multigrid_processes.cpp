// vbond-petsc: of several processes of MPI the first one runs the program; the others have parts of
// multigrid.
#include <mpi.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <initializer_list>
#include <memory>
#include <string>

#include "commands.hpp"
#include "processes.hpp"
#include "vbond/statics/multigrid_ranks.hpp"

namespace vbond::app {
namespace {

class MultigridProcesses : public Processes {
 public:
  MultigridProcesses() = default;
  ~MultigridProcesses() override { end_multigrid_ranks(); }
  MultigridProcesses(const MultigridProcesses&) = delete;
  MultigridProcesses& operator=(const MultigridProcesses&) = delete;
  bool may_start_programs() const override { return false; }
};

/// By mpirun or the like. Alone, a program begins MPI with PETSc, when it needs that.
bool is_one_of_several() {
  const auto names = {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK"};
  return std::any_of(names.begin(), names.end(),
                     [](const char* name) { return std::getenv(name) != nullptr; });
}

[[noreturn]] void end_all(const std::string& why) {
  std::fprintf(stderr, "%s\n", why.c_str());
  std::fflush(stderr);
  MPI_Abort(MPI_COMM_WORLD, failed);
  std::abort();
}

}  // namespace

const char* const program_name = "vbond";
const char* const program_note = "";
const bool has_ranks = false;

std::unique_ptr<Processes> start_processes(int& argc, char**& argv) {
  if (!is_one_of_several()) return std::make_unique<Processes>();
  MPI_Init(&argc, &argv);
  std::atexit([] { MPI_Finalize(); });  // after PETSc, which ends in the same way
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  if (rank > 0)  // it ends when the first one has ended
    for (const int s : {SIGINT, SIGTERM, SIGHUP}) std::signal(s, SIG_IGN);
  if (!begin_multigrid_ranks(end_all)) std::exit(done);
  return std::make_unique<MultigridProcesses>();
}

}  // namespace vbond::app
