// SPDX-License-Identifier: BSL-1.0
#include "sizes.hpp"

#include "framehex/adapters/vtu_reader.hpp"
#include "framehex/geometry/bounding_box.hpp"
#include "framehex/insertion/estimate.hpp"
#include "framehex/mesh/enclosed_volume.hpp"
#include "framehex/mesh/validation.hpp"
#include "framehex/sizing/surface_sizes.hpp"
#include "framehex/surface/refinement.hpp"

#include "report.hpp"

namespace program {

using framehex::index_t;
using framehex::invalid_option;

namespace {

std::string text_of(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.4g", x);
  return text;
}

/// Everything that is wanted of one surface.
class SizeMaker {
public:
  SizeMaker(const Options& options, const framehex::SoupSurface& soup, const framehex::FeatureOptions& features,
            nlohmann::ordered_json& json)
      : options_(options), soup_(soup), features_(features), json_(json["sizes"]) {
    diagonal_ = framehex::bounding_box(soup.surface.points).diagonal().norm();
  }

  framehex::GradedSize make() {
    bounds_.growth = options_.growth;
    read_field();
    bounds_.most = largest_size();
    check_least();
    bounds_.least = options_.least.value_or(0);
    json_["wished"] = bounds_.most;
    if (field_ || !sources_.empty()) json_["size-field"] = json_field_;
    if (!options_.size_on.empty() || options_.segments || options_.cells_across) {
      surface_ = framehex::Surface(soup_.surface, features_);
      add_patches();
      add_curvature();
      add_walls();
    }
    return framehex::GradedSize(bounds_, std::move(sources_), std::move(field_));
  }

private:
  void read_field() {
    if (options_.size_field.empty()) {
      if (!options_.size_array.empty()) throw invalid_option("--size-array goes with --size-field");
      return;
    }
    framehex::PointLengths lengths{.wanted = options_.size_array};
    const framehex::MixedMesh mesh = framehex::read_vtu_lengths(options_.size_field, lengths);
    for (std::size_t v = 0; v < lengths.values.size(); ++v)
      if (!(lengths.values[v] > 0) || !std::isfinite(lengths.values[v]))
        throw framehex::invalid_field(options_.size_field + ": \"" + lengths.array + "\" is " +
                                          text_of(lengths.values[v]) + " at point " + std::to_string(v) +
                                          "; lengths are positive",
                                      framehex::Entity::vertex, {v});
    remark_uncovered(mesh);
    largest_of_field_ = *std::max_element(lengths.values.begin(), lengths.values.end());
    json_field_ = {{"array", lengths.array}, {"points", lengths.values.size()}};
    if (mesh.n_cells() > 0)
      set_volume_field(mesh, std::move(lengths.values));
    else
      add_surface_field(mesh, std::move(lengths.values));
  }

  void remark_uncovered(const framehex::MixedMesh& mesh) const {
    const Eigen::AlignedBox3d body = framehex::bounding_box(soup_.surface.points);
    const Eigen::AlignedBox3d box = framehex::bounding_box(mesh.points);
    const framehex::Vector3 margin = framehex::Vector3::Constant(0.01 * diagonal_);
    if (!Eigen::AlignedBox3d(box.min() - margin, box.max() + margin).contains(body))
      remark(options_, "the sizes of " + options_.size_field +
                           " do not reach over the whole surface: beyond them those of their nearest point hold");
  }

  void set_volume_field(const framehex::MixedMesh& mesh, std::vector<double> lengths) {
    framehex::IndexedTetMesh tets;
    try {
      tets = framehex::tetrahedra_of(mesh);
      framehex::validate(tets);
    } catch (const framehex::error& e) {
      throw framehex::io_error(options_.size_field + ": " + e.what());
    }
    framehex::TetAdjacency adjacency = framehex::make_adjacency(tets);
    framehex::limit_gradation(adjacency, tets.points, lengths, bounds_.growth);
    field_.emplace(std::make_shared<framehex::TetLocator>(std::move(adjacency), std::move(tets.points)),
                   std::move(lengths));
  }

  void add_surface_field(const framehex::MixedMesh& mesh, std::vector<double> lengths) {
    framehex::IndexedTriangleMesh surface{mesh.points, {}};
    for (const framehex::LabelledFace& face : mesh.faces) {
      const auto& v = face.vertices;
      surface.triangles.push_back({v[0], v[1], v[2]});
      if (face.size() == 4) surface.triangles.push_back({v[0], v[2], v[3]});
    }
    if (surface.triangles.empty())
      throw framehex::io_error(options_.size_field + ": holds neither tetrahedra nor faces");
    add(framehex::vertex_sources(surface, std::move(lengths), bounds_.growth));
  }

  void add(std::vector<framehex::SizeSource> more) { sources_.insert(sources_.end(), more.begin(), more.end()); }

  double filled_volume() const {
    if (options_.bodies == "void") return framehex::enclosed_volume(soup_.surface);
    const framehex::Surface surface(soup_.surface);
    const framehex::SurfaceRegions regions = framehex::find_regions(surface);
    double volume = 0;
    for (index_t region = 0; region < regions.n_regions; ++region)
      volume += framehex::enclosed_volume(framehex::region_surface(surface, regions, region).surface);
    return volume;
  }

  /// Where nothing smaller is wanted.
  double largest_size() const {
    const double volume = filled_volume();
    if (!(volume > 0)) throw framehex::invalid_surface("the surface encloses no volume; does it cross itself?");
    const double size = options_.size                  ? *options_.size
                        : !options_.size_field.empty() ? std::min(largest_of_field_, diagonal_)
                                                       : std::cbrt(volume / double(options_.cells.value_or(10'000)));
    if (!(size > 0) || !std::isfinite(size))
      throw invalid_option("size " + text_of(size) + " is not a positive number");
    if (size > diagonal_)
      throw invalid_option("size " + text_of(size) + " is more than the diagonal of the surface's box, " +
                           text_of(diagonal_));
    const double most = std::min(size, options_.most.value_or(size));
    // More cubes of the size than this in the surface are taken for a mistake: memory ends before.
    constexpr double most_cells = 2e7;
    const double n_cells = volume / (most * most * most);
    if (n_cells > most_cells)
      throw invalid_option("size " + text_of(most) + " asks for " + text_of(n_cells) + " cells, more than " +
                           text_of(most_cells));
    return most;
  }

  void check_least() const {
    if (options_.least && *options_.least > bounds_.most)
      throw invalid_option("--least " + text_of(*options_.least) + " is more than the wished size, " +
                           text_of(bounds_.most));
  }

  /// The label of a patch that is given by name or number.
  index_t label_of(const std::string& patch) const {
    const auto& names = soup_.patch_names;
    const auto at = std::find(names.begin(), names.end(), patch);
    if (at != names.end()) return static_cast<index_t>(at - names.begin());
    const std::string number = patch.starts_with("patch_") ? patch.substr(6) : patch;
    const index_t n = names.empty() ? surface_.features.n_patches : static_cast<index_t>(names.size());
    if (!number.empty() && number.size() < 9 && number.find_first_not_of("0123456789") == number.npos &&
        std::stoul(number) < n)
      return static_cast<index_t>(std::stoul(number));
    std::string known;
    for (std::size_t l = 0; l < std::min<std::size_t>(names.size(), 20); ++l)
      known += (l == 0 ? " (" : ", ") + names[l];
    throw invalid_option("--size-on: the surface has no patch \"" + patch + "\"; it has " + std::to_string(n) +
                         ", numbered from 0" + known +
                         (known.empty()       ? ""
                          : names.size() > 20 ? ", ...)"
                                              : ")"));
  }

  void add_patches() {
    const std::vector<index_t>& labels = soup_.patches.empty() ? surface_.features.triangle_patch : soup_.patches;
    std::vector<double> lengths(labels.size(), framehex::unbounded);
    for (const std::string& wish : options_.size_on) {
      const std::size_t sign = wish.rfind('=');
      const index_t label = label_of(wish.substr(0, sign));
      const double length = std::stod(wish.substr(sign + 1));
      if (length >= bounds_.most)
        remark(options_, "--size-on " + wish + " changes nothing: the size is at most " + text_of(bounds_.most));
      for (std::size_t t = 0; t < labels.size(); ++t)
        if (labels[t] == label) lengths[t] = std::min(lengths[t], length);
    }
    add_lengths("--size-on", surface_, std::move(lengths), options_.least.value_or(0));
  }

  void add_curvature() {
    if (options_.segments)
      add_lengths("--curvature", surface_, framehex::curvature_sizes(surface_, *options_.segments), found_least());
  }

  void add_walls() {
    if (!options_.cells_across) return;
    const framehex::SurfaceRegions regions = framehex::find_regions(surface_);
    const double edge = bounds_.most;
    const framehex::Surface fine =
        framehex::refine(surface_, [edge](const framehex::Vector3&) { return edge; }).surface;
    std::vector<double> lengths = framehex::wall_thickness(fine, regions, *options_.cells_across * bounds_.most);
    add(framehex::wall_sources(fine, regions, lengths, *options_.cells_across, found_least()));
    for (double& length : lengths) length /= *options_.cells_across;
    tell("--cells-across", fine, lengths, found_least());
  }

  /// What nobody has asked for by name does not become arbitrarily small.
  double found_least() const { return options_.least.value_or(bounds_.most / 10); }

  void add_lengths(const char* option, const framehex::Surface& surface, std::vector<double> lengths, double bound) {
    tell(option, surface, lengths, bound);
    for (double& length : lengths) length = std::max(length, bound);
    add(framehex::triangle_sources(surface, lengths));
  }

  /// What a lower bound holds back is told, and how many triangles want less than the largest size.
  void tell(const char* option, const framehex::Surface& surface, const std::vector<double>& lengths, double bound) {
    const auto least = std::min_element(lengths.begin(), lengths.end());
    const auto n_smaller = std::count_if(lengths.begin(), lengths.end(), [&](double x) { return x < bounds_.most; });
    if (least != lengths.end() && *least < bound) {
      const auto& v = surface.triangles()[static_cast<std::size_t>(least - lengths.begin())];
      const framehex::Vector3 p = (surface.points[v[0]] + surface.points[v[1]] + surface.points[v[2]]) / 3;
      remark(options_, std::string(option) + " asks for sizes down to " + text_of(*least) + ", at (" + text_of(p.x()) +
                           ", " + text_of(p.y()) + ", " + text_of(p.z()) + "): none is smaller than " + text_of(bound) +
                           " (--least)");
    }
    if (n_smaller > 0) json_[option + 2] = {{"triangles", n_smaller}, {"least", std::max(*least, bound)}};
  }

  const Options& options_;
  const framehex::SoupSurface& soup_;
  const framehex::FeatureOptions& features_;
  nlohmann::ordered_json& json_;
  nlohmann::ordered_json json_field_;
  double diagonal_ = 0, largest_of_field_ = 0;
  framehex::Surface surface_;
  framehex::GradedSizeOptions bounds_;
  std::vector<framehex::SizeSource> sources_;
  std::optional<framehex::VertexSizeField> field_;
};

}  // namespace

framehex::GradedSize make_size(const Options& options, const framehex::SoupSurface& soup,
                               const framehex::FeatureOptions& features, nlohmann::ordered_json& json) {
  return SizeMaker(options, soup, features, json).make();
}

}  // namespace program
