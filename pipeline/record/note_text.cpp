// Messages about feature lines and patches.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/note_json.hpp"
#include "pipeline/record/notes.hpp"

#include <utility>

namespace scansion {
namespace {

using json::put;
using json::put_key;
using json::put_list;
using json::put_word;

constexpr std::size_t kFull = 1U << 20U; // bytes; a message is closed after this many
constexpr std::int64_t kNoPatch = -1;
constexpr double kTenthUm = 1e4; // per mm

void put_mm(std::string& out, double value) {
  put(out, value, kTenthUm);
}
void put_value(std::string& out, double value) {
  put(out, value, 1e3);
}

void put_patch(std::string& out, const Patch& patch) {
  out += '{';
  put_key(out, "id");
  put(out, patch.id);
  put_word(out, "label", name(patch.label));
  put_word(out, "shape", name(patch.shape));
  put_key(out, "samples");
  put(out, patch.samples);
  put_key(out, "area");
  put_value(out, patch.area_mm2);
  put_key(out, "centroid");
  put_list(out, patch.centroid, [&](double v) { put_mm(out, v); });
  put_key(out, "normal");
  put_list(out, patch.normal, [&](double v) { put(out, v, 1e4); });
  put_key(out, "plane_residual");
  put_mm(out, patch.plane_residual_mm);
  put_key(out, "quadric_residual");
  put_mm(out, patch.quadric_residual_mm);
  put_key(out, "neighbours");
  put_list(out, patch.neighbours, [&](std::uint32_t id) { put(out, id); });
  put_key(out, "doubtful");
  out += patch.doubtful ? "true" : "false";
  out += '}';
}

/// Collects entries of lists into messages that stay near kFull bytes.
class Messages {
public:
  explicit Messages(std::uint64_t group) : group_(group) {}

  /// The text to append one entry of `list` to.
  std::string& entry(std::string_view list) {
    if (!text_.empty() && text_.size() >= kFull) close();
    if (text_.empty()) {
      text_ = "{\"group\":";
      put(text_, group_);
      list_ = {};
    }
    if (list_ == list) return text_ += ',';
    if (!list_.empty()) text_ += ']';
    list_ = list;
    begun_ = true;
    ((text_ += ",\"") += list) += "\":[";
    return text_;
  }
  /// Whether the entry just asked for is the first of its list in its message.
  [[nodiscard]] bool begun() noexcept { return std::exchange(begun_, false); }
  std::vector<std::string> take() {
    if (!text_.empty()) close();
    return std::move(done_);
  }

private:
  void close() {
    text_ += "]}";
    done_.push_back(std::move(text_));
    text_.clear();
    list_ = {};
  }

  std::uint64_t group_;
  std::string text_;
  std::string_view list_;
  bool begun_ = false;
  std::vector<std::string> done_;
};

/// The runs of one scan line: where they begin, how long they are, and their patches; or only by how much their lengths differ
/// from those of the line before when all else is the same.
class RunRows {
public:
  explicit RunRows(Messages& messages) : messages_(messages) {}

  void add(const std::vector<PatchRun>& runs) {
    for (std::size_t begin = 0; begin < runs.size();) {
      std::size_t end = begin + 1;
      while (end < runs.size() && runs[end].line == runs[begin].line &&
             runs[end].first >= runs[end - 1].first + runs[end - 1].count)
        ++end;
      row(runs, begin, end);
      begin = end;
    }
  }

private:
  struct Row {
    std::uint64_t line = 0;
    std::uint32_t first = 0;
    std::vector<std::int64_t> counts, patches;
  };

  void row(const std::vector<PatchRun>& runs, std::size_t begin, std::size_t end) {
    std::string& out = messages_.entry("runs");
    const bool whole = messages_.begun();
    fill(runs, begin, end);
    if (whole || now_.line != before_.line + 1 || now_.first != before_.first || now_.patches != before_.patches)
      put_whole(out);
    else
      put_differences(out);
    std::swap(before_, now_);
  }
  void fill(const std::vector<PatchRun>& runs, std::size_t begin, std::size_t end) {
    now_.line = runs[begin].line;
    now_.first = runs[begin].first;
    now_.counts.clear();
    now_.patches.clear();
    std::uint32_t at = now_.first;
    for (std::size_t k = begin; k < end; ++k) {
      if (runs[k].first > at) {
        now_.counts.push_back(runs[k].first - at);
        now_.patches.push_back(kNoPatch);
      }
      now_.counts.push_back(runs[k].count);
      now_.patches.push_back(runs[k].patch);
      at = runs[k].first + runs[k].count;
    }
  }
  void put_whole(std::string& out) const {
    out += '[';
    put(out, now_.line);
    out += ',';
    put(out, now_.first);
    for (const auto* list : {&now_.counts, &now_.patches}) {
      out += ',';
      put_list(out, *list, [&](std::int64_t value) { put(out, value); });
    }
    out += ']';
  }
  void put_differences(std::string& out) {
    for (std::size_t k = 0; k < now_.counts.size(); ++k) before_.counts[k] = now_.counts[k] - before_.counts[k];
    while (!before_.counts.empty() && before_.counts.back() == 0) before_.counts.pop_back();
    put_list(out, before_.counts, [&](std::int64_t value) { put(out, value); });
  }

  Messages& messages_;
  Row before_, now_;
};

std::string backlash_message(std::uint64_t group, const Backlash& backlash) {
  std::string out = "{\"group\":";
  put(out, group);
  out += ",\"lines\":[],\"backlash\":{";
  put_key(out, "along");
  put_mm(out, backlash.mm);
  put_key(out, "deviation");
  put_mm(out, backlash.deviation_mm);
  put_key(out, "taken_off");
  put_mm(out, backlash.taken_off_mm);
  put_key(out, "places");
  put(out, backlash.places);
  return out += "}}";
}

} // namespace

void append_form(std::string& out, const Form& form, double mm_per_unit) {
  out += '{';
  put_word(out, "kind", name(form.kind));
  put_key(out, "patches");
  put_list(out, form.patches, [&](std::uint32_t id) { put(out, id); });
  put_key(out, "confidence");
  put_value(out, form.confidence);
  if (form.hole) {
    put_key(out, "middle");
    put_list(out, form.hole->middle, [&](double v) { put(out, v / mm_per_unit, kTenthUm * mm_per_unit); });
    const auto size = [&](std::string_view key, double value, double per_unit) {
      put_key(out, key);
      put(out, value, per_unit);
    };
    size("along", form.hole->along_mm, kTenthUm);
    size("across", form.hole->across_mm, kTenthUm);
    size("area", form.hole->area_mm2, kTenthUm * kTenthUm);
    size("diameter", form.hole->diameter_mm(), kTenthUm);
    put_key(out, "rim");
    put(out, form.hole->rim);
  }
  out += '}';
}

std::vector<std::string> features_messages(const FeatureReport& report) {
  Messages messages(report.group);
  for (const FeatureLine& line : report.lines) append_line_entry(messages.entry("lines"), line);
  std::vector<std::string> texts = messages.take();
  if (report.backlash) texts.push_back(backlash_message(report.group, *report.backlash));
  return texts;
}

std::vector<std::string> patches_messages(const FeatureReport& report) {
  Messages messages(report.group);
  RunRows(messages).add(report.runs);
  for (const PatchMerge& merge : report.merges) {
    std::string& out = messages.entry("merges");
    put_list(out, std::array{merge.from, merge.into}, [&](std::uint32_t id) { put(out, id); });
  }
  for (const Patch& patch : report.patches) put_patch(messages.entry("patches"), patch);
  for (const Form& form : report.forms) {
    append_form(messages.entry("forms"), form);
  }
  return messages.take();
}

} // namespace scansion
