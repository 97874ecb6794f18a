// Groups from payload marks.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/salvage.hpp"

namespace scansion {
namespace {

/// Collects the payloads of one group.
class Assembler {
public:
  explicit Assembler(const RecordingFacts& facts) : facts_(facts), payloads_(payloads_per_group(facts)) {}

  /// Whether a payload with this header could start a group or be the next one of the open group.
  [[nodiscard]] bool wants(const PayloadHeader& header) const noexcept {
    if (header.kind == PayloadKind::lines) return belongs(header, 0, header, facts_);
    return count_ > 0 && belongs(header, count_, lines_, facts_) && size_ + header.body_size <= kMaxChunk;
  }
  /// True when the group is complete.
  [[nodiscard]] bool take(const PayloadHeader& header, std::uint64_t offset, ByteView payload) {
    if (header.kind == PayloadKind::lines) {
      lines_ = header;
      offset_ = offset;
      count_ = 0;
      size_ = 0;
    }
    payloads_[count_++].assign(payload.begin(), payload.end());
    size_ += payload.size();
    return count_ == payloads_.size();
  }
  [[nodiscard]] Result<void> hand_over(const std::function<Result<void>(const FoundGroup&)>& found) {
    views_.assign(payloads_.begin(), payloads_.end());
    count_ = 0;
    return found({lines_, views_, offset_, false});
  }
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }

private:
  const RecordingFacts& facts_;
  PayloadHeader lines_;
  std::uint64_t offset_ = 0;
  std::uint64_t size_ = 0;
  std::size_t count_ = 0;
  std::vector<Bytes> payloads_;
  std::vector<ByteView> views_;
};

} // namespace

Result<void> WorkBudget::spend(std::uint64_t bytes, const File& file) {
  if (bytes > left_)
    return fail(Errc::damaged, file.path(), ": holds more false starts of groups than a recording can; it is not one");
  left_ -= bytes;
  return success();
}

Result<Salvaged> salvage_groups(Window& window, const RecordingFacts& facts, std::uint64_t from, std::uint64_t to,
                                WorkBudget& budget, const std::function<Result<void>(const FoundGroup&)>& found) {
  const std::string_view mark(reinterpret_cast<const char*>(kPayloadMark.data()), kPayloadMark.size());
  PatternFinder finder(window, std::span(&mark, 1));
  Assembler assembler(facts);
  Salvaged result{0, from};
  for (std::uint64_t at = from; at < to;) {
    SCANSION_TRY(hit, finder.find(at, to));
    if (!hit) break;
    at = hit->offset + 1;
    SCANSION_TRY(head, window.view(hit->offset, std::min<std::uint64_t>(kLongestPayloadHeader, to - hit->offset)));
    const auto header = parse_payload_header(head, to - hit->offset);
    if (!header || !assembler.wants(header.value()) || header.value().body_size > kMaxChunk) continue;
    const std::uint64_t size = payload_size(header.value());
    SCANSION_TRY(budget.spend(size, window.file()));
    SCANSION_TRY(payload, window.view(hit->offset, size));
    if (!check_payload(payload)) continue;
    at = hit->offset + size;
    if (!assembler.take(header.value(), hit->offset, payload)) continue;
    result.grouped += assembler.size();
    result.last_end = at;
    SCANSION_TRY(assembler.hand_over(found));
  }
  return result;
}

} // namespace scansion
