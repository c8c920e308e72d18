#pragma once
#include <memory>

namespace vbond {

/// A value that few objects of a kind have: the others have room for a pointer alone. Copied with its object.
template <class T>
class Boxed {
 public:
  Boxed() = default;
  Boxed(const Boxed& o) : value_(o.value_ ? std::make_unique<T>(*o.value_) : nullptr) {}
  Boxed(Boxed&&) noexcept = default;
  Boxed& operator=(const Boxed& o) {
    if (!o.value_)
      value_.reset();
    else if (value_)
      *value_ = *o.value_;
    else
      value_ = std::make_unique<T>(*o.value_);
    return *this;
  }
  Boxed& operator=(Boxed&&) noexcept = default;
  ~Boxed() = default;

  explicit operator bool() const { return value_ != nullptr; }
  const T& operator*() const { return *value_; }
  void set(const T& value) { *this = Boxed(value); }
  void reset() { value_.reset(); }

  friend bool operator==(const Boxed& a, const Boxed& b) {
    return a.value_ && b.value_ ? *a.value_ == *b.value_ : a.value_ == b.value_;
  }

 private:
  explicit Boxed(const T& value) : value_(std::make_unique<T>(value)) {}
  std::unique_ptr<T> value_;
};

/// Sets a member of what few objects have; where all is as new there is nothing in the box.
template <class Few, class Value>
void set_of_few(Boxed<Few>& box, Value Few::*member, const Value& value) {
  Few few = box ? *box : Few{};
  few.*member = value;
  if (few == Few{})
    box.reset();
  else
    box.set(few);
}

}  // namespace vbond
