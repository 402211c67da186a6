// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"
#include "framehex/errors.hpp"

#include <cmath>
#include <concepts>
#include <sstream>

namespace framehex {

/// A size field: the edge length wanted at a point, in the host's unit. Any callable will do. One that has
/// `sample(p, hint)` as well (`VertexSizeField`) is asked so where points follow one another.
template <class S>
concept SizeField = requires(const S& size, const Vector3& p) {
  { size(p) } -> std::convertible_to<double>;
};

/// The same length everywhere.
struct ConstantSize {
  double length = 1;
  double operator()(const Vector3&) const { return length; }
};

namespace detail {

/// Size at a point; `hint` is where a search may begin and receives where it ended.
template <SizeField S>
double sampled_size(const S& size, const Vector3& p, [[maybe_unused]] index_t& hint) {
  if constexpr (requires { size.sample(p, hint); })
    return size.sample(p, hint);
  else
    return size(p);
}

/// Size at a point, refused when nothing can be built on it.
///
/// @param hint  see `sampled_size`.
/// @throws invalid_field  when the size is not a positive finite number.
template <SizeField S>
double checked_size(const S& size, const Vector3& p, index_t& hint) {
  const double h = sampled_size(size, p, hint);
  // A size below the resolution of the coordinates would never move a point.
  if (std::isfinite(h) && h > 0x1p-40 * p.cwiseAbs().maxCoeff() && h > 0) return h;
  std::ostringstream message;
  message << "the size field is " << h << " at (" << p.x() << ", " << p.y() << ", " << p.z()
          << "); it must be positive, finite and within the precision of the coordinates";
  throw invalid_field(message.str());
}

template <SizeField S>
double checked_size(const S& size, const Vector3& p) {
  index_t hint = no_index;
  return checked_size(size, p, hint);
}

}  // namespace detail

/// Any size field, by reference: what takes it is compiled once for all of them.
///
/// The size field must outlive it. A size costs one indirect call more.
class SizeFieldRef {
public:
  template <SizeField S>
  requires(!std::same_as<S, SizeFieldRef>)
      SizeFieldRef(const S& size)  // NOLINT: whoever takes any size field is meant to be called with that
      : size_(&size), sample_([](const void* s, const Vector3& p, index_t& hint) -> double {
          return detail::sampled_size(*static_cast<const S*>(s), p, hint);
        }) {}

  double operator()(const Vector3& p) const {
    index_t hint = no_index;
    return sample(p, hint);
  }

  double sample(const Vector3& p, index_t& hint) const { return sample_(size_, p, hint); }

private:
  const void* size_;
  double (*sample_)(const void* size, const Vector3& p, index_t& hint);
};

}  // namespace framehex
