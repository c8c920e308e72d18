#pragma once
#include <cassert>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <utility>
#include <vector>

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

/// One value per particle or per bond, reached only with the index of that kind.
template <class IdType, class T>
class Column {
 public:
  Column() = default;
  explicit Column(std::size_t size, const T& value = T{}) : values_(size, value) {}
  Column(std::initializer_list<T> values) : values_(values) {}
  explicit Column(std::vector<T> values) : values_(std::move(values)) {}

  T& operator[](IdType id) {
    assert(id.value < values_.size());
    return values_[id.value];
  }
  const T& operator[](IdType id) const {
    assert(id.value < values_.size());
    return values_[id.value];
  }

  std::size_t size() const { return values_.size(); }
  bool empty() const { return values_.empty(); }
  IdRange<IdType> ids() const { return IdRange<IdType>(size()); }
  void reserve(std::size_t size) { values_.reserve(size); }
  void push_back(const T& value) { values_.push_back(value); }
  void assign(std::size_t size, const T& value) { values_.assign(size, value); }
  void resize(std::size_t size, const T& value = T{}) { values_.resize(size, value); }

  auto begin() { return values_.begin(); }
  auto end() { return values_.end(); }
  auto begin() const { return values_.begin(); }
  auto end() const { return values_.end(); }
  T* data() { return values_.data(); }
  const T* data() const { return values_.data(); }
  const std::vector<T>& values() const { return values_; }
  friend bool operator==(const Column&, const Column&) = default;

 private:
  std::vector<T> values_;
};

template <class T>
using PerParticle = Column<ParticleId, T>;
template <class T>
using PerBond = Column<BondId, T>;

}  // namespace vbond
