// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"

#include <utility>
#include <vector>

namespace framehex::detail {

/// Binary heap over the numbers 0..n-1 with keys that may rise; the largest key first, the smaller number among equals.
class IndexedMaxHeap {
public:
  explicit IndexedMaxHeap(std::vector<double> keys)
      : keys_(std::move(keys)), heap_(keys_.size()), place_(keys_.size()) {
    for (std::size_t i = 0; i < heap_.size(); ++i) heap_[i] = place_[i] = static_cast<index_t>(i);
    for (std::size_t i = heap_.size() / 2; i-- > 0;) sink(i);
  }

  bool empty() const { return heap_.empty(); }
  bool contains(index_t v) const { return place_[v] != no_index; }

  index_t pop() {
    const index_t top = heap_.front();
    erase(top);
    return top;
  }

  void erase(index_t v) {
    const std::size_t hole = place_[v];
    place_[v] = no_index;
    const index_t last = heap_.back();
    heap_.pop_back();
    if (last == v) return;
    put(hole, last);
    swim(hole);
    sink(place_[last]);
  }

  /// @pre the new key is not smaller than the old.
  void raise(index_t v, double key) {
    keys_[v] = key;
    swim(place_[v]);
  }

private:
  bool before(index_t u, index_t v) const { return keys_[u] != keys_[v] ? keys_[u] > keys_[v] : u < v; }
  void put(std::size_t i, index_t v) {
    heap_[i] = v;
    place_[v] = static_cast<index_t>(i);
  }

  void swim(std::size_t i) {
    const index_t v = heap_[i];
    for (; i > 0 && before(v, heap_[(i - 1) / 2]); i = (i - 1) / 2) put(i, heap_[(i - 1) / 2]);
    put(i, v);
  }

  void sink(std::size_t i) {
    const index_t v = heap_[i];
    for (;;) {
      std::size_t child = 2 * i + 1;
      if (child >= heap_.size()) break;
      if (child + 1 < heap_.size() && before(heap_[child + 1], heap_[child])) ++child;
      if (!before(heap_[child], v)) break;
      put(i, heap_[child]);
      i = child;
    }
    put(i, v);
  }

  std::vector<double> keys_;
  std::vector<index_t> heap_, place_;
};

}  // namespace framehex::detail
