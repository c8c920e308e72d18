#pragma once
#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "vbond/case/value.hpp"
#include "vbond/case/value_lists.hpp"

/// The one table of keys. A function `describe(Table&, T&)` names each key of a struct once, with its codec,
/// whether it is needed, and what it means; the three kinds of Table read, write and document the struct with
/// it.
namespace vbond::keys {

class Table;

/// Whether a key must stand in the file.
struct Need {
  enum class When : unsigned char { never, always, in_si } when = When::never;
  const char* default_text = "";  ///< for the reference, where the default is not a fixed value
};
inline constexpr Need optional{};
inline constexpr Need required{Need::When::always};
/// The default is the unit of the reduced system, which says nothing in SI.
inline constexpr Need required_in_si{Need::When::in_si};
constexpr Need default_is(const char* text) {
  return {Need::When::never, text};
}

struct KeyInfo {
  const char* name;
  Need need;
  const char* doc;  ///< one line
};

/// A value of any type with its codec, as the three kinds of Table see it.
class Value {
 public:
  virtual bool read(const Node& n, ReadContext& in, const std::string& path) = 0;
  virtual void set_place(const SourcePlace& place) = 0;  ///< of a default
  virtual std::string write() const = 0;                 ///< empty: not there
  virtual std::string type() const = 0;
  virtual std::string schema() const = 0;  ///< JSON
  virtual std::string example(UnitSystem u) const = 0;
  virtual bool is_choice() const = 0;         ///< other keys may depend on it
  virtual std::filesystem::path* file() = 0;  ///< a file that the case reads; nullptr: the value is none

 protected:
  ~Value() = default;
};

template <class T, class Codec>
class BoundValue final : public Value {
 public:
  BoundValue(T& value, const Codec& codec) : value_(value), codec_(codec) {}
  bool read(const Node& n, ReadContext& in, const std::string& path) override {
    return read_value(codec_, n, in, path, value_);
  }
  void set_place(const SourcePlace& place) override {
    if constexpr (requires { value_.place; }) value_.place = place;
  }
  std::string write() const override { return write_value(codec_, value_); }
  std::string type() const override { return codec_.type(); }
  std::string schema() const override { return codec_.schema(); }
  std::string example(UnitSystem u) const override { return codec_.example(u); }
  bool is_choice() const override {
    return requires {
      codec_.values;
    };
  }
  std::filesystem::path* file() override {
    if constexpr (!std::is_same_v<Codec, FileCodec>)
      return nullptr;
    else if constexpr (requires { value_.place; })
      return &value_.value;
    else if constexpr (requires { value_->place; })  // that may be absent
      return value_ ? &value_->value : nullptr;
    else
      return &value_;
  }

 private:
  T& value_;
  const Codec& codec_;
};

/// A list of structs, each with its own table.
class Structs {
 public:
  virtual std::size_t size() const = 0;
  virtual void append(const std::string& name) = 0;  ///< the name, if tables are named
  virtual std::string name(std::size_t k) const = 0;
  virtual void describe_one(Table& t, std::size_t k) = 0;
  virtual void describe_any(Table& t) = 0;  ///< a fresh one

 protected:
  ~Structs() = default;
};

using Members = std::function<void(Table&)>;

/// One table of the case file while it is read, written or documented.
class Table {
 public:
  Table() = default;
  Table(const Table&) = delete;
  Table& operator=(const Table&) = delete;

  /// A key with a plain value.
  template <class T, class Codec>
  void key(const char* name, T& value, const Codec& codec, const Need& need, const char* doc) {
    BoundValue<T, Codec> bound(value, codec);
    on_key({name, need, doc}, bound);
  }

  /// A table inside this one; `there` says whether it is to be written.
  void table(const char* name, const Need& need, const char* doc, const Members& members, bool there = true) {
    on_table({name, need, doc}, there, members);
  }

  /// A table whose presence is the presence of the value.
  template <class T>
  void table(const char* name, std::optional<T>& value, const char* doc) {
    table(
        name, optional, doc, [&value](Table& t) { describe(t, value ? *value : value.emplace()); },
        value.has_value());
  }

  /// A list of tables.
  template <class T>
  void tables(const char* name, std::vector<T>& items, const Need& need, const char* doc) {
    tables(name, items, need, doc, [](Table& t, T& item) { describe(t, item); });
  }

  /// The same, where what a table may hold depends on the table around it: described by describe_item(t,
  /// item).
  template <class T, class F>
  void tables(const char* name, std::vector<T>& items, const Need& need, const char* doc, F describe_item) {
    BoundStructs<T> bound(items, describe_item);
    on_tables({name, need, doc}, bound);
  }

  /// Tables whose last name is the `name` of a struct: [name.NAME].
  template <class T>
  void named_tables(const char* name, std::vector<T>& items, const char* doc) {
    BoundStructs<T> bound(items, [](Table& t, T& item) { describe(t, item); });
    on_named_tables({name, optional, doc}, bound);
  }

  /// Keys that belong to one choice only; `condition` says which, as in `kind = "helix"`.
  template <class F>
  void when(bool active, const std::string& condition, F&& keys) {
    if (enter(active, condition)) keys();
    leave();
  }

  /// Exactly one of the keys must stand here: the index of the one that does.
  virtual std::size_t exactly_one(const std::vector<std::string>& names, std::size_t current) = 0;

  /// A rule among the keys `names` of this table, looked at when all that stand there could be read.
  virtual void check(bool, const std::vector<std::string>& /*names*/, const std::string& /*rule*/,
                     const std::string& /*way_out*/) {}

  /// A key that people look for here and that does not exist: reported with these words where it stands.
  virtual void refuse_key(const std::string& /*name*/, const std::string& /*rule*/,
                          const std::string& /*way_out*/) {}

  /// Where this table, or a key in it, stands in the file; left alone unless a file is read.
  virtual void locate(SourcePlace&, const std::string& /*key*/ = {}) const {}
  virtual bool is_given(const char* /*name*/) const { return false; }
  virtual void set_units(UnitSystem) {}
  virtual bool reading() const { return false; }

  /// One struct of a variant for each name in turn, those that are not chosen as fresh objects.
  template <class Variant>
  void alternatives(Variant& v, std::size_t chosen, const std::vector<std::string>& conditions) {
    alternatives(v, chosen, conditions, [](Table& t, auto& item) { describe(t, item); });
  }

  /// The same, where what they may hold depends on the table around them: described by describe_item(t,
  /// item).
  template <class Variant, class F>
  void alternatives(Variant& v, std::size_t chosen, const std::vector<std::string>& conditions,
                    F describe_item) {
    alternatives(v, chosen, conditions, describe_item,
                 std::make_index_sequence<std::variant_size_v<Variant>>{});
  }

 protected:
  ~Table() = default;
  virtual void on_key(const KeyInfo& key, Value& value) = 0;
  virtual void on_table(const KeyInfo& key, bool there, const Members& members) = 0;
  virtual void on_tables(const KeyInfo& key, Structs& items) = 0;
  virtual void on_named_tables(const KeyInfo& key, Structs& items) = 0;
  virtual bool enter(bool active, const std::string& condition) = 0;
  virtual void leave() = 0;

 private:
  template <class T>
  class BoundStructs final : public Structs {
   public:
    using Describe = std::function<void(Table&, T&)>;
    BoundStructs(std::vector<T>& items, Describe describe_item)
        : items_(items), describe_(std::move(describe_item)) {}
    std::size_t size() const override { return items_.size(); }
    void append(const std::string& name) override {
      items_.emplace_back();
      if constexpr (requires(T & t) { t.name; }) {
        if (!name.empty()) items_.back().name = name;
      }
    }
    std::string name(std::size_t k) const override {
      if constexpr (requires(T & t) { t.name; })
        return items_[k].name;
      else
        return {};
    }
    void describe_one(Table& t, std::size_t k) override { describe_(t, items_[k]); }
    void describe_any(Table& t) override {
      T fresh{};
      describe_(t, fresh);
    }

   private:
    std::vector<T>& items_;
    Describe describe_;
  };

  template <class Variant, class F, std::size_t... I>
  void alternatives(Variant& v, std::size_t chosen, const std::vector<std::string>& conditions,
                    F describe_item, std::index_sequence<I...>) {
    (alternative<I>(v, chosen, conditions[I], describe_item), ...);
  }
  template <std::size_t I, class Variant, class F>
  void alternative(Variant& v, std::size_t chosen, const std::string& condition, F describe_item) {
    if (I == chosen && v.index() != I) v.template emplace<I>();
    when(I == chosen, condition, [&] {
      if (v.index() == I) {
        describe_item(*this, std::get<I>(v));
      } else {
        std::variant_alternative_t<I, Variant> fresh{};
        describe_item(*this, fresh);
      }
    });
  }
};

}  // namespace vbond::keys
