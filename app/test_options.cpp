#include <CLI/CLI.hpp>

#include "run_options.hpp"
#include "test_command.hpp"

namespace vbond::app {

namespace {

CLI::Option* quantity(CLI::App* command, const char* name, std::string& to, const char* type,
                      const char* text) {
  return command->add_option(name, to, text)->type_name(type);
}
CLI::Option* direction(CLI::App* command, const char* name, std::string& to, const char* text) {
  return command->add_option(name, to, text)->check(CLI::IsMember({"x", "y", "z"}));
}

}  // namespace

std::vector<CLI::Option*> add_test_of_ends(CLI::App* command, TestOptions& o) {
  std::vector<CLI::Option*> all;
  all.push_back(direction(command, "--axis", o.axis, "Along the specimen, or of a disc its own axis")
                    ->capture_default_str());
  CLI::Option* motion = command->add_flag(
      "--motion", o.motion, "In motion, with time steps (default: at rest, equilibrium by equilibrium)");
  all.push_back(motion);
  all.push_back(
      command
          ->add_option("--ends", o.ends, "tension, compression: ends slide sideways, or move as rigid bodies")
          ->check(CLI::IsMember({"slide", "grip"}))
          ->capture_default_str());
  const auto add = [&](const char* name, std::string& to, const char* type, const char* text) {
    all.push_back(quantity(command, name, to, type, text));
    return all.back();
  };
  add("--strain", o.strain, "NUMBER",
      "At which it ends if nothing gives way before (default: 0.02, if bonds have strengths)");
  add("--drop", o.drop, "NUMBER", "Part of the peak that must be lost at its end (default: 0.5)");
  add("--area", o.area, "AREA", "Of the section (default: measured, of a box or a circle)");
  add("--depth", o.depth, "LENGTH", "Of the ends (default: the particles at the face)");
  add("--rate", o.rate, "RATE", "In motion: of the strain (default: from the speed of waves)")->needs(motion);
  add("--damping", o.damping, "NUMBER", "In motion: local damping (default: 0.7)")->needs(motion);
  return all;
}

CLI::App* add_test(CLI::App& app, TestOptions& o, RunOptions& run) {
  CLI::App* command = app.add_subcommand(
      "test", "Make a laboratory test of the body of a case, run it, and say moduli and strengths");
  command->add_option("KIND", o.kind, "Which test")
      ->required()
      ->check(CLI::IsMember({"tension", "compression", "brazilian", "triaxial", "bend3", "shear"}));
  add_case(command, run);
  command
      ->add_option("-o,--output", run.folder,
                   "New folder for the case of the test, its run and result.json (default: CASE.KIND in the "
                   "current folder)")
      ->type_name("DIR");
  add_test_of_ends(command, o);
  direction(command, "--across", o.across,
            "shear, bend3, brazilian: along which it is loaded (default: z, or x if the axis is z)");
  command
      ->add_option("--pressure", o.pressures,
                   "triaxial: all round, 0 for none; may be repeated, and tests at several pressures tell "
                   "the envelope")
      ->type_name("PRESSURE")
      ->allow_extra_args(false);
  quantity(command, "--span", o.span, "LENGTH",
           "bend3: between the supports (default: as far as the beam goes, with --notch 4 heights)");
  CLI::Option* notch =
      quantity(command, "--notch", o.notch, "DEPTH",
               "bend3: bonds across the middle are left out so far from the stretched side, a length or a "
               "share of the height as \"50 %\": tells K_Ic");
  quantity(command, "--E", o.modulus, "STRESS",
           "With --notch: Young's modulus of the body, for the energy release rate K^2/E")
      ->needs(notch);
  command->add_flag("--frames", o.frames, "Write frames, too, for ParaView and the report page");
  command->add_flag("--verbose", o.verbose, "Print what vbond run prints of the run, too");
  return command;
}

}  // namespace vbond::app
