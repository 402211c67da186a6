// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/parts/transport.hpp"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <thread>

namespace framehex::test {

/// Where ranks that are threads of one process meet. When one of them fails, so do the calls of the others.
class RankHub {
public:
  explicit RankHub(int n_ranks) : n_ranks_(n_ranks), inbox_(static_cast<std::size_t>(n_ranks)) {}

  int n_ranks() const { return n_ranks_; }

  std::vector<Parcel> exchange(int rank, std::vector<Parcel> parcels) {
    {
      const std::lock_guard lock(mutex_);
      for (Parcel& parcel : parcels) {
        n_bytes += parcel.bytes.size();
        inbox_.at(static_cast<std::size_t>(parcel.rank)).push_back({rank, std::move(parcel.bytes)});
      }
    }
    meet();
    std::vector<Parcel> received = std::move(inbox_[static_cast<std::size_t>(rank)]);
    inbox_[static_cast<std::size_t>(rank)].clear();
    std::sort(received.begin(), received.end(), [](const Parcel& a, const Parcel& b) { return a.rank < b.rank; });
    meet();
    return received;
  }

  template <class T, class Combine>
  void combine(std::vector<std::vector<T>>& all, int rank, std::span<T> values, Combine&& with) {
    {
      const std::lock_guard lock(mutex_);
      all.resize(static_cast<std::size_t>(n_ranks_));
      all[static_cast<std::size_t>(rank)].assign(values.begin(), values.end());
    }
    meet();
    for (std::size_t i = 0; i < values.size(); ++i) {
      T result = all[0].at(i);
      for (std::size_t r = 1; r < all.size(); ++r) result = with(result, all[r].at(i));
      values[i] = result;
    }
    meet();
  }

  void fail() {
    const std::lock_guard lock(mutex_);
    failed_ = true;
    wake_.notify_all();
  }

  std::vector<std::vector<std::int64_t>> counts;
  std::vector<std::vector<double>> numbers;
  std::size_t n_bytes = 0;

private:
  void meet() {
    std::unique_lock lock(mutex_);
    if (failed_) throw std::runtime_error("another rank has failed");
    const std::size_t turn = n_meetings_;
    if (++n_waiting_ == n_ranks_) {
      n_waiting_ = 0;
      ++n_meetings_;
      wake_.notify_all();
      return;
    }
    wake_.wait(lock, [&] { return n_meetings_ != turn || failed_; });
    if (n_meetings_ == turn) throw std::runtime_error("another rank has failed");
  }

  int n_ranks_;
  std::vector<std::vector<Parcel>> inbox_;
  std::mutex mutex_;
  std::condition_variable wake_;
  int n_waiting_ = 0;
  std::size_t n_meetings_ = 0;
  bool failed_ = false;
};

struct ThreadTransport {
  RankHub* hub;
  int me;
  int rank() const { return me; }
  int n_ranks() const { return hub->n_ranks(); }
  std::vector<Parcel> exchange(std::vector<Parcel> parcels) const { return hub->exchange(me, std::move(parcels)); }
  void sum(std::span<std::int64_t> values) const {
    hub->combine(hub->counts, me, values, [](std::int64_t a, std::int64_t b) { return a + b; });
  }
  void least(std::span<double> values) const {
    hub->combine(hub->numbers, me, values, [](double a, double b) { return std::min(a, b); });
  }
};

static_assert(Transport<ThreadTransport>);

/// Runs `work(transport)` on as many ranks; throws what the first of them threw that failed by itself.
template <class Work>
void run_on_ranks(int n_ranks, Work&& work) {
  RankHub hub(n_ranks);
  std::vector<std::exception_ptr> failures;
  std::mutex mutex;
  {
    std::vector<std::jthread> threads;
    for (int rank = 0; rank < n_ranks; ++rank)
      threads.emplace_back([&, rank] {
        try {
          work(ThreadTransport{&hub, rank});
        } catch (...) {
          {
            const std::lock_guard lock(mutex);
            failures.push_back(std::current_exception());
          }
          hub.fail();
        }
      });
  }
  if (!failures.empty()) std::rethrow_exception(failures.front());
}

}  // namespace framehex::test
