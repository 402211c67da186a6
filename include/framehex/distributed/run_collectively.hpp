// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/distributed/mpi_transport.hpp"
#include "framehex/observer.hpp"

#include <type_traits>

namespace framehex::distributed {

/// Runs what all ranks do together, so that an exception on one of them ends it on all.
///
/// @param body  called without arguments on every rank; may call `transport` and throw anything.
/// @return what `body` returns, once it has returned on all ranks.
/// @throws remote_error  on all ranks, with the message, the entity and the indices of the first error and the rank it
///                       came from. Nobody waits for a rank that has failed.
template <class Body>
std::invoke_result_t<Body&> run_collectively(const MpiTransport& transport, Body&& body) {
  const auto run = [&]() -> std::invoke_result_t<Body&> {
    try {
      return body();
    } catch (const remote_error&) {
      throw;  // known to all
    } catch (const error& e) {
      transport.fail(e);
    } catch (const std::bad_alloc&) {
      transport.fail(error("out of memory"));
    } catch (const std::exception& e) {
      transport.fail(error(e.what()));
    } catch (...) {
      transport.fail(error("an exception of unknown type"));
    }
  };
  if constexpr (std::is_void_v<std::invoke_result_t<Body&>>) {
    run();
    transport.agree();
  } else {
    auto result = run();
    transport.agree();
    return result;
  }
}

/// One observer out of all ranks': each is asked, and one that wants to stop stops all. Collective, and so is each call
/// of the result. Hosts who want progress once give an observer on rank 0 only.
///
/// @return empty when no rank has one.
inline Observer shared_observer(const MpiTransport& transport, Observer mine) {
  std::array<double, 1> any{mine ? 0.0 : 1.0};
  transport.least(any);
  if (any[0] == 1) return {};
  return [transport, mine = std::move(mine)](const Progress& progress) {
    std::array<double, 1> go{!mine || mine(progress) ? 1.0 : 0.0};
    transport.least(go);
    return go[0] == 1;
  };
}

}  // namespace framehex::distributed
