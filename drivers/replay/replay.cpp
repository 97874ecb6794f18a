// The replay device: a recorded scan as if its lines came from a scanner.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/driver.hpp"
#include "drivers/replay/options.hpp"

#include <cerrno>
#include <sys/stat.h>

namespace scansion {
namespace {

/// Tells whether a path still names the same content.
struct FileIdentity {
  dev_t device = 0;
  ino_t inode = 0;
  off_t size = 0;
  std::int64_t changed_ns = 0;

  friend bool operator==(const FileIdentity&, const FileIdentity&) = default;
};

Result<FileIdentity> identify(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return system_error(path, errno);
  return FileIdentity{status.st_dev, status.st_ino, status.st_size,
                      std::int64_t{status.st_mtim.tv_sec} * 1'000'000'000 + status.st_mtim.tv_nsec};
}

/// The content itself is wrong: reading the same bytes again cannot help.
bool is_of_content(Errc code) noexcept {
  return code == Errc::undecodable || code == Errc::out_of_range || code == Errc::finer || code == Errc::damaged;
}

class ReplayDriver final : public Driver {
public:
  explicit ReplayDriver(ReplayOptions options)
      : options_(std::move(options)), survey_whole_(!std::holds_alternative<ResolutionGiven>(options_.import.resolution)) {}

  Result<void> open() override {
    SCANSION_TRY(identity, identify(options_.file));
    if (refused_ && refused_->first == identity) return refused_->second;
    refused_.reset();
    identity_ = identity;
    auto importer = Importer::open({options_.file}, options_.import, {});
    if (!importer) return refuse(std::move(importer).assume_error());
    importer_.emplace(std::move(importer).assume_value());
    return success();
  }

  Result<DeviceFacts> start() override {
    // A lattice that turns out too coarse half-way would split the recording: look at all of the file first.
    if (survey_whole_) {
      if (auto surveyed = importer_->survey_all(); !surveyed) return refuse(std::move(surveyed).assume_error());
    }
    facts_.lattice = importer_->lattice();
    facts_.gap_mm = options_.import.gap_mm;
    facts_.live = options_.rate.has_value();
    facts_.pace = options_.rate;
    facts_.rounding_mm = 0.0;
    if (std::holds_alternative<ResolutionGiven>(options_.import.resolution)) {
      SCANSION_TRY(count_mm, resolution_mm(facts_.lattice));
      facts_.rounding_mm = count_mm.value() / 2.0;
    }
    rounding_mm_ = 0.0;
    return facts_;
  }

  Result<Delivery> next(LineBuffer& line, Gap& /*gap*/) override {
    auto more = importer_->next(line);
    if (!more) {
      if (more.assume_error().code != Errc::finer || survey_whole_) return refuse(std::move(more).assume_error());
      survey_whole_ = true; // the next attempt will know better
      return std::move(more).assume_error();
    }
    rounding_mm_ = std::max(rounding_mm_, importer_->counts().rounding_mm);
    if (more.assume_value()) return Delivery::line;
    if (!options_.loop || importer_->counts().lines == 0) return Delivery::end;
    SCANSION_TRY(rewind());
    line.clear();
    return Delivery::nothing;
  }

  void close() noexcept override { importer_.reset(); }
  double rounding_mm() const noexcept override { return rounding_mm_; }

private:
  Result<void> rewind() {
    const double rounding = rounding_mm_;
    const DeviceFacts before = facts_;
    close();
    SCANSION_TRY(open());
    SCANSION_TRY(after, start());
    rounding_mm_ = rounding;
    if (!(after == before)) {
      return fail(Errc::unavailable, options_.file, ": changed while it was played in a loop; a new recording is started");
    }
    return success();
  }

  Error refuse(Error error) {
    if (!is_of_content(error.code)) return error;
    error.context += " (not read again before the file changes)";
    refused_.emplace(identity_, error);
    return error;
  }

  ReplayOptions options_;
  bool survey_whole_; ///< look at all of the file before the first line
  std::optional<Importer> importer_;
  FileIdentity identity_;
  std::optional<std::pair<FileIdentity, Error>> refused_; ///< bad content is not read again before it changes
  DeviceFacts facts_;
  double rounding_mm_ = 0.0;
};

Result<std::unique_ptr<Driver>> make_replay(const OptionValues& values) {
  SCANSION_TRY(options, replay_options(values));
  return std::unique_ptr<Driver>(std::make_unique<ReplayDriver>(std::move(options)));
}

} // namespace

const DriverInfo& replay_driver() noexcept;
const DriverInfo& replay_driver() noexcept {
  static const DriverInfo info{"replay", "plays a recorded scan", replay_schema(), make_replay};
  return info;
}

} // namespace scansion
