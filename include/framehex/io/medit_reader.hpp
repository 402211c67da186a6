// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/io/input_file.hpp"
#include "framehex/io/mesh_builder.hpp"

namespace framehex {

namespace detail {

/// A section of elements of a MEDIT file: its keyword in text (in lower case) and its number in binary.
struct MeditSection {
  std::string_view keyword;
  int code;
  int dimension;
  CellKind kind;
  std::size_t n_corners;
};

inline constexpr std::array<MeditSection, 8> medit_sections{{{"edges", 5, 1, {}, 2},
                                                             {"triangles", 6, 2, {}, 3},
                                                             {"quadrilaterals", 7, 2, {}, 4},
                                                             {"tetrahedra", 8, 3, CellKind::tetrahedron, 4},
                                                             {"pyramids", 49, 3, CellKind::pyramid, 5},
                                                             {"prisms", 9, 3, CellKind::prism, 6},
                                                             {"hexahedra", 10, 3, CellKind::hexahedron, 8},
                                                             {"hexaedra", 10, 3, CellKind::hexahedron, 8}}};

inline bool is_number(std::string_view word) {
  return !word.empty() && (word[0] == '-' || word[0] == '+' || word[0] == '.' || (word[0] >= '0' && word[0] <= '9'));
}

/// Vertices count from 1; the least integer has none below it.
constexpr std::int64_t medit_index(std::int64_t number) {
  return number > 0 ? number - 1 : -1;
}

/// @tparam Builder  takes what is found, as MeshBuilder does.
template <class Builder>
class TextMeditReader {
public:
  /// @param bytes  of the file; must outlive this, as must the builder.
  TextMeditReader(const std::string& name, std::string_view bytes, Builder& builder)
      : in_(name, bytes, '#'), builder_(builder) {}

  auto read(Volume volume) {
    if (!same_word(in_.word(), "meshversionformatted")) in_.fail("not a MEDIT text file");
    in_.number<int>("the version");
    while (!in_.at_end()) {
      const std::string_view keyword = in_.word();
      if (same_word(keyword, "end")) break;
      const auto* const section = std::find_if(medit_sections.begin(), medit_sections.end(),
                                               [&](const auto& s) { return same_word(keyword, s.keyword); });
      if (same_word(keyword, "dimension")) {
        if (in_.number<int>("the dimension") != 3) in_.fail("not a mesh in space");
      } else if (same_word(keyword, "vertices")) {
        read_points();
      } else if (section != medit_sections.end()) {
        read_elements(*section);
      } else if (is_number(keyword)) {
        in_.fail("a keyword should stand where \"" + Cursor::printable(keyword) + "\" does");
      } else {
        while (is_number(in_.peek_word())) in_.word();
      }
    }
    return builder_.finish(volume);
  }

private:
  void read_points() {
    const std::size_t n = in_.count("the number of vertices", 8);
    for (std::size_t i = 0; i < n; ++i) {
      const auto x = in_.number<double>("a coordinate"), y = in_.number<double>("a coordinate"),
                 z = in_.number<double>("a coordinate");
      builder_.add_point(x, y, z);
      in_.number<std::int64_t>("a reference");
    }
  }

  void read_elements(const MeditSection& section) {
    const std::size_t n = in_.count("the number of elements", 2 * section.n_corners);
    std::array<std::int64_t, 8> corners{};
    for (std::size_t i = 0; i < n; ++i, ++number_) {
      for (std::size_t j = 0; j < section.n_corners; ++j)
        corners[j] = medit_index(in_.number<std::int64_t>("a vertex"));
      const auto label = in_.number<std::int64_t>("a reference");
      builder_.add(section.dimension, section.kind, std::span(corners).first(section.n_corners), label, number_);
    }
  }

  Cursor in_;
  Builder& builder_;
  std::size_t number_ = 0;  // of an element, over the whole file
};

/// Versions 1 to 4: from 2 on coordinates are doubles, from 3 on positions have 64 bits, in 4 all integers.
template <class Builder>
class BinaryMeditReader {
public:
  BinaryMeditReader(const std::string& name, std::string_view bytes, Builder& builder)
      : in_(name, bytes), builder_(builder) {}

  auto read(Volume volume) {
    const auto one = in_.raw<std::int32_t>();
    if (one != 1 && one != 0x01000000) fail("not a MEDIT binary file");
    if (one != 1) order_ = std::endian::native == std::endian::little ? std::endian::big : std::endian::little;
    version_ = in_.raw<std::int32_t>(order_);
    if (version_ < 1 || version_ > 4) fail("version " + std::to_string(version_) + " is not read");
    while (read_section()) {
    }
    return builder_.finish(volume);
  }

private:
  static constexpr std::int32_t dimension_code = 3, vertices_code = 4, end_code = 54;

  [[noreturn]] void fail(const std::string& what) const { throw io_error(in_.name() + ": " + what); }

  std::int64_t integer() { return version_ == 4 ? in_.raw<std::int64_t>(order_) : in_.raw<std::int32_t>(order_); }
  double real() { return version_ == 1 ? static_cast<double>(in_.raw<float>(order_)) : in_.raw<double>(order_); }

  /// Each section tells where the next one begins; 0: none.
  bool read_section() {
    if (in_.remaining() < 8) return false;
    const auto code = in_.raw<std::int32_t>(order_);
    if (code == end_code) return false;
    const std::int64_t next = version_ >= 3 ? in_.raw<std::int64_t>(order_) : in_.raw<std::int32_t>(order_);
    if (next != 0 && next < static_cast<std::int64_t>(in_.position()))
      fail("a section tells that the next lies before it");
    const auto* const section =
        std::find_if(medit_sections.begin(), medit_sections.end(), [&](const auto& s) { return s.code == code; });
    if (code == dimension_code) {
      if (in_.raw<std::int32_t>(order_) != 3) fail("not a mesh in space");
    } else if (code == vertices_code) {
      const std::size_t n = count(version_ == 1 ? 16 : version_ == 4 ? 32 : 28);
      for (std::size_t i = 0; i < n; ++i) {
        const double x = real(), y = real(), z = real();
        builder_.add_point(x, y, z);
        integer();
      }
    } else if (section != medit_sections.end()) {
      read_elements(*section);
    }
    if (next == 0) return false;
    in_.move_to(static_cast<std::size_t>(next));
    return true;
  }

  std::size_t count(std::size_t size) {
    const std::int64_t n = integer();
    if (n < 0 || static_cast<std::size_t>(n) > in_.remaining() / size)
      fail("a count is " + std::to_string(n) + ", more than the file can hold");
    return static_cast<std::size_t>(n);
  }

  void read_elements(const MeditSection& section) {
    const std::size_t n = count((section.n_corners + 1) * (version_ == 4 ? 8 : 4));
    std::array<std::int64_t, 8> corners{};
    for (std::size_t i = 0; i < n; ++i, ++number_) {
      for (std::size_t j = 0; j < section.n_corners; ++j) corners[j] = medit_index(integer());
      const std::int64_t label = integer();
      builder_.add(section.dimension, section.kind, std::span(corners).first(section.n_corners), label, number_);
    }
  }

  Cursor in_;
  Builder& builder_;
  std::endian order_ = std::endian::native;
  std::int32_t version_ = 0;
  std::size_t number_ = 0;  // of an element, over the whole file
};

/// @param bytes  of the file; the name tells whether it is text or binary.
template <class Builder>
auto read_medit_into(Builder& builder, const std::filesystem::path& path, std::string_view bytes, Volume volume) {
  if (lower_text(path.extension().string()) == ".meshb")
    return BinaryMeditReader(path.string(), bytes, builder).read(volume);
  return TextMeditReader(path.string(), bytes, builder).read(volume);
}

}  // namespace detail

/// Reads a mesh in MEDIT's format, text (keywords in any case) or binary (.meshb, versions 1 to 4).
///
/// @return cells, faces and edges with their references less one as labels (by rank where one is not positive). Other
///         sections (corners, ridges, normals...) are passed over.
/// @throws io_error naming file and line; invalid_connectivity (a vertex out of range) and invalid_coordinate (NaN,
///         infinity), both naming the file as well. Cells are numbered from 0 over the whole file.
/// @par Complexity   O(n).
inline MixedMesh read_medit(const std::filesystem::path& path, Volume volume = Volume::required) {
  const std::string bytes = read_file(path);
  detail::MeshBuilder builder(path.string(), 1);
  return detail::read_medit_into(builder, path, bytes, volume);
}

}  // namespace framehex
