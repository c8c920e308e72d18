#pragma once
#include <map>
#include <set>
#include <string>
#include <vector>

#include "vbond/case/key_table.hpp"

namespace vbond::keys {

/// Reads one table of a file into a struct, and collects what is wrong in it.
class Reader final : public Table {
 public:
  /// `path` names the table in messages, as in `stage[0].stop`; `header` is where it begins.
  Reader(const NodeTable& members, ReadContext& context, std::string path, SourcePlace header);

  /// Reports the keys that nobody asked for, and those that are missing. Call it last.
  void finish();

  std::size_t exactly_one(const std::vector<std::string>& names, std::size_t current) override;
  void check(bool good, const std::vector<std::string>& names, const std::string& rule,
             const std::string& way_out) override;
  void refuse_key(const std::string& name, const std::string& rule, const std::string& way_out) override;
  void locate(SourcePlace& place, const std::string& key) const override;
  bool is_given(const char* name) const override { return find(name) != nullptr; }
  void set_units(UnitSystem units) override {
    in_.units = units;
    in_.any_units = failed_.count("system") > 0;
  }
  bool reading() const override { return true; }

 protected:
  void on_key(const KeyInfo& key, Value& value) override;
  void on_table(const KeyInfo& key, bool there, const Members& members) override;
  void on_tables(const KeyInfo& key, Structs& items) override;
  void on_named_tables(const KeyInfo& key, Structs& items) override;
  bool enter(bool active, const std::string& condition) override;
  void leave() override;

 private:
  const Member* find(const std::string& name) const;
  bool is_meant_for_absent(const Member& m);
  void report_unknown(const Member& m, const std::vector<std::string>& names, bool shown);
  const Member* take(const KeyInfo& key, const std::string& way_out);
  bool is_skipping() const { return inactive_ > 0; }
  std::string path_of(const std::string& name) const { return path_.empty() ? name : path_ + "." + name; }
  SourcePlace place_of(const Member& m) const { return in_.place(m.line, m.column); }
  bool read_struct(const Node& n, const std::string& path, const Members& members);

  const NodeTable& members_;
  ReadContext& in_;
  std::string path_;
  SourcePlace header_;
  std::vector<std::pair<bool, std::string>> conditions_;  ///< those we are inside of: active, text
  int inactive_ = 0;                                      ///< how many of them do not hold
  std::set<std::string> known_;                           ///< keys that are right here
  std::set<std::string> refused_;                         ///< keys told by refuse_key
  std::map<std::string, std::string> elsewhere_;          ///< keys that need a condition: which
  std::set<std::string> failed_;                          ///< keys that could not be read or are missing
  std::map<std::string, Problem> missing_;                ///< what finish() will report of these
  std::vector<std::pair<std::vector<std::string>, Problem>> absent_;  ///< of these keys none is there
  bool unsure_ = false;  ///< a choice could not be read: which keys are right is not known
};

}  // namespace vbond::keys
