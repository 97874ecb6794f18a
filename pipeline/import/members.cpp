// Files, folders, archives and standard input, as one list of members.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/import/members.hpp"

#include "pipeline/import/natural_order.hpp"
#include "pipeline/import/unpack.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <fcntl.h>
#include <filesystem>
#include <iterator>
#include <sys/stat.h>
#include <system_error>

namespace scansion {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 5> kEndings{"xyz", "txt", "asc", "csv", "ply"};
constexpr std::array<std::string_view, 3> kPackedEndings{"gz", "xz", "zst"};

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c + ('a' - 'A'));
  return out;
}

bool is_known(std::string_view name) {
  return std::find(kEndings.begin(), kEndings.end(), ending_of(name)) != kEndings.end();
}

class Lister {
public:
  Lister(const std::string& name_for_stdin, Notes& notes) : name_for_stdin_(name_for_stdin), notes_(notes) {}

  Result<void> add(const std::string& input) {
    if (input == "-") return add_standard_input();
    struct stat status {};
    if (::stat(input.c_str(), &status) != 0) return system_error(input + ": cannot be read; check the path", errno);
    return S_ISDIR(status.st_mode) ? add_folder(input) : add_file(input);
  }

  Result<MemberList> finish() {
    if (passed_over_ > 0) {
      const std::string more =
          passed_over_ > kNamed ? " and " + std::to_string(passed_over_ - kNamed) + " more" : std::string();
      notes_.say(Notes::Subject::passed_over,
                 "passed over (ending not xyz, txt, asc, csv or ply): " + passed_over_names_ + more);
    }
    return std::move(list_);
  }

private:
  static constexpr std::size_t kNamed = 5;

  void pass_over(const std::string& name) {
    if (++passed_over_ > kNamed) return;
    passed_over_names_ += (passed_over_ > 1 ? ", " : "") + name;
  }

  Result<void> add_standard_input() {
    UniqueFd fd(::dup(STDIN_FILENO));
    if (!fd) return system_error(name_for_stdin_ + ": standard input cannot be read; connect it to a file or a pipe", errno);
    if (list_.standard_input) return fail(Errc::usage, name_for_stdin_, ": standard input is named twice; name it once");
    list_.standard_input = std::move(fd);
    return add_open(list_.standard_input.get(), name_for_stdin_, {});
  }

  Result<void> add_file(const std::string& path) {
    const UniqueFd fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY));
    if (!fd) return system_error(path + ": cannot be opened; check the path and its permissions", errno);
    return add_open(fd.get(), path, path);
  }

  /// `path` is empty when the file has no name to open it again by; `fd` then outlives the list.
  Result<void> add_open(int fd, const std::string& name, const std::string& path) {
    struct stat status {};
    if (::fstat(fd, &status) != 0) return system_error(name + ": cannot be read", errno);
    if (S_ISDIR(status.st_mode)) return fail(Errc::undecodable, name, ": is a folder; name it by its path");
    if (!S_ISREG(status.st_mode)) return unpack_from(PackedSource{.fd = fd}, name);
    // A shell may have read the first part of standard input already.
    const off_t position = path.empty() ? ::lseek(fd, 0, SEEK_CUR) : 0;
    const auto offset = static_cast<std::uint64_t>(std::max<off_t>(position, 0));
    const auto end = static_cast<std::uint64_t>(status.st_size);
    const std::uint64_t size = end > offset ? end - offset : 0;
    std::array<std::byte, kSniffBytes> start;
    SCANSION_TRY(n, read_at(fd, offset, std::span(start).first(std::min<std::size_t>(start.size(), size)), name));
    const std::string_view text(reinterpret_cast<const char*>(start.data()), n);
    if (packing_of(text) != Packing::none)
      return unpack_from(PackedSource{.fd = fd, .seekable = true, .offset = offset, .size = size}, name);
    list_.members.push_back(Member{.name = name, .path = path, .fd = path.empty() ? fd : -1, .offset = offset, .size = size});
    return success();
  }

  Result<void> unpack_from(const PackedSource& source, const std::string& name) {
    const std::size_t first = list_.members.size();
    const std::size_t passed_over = passed_over_;
    const UnpackPlan plan{.archives = true, .wanted = [this, &name](const std::string& member) {
                            if (is_known(member)) return true;
                            pass_over(name + ":" + member);
                            return false;
                          }};
    SCANSION_TRY(unpack(source, name, plan, list_));
    if (list_.members.size() == first) {
      if (passed_over_ > passed_over)
        return fail(Errc::undecodable, name, ": holds no .xyz, .txt, .asc, .csv or .ply file; check its content");
      return fail(Errc::undecodable, name, ": is empty; give a scan with at least one point");
    }
    SCANSION_TRY(unpack_members_from(first));
    sort_members_from(first);
    return success();
  }

  /// Members of an archive may be packed themselves.
  Result<void> unpack_members_from(std::size_t first) {
    for (std::size_t i = first; i < list_.members.size(); ++i) {
      const Member packed = list_.members[i];
      std::array<std::byte, 16> start;
      SCANSION_TRY(n, read_at(packed.fd, packed.offset,
                              std::span(start).first(std::min<std::size_t>(start.size(), packed.size)), packed.name));
      if (packing_of({reinterpret_cast<const char*>(start.data()), n}) != Packing::packed) continue;
      const std::size_t before = list_.members.size();
      const PackedSource source{.fd = packed.fd, .seekable = true, .offset = packed.offset, .size = packed.size};
      SCANSION_TRY(unpack(source, packed.name, UnpackPlan{.archives = false, .wanted = {}}, list_));
      if (list_.members.size() != before + 1) return fail(Errc::undecodable, packed.name, ": is empty; leave it out");
      list_.members[i] = std::move(list_.members.back());
      list_.members.pop_back();
    }
    return success();
  }

  /// As in extracting a tar archive, a later member takes the place of an earlier one of the same name.
  void sort_members_from(std::size_t first) {
    const auto begin = list_.members.begin() + static_cast<std::ptrdiff_t>(first);
    std::stable_sort(begin, list_.members.end(), [](const Member& a, const Member& b) { return natural_less(a.name, b.name); });
    std::vector<Member> kept;
    for (auto it = begin; it != list_.members.end(); ++it)
      if (it + 1 == list_.members.end() || (it + 1)->name != it->name) kept.push_back(std::move(*it));
    list_.members.erase(begin, list_.members.end());
    std::move(kept.begin(), kept.end(), std::back_inserter(list_.members));
  }

  Result<void> add_folder(const std::string& folder) {
    std::vector<std::string> names;
    std::error_code error;
    fs::recursive_directory_iterator it(folder, error);
    for (; !error && it != fs::recursive_directory_iterator(); it.increment(error)) {
      std::error_code type_error;
      if (it->is_directory(type_error)) continue;
      std::string relative = it->path().lexically_relative(folder).string();
      if (it->is_regular_file(type_error) && is_known(relative)) {
        names.push_back(std::move(relative));
      } else {
        pass_over(it->path().string());
      }
    }
    if (error) return system_error(folder + ": cannot be walked; check the permissions inside", error.value());
    if (names.empty())
      return fail(Errc::undecodable, folder, ": holds no .xyz, .txt, .asc, .csv or .ply file; check its content");
    std::sort(names.begin(), names.end(), [](const std::string& a, const std::string& b) { return natural_less(a, b); });
    for (const std::string& name : names) {
      SCANSION_TRY(add_file((fs::path(folder) / name).string()));
    }
    return success();
  }

  const std::string& name_for_stdin_;
  Notes& notes_;
  MemberList list_;
  std::size_t passed_over_ = 0;
  std::string passed_over_names_;
};

} // namespace

std::uint64_t MemberList::bytes() const noexcept {
  std::uint64_t sum = 0;
  for (const Member& member : members) sum += member.size;
  return sum;
}

std::string ending_of(std::string_view name) {
  std::string text = lower(name.substr(name.find_last_of('/') + 1));
  for (const std::string_view packed : kPackedEndings)
    if (text.ends_with(packed) && text.size() > packed.size() && text[text.size() - packed.size() - 1] == '.') {
      text.resize(text.size() - packed.size() - 1);
      break;
    }
  const std::size_t dot = text.find_last_of('.');
  return dot == std::string::npos ? std::string() : text.substr(dot + 1);
}

bool starts_ply(std::string_view start) noexcept {
  return start.starts_with("ply\n") || start.starts_with("ply\r");
}

bool is_binary(std::string_view start) noexcept {
  return !starts_ply(start) && start.find('\0') != std::string_view::npos;
}

Result<MemberList> list_members(const std::vector<std::string>& inputs, const std::string& name_for_stdin, Notes& notes) {
  if (inputs.empty()) return fail(Errc::usage, "no input; name a file, a folder, an archive or - for standard input");
  Lister lister(name_for_stdin, notes);
  for (const std::string& input : inputs) {
    SCANSION_TRY(lister.add(input));
  }
  return lister.finish();
}

} // namespace scansion
