// Boost.Geometry's simplify. The only unit that includes it: it takes long to compile.
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/peers.hpp"

#include <boost/geometry/algorithms/simplify.hpp>
#include <boost/geometry/core/cs.hpp>
#include <boost/geometry/geometries/linestring.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/strategies/strategies.hpp>

namespace scansion::bench {
namespace {

using Point = boost::geometry::model::d2::point_xy<double>;
using Line = boost::geometry::model::linestring<Point>;

class BoostSimplifier final : public Simplifier {
public:
  explicit BoostSimplifier(const PlaneLines& lines) {
    for (const auto& points : lines) {
      Line& line = lines_.emplace_back();
      line.reserve(points.size());
      for (const PlanePoint& p : points) line.emplace_back(p.u, p.v);
    }
  }
  std::size_t run(double tolerance_mm) override {
    std::size_t kept = 0;
    for (const Line& line : lines_) {
      out_.clear();
      boost::geometry::simplify(line, out_, tolerance_mm);
      kept += out_.size();
    }
    return kept;
  }

private:
  std::vector<Line> lines_;
  Line out_;
};

} // namespace

std::unique_ptr<Simplifier> boost_simplifier(const PlaneLines& lines) {
  return std::make_unique<BoostSimplifier>(lines);
}

} // namespace scansion::bench
