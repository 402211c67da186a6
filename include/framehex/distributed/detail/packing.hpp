// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/distributed/mpi_transport.hpp"
#include "framehex/parts/detail/exchange.hpp"

#include <algorithm>
#include <cstring>
#include <string>

namespace framehex::distributed::detail {

using framehex::detail::any_rank;
using framehex::detail::send_joined;
using framehex::detail::sum_of;

/// Appends values as they stand in memory, after their number.
template <class Value>
void pack(std::vector<std::byte>& bytes, const std::vector<Value>& values) {
  const std::uint64_t n = values.size();
  const std::size_t place = bytes.size();
  bytes.resize(place + sizeof n + n * sizeof(Value));
  std::memcpy(bytes.data() + place, &n, sizeof n);
  if (n > 0) std::memcpy(bytes.data() + place + sizeof n, static_cast<const void*>(values.data()), n * sizeof(Value));
}

/// Takes back what was packed, in the same order.
class Unpacker {
public:
  explicit Unpacker(std::span<const std::byte> bytes) : rest_(bytes) {}

  template <class Value>
  std::vector<Value> take() {
    std::uint64_t n = 0;
    std::memcpy(&n, rest_.data(), sizeof n);
    std::vector<Value> values(n);
    if (n > 0) std::memcpy(static_cast<void*>(values.data()), rest_.data() + sizeof n, n * sizeof(Value));
    rest_ = rest_.subspan(sizeof n + n * sizeof(Value));
    return values;
  }

private:
  std::span<const std::byte> rest_;
};

/// Values for each rank, to be sent together.
template <class... Values>
std::vector<Parcel> parcels_of(const std::vector<Values>&... by_rank) {
  const std::size_t n = std::get<0>(std::tie(by_rank...)).size();
  std::vector<Parcel> parcels;
  for (std::size_t rank = 0; rank < n; ++rank) {
    if ((by_rank[rank].empty() && ...)) continue;
    Parcel& parcel = parcels.emplace_back(Parcel{static_cast<int>(rank), {}});
    (pack(parcel.bytes, by_rank[rank]), ...);
  }
  return parcels;
}

/// Asks other ranks for values.
///
/// @param questions  per rank. @param answer  `answer(question)`, called there.
/// @return the answers in the order of the questions, per rank.
template <class Answer, class Question, class Reply>
std::vector<std::vector<Answer>> ask(const MpiTransport& transport, const std::vector<std::vector<Question>>& questions,
                                     const Reply& answer) {
  std::vector<std::vector<Answer>> replies(questions.size());
  for (const Parcel& p : transport.exchange(parcels_of(questions))) {
    auto& reply = replies[static_cast<std::size_t>(p.rank)];
    for (const Question& question : Unpacker(p.bytes).take<Question>()) reply.push_back(answer(question, p.rank));
  }
  std::vector<std::vector<Answer>> answers(questions.size());
  for (const Parcel& p : transport.exchange(parcels_of(replies)))
    answers[static_cast<std::size_t>(p.rank)] = Unpacker(p.bytes).take<Answer>();
  return answers;
}

/// Everybody's values, by rank.
template <class Value>
std::vector<Value> gathered(const MpiTransport& transport, const std::vector<Value>& values) {
  std::vector<Value> all;
  const auto* const bytes = reinterpret_cast<const std::byte*>(values.data());
  for (const auto& share : transport.gather({bytes, values.size() * sizeof(Value)})) {
    const std::size_t place = all.size();
    all.resize(place + share.size() / sizeof(Value));
    if (!share.empty()) std::memcpy(static_cast<void*>(all.data() + place), share.data(), share.size());
  }
  return all;
}

/// Everybody's texts, by rank. Collective.
inline std::vector<std::string> gathered_texts(const MpiTransport& transport, const std::vector<std::string>& texts) {
  std::vector<char> flat;
  for (const std::string& text : texts) {
    flat.insert(flat.end(), text.begin(), text.end());
    flat.push_back('\0');
  }
  std::vector<std::string> all;
  const std::vector<char> chars = gathered(transport, flat);
  for (auto at = chars.begin(); at != chars.end(); ++at) {
    const auto end = std::find(at, chars.end(), '\0');
    all.emplace_back(at, end);
    at = end;
  }
  return all;
}

}  // namespace framehex::distributed::detail
