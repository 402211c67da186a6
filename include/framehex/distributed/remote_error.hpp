// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"

namespace framehex::distributed {

/// What went wrong on one rank, thrown on all of them: the same message everywhere.
///
/// `what()` starts with the rank, `entity()` and `indices()` are those of the error there.
class remote_error : public error {
public:
  remote_error(int rank, const std::string& message, Entity entity, std::vector<std::size_t> indices)
      : error("rank " + std::to_string(rank) + ": " + message, entity, std::move(indices)), rank_(rank) {}

  int rank() const noexcept { return rank_; }

private:
  int rank_;
};

}  // namespace framehex::distributed
