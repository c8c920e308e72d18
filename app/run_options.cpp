#include "run_options.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>

#include "vbond/core/error.hpp"

namespace vbond::app {

void add_case(CLI::App* command, RunOptions& run) {
  command->add_option("CASE", run.case_file, "Case file (TOML); - is the standard input")->required();
  command
      ->add_option("--set", run.changes,
                   "KEY=VALUE: another value of a key, as in stage[0].duration=\"2 T0\"; may be repeated")
      ->allow_extra_args(false);
}

void add_output(CLI::App* command, RunOptions& run) {
  command
      ->add_option(
          "-o,--output", run.folder,
          "Output folder (default: CASE.out in the current folder, or CASE-2.out, ... if there is one)")
      ->type_name("DIR");
  command->add_flag("--force", run.force,
                    "Replace an earlier output in that folder, or in CASE.out; other files in it stay");
  command->add_flag("--report", run.report, "Write report.html at the end, as the command report does");
}

void add_printing(CLI::App* command, RunOptions& run) {
  CLI::Option* quiet = command->add_flag("--quiet", run.quiet, "Print mistakes and failures only");
  command->add_flag("--json", run.json, "Print what status.json says instead, a line of JSON each second")
      ->excludes(quiet);
}

void choose_printing(RunOptions& run) {
  if (!run.quiet && !run.json) return;
  if (run.json) run.status_lines = fdopen(dup(STDOUT_FILENO), "w");
  if ((run.json && run.status_lines == nullptr) || std::freopen("/dev/null", "w", stdout) == nullptr)
    throw IoError(std::string("cannot print: ") + std::strerror(errno));
}

}  // namespace vbond::app
