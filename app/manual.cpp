#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>

#include "campaign.hpp"
#include "command_tree.hpp"
#include "commands.hpp"
#include "vbond/observe/files.hpp"

namespace vbond::app {
namespace {

/// Text as roff takes it: a plain hyphen is one, and no line begins with a dot or a quote.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
  }
  return out.empty() || (out[0] != '.' && out[0] != '\'') ? out : "\\&" + out;
}

std::string bold(const std::string& text) {
  return "\\fB" + roff(text) + "\\fR";
}
std::string italic(const std::string& text) {
  return "\\fI" + roff(text) + "\\fR";
}

std::string upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

std::string page_name(const CLI::App& program, const CLI::App& command) {
  return &program == &command ? "vbond" : "vbond-" + command.get_name();
}

/// A word of the synopsis: what may be left out is in brackets.
std::string in_synopsis(const Parameter& p) {
  std::string word = p.is_argument() ? italic(p.value) : bold(p.names.back()) + " " + italic(p.value);
  if (p.repeats) word += "...";
  return p.required ? word : "[" + word + "]";
}

std::string synopsis(const CLI::App& command, const std::vector<Parameter>& all) {
  std::string line = " [" + italic("OPTION") + "]...";
  for (const Parameter& p : all)
    if (p.required && !p.is_argument()) line += " " + in_synopsis(p);
  for (const Parameter& p : all)
    if (p.is_argument()) line += " " + in_synopsis(p);
  return bold("vbond " + command.get_name()) + line + "\n";
}

std::string item(const Parameter& p) {
  std::string head;
  for (const std::string& name : p.names) head += (head.empty() ? "" : ", ") + bold(name);
  if (!p.value.empty()) head += (head.empty() ? "" : " ") + italic(p.value);
  const std::string otherwise = p.unless_given.empty() ? "" : " (default: " + p.unless_given + ")";
  return ".TP\n" + head + "\n" + roff(p.text + otherwise) + "\n";
}

std::string section(const std::string& name, const std::string& text) {
  return text.empty() ? "" : ".SH " + name + "\n" + text;
}

/// The footer of the help, "Exit status: 0 done, ...", as a section of its own.
std::string exit_status(const CLI::App& program) {
  const std::string text = program.get_footer(), head = "Exit status: ";
  return section("EXIT STATUS", roff(text.rfind(head, 0) == 0 ? text.substr(head.size()) : text) + "\n");
}

std::string see_also(const CLI::App& program, const CLI::App& shown) {
  std::vector<std::string> pages;
  if (&shown != &program) pages.push_back(bold("vbond") + "(1)");
  for (const CLI::App* c : commands(program))
    if (c != &shown) pages.push_back(bold(page_name(program, *c)) + "(1)");
  return section("SEE ALSO", fmt::format("{}\n", fmt::join(pages, ",\n")));
}

std::string page_of(const CLI::App& program, const CLI::App& shown) {
  const bool whole = &shown == &program;
  const std::vector<Parameter> all = parameters(shown);
  std::string arguments, options, list;
  for (const Parameter& p : all) (p.is_argument() ? arguments : options) += item(p);
  if (whole)
    for (const CLI::App* c : commands(program))
      list += ".TP\n" + bold(page_name(program, *c)) + "(1)\n" + roff(c->get_description()) + "\n";

  const std::string name = page_name(program, shown), about = shown.get_description(), own = "vbond: ";
  const std::string what = about.rfind(own, 0) == 0 ? about.substr(own.size()) : about;
  return fmt::format(".TH {} 1 \"\" \"vbond {}\" \"vbond\"\n", upper(roff(name)), VBOND_VERSION) +
         section("NAME", roff(name) + " \\- " + roff(what) + "\n") +
         section("SYNOPSIS", whole ? bold("vbond") + " " + italic("COMMAND") + " [" + italic("OPTION") +
                                         "]... [" + italic("ARGUMENT") + "]...\n"
                                   : synopsis(shown, all)) +
         section("COMMANDS", list) + section("ARGUMENTS", arguments) + section("OPTIONS", options) +
         exit_status(program) + see_also(program, shown);
}

}  // namespace

int manual(const CLI::App& program, const std::string& command) {
  say(page_of(program, command.empty() ? program : *program.get_subcommand(command)));
  return done;
}

int write_manual(const CLI::App& program, const std::filesystem::path& folder) {
  std::vector<const CLI::App*> shown = commands(program);
  shown.push_back(&program);
  for (const CLI::App* c : shown)
    replace_file(folder / (page_name(program, *c) + ".1"), page_of(program, *c), Sync::none);
  return done;
}

}  // namespace vbond::app
