#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace vbond::keys {

struct Node;
struct Member;
struct Date {};  ///< dates and times of TOML, which no key takes
using NodeList = std::vector<Node>;
using NodeTable = std::vector<Member>;  ///< in the order of the file

/// A value of a TOML file. Keeps the TOML library out of every other file of this layer.
struct Node {
  std::variant<bool, std::int64_t, double, std::string, Date, NodeList, NodeTable> value;
  std::uint32_t line = 0, column = 0;  ///< of its key, its header, or itself if it stands in a list
};

struct Member {
  std::string key;
  std::uint32_t line = 0, column = 0;
  Node value;
};

/// The tree of a TOML text. Throws CaseError if the text is no TOML, is over 16 MiB or nested over 32 deep.
NodeTable parse_toml(std::string_view text, const std::string& file);

/// "a string", "a table", ...
const char* kind_name(const Node& n);

/// The value as TOML, cut after about 60 characters: for messages.
std::string short_text(const Node& n);

/// A TOML string literal.
std::string toml_string(std::string_view text);

/// The shortest TOML float that reads back as the same double.
std::string number_text(double x);

}  // namespace vbond::keys
