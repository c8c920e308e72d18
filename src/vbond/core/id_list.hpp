#pragma once
#include <algorithm>
#include <compare>
#include <cstddef>
#include <initializer_list>
#include <iterator>
#include <utility>
#include <vector>

namespace vbond {

/// Ids in an order, as a vector of them that cannot be changed but at its end. Consecutive ones take no
/// memory each: of all particles, or those of a specimen, the first and their number are kept.
template <class IdType>
class IdList {
 public:
  class Iterator {
   public:
    using iterator_category = std::random_access_iterator_tag;
    using value_type = IdType;
    using difference_type = std::ptrdiff_t;
    using pointer = const IdType*;
    using reference = IdType;

    Iterator() = default;
    Iterator(const IdList& of, difference_type k) : of_(&of), k_(k) {}
    IdType operator*() const { return (*of_)[static_cast<std::size_t>(k_)]; }
    IdType operator[](difference_type n) const { return *(*this + n); }
    Iterator& operator+=(difference_type n) { return k_ += n, *this; }
    Iterator& operator-=(difference_type n) { return k_ -= n, *this; }
    Iterator& operator++() { return *this += 1; }
    Iterator& operator--() { return *this -= 1; }
    Iterator operator++(int) { return std::exchange(*this, *this + 1); }
    Iterator operator--(int) { return std::exchange(*this, *this - 1); }
    friend Iterator operator+(Iterator a, difference_type n) { return a += n; }
    friend Iterator operator+(difference_type n, Iterator a) { return a += n; }
    friend Iterator operator-(Iterator a, difference_type n) { return a -= n; }
    friend difference_type operator-(const Iterator& a, const Iterator& b) { return a.k_ - b.k_; }
    friend bool operator==(const Iterator& a, const Iterator& b) { return a.k_ == b.k_; }
    friend auto operator<=>(const Iterator& a, const Iterator& b) { return a.k_ <=> b.k_; }

   private:
    const IdList* of_ = nullptr;
    difference_type k_ = 0;
  };

  IdList() = default;
  IdList(const std::vector<IdType>& ids) {
    for (const IdType id : ids) push_back(id);
  }
  IdList(std::initializer_list<IdType> ids) : IdList(std::vector<IdType>(ids)) {}
  /// first, first + 1, ...: so many.
  static IdList consecutive(IdType first, std::size_t size) {
    IdList list;
    list.first_ = first, list.size_ = size;
    return list;
  }
  operator std::vector<IdType>() const { return {begin(), end()}; }

  void push_back(IdType id) {
    if (size_ == 0) first_ = id;
    const bool goes_on = others_.empty() && id.value == first_.value + size_;
    if (others_.empty() && !goes_on) others_ = static_cast<std::vector<IdType>>(*this);
    if (!goes_on) others_.push_back(id);
    ++size_;
  }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  IdType operator[](std::size_t k) const { return others_.empty() ? IdType{first_.value + k} : others_[k]; }
  IdType front() const { return (*this)[0]; }
  IdType back() const { return (*this)[size_ - 1]; }
  Iterator begin() const { return {*this, 0}; }
  Iterator end() const { return {*this, static_cast<std::ptrdiff_t>(size_)}; }
  std::size_t bytes() const { return others_.capacity() * sizeof(IdType); }

  friend bool operator==(const IdList& a, const IdList& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end());
  }

 private:
  IdType first_;
  std::size_t size_ = 0;
  std::vector<IdType> others_;  // all of them, unless they are consecutive
};

}  // namespace vbond
