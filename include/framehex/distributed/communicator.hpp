// SPDX-License-Identifier: BSL-1.0
#pragma once

#include <mpi.h>

#include <utility>

namespace framehex::distributed {

/// A communicator of our own over the ranks of the host's, so that no message is mistaken for one of the host's.
///
/// Made and freed by all ranks together; MPI must have been initialised and not be finalised before.
class Communicator {
public:
  explicit Communicator(MPI_Comm host) {
    MPI_Comm_dup(host, &handle_);
    MPI_Comm_rank(handle_, &rank_);
    MPI_Comm_size(handle_, &size_);
  }
  Communicator(Communicator&& other) noexcept
      : handle_(std::exchange(other.handle_, MPI_COMM_NULL)), rank_(other.rank_), size_(other.size_) {}
  Communicator(const Communicator&) = delete;
  Communicator& operator=(const Communicator&) = delete;
  Communicator& operator=(Communicator&&) = delete;
  ~Communicator() {
    if (handle_ != MPI_COMM_NULL) MPI_Comm_free(&handle_);
  }

  MPI_Comm handle() const { return handle_; }
  int rank() const { return rank_; }
  int size() const { return size_; }

private:
  MPI_Comm handle_ = MPI_COMM_NULL;
  int rank_ = 0, size_ = 1;
};

}  // namespace framehex::distributed
