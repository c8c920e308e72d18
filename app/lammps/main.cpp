// vbond-lammps: cases of vbond on many ranks. It links LAMMPS and so is under LAMMPS' licence, GPL-2.
#include <fmt/core.h>
#include <mpi.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>

#include "campaign.hpp"
#include "commands.hpp"
#include "failure.hpp"
#include "prepare.hpp"
#include "refusals.hpp"
#include "run_options.hpp"
#include "vbond/build/build.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/error.hpp"
#include "vbond/dynamics/kernel.hpp"
#include "vbond/observe/checkpoint.hpp"
#include "vbond/observe/frame_files.hpp"
#include "vbond/ranks/ranks.hpp"
#include "vbond/run/memory_needed.hpp"
#include "vbond/run/plan_output.hpp"
#include "vbond/run/run.hpp"

namespace {

using namespace vbond;

constexpr const char* version = "vbond-lammps " VBOND_VERSION
                                "\nIt links LAMMPS (https://www.lammps.org), so this program is under the "
                                "GNU General Public License, version 2;\n"
                                "vbond's own sources stay under the licence of vbond.";

void tell(const app::Failure& failure) {
  std::fprintf(stderr, "%s\n", failure.text.c_str());
  std::fflush(stderr);
}

/// What the command line asks for: to run a case, or to go on in a folder.
struct Task {
  app::RunOptions options;
  std::filesystem::path folder;
  bool resumes = false;
};

RanksHere ranks_here(const Ranks& ranks) {
  return {ranks.on_this_machine(), ranks.first_is_here(), ranks.parts()};
}

/// Each rank is to write what it has of a frame, into the folder that rank 0 names.
void set_frame_writer(Ranks& ranks, const Case& c, const Model& model) {
  ranks.set_look(
      [part = ranks.rank(), format = plan_output(c, model, {}).format_of_frames()](
          const Simulation& run, const std::string& folder) { write_part(folder, part, run, format); });
}

/// Rank 0: the run as vbond does it, with its files and its text.
int lead(Task task) {
  app::RunOptions& options = task.options;
  Ranks ranks;
  try {
    instruction_set();  // refuses a wrong VBOND_SIMD before anything is written
    if (options.case_file == "-")
      throw std::invalid_argument("every rank reads the case: give a file, not the standard input");
    app::choose_printing(options);
    options.stepper = &ranks;
    options.before_build = [here = ranks_here(ranks)](const Case& c) { require_memory(c, here); };
    options.before_output = [&ranks](const Case& c, const Run& run) {
      app::refuse_beyond_ranks(c);
      require_memory(c, run.model(), run.current(), ranks_here(ranks));
      set_frame_writer(ranks, c, run.model());
      if (const std::string other = ranks.agree({}); !other.empty())
        throw IoError("on another rank: " + other);
      app::say(fmt::format("ranks            {}\n", ranks.parts()));
    };
    const int status = task.resumes ? app::resume(task.folder, options) : app::run(options);
    app::say(fmt::format("{} times a particle went to another rank; particles were spread anew {} times\n",
                         ranks.migrations(), ranks.redistributions()));
    app::say(fmt::format("the rank with the most work worked {:.2f} times as long as the mean\n",
                         ranks.imbalance()));
    return status;
  } catch (...) {
    const app::Failure failure = app::failure_under_way();
    const bool begun = ranks.has_agreed();
    if (!begun) ranks.agree(failure.text);
    tell(failure);
    if (begun && failure.unforeseen)
      MPI_Abort(MPI_COMM_WORLD, failure.status);  // the others may wait for this rank
    return failure.status;
  }
}

/// The run of any other rank, once all can begin.
void follow(Run& run, Ranks& ranks) {
  try {
    run.set_stepper(&ranks);
    if (!run.complete()) run.run();
  } catch (const Diverged&) {  // rank 0 tells of it
  } catch (const NoEquilibrium&) {
  }
  ranks.wait_for_end();
}

State first_state(const Task& task, const Model& model, State built) {
  return task.resumes ? read_checkpoint(task.folder / "checkpoint.h5", model).state : std::move(built);
}

/// What goes wrong on one of the others alone ends them all.
int follow(const Task& task) {
  for (const int s : {SIGINT, SIGTERM, SIGHUP})
    std::signal(s, SIG_IGN);  // rank 0 hears them, and writes a checkpoint
  Ranks ranks;
  try {
    instruction_set();
    const Case c = read_case(task.resumes ? task.folder / "resolved.toml" : task.options.case_file,
                             task.resumes ? std::vector<std::string>{} : task.options.changes);
    require_statics(c);
    require_memory(c, ranks_here(ranks));
    Built built = build(c);
    State state = first_state(task, built.model, std::move(built.state));
    Run run(std::move(built.model), std::move(state), stages_of(c));
    if (!run.complete()) run.check();
    app::refuse_beyond_ranks(c);
    require_memory(c, run.model(), run.current(), ranks_here(ranks));
    set_frame_writer(ranks, c, run.model());
    if (ranks.agree({}).empty()) follow(run, ranks);
  } catch (const Dismissed&) {
  } catch (...) {
    const app::Failure failure = app::failure_under_way();
    if (!ranks.has_agreed()) {
      ranks.agree(failure.text);
      return app::done;  // rank 0 tells of it
    }
    tell(failure);
    MPI_Abort(MPI_COMM_WORLD, failure.status);
  }
  return app::done;
}

int dispatch(int argc, char** argv, bool leads) {
  CLI::App program("vbond-lammps: dynamic cases of vbond on many ranks: mpirun -np N vbond-lammps run CASE");
  program.set_version_flag("--version", version);
  program.require_subcommand(1);
  program.footer("Exit status: 0 done, 1 the run failed, 2 usage or input, 3 input/output.");
  Task task;
  app::RunOptions& run = task.options;
  run.program = argv[0];
  CLI::App* command = program.add_subcommand("run", "Compute a case");
  app::add_case(command, run);
  app::add_output(command, run);
  app::add_printing(command, run);
  CLI::App* resume =
      program.add_subcommand("resume", "Go on with a run that was stopped, on any number of ranks");
  resume->add_option("DIR", task.folder, "Its output folder, of vbond-lammps or vbond")->required();
  app::add_printing(resume, run);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (!leads) return app::done;
    return program.exit(e) == 0 ? app::done : app::bad_input;
  }
  task.resumes = resume->parsed();
  return leads ? lead(task) : follow(task);
}

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  std::signal(SIGXFSZ, SIG_IGN);  // a file that grows beyond ulimit -f is an error of writing, which is told
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  const int status = dispatch(argc, argv, rank == 0);
  MPI_Finalize();
  return status;
}
