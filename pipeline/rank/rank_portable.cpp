// The vector ranking and order, compiled for any processor.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/rank/radix_order.hpp"
#include "pipeline/rank/vector_unit.hpp"

namespace scansion {

void rank_portable(const VectorJob& job) {
  rank_vector(job);
}

bool order_portable(const OrderJob& job) {
  return RadixOrder(job).run();
}

} // namespace scansion
