// The vector ranking and order, compiled for processors with AVX2.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/rank/radix_order.hpp"
#include "pipeline/rank/vector_unit.hpp"

namespace scansion {

void rank_avx2(const VectorJob& job) {
  rank_vector(job);
}

bool order_avx2(const OrderJob& job) {
  return RadixOrder(job).run();
}

} // namespace scansion
