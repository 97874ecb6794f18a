// The vector ranking and order, compiled for processors with AVX-512 F, BW, DQ and VL.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/rank/radix_order.hpp"
#include "pipeline/rank/vector_unit.hpp"

namespace scansion {

void rank_avx512(const VectorJob& job) {
  rank_vector(job);
}

bool order_avx512(const OrderJob& job) {
  return RadixOrder(job).run();
}

} // namespace scansion
