#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <string_view>

#include "campaign.hpp"
#include "command_tree.hpp"
#include "commands.hpp"

// A value is completed by what the help calls it: CASE is a case file, DIR a folder; choices are as they are
// listed.

namespace vbond::app {
namespace {

/// In single quotes, as all three shells read them; fish knows a backslash in them, the others do not.
std::string in_quotes(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string joined(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, " "));
}

std::string option_names(const std::vector<Parameter>& all) {
  std::vector<std::string> names;
  for (const Parameter& p : all) names.insert(names.end(), p.names.begin(), p.names.end());
  return joined(names);
}

// ---- bash

constexpr std::string_view bash_begin = R"(# Completion of vbond in bash, written by: vbond completion bash
_vbond() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} kind= words=
  # bash takes --option=value apart
  [[ $word != = ]] || word=
  [[ $before != = ]] || before=${COMP_WORDS[COMP_CWORD - 2]}
)";

constexpr std::string_view bash_end = R"(  case $kind in
    CASE) mapfile -t COMPREPLY < <(compgen -f -X '!*.toml' -- "$word"; compgen -d -- "$word") ;;
    DIR) mapfile -t COMPREPLY < <(compgen -d -- "$word") ;;
    *) mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word"); return ;;
  esac
  compopt -o filenames 2>/dev/null
}
complete -F _vbond vbond
)";

std::string bash_command(const CLI::App& command) {
  const std::vector<Parameter> all = parameters(command);
  const std::string name = command.get_name();
  std::string text, argument;
  for (const Parameter& p : all) {
    if (p.is_argument() && argument.empty()) argument = p.value;
    if (p.is_argument() || p.value.empty()) continue;
    std::string pattern;
    for (const std::string& option : p.names)
      pattern += (pattern.empty() ? "" : " | ") + in_quotes(name + " " + option);
    text += fmt::format("      {}) kind={} words={} ;;\n", pattern, p.value, in_quotes(joined(p.choices)));
  }
  const std::string options = in_quotes(option_names(all)), others = in_quotes(name + " ") + "*)";
  if (argument.empty()) return text + fmt::format("      {} words={} ;;\n", others, options);
  return text +
         fmt::format("      {} [[ $word == -* ]] && words={} || kind={} ;;\n", others, options, argument);
}

std::string for_bash(const CLI::App& program) {
  std::string text(bash_begin);
  text += fmt::format(
      "  if ((COMP_CWORD == 1)); then\n    words={}\n  else\n    case \"${{COMP_WORDS[1]}} $before\" in\n",
      in_quotes(joined(names(commands(program))) + " " + option_names(parameters(program))));
  for (const CLI::App* c : commands(program)) text += bash_command(*c);
  return text + "    esac\n  fi\n" + std::string(bash_end);
}

// ---- zsh

constexpr std::string_view zsh_begin = R"(#compdef vbond
# Completion of vbond in zsh, written by: vbond completion zsh
_vbond() {
  local curcontext=$curcontext state line
  local -a commands
)";

constexpr std::string_view zsh_end = R"(      esac ;;
  esac
}
if [[ $funcstack[1] == _vbond ]]; then
  _vbond "$@"
else
  compdef _vbond vbond
fi
)";

/// Brackets, colons and backslashes have a meaning in the arguments of _arguments.
std::string zsh_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
    out += c;
  }
  return out;
}

std::string zsh_value(const Parameter& p) {
  if (p.value.empty()) return "";
  std::string action = " ";
  if (p.value == "CASE") action = "_files -g \"*.toml\"";
  if (p.value == "DIR") action = "_files -/";
  if (!p.choices.empty()) action = fmt::format("({})", fmt::join(p.choices, " "));
  return ":" + zsh_text(p.value) + ":" + action;
}

/// The arguments of _arguments for all options of a command, and its own arguments.
std::string zsh_parameters(const CLI::App& command) {
  std::string text;
  int place = 0;
  for (const Parameter& p : parameters(command)) {
    const std::string front = p.repeats ? "*" : p.names.size() > 1 ? "(" + joined(p.names) + ")" : "";
    for (const std::string& name : p.names)
      text += " \\\n            " + in_quotes(front + name +
                                              (p.value.empty()  ? ""
                                               : name[1] == '-' ? "="
                                                                : "+") +
                                              "[" + zsh_text(p.text) + "]" + zsh_value(p));
    if (p.is_argument())
      text += " \\\n            " +
              in_quotes((p.repeats ? "*" : std::to_string(++place) + (p.required ? "" : ":")) + zsh_value(p));
  }
  return text;
}

std::string for_zsh(const CLI::App& program) {
  std::string text(zsh_begin);
  text += "  commands=(\n";
  for (const CLI::App* c : commands(program))
    text += "    " + in_quotes(zsh_text(c->get_name()) + ":" + c->get_description()) + "\n";
  text += "  )\n  _arguments -C" + zsh_parameters(program) +
          " \\\n            '1:command:->command' '*::argument:->arguments'\n"
          "  case $state in\n    command) _describe command commands ;;\n    arguments)\n      case "
          "$words[1] in\n";
  for (const CLI::App* c : commands(program))
    text += "        " + c->get_name() + ")\n          _arguments" + zsh_parameters(*c) + " ;;\n";
  return text + std::string(zsh_end);
}

// ---- fish

std::string fish_text(const std::string& text) {
  std::string doubled;
  for (const char c : text) doubled += c == '\\' ? std::string("\\\\") : std::string(1, c);
  return in_quotes(doubled);
}

std::string fish_value(const Parameter& p) {
  if (!p.choices.empty()) return " -a " + in_quotes(joined(p.choices));
  if (p.value == "CASE") return " -k -a '(__fish_complete_suffix .toml)'";
  if (p.value == "DIR") return " -a '(__fish_complete_directories)'";
  return "";
}

std::string fish_parameters(const CLI::App& command, const std::string& where) {
  std::string text;
  for (const Parameter& p : parameters(command)) {
    const std::string values = fish_value(p);
    if (p.is_argument() && values.empty()) continue;
    text += "complete -c vbond -n " + in_quotes(where);
    for (const std::string& name : p.names)
      text += name[1] == '-' ? " -l " + name.substr(2) : " -s " + name.substr(1);
    if (!p.is_argument()) text += (p.value.empty() ? " -d " : " -x -d ") + fish_text(p.text);
    text += values + "\n";
  }
  return text;
}

std::string for_fish(const CLI::App& program) {
  std::string text =
      "# Completion of vbond in fish, written by: vbond completion fish\ncomplete -c vbond -f\n";
  text += fish_parameters(program, "__fish_use_subcommand");
  for (const CLI::App* c : commands(program)) {
    text += fmt::format("complete -c vbond -n __fish_use_subcommand -a {} -d {}\n", c->get_name(),
                        fish_text(c->get_description()));
    text += fish_parameters(*c, "__fish_seen_subcommand_from " + c->get_name());
  }
  return text;
}

}  // namespace

int completion(const CLI::App& program, const std::string& shell) {
  say(shell == "bash" ? for_bash(program) : shell == "zsh" ? for_zsh(program) : for_fish(program));
  return done;
}

}  // namespace vbond::app
