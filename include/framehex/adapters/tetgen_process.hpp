// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/adapters/detail/points_in_cavities.hpp"
#include "framehex/io/input_file.hpp"
#include "framehex/tetrahedralization/tetrahedralizer.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <utility>

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

/// A file of words and numbers, which look the same whatever locale the host has set.
class TextFile {
public:
  explicit TextFile(const std::filesystem::path& path) : path_(path), file_(std::fopen(path.c_str(), "w")) {
    if (!file_) throw io_error(path.string() + ": cannot be opened");
  }
  TextFile(const TextFile&) = delete;
  TextFile& operator=(const TextFile&) = delete;
  ~TextFile() {
    if (file_) std::fclose(file_);
  }

  /// A line of numbers; reals are the shortest decimals that read back as the same number.
  template <class... Numbers>
  void line(const Numbers&... numbers) {
    constexpr std::size_t room = 32;  // a number takes 24 at most
    char text[room * sizeof...(numbers)];
    char* end = text;
    const auto put = [&](const auto number) {
      end = std::to_chars(end, end + room - 1, number).ptr;
      *end++ = ' ';
    };
    (put(numbers), ...);
    end[-1] = '\n';
    std::fwrite(text, 1, static_cast<std::size_t>(end - text), file_);
  }

  /// A full disk shows here at the latest.
  void finish() {
    const bool failed = std::ferror(file_) != 0;
    if (std::fclose(std::exchange(file_, nullptr)) != 0 || failed)
      throw io_error(path_.string() + ": cannot be written (is the disk full?)");
  }

private:
  std::filesystem::path path_;
  std::FILE* file_;
};

inline void write_points(TextFile& file, std::span<const Vector3> points) {
  for (std::size_t i = 0; i < points.size(); ++i) file.line(i, points[i].x(), points[i].y(), points[i].z());
}

inline void write_nodes(const std::filesystem::path& path, std::span<const Vector3> points) {
  TextFile file(path);
  file.line(points.size(), 3, 0, 0);
  write_points(file, points);
  file.finish();
}

inline void write_facets(const std::filesystem::path& path, std::span<const Vector3> points,
                         std::span<const std::array<index_t, 3>> triangles) {
  TextFile file(path);
  file.line(0, 3, 0, 0);
  file.line(triangles.size(), 0);
  for (const auto& t : triangles) file.line(3, t[0], t[1], t[2]);
  const std::vector<Vector3> holes = points_in_cavities(points, triangles);
  file.line(holes.size());
  write_points(file, holes);
  file.line(0);
  file.finish();
}

/// A pipe on which one hears at once that the process that holds its other end has ended.
class EndOfProcess {
public:
  EndOfProcess() {
    if (::pipe2(ends_, O_CLOEXEC) != 0) ends_[0] = ends_[1] = -1;
  }
  EndOfProcess(const EndOfProcess&) = delete;
  EndOfProcess& operator=(const EndOfProcess&) = delete;
  ~EndOfProcess() {
    for (const int end : ends_)
      if (end >= 0) ::close(end);
  }

  /// The child gets the other end as file 3.
  void hand_over(posix_spawn_file_actions_t& actions) const {
    if (ends_[1] >= 0) ::posix_spawn_file_actions_adddup2(&actions, ends_[1], 3);
  }
  void let_go() {
    if (ends_[1] >= 0) ::close(std::exchange(ends_[1], -1));
  }
  /// Returns when the process has ended or the time is up.
  void wait(int milliseconds) const {
    pollfd end{ends_[0], POLLIN, 0};
    ::poll(&end, 1, milliseconds);
  }

private:
  int ends_[2];
};

/// Runs a program, its output going to a file, until it ends or the observer says stop.
/// @return the exit status, or -1 when it was stopped, or -2 when it cannot be started, or -3 when a signal ended it.
inline int run_process(std::vector<std::string> arguments, const std::filesystem::path& log, const Observer& observer) {
  if (!keep_going(observer, "tetrahedra", 0.0)) return -1;  // it may be done before it is looked at again
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, 1, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  ::posix_spawn_file_actions_adddup2(&actions, 1, 2);
  EndOfProcess end;
  end.hand_over(actions);
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
  end.let_go();
  for (;;) {
    int status = 0;
    const pid_t ended = ::waitpid(child, &status, WNOHANG);
    if (ended == child) return WIFEXITED(status) ? WEXITSTATUS(status) : -3;
    if (ended < 0) return -3;
    if (!keep_going(observer, "tetrahedra", 0.0)) {
      ::kill(child, SIGKILL);
      ::waitpid(child, &status, 0);
      return -1;
    }
    end.wait(100);
  }
}

inline std::string read_text(const std::filesystem::path& path) {
  std::ifstream stream(path);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Calls `read` with a cursor over a file that TetGen has written.
template <class Read>
auto read_answer(const std::filesystem::path& path, Read&& read) {
  try {
    const std::string bytes = read_file(path);
    Cursor in(path.filename().string(), bytes, '#');
    return read(in);
  } catch (const io_error& failure) {
    throw tetrahedralization_error("tetgen wrote no result that can be understood: " + std::string(failure.what()));
  }
}

inline std::vector<Vector3> read_nodes(const std::filesystem::path& path) {
  return read_answer(path, [](Cursor& in) {
    std::vector<Vector3> points(in.count("the number of points", 8));
    if (in.number<int>("the dimension") != 3) in.fail("not points in space");
    const auto n_extra = in.number<unsigned>("the number of attributes") + in.number<unsigned>("the number of markers");
    for (Vector3& p : points) {
      in.number<std::size_t>("a point's number");
      for (double& x : p) x = in.number<double>("a coordinate");
      for (unsigned i = 0; i < n_extra; ++i) in.number<double>("an attribute");
    }
    return points;
  });
}

inline std::vector<std::array<index_t, 4>> read_tets(const std::filesystem::path& path) {
  return read_answer(path, [](Cursor& in) {
    std::vector<std::array<index_t, 4>> tets(in.count("the number of tetrahedra", 10));
    if (in.number<int>("the number of corners") != 4) in.fail("not tetrahedra of four corners");
    const auto n_extra = in.number<unsigned>("the number of attributes");
    for (auto& t : tets) {
      in.number<std::size_t>("a tetrahedron's number");
      for (index_t& v : t) v = in.number<index_t>("a vertex");
      for (unsigned i = 0; i < n_extra; ++i) in.number<double>("an attribute");
    }
    return tets;
  });
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
  /// flips only, since the other ways move points; M0/1: do not merge points within 1e-8 of the box (facets may be, as
  /// ever); B F Q: write less.
  std::string switches = "-pYJO2/1M0/1BFQ";

  TetrahedralizationResult operator()(const TetrahedralizationRequest& request) const {
    const detail::TemporaryFolder folder;
    const auto file = [&](const char* name) { return folder.path() / name; };
    // All points in one file: given apart, to be inserted afterwards (switch i), they make TetGen crash now and then.
    detail::write_nodes(file("surface.node"), request.points);
    detail::write_facets(file("surface.smesh"), request.points, request.triangles);
    Ending ending = run(switches, folder.path(), request.observer);
    if (ending == Ending::failed) {
      check_crossings(request, folder.path());
      // The search for where a point lies fails now and then, among points of a lattice; not if they come in other order.
      ending = run(switches + "b0", folder.path(), request.observer);
    }
    if (ending == Ending::stopped) return {.tets = {}, .extra_points = {}, .status = Status::cancelled};
    if (ending == Ending::failed)
      throw invalid_surface(
          "tetgen refuses the surface, but names no triangles that cross: parts of it may touch or coincide");
    return read(request, file("surface.1.node"), file("surface.1.ele"));
  }

private:
  enum class Ending { done, failed, stopped };

  Ending run(const std::string& how, const std::filesystem::path& folder, const Observer& observer) const {
    const int exit = detail::run_process({program, how, (folder / "surface.smesh").string()}, folder / "log", observer);
    if (exit == -2 || exit == 127)
      throw tetrahedralization_error("the program '" + program +
                                     "' is not on the PATH; install it (Debian: apt-get install tetgen)");
    if (exit == -1) return Ending::stopped;
    return exit == 0 && std::filesystem::exists(folder / "surface.1.ele") ? Ending::done : Ending::failed;
  }

  /// TetGen aborts without a word on a surface that crosses itself; asked to look for just that, it names the
  /// triangles.
  void check_crossings(const TetrahedralizationRequest& request, const std::filesystem::path& folder) const {
    detail::run_process({program, "-dBF", (folder / "surface.smesh").string()}, folder / "log", {});
    const std::string log = detail::read_text(folder / "log");
    const std::size_t at = log.find("at triangles:");
    std::array<index_t, 3> a{}, b{};
    if (at == std::string::npos || std::sscanf(log.c_str() + at, "at triangles: ( %u, %u, %u) and ( %u, %u, %u", &a[0],
                                               &a[1], &a[2], &b[0], &b[1], &b[2]) != 6)
      return;
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
    // Written with 16 digits or 17, so a coordinate comes back with its last bits changed at most.
    const auto is_same = [](const Vector3& p, const Vector3& q) {
      return ((p - q).array().abs() <= 1e-14 * q.array().abs()).all();
    };
    for (std::size_t v = 0; v < n; ++v)
      if (v >= points.size() || !is_same(points[v], request.points[v]))
        throw tetrahedralization_error("tetgen renumbered its input at point " + std::to_string(v), Entity::vertex,
                                       {v});
    result.extra_points.assign(points.begin() + static_cast<std::ptrdiff_t>(n), points.end());
    result.tets = detail::read_tets(elements);
    return result;
  }
};

static_assert(Tetrahedralizer<TetgenProcess>);

}  // namespace framehex
