// GEOS: GEOSSimplify, its DouglasPeuckerLineSimplifier on line strings.
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/peers.hpp"

#ifdef SCANSION_BENCH_GEOS

#include <geos_c.h>

namespace scansion::bench {
namespace {

class GeosSimplifier final : public Simplifier {
public:
  explicit GeosSimplifier(const PlaneLines& lines) : context_(GEOS_init_r()) {
    std::vector<double> u;
    std::vector<double> v;
    for (const auto& points : lines) {
      if (points.size() < 2) continue; // no line string to GEOS
      u.clear();
      v.clear();
      for (const PlanePoint& p : points) {
        u.push_back(p.u);
        v.push_back(p.v);
      }
      GEOSCoordSequence* sequence =
          GEOSCoordSeq_copyFromArrays_r(context_, u.data(), v.data(), nullptr, nullptr, static_cast<unsigned>(u.size()));
      lines_.push_back(GEOSGeom_createLineString_r(context_, sequence));
    }
  }
  ~GeosSimplifier() override {
    for (GEOSGeometry* line : lines_) GEOSGeom_destroy_r(context_, line);
    GEOS_finish_r(context_);
  }
  GeosSimplifier(const GeosSimplifier&) = delete;
  GeosSimplifier& operator=(const GeosSimplifier&) = delete;

  std::size_t run(double tolerance_mm) override {
    std::size_t kept = 0;
    for (const GEOSGeometry* line : lines_) {
      GEOSGeometry* out = GEOSSimplify_r(context_, line, tolerance_mm);
      kept += static_cast<std::size_t>(GEOSGeomGetNumPoints_r(context_, out));
      GEOSGeom_destroy_r(context_, out);
    }
    return kept;
  }

private:
  GEOSContextHandle_t context_;
  std::vector<GEOSGeometry*> lines_;
};

} // namespace

std::unique_ptr<Simplifier> geos_simplifier(const PlaneLines& lines) {
  return std::make_unique<GeosSimplifier>(lines);
}

} // namespace scansion::bench

#else

namespace scansion::bench {

std::unique_ptr<Simplifier> geos_simplifier(const PlaneLines& /*lines*/) {
  return nullptr;
}

} // namespace scansion::bench

#endif
