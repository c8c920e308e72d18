#pragma once
#include <cassert>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "vbond/core/id_set.hpp"

namespace vbond {

/// An index of one kind of thing; indices of different kinds do not mix.
template <class Tag>
struct Id {
  std::uint32_t value = 0;

  constexpr Id() = default;
  constexpr explicit Id(std::size_t v) : value(static_cast<std::uint32_t>(v)) {}
  friend constexpr auto operator<=>(const Id&, const Id&) = default;
};

using ParticleId = Id<struct ParticleTag>;
using BondId = Id<struct BondTag>;

/// All indices 0 .. size-1 of one kind, for range-for.
template <class IdType>
class IdRange {
 public:
  struct Iterator {
    std::size_t at;
    IdType operator*() const { return IdType{at}; }
    Iterator& operator++() { return ++at, *this; }
    bool operator!=(const Iterator& o) const { return at != o.at; }
  };
  constexpr explicit IdRange(std::size_t size) : size_(size) {}
  Iterator begin() const { return {0}; }
  Iterator end() const { return {size_}; }

 private:
  std::size_t size_;
};

/// Whether columns of this kind may hold the values of some ids alone: of the particles that a part of a body
/// knows.
template <class IdType>
inline constexpr bool may_hold_some = std::is_same_v<IdType, ParticleId>;

/// One value per particle or per bond, reached only with the index of that kind. A column may hold the values
/// of some ids alone, which keep their numbers: size() and ids() are still those of the whole, and whoever
/// asks for another value gets std::logic_error. Iterators and values() are of those that it holds.
template <class IdType, class T>
class Column {
 public:
  using Some = std::shared_ptr<const IdSet<IdType>>;  ///< null: all

  Column() = default;
  explicit Column(std::size_t size, const T& value = T{}) : values_(size, value) {}
  Column(std::initializer_list<T> values) : values_(values) {}
  explicit Column(std::vector<T> values) : values_(std::move(values)) {}
  /// This value for all ids that another column holds.
  template <class U>
  static Column alike(const Column<IdType, U>& other, const T& value = T{}) requires may_hold_some<IdType> {
    Column column(other.values().size(), value);
    column.some_ = other.held();
    return column;
  }

  T& operator[](IdType id) { return values_[place(id)]; }
  const T& operator[](IdType id) const { return values_[place(id)]; }

  std::size_t size() const { return holds_all() ? values_.size() : some_->whole(); }
  bool empty() const { return size() == 0; }
  IdRange<IdType> ids() const { return IdRange<IdType>(size()); }
  void reserve(std::size_t size) { values_.reserve(size); }
  void push_back(const T& value) {
    assert(holds_all());
    values_.push_back(value);
  }
  /// Where the size stays as it is, for the ids that it holds; else for all.
  void assign(std::size_t size, const T& value) {
    if (size != this->size()) some_ = {};
    values_.assign(holds_all() ? size : values_.size(), value);
  }
  void resize(std::size_t size, const T& value = T{}) {
    assert(holds_all());
    values_.resize(size, value);
  }

  bool holds_all() const {
    if constexpr (may_hold_some<IdType>) return some_ == nullptr;
    return true;
  }
  bool holds(IdType id) const { return holds_all() ? id.value < values_.size() : some_->has(id); }
  /// Holds these from now on, of as large a whole, or all. Those that it has not held so far are as new.
  void hold(Some some) requires may_hold_some<IdType> {
    if (some == some_ || (some && some_ && *some == *some_)) return;
    Column now;
    now.some_ = std::move(some);
    const std::size_t whole = size();
    now.values_.resize(now.some_ ? now.some_->size() : whole);
    const auto take = [&](std::size_t from, std::size_t to) { now.values_[to] = std::move(values_[from]); };
    std::size_t k = 0;
    if (now.some_ && some_)
      some_->for_each_common(*now.some_, take);
    else if (now.some_)
      now.some_->for_each([&](IdType id) {
        if (holds(id)) take(id.value, k);
        ++k;
      });
    else
      some_->for_each([&](IdType id) { take(k++, id.value); });
    *this = std::move(now);
  }
  const Some& held() const requires may_hold_some<IdType> { return some_; }

  auto begin() { return values_.begin(); }
  auto end() { return values_.end(); }
  auto begin() const { return values_.begin(); }
  auto end() const { return values_.end(); }
  T* data() { return values_.data(); }
  const T* data() const { return values_.data(); }
  const std::vector<T>& values() const { return values_; }
  friend bool operator==(const Column& a, const Column& b) {
    if (a.holds_all() != b.holds_all()) return false;
    return a.values_ == b.values_ && (a.holds_all() || *a.some_ == *b.some_);
  }

 private:
  struct All {
    const IdSet<IdType>* operator->() const { return nullptr; }
    const IdSet<IdType>& operator*() const { return *operator->(); }
  };

  std::size_t place(IdType id) const {
    if constexpr (may_hold_some<IdType>)
      if (some_ != nullptr) return some_->place(id);
    assert(id.value < values_.size());
    return id.value;
  }

  std::vector<T> values_;
  [[no_unique_address]] std::conditional_t<may_hold_some<IdType>, Some, All> some_;
};

template <class T>
using PerParticle = Column<ParticleId, T>;
template <class T>
using PerBond = Column<BondId, T>;

}  // namespace vbond
