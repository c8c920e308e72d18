#pragma once
#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace vbond {

/// Some of the ids 0 .. whole - 1, and how many of them come before each: a quarter of a byte for each id of
/// the whole.
template <class IdType>
class IdSet {
 public:
  /// some: in any order, and any number of times.
  IdSet(std::size_t whole, const std::vector<IdType>& some)
      : IdSet(of(whole, [&some](const auto& add) {
          for (const IdType id : some) add(id);
        })) {}
  /// Those with which for_some calls the function that it gets, likewise.
  template <class ForSome>
  static IdSet of(std::size_t whole, const ForSome& for_some) {
    IdSet set(whole);
    for_some([&set](IdType id) { set.words_[id.value / 64].bits |= bit(id); });
    for (Word& w : set.words_) {
      w.before = static_cast<std::uint32_t>(set.size_);
      set.size_ += count(w.bits);
    }
    return set;
  }

  std::size_t whole() const { return whole_; }
  std::size_t size() const { return size_; }
  bool has(IdType id) const { return id.value < whole_ && (words_[id.value / 64].bits & bit(id)) != 0; }
  /// How many of them are lower than this one, which must be one of them: else std::logic_error.
  std::size_t place(IdType id) const {
    if (!has(id)) refuse(id);
    const Word& w = words_[id.value / 64];
    return w.before + count(w.bits & (bit(id) - 1));
  }
  /// Calls visit(place here, place there) for all that another set has too, in increasing order.
  template <class Visit>
  void for_each_common(const IdSet& other, Visit&& visit) const {
    for (std::size_t k = 0; k < std::min(words_.size(), other.words_.size()); ++k) {
      const std::uint64_t here = words_[k].bits, there = other.words_[k].bits;
      std::size_t place = words_[k].before, of_other = other.words_[k].before;
      for (std::uint64_t left = here | there; left != 0; left &= left - 1) {
        const std::uint64_t lowest = left & (~left + 1);
        const bool is_here = (here & lowest) != 0, is_there = (there & lowest) != 0;
        if (is_here && is_there) visit(place, of_other);
        place += is_here ? 1 : 0, of_other += is_there ? 1 : 0;
      }
    }
  }
  /// In increasing order.
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (std::size_t k = 0; k < words_.size(); ++k)
      for (std::uint64_t left = words_[k].bits; left != 0; left &= left - 1)
        visit(IdType{64 * k + static_cast<std::size_t>(std::countr_zero(left))});
  }
  friend bool operator==(const IdSet&, const IdSet&) = default;

 private:
  struct Word {
    std::uint64_t bits = 0;
    std::uint32_t before = 0;  // in the words below
    friend bool operator==(const Word&, const Word&) = default;
  };
  explicit IdSet(std::size_t whole) : words_((whole + 63) / 64), whole_(whole) {}
  /// std::popcount calls a function where a program is to run on any x86-64. Sums of 2, 4, 8 bits side by
  /// side.
  static std::size_t count(std::uint64_t bits) {
    bits -= (bits >> 1) & 0x5555555555555555u;
    bits = (bits & 0x3333333333333333u) + ((bits >> 2) & 0x3333333333333333u);
    bits = (bits + (bits >> 4)) & 0x0F0F0F0F0F0F0F0Fu;
    return static_cast<std::size_t>((bits * 0x0101010101010101u) >> 56);
  }
  static std::uint64_t bit(IdType id) { return std::uint64_t{1} << (id.value % 64); }
  [[noreturn]] void refuse(IdType id) const {
    throw std::logic_error("number " + std::to_string(id.value) + " is not among the " +
                           std::to_string(size_) + " of " + std::to_string(whole_) + " that are known here");
  }

  std::vector<Word> words_;
  std::size_t whole_, size_ = 0;
};

}  // namespace vbond
