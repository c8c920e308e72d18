#include <fcntl.h>

#include <CLI/CLI.hpp>
#include <cctype>
#include <csignal>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "blas.hpp"
#include "calibrate_strengths.hpp"
#include "command_tree.hpp"
#include "commands.hpp"
#include "failure.hpp"
#include "fit_command.hpp"
#include "processes.hpp"
#include "run_options.hpp"
#include "test_command.hpp"
#include "vbond/core/nearest.hpp"
#include "vbond/dynamics/kernel.hpp"

namespace {

using namespace vbond;

int default_threads() {
  if (const char* set = std::getenv("OMP_NUM_THREADS"))
    if (const int n = std::atoi(set); n > 0) return n;
  return static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

void add_threads(CLI::App* command, int& threads) {
  command
      ->add_option("--threads", threads,
                   "Threads; results do not depend on it (default: all cores, or OMP_NUM_THREADS)")
      ->check(CLI::Range(1, 1024));
}

/// Parameters that `calibrate` takes from other programs.
void add_published(CLI::App* command, PublishedBonds& b) {
  CLI::Option* from =
      command
          ->add_option("--from", b.program,
                       "Print the section [[bonds]] of parameters of this program, pfc or edem, instead")
          ->check(CLI::IsMember({"pfc", "edem"}));
  for (const char* theirs : {"--E", "--length", "--diameter", "--inner-diameter", "--side", "--A", "--J",
                             "--J_p", "--kappa", "--thickness"})
    from->excludes(command->get_option(theirs));
  const auto add = [&](const char* name, std::string& text, const char* meaning) {
    command->add_option(name, text, meaning)->needs(from);
  };
  add("--pb_kn", b.pb_kn, "PFC: normal stiffness per area");
  add("--pb_ks", b.pb_ks, "PFC: shear stiffness per area");
  add("--pb_emod", b.pb_emod, "PFC: effective modulus, with --pb_kratio instead of these two");
  add("--pb_kratio", b.pb_kratio, "PFC: ratio of normal to shear stiffness");
  add("--pb_rmul", b.pb_rmul, "PFC: radius multiplier (default: 1)");
  add("--pb_ten", b.pb_ten, "PFC: tensile strength");
  add("--pb_coh", b.pb_coh, "PFC: cohesion");
  add("--pb_fa", b.pb_fa, "PFC: friction angle in degrees (default: 0)");
  add("--pb_mcf", b.pb_mcf, "PFC: moment-contribution factor (default: 1)");
  add("--normal-stiffness", b.normal_stiffness, "EDEM: normal stiffness per unit area");
  add("--shear-stiffness", b.shear_stiffness, "EDEM: shear stiffness per unit area");
  add("--normal-stress", b.normal_stress, "EDEM: critical normal stress");
  add("--shear-stress", b.shear_stress, "EDEM: critical shear stress");
  add("--disk-radius", b.disk_radius, "EDEM: bonded disk radius");
  add("--gap", b.gap, "Largest gap of surfaces that was bonded (default: 0)");
}

void add_calibrate(CLI::App& app, CalibrateOptions& o, PublishedBonds& published, app::RunOptions& body,
                   std::string& bending, CLI::App*& command) {
  command = app.add_subcommand("calibrate",
                               "Bond stiffnesses from E and nu: of one bond from its section, length and "
                               "theory; with CASE of all bonds of a periodic cell that is to have them; or "
                               "limits of bonds from the strengths of a body");
  CLI::Option* of_case =
      command->add_option("CASE", body.case_file,
                          "Case file (TOML) with a periodic cell, whose bonds get factors; or "
                          "with a body, for strengths");
  command->add_option("--set", body.changes, "KEY=VALUE: another value of a key of the case; may be repeated")
      ->allow_extra_args(false)
      ->needs(of_case);
  command
      ->add_option("--bending", bending,
                   "With CASE: what c_B and c_T go with, c_A and c_D (area), or both with one of these")
      ->check(CLI::IsMember({"area", "normal", "shear"}))
      ->capture_default_str()
      ->needs(of_case);
  command->add_option("--E", o.E, "Young's modulus, e.g. 2e9 or \"2 GPa\"");
  command->add_option("--nu", o.nu, "Poisson's ratio")->capture_default_str();
  command->add_option("--length", o.length, "Length of the bond between its fastening points");
  command->add_option("--diameter", o.diameter, "Circle, or outer diameter of an annulus");
  command->add_option("--inner-diameter", o.inner_diameter, "Inner diameter of an annulus");
  command->add_option("--side", o.side, "Side of a square");
  command->add_option("--A", o.A, "Area of any other section, with --J and --J_p");
  command->add_option("--J", o.J, "Second moment of area");
  command->add_option("--J_p", o.J_p, "Torsion constant");
  command->add_option("--kappa", o.kappa, "Shear coefficient (default: Hutchinson's, for a circle)");
  command->add_option(
      "--thickness", o.thickness,
      "Of the thin wall that a triangular sheet stands for (theory shell), instead of a section");
  command->add_option("--theory", o.theory, "bernoulli-euler, timoshenko, short-cylinder, shell or all")
      ->check(CLI::IsMember({"bernoulli-euler", "timoshenko", "short-cylinder", "shell", "all"}))
      ->capture_default_str();
  add_published(command, published);
  command->get_option("--from")->excludes(of_case);
}

void add_plot(CLI::App& app, app::PlotOptions& o, CLI::App*& command) {
  command = app.add_subcommand("plot", "Plot columns of history.csv in the terminal");
  command->add_option("DIR", o.folder, "Output folder of a run")->required();
  command->add_option("COLUMN", o.columns, "Columns, a panel each; without any they are listed");
  command->add_option(
      "--x", o.x,
      "Column to plot against (default: time; of balances alone the load factor or, where that "
      "goes back, a displacement)");
  command->add_flag("--png", o.still,
                    "Write DIR/report.png, the report with its last frame as a picture; needs chromium");
}

/// Commands for whoever installs the program, which the help does not list.
struct Hidden {
  CLI::App *completion = nullptr, *manual = nullptr;
  std::string shell, command;
  std::optional<std::filesystem::path> folder;
};

void add_hidden(CLI::App& program, Hidden& h) {
  h.completion =
      program.add_subcommand("completion", "Print a script by which a shell completes commands")->group("");
  h.completion->add_option("SHELL", h.shell, "bash, zsh or fish")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish"}));
  h.manual =
      program.add_subcommand("manual", "Print the manual page of the program, or of a command")->group("");
  h.manual->add_option("COMMAND", h.command, "A command")
      ->check(CLI::IsMember(app::names(app::commands(program))));
  h.manual->add_option("-o,--output", h.folder, "Folder that takes all pages")->type_name("DIR");
}

[[noreturn]] void refuse(const std::string& what, const std::string& wrong,
                         const std::vector<std::string>& right, const std::string& list) {
  const auto meant = nearest_name(wrong, right);
  std::string text = what + "\n  " + list;
  for (const std::string& name : right) text += " " + name;
  throw std::invalid_argument(meant ? what + "\n  did you mean " + *meant + "?" : text);
}

bool is_option(const std::string& word) {
  return word.size() > 1 && word[0] == '-' && std::isdigit(static_cast<unsigned char>(word[1])) == 0 &&
         word[1] != '.';
}

/// Throws std::invalid_argument for a command or an option that does not exist: the parser would blame the
/// word behind it, such as the case file.
void refuse_unknown(const CLI::App& program, int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  const CLI::App* command = &program;
  if (!words.empty() && !is_option(words[0])) {
    for (const CLI::App* c : program.get_subcommands([](const CLI::App*) { return true; }))
      if (c->get_name() == words[0]) command = c;
    const std::vector<std::string> names = app::names(app::commands(program));
    if (command == &program)
      refuse("\"" + words[0] + "\" is no command of vbond", words[0], names, "the commands are");
  }
  std::vector<std::string> options;
  for (const CLI::Option* o : command->get_options())
    for (const std::string& name : o->get_lnames()) options.push_back("--" + name);
  for (const std::string& word : words) {
    if (!is_option(word)) continue;
    if (word == "--") return;
    const std::string name = word[1] == '-' ? word.substr(0, word.find('=')) : word.substr(0, 2);
    if (command->get_option_no_throw(name) != nullptr) continue;
    const bool before = command == &program;
    refuse(name + " is no option of vbond" + (before ? " before its command" : " " + command->get_name()),
           name, options, before ? "options stand behind the command; before it" : "its options are");
  }
}

int dispatch(int argc, char** argv, app::Processes& processes) {
  const std::string name = app::program_name;
  CLI::App program(name + ": solids as rigid particles joined by elastic bonds that have an energy");
  program.set_version_flag("--version", name + " " VBOND_VERSION + app::program_note);
  program.require_subcommand(1);
  program.footer(
      "Exit status: 0 done, 1 the run failed, 2 usage or input, 3 input/output, 129/130/141/143 on a "
      "signal.");

  app::RunOptions run;
  run.processes = &processes;
  run.threads = app::has_ranks ? 1 : default_threads();
  run.program = argv[0];
  CLI::App* run_command = program.add_subcommand("run", "Compute a case");
  app::add_case(run_command, run);
  app::add_output(run_command, run);
  app::add_printing(run_command, run);
  if (!app::has_ranks) add_threads(run_command, run.threads);

  CLI::App* check_command = program.add_subcommand("check", "Validate a case and say what would be run");
  app::add_case(check_command, run);
  add_threads(check_command, run.threads);
  check_command
      ->add_option("--ranks", run.ranks, "Say what memory each of so many ranks of vbond-lammps takes")
      ->check(CLI::Range(1, 1000000));

  std::filesystem::path folder;
  CLI::App* resume_command = program.add_subcommand("resume", "Go on with a run that was stopped");
  resume_command->add_option("DIR", folder, "Its output folder")->required();
  app::add_printing(resume_command, run);
  if (!app::has_ranks) add_threads(resume_command, run.threads);

  CLI::App* report_command =
      program.add_subcommand("report", "Write DIR/report.html: one page that shows a run, for any browser");
  report_command->add_option("DIR", folder, "Output folder of a run, ended or not")->required();

  app::PlotOptions plot;
  CLI::App* plot_command = nullptr;
  add_plot(program, plot, plot_command);

  app::WatchOptions watch;
  watch.program = argv[0];
  CLI::App* watch_command = program.add_subcommand("watch", "Show how a run stands until it ends");
  watch_command->add_option("DIR", watch.folder, "Its output folder")->required();
  CLI::Option* once = watch_command->add_flag("--once", watch.once, "Say it once, without waiting");
  CLI::Option* page = watch_command->add_flag(
      "--page", watch.page,
      "Show it in a browser of this machine, too: 3D view and plots that follow the run");
  page->excludes(once);
  watch_command->add_option("--port", watch.port, "Port of that page (default: any that is free)")
      ->needs(page)
      ->check(CLI::Range(1024, 65535));

  bool all_breaks = false;
  CLI::App* breaks_command = program.add_subcommand("breaks", "Say which bonds of a run broke, when and why");
  breaks_command->add_option("DIR", folder, "Output folder of a run, ended or not")->required();
  breaks_command->add_flag("--all", all_breaks, "All of them, not the first 100");

  app::SweepOptions sweep;
  sweep.program = argv[0];
  sweep.jobs = default_threads();
  CLI::App* sweep_command = program.add_subcommand(
      "sweep", "Compute a case for all combinations of values of some keys, or go on with that");
  sweep_command->add_option("CASE", sweep.case_file, "Case file (TOML)")->required();
  sweep_command
      ->add_option("--set", sweep.sets,
                   "KEY=a,b,c or KEY=range(first, last, count) or logrange(...); may be repeated")
      ->required()
      ->allow_extra_args(false);
  sweep_command->add_option("-o,--output", sweep.folder, "Folder of the sweep (default: CASE.sweep)")
      ->type_name("DIR");
  sweep_command->add_option("--jobs", sweep.jobs, "Runs at once (default: all cores)")
      ->check(CLI::Range(1, 1024));
  sweep_command->add_option("--threads", sweep.threads, "Threads of each run (default: 1)")
      ->check(CLI::Range(1, 1024));

  std::filesystem::path export_to;
  CLI::App* export_command = program.add_subcommand(
      "export", "Write the body of a case as input of LAMMPS, for its plugin of vbond's bonds");
  app::add_case(export_command, run);
  export_command->add_option("-o,--output", export_to, "Folder for body.data, body.bonds, body.lammps")
      ->required()
      ->type_name("DIR");

  std::filesystem::path pack_to;
  CLI::App* pack_command = program.add_subcommand(
      "pack", "Pack the grains of a case, and write its particles alone: as CSV, or for LAMMPS");
  app::add_case(pack_command, run);
  pack_command->add_option("-o,--output", pack_to, "File: NAME.csv, or NAME.data for LAMMPS")
      ->required()
      ->type_name("FILE");

  CLI::App* homogenise_command = program.add_subcommand(
      "homogenise", "Say what elastic material or plate a body of particles and bonds is");
  app::add_case(homogenise_command, run);
  homogenise_command->add_flag("--json", run.json, "Print it as JSON");
  app::HomogeniseOptions of_body;
  homogenise_command
      ->add_option("--report", of_body.report,
                   "Write a page for any browser: moduli by direction as polar plots, and tables")
      ->type_name("NAME.html");
  homogenise_command
      ->add_option("--volume", of_body.volume,
                   "Of a body without a cell; without it that of the box around it")
      ->type_name("VOLUME");
  homogenise_command
      ->add_option("--surface", of_body.surface,
                   "Group whose particles are its surface; without it the box's")
      ->type_name("GROUP");
  homogenise_command
      ->add_flag(
          "--along", of_body.along,
          "Run the case, and print the constants of its cell at each balance of its static stages, as CSV")
      ->excludes("--json")
      ->excludes("--report");

  app::FitOptions fit;
  fit.threads = default_threads();
  CLI::App* fit_command = app::add_fit(program, fit);
  add_threads(fit_command, fit.threads);

  app::TestOptions test;
  CLI::App* test_command = app::add_test(program, test, run);
  add_threads(test_command, run.threads);

  std::string key;
  CLI::App* reference_command =
      program.add_subcommand("reference", "Print what a key of case files means, or all keys of a table");
  reference_command->add_option("KEY", key, "e.g. bonds.theory, stage.stop, fix; without it: all keys");

  CLI::App* schema_command =
      program.add_subcommand("schema", "Print a JSON Schema of case files, for completion in an editor");

  CalibrateOptions calibrate;
  CLI::App* calibrate_command = nullptr;
  PublishedBonds published;
  std::string bending = "area";
  add_calibrate(program, calibrate, published, run, bending, calibrate_command);
  app::StrengthOptions strengths;
  add_threads(calibrate_command, run.threads);
  const std::vector<CLI::Option*> for_strengths = app::add_strengths(calibrate_command, strengths, run);

  Hidden hidden;
  add_hidden(program, hidden);

  if (argc == 1) {
    std::fputs(program.help().c_str(), stderr);
    return app::bad_input;
  }
  refuse_unknown(program, argc, argv);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return program.exit(e) == 0 ? app::done : app::bad_input;
  }
  const auto compute = [&] {
    instruction_set();  // refuses a wrong VBOND_SIMD before anything is written
    app::choose_printing(run);
    return run_command->parsed() ? app::run(run) : app::resume(folder, run);
  };
  if (run_command->parsed() || resume_command->parsed()) return processes.run(compute);
  if (!processes.leads()) return app::done;
  if (check_command->parsed()) {
    instruction_set();
    return app::check(run);
  }
  if (report_command->parsed()) return app::report(folder);
  if (plot_command->parsed()) return app::plot(plot);
  if (watch_command->parsed()) return app::watch(watch);
  if (breaks_command->parsed()) return app::breaks(folder, all_breaks);
  if (sweep_command->parsed()) {
    if (!processes.may_start_programs())
      throw std::invalid_argument("a sweep starts programs of its own: use vbond sweep, in one process");
    return app::sweep(sweep);
  }
  if (export_command->parsed()) return app::export_lammps(run, export_to);
  if (pack_command->parsed()) return app::pack(run, pack_to);
  if (homogenise_command->parsed()) return app::homogenise(run, of_body);
  if (fit_command->parsed()) return app::fit(fit);
  if (test_command->parsed()) return app::test(run, test);
  if (reference_command->parsed()) return app::reference(key);
  if (schema_command->parsed()) return app::schema();
  if (hidden.completion->parsed()) return app::completion(program, hidden.shell);
  if (hidden.manual->parsed())
    return hidden.folder ? app::write_manual(program, *hidden.folder) : app::manual(program, hidden.command);
  if (calibrate_command->count("--tensile") + calibrate_command->count("--compressive") +
          calibrate_command->count("--toughness") >
      0)
    return app::calibrate_strengths(run, strengths);
  app::refuse_without_strengths(for_strengths);
  if (!run.case_file.empty() && calibrate_command->count("--nu") == 0) calibrate.nu.clear();
  if (!run.case_file.empty()) return app::calibrate_body(run, calibrate, bending);
  return app::calibrate(calibrate, published);
}

/// A standard stream that the caller has closed would be the next file that is opened: history.csv, say, with
/// the table of the run in it.
void open_standard_streams() {
  for (const int stream : {0, 1, 2})
    if (fcntl(stream, F_GETFD) == -1) open("/dev/null", O_RDWR);  // takes the lowest number that is free
}

}  // namespace

int main(int argc, char** argv) {
  app::choose_blas_kernel(argv);
  open_standard_streams();
  const std::unique_ptr<app::Processes> processes = app::start_processes(argc, argv);
  std::signal(SIGXFSZ, SIG_IGN);  // a file that grows beyond ulimit -f is an error of writing, which is told
  try {
    return dispatch(argc, argv, *processes);
  } catch (...) {
    const app::Failure failure = app::failure_under_way();
    std::fprintf(stderr, "%s\n", failure.text.c_str());
    return failure.status;
  }
}
