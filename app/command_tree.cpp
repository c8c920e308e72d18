#include "command_tree.hpp"

#include <CLI/CLI.hpp>

namespace vbond::app {
namespace {

/// CLI11 says of an option "TEXT:{a,b,c}", and of a number "INT:INT in [1 - 8]".
std::vector<std::string> choices(const std::string& type) {
  const std::size_t open = type.find('{'), close = type.find('}');
  if (open == std::string::npos || close == std::string::npos) return {};
  return CLI::detail::split(type.substr(open + 1, close - open - 1), ',');
}

}  // namespace

std::vector<Parameter> parameters(const CLI::App& command) {
  std::vector<Parameter> all;
  for (const CLI::Option* o : command.get_options()) {
    Parameter p;
    for (const std::string& name : o->get_snames()) p.names.push_back("-" + name);
    for (const std::string& name : o->get_lnames()) p.names.push_back("--" + name);
    const std::string type = o->get_type_name();
    if (p.is_argument())
      p.value = o->get_name();
    else if (o->get_type_size_max() > 0)
      p.value = type.substr(0, type.find(':'));
    p.text = o->get_description();
    p.unless_given = o->get_default_str();
    p.choices = choices(type);
    p.required = o->get_required();
    p.repeats = o->get_items_expected_max() > 1;
    all.push_back(std::move(p));
  }
  return all;
}

std::vector<const CLI::App*> commands(const CLI::App& program) {
  return program.get_subcommands([](const CLI::App* c) { return !c->get_group().empty(); });
}

std::vector<std::string> names(const std::vector<const CLI::App*>& commands) {
  std::vector<std::string> all;
  for (const CLI::App* c : commands) all.push_back(c->get_name());
  return all;
}

}  // namespace vbond::app
