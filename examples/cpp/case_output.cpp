// Runs a case and writes what it asks for into a folder: history, breaks, frames and checkpoint, the same
// files as `vbond run CASE -o FOLDER`. case_output CASE FOLDER
#include <cstdio>
#include <filesystem>
#include <utility>

#include "vbond/case/read.hpp"
#include "vbond/observe/observers.hpp"
#include "vbond/run/plan_output.hpp"
#include "vbond/run/run.hpp"
#include "vbond/setup/build.hpp"

int main(int argc, char** argv) try {
  using namespace vbond;
  if (argc != 3) return std::fprintf(stderr, "case_output CASE FOLDER\n"), 2;
  const Case c = read_case(argv[1]);
  Built built = build(c);
  Run run(std::move(built.model), std::move(built.state), stages_of(c));
  run.check();  // all stages, before anything is written

  std::filesystem::create_directories(argv[2]);
  const auto tell = [](const std::string& report) { std::fprintf(stderr, "%s\n", report.c_str()); };
  const FileObservers files = open_output(plan_output(c, run.model(), argv[2]), tell, "0.1.0");
  for (const auto& observer : files.all()) run.add_observer(observer);
  RunHooks hooks;
  hooks.tell = tell;
  run.set_hooks(std::move(hooks));
  run.run();
  std::printf("%zu stages written to %s\n", run.results().size(), argv[2]);
} catch (const vbond::CaseError& mistakes) {
  std::fprintf(stderr, "%s\n", mistakes.what());
  return 2;
}
