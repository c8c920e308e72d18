#include <nlohmann/json.hpp>

#include "vbond/case/keys.hpp"
#include "vbond/case/read.hpp"

namespace vbond::keys {
namespace {

using Json = nlohmann::ordered_json;

/// Makes a JSON Schema of a struct's keys. It knows which keys there are, what their values look like, and
/// which are needed in any case; which choice they belong to is in their descriptions only. It uses what
/// means the same in drafts 4 to 7, since editors differ.
class SchemaMaker final : public Table {
 public:
  std::size_t exactly_one(const std::vector<std::string>& names, std::size_t current) override {
    Json one_of = Json::array();
    for (const std::string& name : names) one_of.push_back({{"required", {name}}});
    if (conditions_.empty()) choices_.push_back({{"oneOf", one_of}});
    return current;
  }

  Json object() const {
    Json o{{"type", "object"}, {"additionalProperties", false}};
    for (const auto& [name, schemas] : properties_.items())
      o["properties"][name] = schemas.size() == 1 ? schemas[0] : Json{{"anyOf", schemas}};
    if (!required_.empty()) o["required"] = required_;
    if (!choices_.empty()) o["allOf"] = choices_;
    return o;
  }

 protected:
  void on_key(const KeyInfo& key, Value& value) override {
    Json schema = Json::parse(value.schema());
    const std::string written = value.write();
    const char* in_words = key.need.default_text;
    if (key.need.when == Need::When::never && (*in_words != '\0' || !written.empty()))
      add(key, std::move(schema), std::string(". Default: ") + (*in_words != '\0' ? in_words : written));
    else
      add(key, std::move(schema), "");
  }
  void on_table(const KeyInfo& key, bool, const Members& members) override {
    SchemaMaker inner;
    members(inner);
    add(key, inner.object(), "");
  }
  void on_tables(const KeyInfo& key, Structs& items) override {
    SchemaMaker inner;
    items.describe_any(inner);
    add(key, {{"type", "array"}, {"items", inner.object()}, {"minItems", is_needed(key) ? 1 : 0}}, "");
  }
  void on_named_tables(const KeyInfo& key, Structs& items) override {
    SchemaMaker inner;
    items.describe_any(inner);
    add(key, {{"type", "object"}, {"additionalProperties", inner.object()}}, "");
  }
  bool enter(bool, const std::string& condition) override {
    conditions_.push_back(condition);
    return true;
  }
  void leave() override { conditions_.pop_back(); }

 private:
  static bool is_needed(const KeyInfo& key) { return key.need.when == Need::When::always; }

  /// A key that several choices have may look different in each.
  void add(const KeyInfo& key, Json schema, const std::string& more) {
    std::string text = key.doc + more;
    if (!conditions_.empty()) text += ". With " + conditions_.back();
    schema["description"] = text;
    properties_[key.name].push_back(std::move(schema));
    if (is_needed(key) && conditions_.empty()) required_.push_back(key.name);
  }

  Json properties_ = Json::object(), required_ = Json::array(), choices_ = Json::array();
  std::vector<std::string> conditions_;
};

}  // namespace
}  // namespace vbond::keys

namespace vbond {

std::string case_schema() {
  Case fresh;
  keys::SchemaMaker maker;
  keys::describe(maker, fresh);
  keys::Json schema{{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", "Case file of vbond"}};
  schema.update(maker.object());
  return schema.dump(2) + '\n';
}

}  // namespace vbond
