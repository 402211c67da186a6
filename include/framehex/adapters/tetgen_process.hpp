// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/tetrahedralization/tetrahedralizer.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numeric>
#include <thread>

extern char** environ;

namespace framehex {

namespace detail {

/// A folder of its own for temporary files, gone with the object.
class TemporaryFolder {
public:
  TemporaryFolder() {
    std::error_code failure;
    const std::filesystem::path parent = std::filesystem::temp_directory_path(failure);
    if (failure) {
      const char* const wanted = std::getenv("TMPDIR");
      throw io_error(std::string(wanted ? wanted : "/tmp") + ": no folder for temporary files (" + failure.message() +
                     ")");
    }
    std::string pattern = (parent / (prefix() + "XXXXXX")).string();
    if (!::mkdtemp(pattern.data())) throw io_error(pattern + ": cannot make a temporary folder");
    path_ = pattern;
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  const std::filesystem::path& path() const { return path_; }

  /// How the names of this process's folders begin: for those who must clean up after themselves in a hurry.
  static std::string prefix() { return "framehex-" + std::to_string(::getpid()) + "-"; }

private:
  std::filesystem::path path_;
};

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, FileCloser>;

inline File open_file(const std::filesystem::path& path, const char* mode) {
  File file(std::fopen(path.c_str(), mode));
  if (!file) throw io_error(path.string() + ": cannot be opened");
  return file;
}

/// Ends a written file; a full disk shows here at the latest.
inline void finish(File file, const std::filesystem::path& path) {
  const bool failed = std::fflush(file.get()) != 0 || std::ferror(file.get()) != 0;
  if (failed) throw io_error(path.string() + ": cannot be written (is the disk full?)");
}

inline void write_nodes(const std::filesystem::path& path, std::span<const Vector3> points) {
  File file = open_file(path, "w");
  std::fprintf(file.get(), "%zu 3 0 0\n", points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    std::fprintf(file.get(), "%zu %.17g %.17g %.17g\n", i, points[i].x(), points[i].y(), points[i].z());
  finish(std::move(file), path);
}

/// A point in each cavity: TetGen fills what it is not told to leave empty. The shell of a cavity encloses a negative
/// volume; the point lies just outside the body at the middle of its largest triangle.
inline std::vector<Vector3> points_in_cavities(std::span<const Vector3> points,
                                               std::span<const std::array<index_t, 3>> triangles) {
  std::vector<index_t> shell(points.size());
  std::iota(shell.begin(), shell.end(), index_t{0});
  const auto root = [&](index_t v) {
    while (shell[v] != v) v = shell[v] = shell[shell[v]];
    return v;
  };
  for (const auto& t : triangles)
    for (const index_t v : {t[1], t[2]}) shell[std::max(root(t[0]), root(v))] = std::min(root(t[0]), root(v));
  std::vector<double> volume(points.size(), 0.0), largest(points.size(), 0.0);
  std::vector<Vector3> beside(points.size());
  for (const auto& t : triangles) {
    const Vector3 &a = points[t[0]], &b = points[t[1]], &c = points[t[2]];
    const index_t s = root(t[0]);
    // From a corner of the shell itself, which keeps the digits.
    volume[s] += (a - points[s]).dot((b - points[s]).cross(c - points[s]));
    const Vector3 normal = (b - a).cross(c - a);
    if (normal.norm() <= largest[s]) continue;
    largest[s] = normal.norm();
    beside[s] = (a + b + c) / 3 + 0.01 * normal / std::sqrt(normal.norm());
  }
  std::vector<Vector3> inside;
  for (std::size_t s = 0; s < points.size(); ++s)
    if (volume[s] < 0) inside.push_back(beside[s]);
  return inside;
}

inline void write_facets(const std::filesystem::path& path, std::span<const Vector3> points,
                         std::span<const std::array<index_t, 3>> triangles) {
  File file = open_file(path, "w");
  std::fprintf(file.get(), "0 3 0 0\n%zu 0\n", triangles.size());
  for (const auto& t : triangles) std::fprintf(file.get(), "3 %u %u %u\n", t[0], t[1], t[2]);
  const std::vector<Vector3> holes = points_in_cavities(points, triangles);
  std::fprintf(file.get(), "%zu\n", holes.size());
  for (std::size_t i = 0; i < holes.size(); ++i)
    std::fprintf(file.get(), "%zu %.17g %.17g %.17g\n", i, holes[i][0], holes[i][1], holes[i][2]);
  std::fprintf(file.get(), "0\n");
  finish(std::move(file), path);
}

/// Runs a program, its output going to a file, until it ends or the observer says stop.
/// @return the exit status, or -1 when it was stopped, or -2 when it cannot be started, or -3 when a signal ended it.
inline int run_process(std::vector<std::string> arguments, const std::filesystem::path& log, const Observer& observer) {
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, 1, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  ::posix_spawn_file_actions_adddup2(&actions, 1, 2);
  // In a process group of its own, so that a Ctrl-C reaches the host alone and the host decides.
  posix_spawnattr_t attributes;
  ::posix_spawnattr_init(&attributes);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  ::posix_spawnattr_setpgroup(&attributes, 0);
  pid_t child = 0;
  const int failure = ::posix_spawnp(&child, argv[0], &actions, &attributes, argv.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  ::posix_spawnattr_destroy(&attributes);
  if (failure != 0) return -2;
  for (auto pause = std::chrono::milliseconds(1);;) {
    int status = 0;
    const pid_t ended = ::waitpid(child, &status, WNOHANG);
    if (ended == child) return WIFEXITED(status) ? WEXITSTATUS(status) : -3;
    if (ended < 0) return -3;
    if (!keep_going(observer, "tetrahedra", 0.0)) {
      ::kill(child, SIGKILL);
      ::waitpid(child, &status, 0);
      return -1;
    }
    std::this_thread::sleep_for(pause);
    pause = std::min(2 * pause, std::chrono::milliseconds(100));
  }
}

inline std::string read_text(const std::filesystem::path& path) {
  std::ifstream stream(path);
  return {std::istreambuf_iterator<char>(stream), {}};
}

inline File open_answer(const std::filesystem::path& path) {
  File file(std::fopen(path.c_str(), "r"));
  if (!file) throw tetrahedralization_error("tetgen wrote no result");
  return file;
}

inline std::vector<Vector3> read_nodes(const std::filesystem::path& path) {
  const File file = open_answer(path);
  std::size_t n = 0;
  int dimension = 0, attributes = 0, markers = 0;
  if (std::fscanf(file.get(), "%zu %d %d %d", &n, &dimension, &attributes, &markers) != 4 || dimension != 3 ||
      attributes != 0)
    throw tetrahedralization_error("tetgen wrote a .node file that cannot be understood");
  std::vector<Vector3> points(n);
  for (Vector3& p : points)
    if (std::fscanf(file.get(), "%*u %lf %lf %lf", &p[0], &p[1], &p[2]) != 3 ||
        (markers && std::fscanf(file.get(), "%*d") != 0))
      throw tetrahedralization_error("tetgen wrote a .node file that is cut short");
  return points;
}

inline std::vector<std::array<index_t, 4>> read_tets(const std::filesystem::path& path) {
  const File file = open_answer(path);
  std::size_t n = 0;
  int corners = 0, attributes = 0;
  if (std::fscanf(file.get(), "%zu %d %d", &n, &corners, &attributes) != 3 || corners != 4 || attributes != 0)
    throw tetrahedralization_error("tetgen wrote a .ele file that cannot be understood");
  std::vector<std::array<index_t, 4>> tets(n);
  for (auto& t : tets)
    if (std::fscanf(file.get(), "%*u %u %u %u %u", &t[0], &t[1], &t[2], &t[3]) != 4)
      throw tetrahedralization_error("tetgen wrote a .ele file that is cut short");
  return tets;
}

}  // namespace detail

/// Tetrahedralizer that runs the `tetgen` 1.5 executable as a separate process on temporary files.
///
/// A process of its own keeps a crash of TetGen away from the host, and the host free of TetGen's licence (AGPL).
/// Points that TetGen drops or merges are found by `tetrahedralize`.
///
/// @throws tetrahedralization_error  when the program is missing, crashes or answers nonsense; invalid_surface when it
///         refuses the surface, with its own words; io_error when the temporary files cannot be written.
/// @par Determinism   TetGen's: the same input gives the same mesh.
struct TetgenProcess {
  std::string program = "tetgen";  ///< looked up on the PATH

  /// p: fill the surface; Y: do not touch it; J: keep unused points, so that the numbering survives; O2/1: optimise by
  /// flips only, since the other ways move points; B F Q: write less.
  std::string switches = "-pYJO2/1BFQ";

  TetrahedralizationResult operator()(const TetrahedralizationRequest& request) const {
    const detail::TemporaryFolder folder;
    const auto file = [&](const char* name) { return folder.path() / name; };
    // All points in one file: given apart, to be inserted afterwards (switch i), they make TetGen crash now and then.
    detail::write_nodes(file("surface.node"), request.points);
    detail::write_facets(file("surface.smesh"), request.points, request.triangles);
    const int exit =
        detail::run_process({program, switches, file("surface.smesh").string()}, file("log"), request.observer);
    if (exit == -1) return {.tets = {}, .extra_points = {}, .status = Status::cancelled};
    const bool missing = exit == -2 || exit == 127;
    if (missing)
      throw tetrahedralization_error("the program '" + program +
                                     "' is not on the PATH; install it (Debian: apt-get install tetgen)");
    if (exit != 0 || !std::filesystem::exists(file("surface.1.ele"))) refuse(request, folder.path());
    return read(request, file("surface.1.node"), file("surface.1.ele"));
  }

private:
  /// TetGen aborts without a word on a surface that crosses itself; asked to look for just that, it names the
  /// triangles.
  [[noreturn]] void refuse(const TetrahedralizationRequest& request, const std::filesystem::path& folder) const {
    detail::run_process({program, "-dBF", (folder / "surface.smesh").string()}, folder / "log", {});
    const std::string log = detail::read_text(folder / "log");
    const std::size_t at = log.find("at triangles:");
    std::array<index_t, 3> a{}, b{};
    if (at == std::string::npos || std::sscanf(log.c_str() + at, "at triangles: ( %u, %u, %u) and ( %u, %u, %u", &a[0],
                                               &a[1], &a[2], &b[0], &b[1], &b[2]) != 6)
      throw invalid_surface(
          "tetgen refuses the surface, but names no triangles that cross: parts of it may touch or coincide");
    const std::size_t i = triangle_of(request, a), j = triangle_of(request, b);
    throw invalid_surface("the surface crosses itself at triangles " + std::to_string(i) + " and " + std::to_string(j),
                          Entity::triangle, {i, j});
  }

  static std::size_t triangle_of(const TetrahedralizationRequest& request, const std::array<index_t, 3>& vertices) {
    const auto same = [&](const std::array<index_t, 3>& t) { return detail::sorted(t) == detail::sorted(vertices); };
    return static_cast<std::size_t>(std::find_if(request.triangles.begin(), request.triangles.end(), same) -
                                    request.triangles.begin());
  }

  static TetrahedralizationResult read(const TetrahedralizationRequest& request, const std::filesystem::path& nodes,
                                       const std::filesystem::path& elements) {
    TetrahedralizationResult result;
    const std::vector<Vector3> points = detail::read_nodes(nodes);
    const std::size_t n = request.points.size();
    // Written with 16 digits, so a point comes back with its last bit changed at most.
    for (std::size_t v = 0; v < n; ++v)
      if (v >= points.size() || (points[v] - request.points[v]).norm() > 1e-12 * (1 + request.points[v].norm()))
        throw tetrahedralization_error("tetgen renumbered its input at point " + std::to_string(v), Entity::vertex,
                                       {v});
    result.extra_points.assign(points.begin() + static_cast<std::ptrdiff_t>(n), points.end());
    result.tets = detail::read_tets(elements);
    return result;
  }
};

static_assert(Tetrahedralizer<TetgenProcess>);

}  // namespace framehex
