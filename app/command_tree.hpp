#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace vbond::app {

/// What a reader, or a shell, is told of an option or an argument of a command.
struct Parameter {
  std::vector<std::string> names;    ///< "-o", "--output"; none: an argument
  std::string value;                 ///< "DIR", "TEXT"; empty: a flag, nothing follows
  std::string text;                  ///< what it means
  std::string unless_given;          ///< the value it has then; may be empty
  std::vector<std::string> choices;  ///< all values that there are; empty: any
  bool required = false;
  bool repeats = false;

  bool is_argument() const { return names.empty(); }
};

/// Of one command, or of the program before it: arguments in their order, and options.
std::vector<Parameter> parameters(const CLI::App& command);
/// In the order of the help, without those that it hides.
std::vector<const CLI::App*> commands(const CLI::App& program);
std::vector<std::string> names(const std::vector<const CLI::App*>& commands);

/// Prints a script for bash, zsh or fish by which the shell completes commands, options and files.
int completion(const CLI::App& program, const std::string& shell);
/// Prints the manual page of a command, or with an empty text that of the program, as man reads it.
int manual(const CLI::App& program, const std::string& command);
/// Writes all of them into a folder: vbond.1, vbond-run.1 ...
int write_manual(const CLI::App& program, const std::filesystem::path& folder);

}  // namespace vbond::app
