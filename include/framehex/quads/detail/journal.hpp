// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"

#include <cstddef>
#include <utility>
#include <vector>

namespace framehex::detail {

/// An array whose changes since a mark can be taken back.
template <class T>
class JournaledArray {
public:
  JournaledArray() = default;
  explicit JournaledArray(std::vector<T> values) : values_(std::move(values)) {}

  std::size_t size() const { return values_.size(); }
  const T& operator[](std::size_t i) const { return values_[i]; }
  const std::vector<T>& values() const { return values_; }

  void set(std::size_t i, const T& value) {
    if (recording_) old_.emplace_back(i, values_[i]);
    values_[i] = value;
  }
  void push_back(const T& value) { values_.push_back(value); }

  void mark() {
    recording_ = true;
    old_.clear();
    size_ = values_.size();
  }
  void keep() { recording_ = false; }
  void take_back() {
    for (std::size_t k = old_.size(); k-- > 0;) values_[old_[k].first] = old_[k].second;
    values_.resize(size_);
    recording_ = false;
  }

private:
  std::vector<T> values_;
  std::vector<std::pair<std::size_t, T>> old_;
  std::size_t size_ = 0;
  bool recording_ = false;
};

}  // namespace framehex::detail
