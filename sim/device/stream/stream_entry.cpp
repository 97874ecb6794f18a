// scansim stream: the entry of the simulated digitizer that prints points.
// SPDX-License-Identifier: Apache-2.0
#include "sim/device/stream/stream_entry.hpp"

#include "drivers/stream/plan.hpp"
#include "sim/device/stream/stream_device.hpp"

#include <CLI/CLI.hpp>

namespace scansion {
namespace {

struct Options {
  StreamPlan plan;
  std::string format = "text", fields = "x y z", sum = "none", order = "little", sync;
};

Result<StreamPlan> plan_of(const Options& options) {
  StreamPlan plan = options.plan;
  plan.is_binary = options.format == "binary";
  auto fields = stream::parse_fields(options.fields, plan.is_binary);
  if (!fields) return fail(Errc::usage, "--fields ", options.fields, " ", fields.assume_error().context);
  plan.fields = std::move(fields).assume_value();
  const auto sum = stream::parse_checksum(options.sum);
  if (!sum) return fail(Errc::usage, "--checksum ", options.sum, ": unknown");
  plan.sum = *sum;
  plan.is_sum_big_endian = options.order == "big";
  auto sync = stream::parse_sync(options.sync);
  if (!sync) return fail(Errc::usage, "--sync ", options.sync, " ", sync.assume_error().context);
  plan.sync = std::move(sync).assume_value();
  if (plan.is_binary && plan.sum_from > plan.sync.size() + bytes_of(plan.fields))
    return fail(Errc::usage, "--checksum-from: a record is shorter");
  return plan;
}

} // namespace

SimulatedDevice stream_entry() {
  auto options = std::make_shared<Options>();
  SimulatedDevice out;
  out.name = "stream";
  out.meaning = "a digitizer that sends points as rows of text or as records";
  out.add_options = [options](CLI::App& app) {
    StreamPlan& plan = options->plan;
    app.add_option("--format", options->format, "text (default) or binary")->check(CLI::IsMember({"text", "binary"}));
    app.add_option("--fields", options->fields, "fields of a record as in scansiond.toml(5) (default \"x y z\")");
    app.add_option("--decimals", plan.decimals, "decimals of numbers in text (default 3)")->check(CLI::Range(0, 12));
    app.add_option("--checksum", options->sum, "none (default), xor, sum, crc16-modbus, crc16-ccitt, crc32");
    app.add_option("--checksum-from", plan.sum_from, "bytes of a record before the first one in its sum");
    app.add_option("--checksum-order", options->order, "little (default) or big")->check(CLI::IsMember({"little", "big"}));
    app.add_option("--sync", options->sync, "bytes in hex in front of every binary record");
    app.add_option("--mark", plan.mark, "row behind every line of text, instead of a blank one");
    app.add_flag("!--no-blank", plan.has_blank, "no row between lines of text");
    app.add_flag("--asked", plan.is_asked, "begin when the host has sent something");
    app.add_option("--head", plan.head, "text before everything else");
  };
  out.make = [options](LineSource source, const DevicePlan& common) -> Result<std::unique_ptr<DeviceModel>> {
    SCANSION_TRY(plan, plan_of(*options));
    plan.rate = common.rate.value_or(plan.rate);
    plan.at_maximum = common.at_maximum;
    return std::unique_ptr<DeviceModel>(std::make_unique<StreamDevice>(std::move(source), std::move(plan), common.on_network));
  };
  return out;
}

} // namespace scansion
