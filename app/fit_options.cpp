#include <CLI/CLI.hpp>

#include "fit_command.hpp"

namespace vbond::app {

CLI::App* add_fit(CLI::App& app, FitOptions& o) {
  CLI::App* command = app.add_subcommand(
      "fit", "Vary keys of a case until columns of its history.csv follow measured points");
  command->add_option("CASE", o.case_file, "Case file (TOML)")->required();
  command->add_option("DATA", o.data_file, "Measured points (CSV), a row each, under a line of headings")
      ->required();
  command
      ->add_option("--vary", o.vary,
                   "KEY, KEY=log, KEY=range(low, high) or KEY=logrange(low, high): a number to vary, from "
                   "its value in "
                   "the case; may be repeated")
      ->required()
      ->allow_extra_args(false);
  command
      ->add_option(
          "--x", o.x,
          "Column of history.csv that the points lie along, such as load_factor; as COLUMN=HEADING if it has "
          "another name in the data")
      ->required();
  command
      ->add_option("--compare", o.compare,
                   "Column of history.csv that was measured, or COLUMN=HEADING; may be repeated")
      ->required()
      ->allow_extra_args(false);
  command
      ->add_option(
          "--sigma", o.sigma,
          "Standard deviation of the points: a number, or a heading of the data; one for each --compare "
          "(default: estimated from the residuals)")
      ->allow_extra_args(false);
  command->add_option("--stage", o.stage,
                      "Compare with this stage alone (default: column stage of the data, or all)");
  command
      ->add_option("-o,--output", o.output,
                   "Fitted case; NAME.json, NAME.csv and NAME.runs.csv are written beside it (default: "
                   "CASE.fitted.toml in the current folder)")
      ->type_name("NAME.toml");
  command->add_option("--iterations", o.iterations, "End the search after so many")
      ->check(CLI::Range(0, 100000))
      ->capture_default_str();
  command->add_option("--difference", o.difference, "Step of differences, relative")
      ->check(CLI::Range(1e-8, 0.5))
      ->capture_default_str();
  command
      ->add_option(
          "--derivatives", o.derivatives,
          "automatic: by the tangents of balances for values that are parameters of bonds; differences: for "
          "all values, by runs beside")
      ->check(CLI::IsMember({"automatic", "differences"}))
      ->capture_default_str();
  command->add_flag("--report", o.report,
                    "Write NAME.html: curves, residuals and history of the fit, for any browser");
  return command;
}

}  // namespace vbond::app
