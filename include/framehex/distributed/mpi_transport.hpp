// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/distributed/communicator.hpp"
#include "framehex/distributed/remote_error.hpp"
#include "framehex/parts/transport.hpp"

#include <algorithm>
#include <array>
#include <ctime>
#include <limits>
#include <memory>
#include <thread>

namespace framehex::distributed {

/// What a rank has sent.
struct Traffic {
  std::int64_t messages = 0;     ///< from rank to rank; to itself not counted
  std::int64_t bytes = 0;        ///< in them
  std::int64_t collectives = 0;  ///< calls in which all ranks took part
  double seconds = 0;            ///< processor time within the calls, most of it spent on waiting
};

/// Transport over MPI, in which errors agree: every call begins by asking all ranks whether one has failed. If so, all
/// throw the same `remote_error`; none waits for a message that does not come. See `run_collectively`.
///
/// Not safe from several threads at once. Copies share the communicator.
class MpiTransport {
public:
  /// @param host           copied; see `Communicator`. Collective.
  /// @param largest_bytes  of one message; longer parcels are cut. MPI counts bytes in an `int`.
  explicit MpiTransport(MPI_Comm host, std::size_t largest_bytes = std::size_t{1} << 30)
      : state_(std::make_shared<State>(State{Communicator(host), {}})), largest_(largest_bytes) {}

  int rank() const { return state_->communicator.rank(); }
  int n_ranks() const { return state_->communicator.size(); }
  MPI_Comm handle() const { return state_->communicator.handle(); }
  const Traffic& traffic() const { return state_->traffic; }

  /// See Transport.
  ///
  /// @throws invalid_option  for a parcel to a rank that there is not, here; remote_error  when a rank has failed.
  /// @par Complexity  messages between those who have something to say, and O(log ranks) to know that all has arrived.
  /// @par Source      T. Hoefler, C. Siebert, A. Lumsdaine, PPoPP (2010) 159-168 (nonblocking consensus).
  std::vector<Parcel> exchange(std::vector<Parcel> parcels) const {
    for (const Parcel& p : parcels)
      if (p.rank < 0 || p.rank >= n_ranks())
        throw invalid_option("a parcel to rank " + std::to_string(p.rank) + " of " + std::to_string(n_ranks()));
    const Watch watch(state_->traffic);
    // No rank sends before all are out of the last exchange: its messages cannot be taken for those of this one.
    agree();
    std::vector<Parcel> arrived;
    std::vector<MPI_Request> sends;
    for (Parcel& p : parcels)
      if (p.rank == rank())
        arrived.push_back(std::move(p));
      else
        send(p, sends);
    receive_all(sends, arrived);
    std::stable_sort(arrived.begin(), arrived.end(), [](const Parcel& a, const Parcel& b) { return a.rank < b.rank; });
    return arrived;
  }

  /// See Transport. @throws remote_error
  void sum(std::span<std::int64_t> counts) const { reduce(counts, MPI_INT64_T, MPI_SUM); }

  /// See Transport. @throws remote_error
  void least(std::span<double> numbers) const { reduce(numbers, MPI_DOUBLE, MPI_MIN); }

  /// Everybody's bytes, by rank, for everybody. @throws remote_error
  std::vector<std::vector<std::byte>> gather(std::span<const std::byte> bytes) const {
    const Watch watch(state_->traffic);
    agree();
    const auto n = static_cast<std::size_t>(n_ranks());
    std::vector<std::int64_t> sizes(n);
    const auto mine = static_cast<std::int64_t>(bytes.size());
    MPI_Allgather(&mine, 1, MPI_INT64_T, sizes.data(), 1, MPI_INT64_T, handle());
    std::vector<std::vector<std::byte>> all(n);
    for (std::size_t r = 0; r < n; ++r) all[r].resize(static_cast<std::size_t>(sizes[r]));
    std::vector<std::byte> flat;
    std::vector<int> counts(n), places(n);
    // In rounds: MPI counts bytes in an `int`, all ranks' together.
    const std::size_t share = std::max<std::size_t>(1, largest_ / n);
    const auto longest = static_cast<std::size_t>(*std::max_element(sizes.begin(), sizes.end()));
    for (std::size_t first = 0; first < longest; first += share) {
      int total = 0;
      for (std::size_t r = 0; r < n; ++r) {
        counts[r] = static_cast<int>(std::min(share, all[r].size() - std::min(first, all[r].size())));
        places[r] = std::exchange(total, total + counts[r]);
      }
      flat.resize(static_cast<std::size_t>(total));
      const std::byte* const from = bytes.data() + std::min(first, bytes.size());
      MPI_Allgatherv(from, counts[static_cast<std::size_t>(rank())], MPI_BYTE, flat.data(), counts.data(),
                     places.data(), MPI_BYTE, handle());
      for (std::size_t r = 0; r < n; ++r)
        std::copy_n(flat.begin() + places[r], counts[r], all[r].begin() + static_cast<std::ptrdiff_t>(first));
      ++state_->traffic.collectives;
    }
    return all;
  }

  /// Asks whether a rank has failed. Collective. @throws remote_error  on all ranks.
  void agree() const { agree(nullptr); }

  /// Takes part, as one that has failed, in whatever the other ranks do next. @throws remote_error  on all ranks; of
  /// several that failed at once the least is named.
  [[noreturn]] void fail(const error& e) const {
    agree(&e);
    throw e;  // never reached: agreeing on a failure throws
  }

private:
  struct State {
    Communicator communicator;
    Traffic traffic;
  };

  /// Adds the processor time of its life.
  class Watch {
  public:
    explicit Watch(Traffic& traffic) : traffic_(traffic) {}
    Watch(const Watch&) = delete;
    Watch& operator=(const Watch&) = delete;
    ~Watch() { traffic_.seconds += static_cast<double>(std::clock() - begin_) / CLOCKS_PER_SEC; }

  private:
    Traffic& traffic_;
    std::clock_t begin_ = std::clock();
  };

  static constexpr int last_tag = 0, more_tag = 1;  ///< of a cut parcel's pieces

  void send(const Parcel& p, std::vector<MPI_Request>& sends) const {
    for (std::size_t first = 0;; first += largest_) {
      const std::size_t n = std::min(largest_, p.bytes.size() - first);
      const bool is_last = first + n == p.bytes.size();
      // Synchronous: complete when the receiver has it, which is what the barrier is about.
      MPI_Issend(p.bytes.data() + first, static_cast<int>(n), MPI_BYTE, p.rank, is_last ? last_tag : more_tag, handle(),
                 &sends.emplace_back());
      ++state_->traffic.messages;
      state_->traffic.bytes += static_cast<std::int64_t>(n);
      if (is_last) return;
    }
  }

  void receive_all(std::vector<MPI_Request>& sends, std::vector<Parcel>& arrived) const {
    std::vector<Parcel> begun;  // cut parcels whose last piece is still to come
    MPI_Request barrier = MPI_REQUEST_NULL;
    bool in_barrier = false;
    for (int done = 0; !done;) {
      if (receive_one(begun, arrived)) continue;
      if (in_barrier) {
        MPI_Test(&barrier, &done, MPI_STATUS_IGNORE);
      } else {
        int sent = 0;
        MPI_Testall(static_cast<int>(sends.size()), sends.data(), &sent, MPI_STATUSES_IGNORE);
        if (sent) MPI_Ibarrier(handle(), &barrier);
        in_barrier = sent;
      }
      if (!done) std::this_thread::yield();
    }
    ++state_->traffic.collectives;
  }

  bool receive_one(std::vector<Parcel>& begun, std::vector<Parcel>& arrived) const {
    int found = 0, n = 0;
    MPI_Message message;
    MPI_Status status;
    MPI_Improbe(MPI_ANY_SOURCE, MPI_ANY_TAG, handle(), &found, &message, &status);
    if (!found) return false;
    MPI_Get_count(&status, MPI_BYTE, &n);
    auto parcel =
        std::find_if(begun.begin(), begun.end(), [&](const Parcel& p) { return p.rank == status.MPI_SOURCE; });
    if (parcel == begun.end()) parcel = begun.insert(begun.end(), Parcel{status.MPI_SOURCE, {}});
    const std::size_t place = parcel->bytes.size();
    parcel->bytes.resize(place + static_cast<std::size_t>(n));
    MPI_Mrecv(parcel->bytes.data() + place, n, MPI_BYTE, &message, MPI_STATUS_IGNORE);
    if (status.MPI_TAG == last_tag) {
      arrived.push_back(std::move(*parcel));
      begun.erase(parcel);
    }
    return true;
  }

  template <class Value>
  void reduce(std::span<Value> values, MPI_Datatype type, MPI_Op operation) const {
    const Watch watch(state_->traffic);
    agree();
    constexpr std::size_t largest = std::size_t{1} << 27;
    for (std::size_t first = 0; first < values.size(); first += largest) {
      const auto n = static_cast<int>(std::min(largest, values.size() - first));
      MPI_Allreduce(MPI_IN_PLACE, values.data() + first, n, type, operation, handle());
    }
    ++state_->traffic.collectives;
  }

  /// @param mine  the failure of this rank, or null.
  void agree(const error* mine) const {
    constexpr int nobody = std::numeric_limits<int>::max();
    int failed = mine ? rank() : nobody;
    MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPI_INT, MPI_MIN, handle());
    if (failed == nobody) return;
    std::string message;
    std::vector<std::size_t> indices;
    std::array<std::uint64_t, 3> head{};  // bytes, indices, entity
    if (mine && failed == rank()) {
      message = mine->what();
      indices = mine->indices();
      head = {message.size(), indices.size(), static_cast<std::uint64_t>(mine->entity())};
    }
    MPI_Bcast(head.data(), 3, MPI_UINT64_T, failed, handle());
    message.resize(head[0]);
    indices.resize(head[1]);
    MPI_Bcast(message.data(), static_cast<int>(message.size()), MPI_BYTE, failed, handle());
    MPI_Bcast(indices.data(), static_cast<int>(indices.size()), MPI_UINT64_T, failed, handle());
    throw remote_error(failed, message, static_cast<Entity>(head[2]), std::move(indices));
  }

  std::shared_ptr<State> state_;
  std::size_t largest_;
};

static_assert(Transport<MpiTransport>);

}  // namespace framehex::distributed
