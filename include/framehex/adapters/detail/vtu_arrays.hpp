// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/io/input_file.hpp"

#include <lzma.h>
#include <zlib.h>

#include <functional>
#include <optional>

namespace framehex::detail {

/// Unpacks a block of deflated bytes. @return whether it is whole and has the size of `block`.
inline bool unpack_zlib(std::string_view packed, std::string& block) {
  uLongf length = static_cast<uLongf>(block.size());
  return uncompress(reinterpret_cast<Bytef*>(block.data()), &length, reinterpret_cast<const Bytef*>(packed.data()),
                    static_cast<uLong>(packed.size())) == Z_OK &&
         length == block.size();
}

/// The same for xz.
inline bool unpack_lzma(std::string_view packed, std::string& block) {
  std::uint64_t memory = std::uint64_t{1} << 30;
  std::size_t in = 0, out = 0;
  const auto* const from = reinterpret_cast<const std::uint8_t*>(packed.data());
  auto* const to = reinterpret_cast<std::uint8_t*>(block.data());
  return lzma_stream_buffer_decode(&memory, 0, nullptr, from, &in, packed.size(), to, &out, block.size()) == LZMA_OK &&
         out == block.size();
}

/// How the arrays of a file are stored.
struct VtuEncoding {
  enum class Compression { none, zlib, lzma };

  std::endian order = std::endian::little;
  std::size_t header_bytes = 4;
  Compression compression = Compression::none;
};

/// The bytes of an array, from the first to the last: raw or base64, packed or not. A block at a time is in memory.
class VtuBytes {
public:
  /// @param stored  begins where the array does. @param name  of the file, for errors.
  VtuBytes(const std::string& name, std::string_view stored, bool base64, const VtuEncoding& encoding)
      : name_(name), stored_(stored), base64_(base64), encoding_(encoding) {
    if (encoding_.compression == VtuEncoding::Compression::none) {
      n_left_ = header();
      if (n_left_ > stored_.size()) fail("the file ends within binary data");
      return;
    }
    const std::uint64_t n_blocks = header();
    block_size_ = header();
    last_size_ = header();
    if (n_blocks > stored_.size()) fail("a count of compressed blocks is more than the file can hold");
    for (std::uint64_t b = 0; b < n_blocks; ++b) {
      sizes_.push_back(header());
      if (sizes_.back() > stored_.size()) fail("a compressed block is longer than the file");
    }
  }

  /// The next bytes, `n` or as many as there are.
  std::string next(std::size_t n) {
    if (encoding_.compression == VtuEncoding::Compression::none) {
      n = std::min<std::size_t>(n, n_left_);
      n_left_ -= n;
      return decode(n);
    }
    std::string bytes;
    while (bytes.size() < n && (at_ < block_.size() || next_block())) {
      const std::size_t m = std::min(n - bytes.size(), block_.size() - at_);
      bytes.append(block_, at_, m);
      at_ += m;
    }
    return bytes;
  }

private:
  [[noreturn]] void fail(const std::string& what) const { throw io_error(name_ + ": " + what); }

  std::uint64_t header() {
    const std::string bytes = decode(encoding_.header_bytes);
    Cursor in(name_, bytes);
    return encoding_.header_bytes == 8 ? in.raw<std::uint64_t>(encoding_.order)
                                       : in.raw<std::uint32_t>(encoding_.order);
  }

  bool next_block() {
    if (n_unpacked_ == sizes_.size()) return false;
    const bool is_last = n_unpacked_ + 1 == sizes_.size();
    const std::uint64_t n = sizes_[n_unpacked_++], expected = is_last && last_size_ != 0 ? last_size_ : block_size_;
    const bool is_lzma = encoding_.compression == VtuEncoding::Compression::lzma;
    // No byte can stand for more: deflate's limit is 1032, that of xz below 10000.
    if (expected / (is_lzma ? 10000 : 1100) > n) fail("a compressed block unpacks to more than it can");
    const std::string packed = decode(n);
    block_.assign(expected, '\0');
    at_ = 0;
    if (!(is_lzma ? unpack_lzma(packed, block_) : unpack_zlib(packed, block_))) fail("a compressed block is damaged");
    return true;
  }

  /// The next `n` stored bytes.
  std::string decode(std::size_t n) {
    std::string bytes;
    if (n > stored_.size() - from_) fail("the file ends within binary data");
    if (!base64_) {
      bytes = stored_.substr(from_, n);
      from_ += n;
      return bytes;
    }
    bytes.reserve(n);
    while (bytes.size() < n) {
      const int v = from_ < stored_.size() ? base64_value(stored_[from_]) : -1;
      if (v < 0) {
        if (from_ == stored_.size() || stored_[from_] != '=') fail("the file ends within binary data");
        n_bits_ = 0;  // the run ends here; another may follow
        ++from_;
        continue;
      }
      ++from_;
      bits_ = (bits_ << 6 | static_cast<unsigned>(v)) & 0xffffu;
      if ((n_bits_ += 6) >= 8) {
        n_bits_ -= 8;
        bytes += static_cast<char>(bits_ >> n_bits_ & 0xffu);
      }
    }
    return bytes;
  }

  static int base64_value(char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    return c == '+' ? 62 : c == '/' ? 63 : -1;
  }

  std::string name_;
  std::string_view stored_;
  bool base64_;
  VtuEncoding encoding_;
  std::size_t from_ = 0;  ///< of the stored bytes
  unsigned bits_ = 0;     ///< of base64, decoded and not yet taken
  int n_bits_ = 0;
  std::uint64_t n_left_ = 0, block_size_ = 0, last_size_ = 0;
  std::vector<std::uint64_t> sizes_;  ///< of packed blocks
  std::size_t n_unpacked_ = 0, at_ = 0;
  std::string block_;
};

/// The values of an array, some at a time.
class VtuValues {
public:
  /// @param text   of an array in text. @param bytes  of any other, of values of VTK's type.
  VtuValues(const std::string& name, std::string_view text) : name_(name), text_(std::in_place, name, text) {}
  VtuValues(const std::string& name, VtuBytes bytes, std::string_view type, std::endian order)
      : name_(name), bytes_(std::move(bytes)), type_(type), order_(order) {}

  /// The next values, `n` or as many as there are. @throws io_error
  template <class Value>
  std::vector<Value> next(std::size_t n) {
    if (text_) {
      std::vector<Value> out;
      while (out.size() < n && !text_->at_end()) out.push_back(text_->number<Value>("a number of a DataArray"));
      return out;
    }
    if (type_ == "Float64") return convert<double, Value>(n);
    if (type_ == "Float32") return convert<float, Value>(n);
    if (type_ == "Int64") return convert<std::int64_t, Value>(n);
    if (type_ == "UInt64") return convert<std::uint64_t, Value>(n);
    if (type_ == "Int32") return convert<std::int32_t, Value>(n);
    if (type_ == "UInt32") return convert<std::uint32_t, Value>(n);
    if (type_ == "Int16") return convert<std::int16_t, Value>(n);
    if (type_ == "UInt16") return convert<std::uint16_t, Value>(n);
    if (type_ == "Int8") return convert<std::int8_t, Value>(n);
    if (type_ == "UInt8") return convert<std::uint8_t, Value>(n);
    throw io_error(name_ + ": a DataArray of type \"" + Cursor::printable(type_) + "\"");
  }

  template <class Value>
  std::vector<Value> all() {
    constexpr std::size_t at_once = std::size_t{1} << 16;
    std::vector<Value> values;
    for (;;) {
      const std::vector<Value> some = next<Value>(at_once);
      if (some.empty()) return values;
      values.insert(values.end(), some.begin(), some.end());
    }
  }

private:
  template <class Stored, class Value>
  std::vector<Value> convert(std::size_t n) {
    const std::string bytes = bytes_->next(n * sizeof(Stored));
    std::vector<Stored> stored(bytes.size() / sizeof(Stored));
    Cursor(name_, bytes).raw(stored.data(), stored.size(), order_);
    std::vector<Value> values;
    values.reserve(stored.size());
    for (const Stored x : stored) values.push_back(static_cast<Value>(x));
    return values;
  }

  std::string name_;
  std::optional<Cursor> text_;
  std::optional<VtuBytes> bytes_;
  std::string type_;
  std::endian order_ = std::endian::native;
};

/// Looks for some text, and gives back the memory of a mapped file on the way. @param n_lines  adds those passed over.
inline std::size_t find_far(std::string_view whole, std::string_view wanted, std::size_t at,
                            const std::function<void()>& release, std::size_t& n_lines) {
  constexpr std::size_t window = std::size_t{1} << 24;
  for (; at < whole.size(); at += window) {
    const std::string_view some = whole.substr(at, window + wanted.size() - 1);
    const std::size_t found = some.find(wanted);
    const std::string_view before = some.substr(0, std::min(found, window));
    n_lines += static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
    if (found != some.npos) return at + found;
    if (release) release();
  }
  return whole.npos;
}

/// An XML document without what stands in its arrays, which may be most of it: each has the number of its text in its
/// place.
struct VtuSkeleton {
  std::string xml;
  std::vector<std::string_view> texts;

  /// @param release  gives back memory of what was looked at; may be empty.
  explicit VtuSkeleton(std::string_view whole, const std::function<void()>& release) {
    std::size_t copied = 0;
    for (std::size_t at = 0; (at = whole.find('<', at)) != whole.npos;) {
      if (whole.substr(at).starts_with("<!--")) {
        at = std::min(whole.find("-->", at), whole.size());
        continue;
      }
      const std::size_t end = tag_end(whole, at);
      const bool is_array = whole.substr(at).starts_with("<DataArray") && end < whole.size() && whole[end - 1] != '/';
      at = end;
      if (!is_array) continue;
      std::size_t n_lines = 0;
      const std::size_t close = find_far(whole, "</DataArray", end, release, n_lines);
      if (close == whole.npos) break;
      xml += whole.substr(copied, end + 1 - copied);
      cuts_.push_back({xml.size(), n_lines});
      xml += std::to_string(texts.size());
      texts.push_back(text_of(whole.substr(end + 1, close - end - 1)));
      copied = at = close;
    }
    xml += whole.substr(copied);
  }

  /// The line of the whole document that a place of the skeleton lies in.
  std::size_t line(std::size_t place) const {
    place = std::min(place, xml.size());
    auto n =
        static_cast<std::size_t>(1 + std::count(xml.begin(), xml.begin() + static_cast<std::ptrdiff_t>(place), '\n'));
    for (const Cut& cut : cuts_)
      if (cut.place < place) n += cut.n_lines;
    return n;
  }

private:
  struct Cut {
    std::size_t place, n_lines;
  };

  /// Where the tag ends that begins at `at`: its '>', quotes passed over.
  static std::size_t tag_end(std::string_view text, std::size_t at) {
    for (char quote = '\0'; at < text.size(); ++at) {
      const char c = text[at];
      if (quote != '\0')
        quote = c == quote ? '\0' : quote;
      else if (c == '"' || c == '\'')
        quote = c;
      else if (c == '>')
        return at;
    }
    return text.size();
  }

  /// The first text that is in no further element, and what follows.
  static std::string_view text_of(std::string_view inside) {
    int depth = 0;
    for (std::size_t at = 0; at < inside.size();) {
      if (inside[at] != '<') {
        const std::size_t begin = std::min(inside.find_first_not_of(" \t\r\n", at), inside.size());
        if (depth == 0 && begin < inside.size() && inside[begin] != '<') return inside.substr(begin);
        at = std::min(inside.find('<', at), inside.size());
        continue;
      }
      const std::size_t end = tag_end(inside, at);
      const bool closes = inside.substr(at).starts_with("</"), is_empty = end > at && inside[end - 1] == '/';
      const bool is_other = inside.substr(at).starts_with("<!") || inside.substr(at).starts_with("<?");
      if (!is_empty && !is_other) depth += closes ? -1 : 1;
      at = std::min(end + 1, inside.size());
    }
    return {};
  }

  std::vector<Cut> cuts_;
};

}  // namespace framehex::detail
