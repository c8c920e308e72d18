#include "vbond/case/keys.hpp"
#include "vbond/case/read.hpp"

namespace vbond::keys {
namespace {

/// Collects the values of a struct that are names of files.
class FileFinder final : public Table {
 public:
  std::vector<std::filesystem::path*> files;

  std::size_t exactly_one(const std::vector<std::string>&, std::size_t current) override { return current; }

 protected:
  void on_key(const KeyInfo&, Value& value) override {
    if (std::filesystem::path* file = value.file()) files.push_back(file);
  }
  void on_table(const KeyInfo&, bool there, const Members& members) override {
    if (there) members(*this);
  }
  void on_tables(const KeyInfo&, Structs& items) override {
    for (std::size_t k = 0; k < items.size(); ++k) items.describe_one(*this, k);
  }
  void on_named_tables(const KeyInfo& key, Structs& items) override { on_tables(key, items); }
  bool enter(bool active, const std::string&) override { return active; }
  void leave() override {}
};

}  // namespace
}  // namespace vbond::keys

namespace vbond {

std::vector<std::filesystem::path*> files_of(Case& c) {
  keys::FileFinder finder;
  keys::describe(finder, c);
  return finder.files;
}

}  // namespace vbond
