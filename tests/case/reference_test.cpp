#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "vbond/case/read.hpp"

namespace vbond {
namespace {

// The page of all keys comes from the table that checks them; the message says how to write it anew.
TEST(KeyReference, PageIsTheGeneratedOne) {
  const std::string page = std::string(VBOND_DOCS) + "/case-reference.md";
  if (std::getenv("VBOND_UPDATE_REFERENCE") != nullptr)
    std::ofstream(page, std::ios::binary) << key_reference();
  std::ifstream stream(page, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  EXPECT_TRUE(text.str() == key_reference())
      << page << " is stale; to write it anew:\n"
      << "  VBOND_UPDATE_REFERENCE=1 build/dev/case_test --gtest_filter='KeyReference.*'";
}

TEST(KeyReference, NamesEveryTable) {
  const std::string text = key_reference();
  for (const char* table : {"[units]", "[[specimen]]", "[groups.NAME]", "[[bonds]]", "[contact]",
                            "[[velocities]]", "[time]", "[[stage]]", "[output]", "[watch]"})
    EXPECT_NE(text.find("## `" + std::string(table) + "`"), std::string::npos) << table;
}

/// What a schema says of a key in it, of each of its alternatives; empty if there is none.
std::vector<nlohmann::json> schemas_of(const nlohmann::json& table, const std::string& key) {
  std::vector<nlohmann::json> found;
  if (!table.contains("properties") || !table["properties"].contains(key)) return found;
  const nlohmann::json& schema = table["properties"][key];
  if (schema.contains("anyOf") && !schema.contains("description"))
    return schema["anyOf"].get<std::vector<nlohmann::json>>();
  return {schema};
}

/// Follows a path, through the elements of lists and through tables with names.
bool has_path(const nlohmann::json& table, const std::string& path) {
  const std::size_t dot = path.find('.');
  for (const nlohmann::json& schema : schemas_of(table, path.substr(0, dot))) {
    if (dot == std::string::npos) return true;
    const bool is_list = schema.contains("items"),
               is_named = !is_list && schema.value("additionalProperties", nlohmann::json()).is_object();
    const nlohmann::json& inner = is_list    ? schema["items"]
                                  : is_named ? schema["additionalProperties"]
                                             : schema;
    if (has_path(inner, path.substr(dot + 1))) return true;
  }
  return false;
}

TEST(CaseSchema, HasEveryKeyOfTheTable) {
  const nlohmann::json schema = nlohmann::json::parse(case_schema());
  EXPECT_EQ(schema["$schema"], "http://json-schema.org/draft-07/schema#");
  EXPECT_EQ(schema["required"], (nlohmann::json{"specimen", "stage"}));
  const std::vector<KeyEntry> keys = list_keys();
  EXPECT_GT(keys.size(), 150U);
  for (const KeyEntry& key : keys) EXPECT_TRUE(has_path(schema, key.path)) << key.path;
  EXPECT_FALSE(has_path(schema, "specimen.colour"));
  EXPECT_FALSE(has_path(schema, "stage.supports.colour"));
  EXPECT_TRUE(has_path(schema, "groups.box.min"));
}

TEST(KeyList, HasEveryRowOfThePage) {
  std::set<std::string> of_page, listed;
  std::istringstream page(key_reference());
  for (std::string line; std::getline(page, line);)
    if (line.rfind("| `", 0) == 0) {
      std::string path = line.substr(3, line.find('`', 3) - 3);
      for (std::size_t at; (at = path.find("[]")) != std::string::npos;) path.erase(at, 2);
      of_page.insert(path);
    }
  for (const KeyEntry& key : list_keys())  // the page has a section for each table, and paths inside of it
    listed.insert(key.path.substr(key.path.find('.') + 1));
  for (const std::string& path : of_page) EXPECT_EQ(listed.count(path), 1U) << path;
  EXPECT_GT(of_page.size(), 130U);
}

}  // namespace
}  // namespace vbond
