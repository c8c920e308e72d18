#include <CLI/CLI.hpp>
#include <stdexcept>

#include "calibrate_strengths.hpp"

namespace vbond::app {

std::vector<CLI::Option*> add_strengths(CLI::App* command, StrengthOptions& o, RunOptions& run) {
  CLI::Option* of_case = command->get_option("CASE");
  const auto target = [&](const char* name, std::string& to, const char* text, const char* type = "STRESS") {
    CLI::Option* option = command->add_option(name, to, text)->type_name(type)->needs(of_case);
    option->check([](const std::string& word) { return std::string(word.empty() ? "is empty" : ""); });
    for (const char* other :
         {"--E", "--nu", "--bending", "--length", "--diameter", "--inner-diameter", "--side", "--A", "--J",
          "--J_p", "--kappa", "--thickness", "--theory", "--from"})
      option->excludes(command->get_option(other));
  };
  target("--tensile", o.tensile, "With CASE, a body: its tensile strength, for limits of bonds");
  target("--compressive", o.compressive, "With CASE, a body: its compressive strength, for limits of bonds");
  target("--toughness", o.toughness,
         "With CASE, a beam: its fracture toughness, as \"1.5 MPa m^0.5\", for limits of bonds", "TOUGHNESS");
  std::vector<CLI::Option*> all = add_test_of_ends(command, o.test);
  all.push_back(command
                    ->add_option("--notch", o.notch,
                                 "With --toughness: depth of the notch, a length or a share of the height")
                    ->type_name("DEPTH")
                    ->needs(command->get_option("--toughness"))
                    ->capture_default_str());
  all.push_back(command->add_option("--within", o.within, "Of each of them, relative")
                    ->type_name("NUMBER")
                    ->capture_default_str());
  all.push_back(command
                    ->add_option("-o,--output", run.folder,
                                 "New folder for the tests of strengths and result.json (default: "
                                 "CASE.calibrate in the current folder)")
                    ->type_name("DIR"));
  all.push_back(command->get_option("--threads"));
  for (CLI::Option* option : all) option->group("Tests of strengths");
  return all;
}

void refuse_without_strengths(const std::vector<CLI::Option*>& for_strengths) {
  for (const CLI::Option* option : for_strengths)
    if (option->count() > 0)
      throw std::invalid_argument(
          option->get_name() +
          " is for tests of strengths\n  give --tensile or --compressive or --toughness, or leave it out");
}

}  // namespace vbond::app
