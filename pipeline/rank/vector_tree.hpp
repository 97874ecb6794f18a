// The split tree of a run, grown in batches of intervals of like size. Included by the units of each instruction set.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/rank/eight.hpp"

namespace scansion {
namespace {

inline constexpr unsigned kBatch = 64;

/// What one batch of intervals found, by place in the batch.
struct Batch {
  Interval interval[kBatch];
  double bound[kBatch]; ///< squared distance of the parent
  std::uint32_t index[kBatch];
  double numerator[kBatch], denominator[kBatch]; ///< of the squared distance; or, for classes of short reach:
  std::int32_t cross[kBatch], squared[kBatch];   ///< numerator = cross^2, denominator = squared, but for those in `apart`
  std::uint8_t apart[kBatch];
  unsigned apart_count;

  void put(unsigned i, std::uint32_t farthest, double num, double den) {
    index[i] = farthest;
    numerator[i] = num;
    denominator[i] = den;
  }
  void put(unsigned i, const Found& found) { put(i, found.index, found.numerator, found.denominator); }

  void set_apart(unsigned i) {
    apart[apart_count++] = static_cast<std::uint8_t>(i);
    cross[i] = 0;
    squared[i] = 1;
  }

  /// numerator := the squared distance, in counts.
  void divide(unsigned count) {
    for (unsigned i = 0; i < count; ++i) numerator[i] /= denominator[i];
  }
  void divide_short(unsigned count) {
    double saved[kBatch];
    for (unsigned k = 0; k < apart_count; ++k) saved[k] = numerator[apart[k]] / denominator[apart[k]];
    for (unsigned i = 0; i < count; ++i) {
      const auto c = static_cast<double>(cross[i]);
      numerator[i] = c * c / static_cast<double>(squared[i]);
    }
    for (unsigned k = 0; k < apart_count; ++k) numerator[apart[k]] = saved[k];
  }
};

template <class T>
T smaller(T a, T b) {
  return b < a ? b : a;
}
template <class T>
T larger(T a, T b) {
  return a < b ? b : a;
}

// Of the set bits of `mask`, bit i standing for the inner point i of an interval with `inner` of them: the one closest to the
// middle, the lower of two.
inline unsigned closest_to_middle(std::uint64_t mask, unsigned inner) {
  if ((mask & (mask - 1)) == 0) return static_cast<unsigned>(__builtin_ctzll(mask));
  const unsigned middle = (inner - 1) / 2;
  const std::uint64_t lower = mask & ((std::uint64_t{2} << middle) - 1);
  const std::uint64_t upper = mask & ~((std::uint64_t{2} << middle) - 1);
  if (lower == 0) return static_cast<unsigned>(__builtin_ctzll(upper));
  const auto below = 63U - static_cast<unsigned>(__builtin_clzll(lower));
  if (upper == 0) return below;
  const auto above = static_cast<unsigned>(__builtin_ctzll(upper));
  return inner - 1 - 2 * below <= 2 * above - (inner - 1) ? below : above;
}

// The inner point of (a, b) that `bits_of(first, count)` marks and that is closest to the middle. bits_of looks at up to
// `lanes` points from `first` on; at least one inner point is marked.
template <class BitsOf>
std::uint32_t closest_marked(std::uint32_t a, std::uint32_t b, unsigned lanes, BitsOf bits_of) {
  const std::uint32_t middle = a + (b - a) / 2;
  std::uint32_t low = middle + 1; // points below are not looked at yet
  std::uint32_t high = middle + 1;
  // Both sides get equally far from the middle with each step, so the first one that finds a mark finds the closest. A point in
  // the very middle belongs to the lower side.
  unsigned step_above = (b - a) % 2 == 0 ? lanes - 1 : lanes;
  for (;;) {
    const unsigned below = smaller(low - (a + 1), lanes);
    low -= below;
    const std::uint32_t lower = below > 0 ? bits_of(low, below) : 0;
    const unsigned above = smaller(b - high, step_above);
    step_above = lanes;
    const std::uint32_t upper = above > 0 ? bits_of(high, above) : 0;
    if ((lower | upper) != 0) {
      const std::uint32_t k = low + (31U - static_cast<unsigned>(__builtin_clz(lower | 1U)));
      const std::uint32_t l = high + static_cast<unsigned>(__builtin_ctz(upper | 0x80000000U));
      if (upper == 0) return k;
      if (lower == 0) return l;
      return a + b - 2 * k <= 2 * l - (a + b) ? k : l;
    }
    high += above;
  }
}

// Depth of the inner points of short intervals in repeated bisection, the first split being 0.
struct BisectionDepths {
  static constexpr unsigned kInner = 31;
  std::uint8_t depth[kInner + 1][kInner + 1];
  constexpr BisectionDepths() : depth{} {
    for (unsigned inner = 1; inner <= kInner; ++inner) {
      const unsigned middle = (inner - 1) / 2;
      depth[inner][middle] = 0;
      for (unsigned i = 0; i < middle; ++i) depth[inner][i] = static_cast<std::uint8_t>(1 + depth[middle][i]);
      for (unsigned i = middle + 1; i < inner; ++i)
        depth[inner][i] = static_cast<std::uint8_t>(1 + depth[inner - 1 - middle][i - middle - 1]);
    }
  }
};
inline constexpr BisectionDepths kBisection{};

// An interval whose inner points all lie on its chord: distance 0, the order of repeated bisection.
inline void bisect(std::uint32_t a, std::uint32_t b, std::uint32_t first_depth, double* q, std::uint32_t* depth) {
  struct Part {
    std::uint32_t a, b, depth;
  };
  Part stack[40];
  unsigned top = 0;
  stack[top++] = {a, b, first_depth};
  while (top > 0) {
    Part part = stack[--top];
    while (part.b - part.a > BisectionDepths::kInner + 1) {
      const std::uint32_t k = part.a + (part.b - part.a) / 2;
      depth[k] = part.depth;
      q[k] = 0;
      stack[top++] = {k, part.b, part.depth + 1};
      part.b = k;
      ++part.depth;
    }
    const std::uint32_t inner = part.b - part.a - 1;
    const std::uint8_t* pattern = kBisection.depth[inner];
    for (std::uint32_t i = 0; i < inner; ++i) depth[part.a + 1 + i] = part.depth + pattern[i];
    for (std::uint32_t i = 0; i < inner; ++i) q[part.a + 1 + i] = 0;
  }
}

// Search has: kClasses; kExact, intervals of class c <= kExact have c inner points; class_of(a, b), 0 for intervals without
// inner points, and class_of_part<c>, the same for parts of an interval of class c, which are never of a higher class;
// least_inner(class); is_short(class), whether its results are crosses; part_class(class), the one most of its parts are of;
// find<class>(batch, count); for exact classes split_eight<class>(waiting, floor, parts), which says what it did not split, and
// find_apart(batch), one interval.
template <class Search>
class Tree {
public:
  Tree(const VectorJob& job, Search& search) : search_(search), q_(job.distance), depth_(job.depth), floor_(job.squared_floor) {
    const std::uint32_t n = job.n;
    Waiting* place = job.waiting;
    for (unsigned c = 0; c < Search::kClasses; ++c) {
      first_[c] = end_[c] = place;
      const std::size_t most = c == 0 ? 2 * kBatch : n / Search::least_inner(c) + 2 + kEight;
      place += c <= Search::kExact ? smaller(most, kShortWaiting) : most;
    }
    for (std::uint32_t r = 0; r < job.run_count; ++r) {
      const auto [a, b] = job.runs[r];
      q_[a] = q_[b] = __builtin_inf();
      depth_[a] = depth_[b] = 0;
      if (b > a + 1) wait(search.class_of(a, b), a, b, 1, __builtin_inf());
    }
    grow<Search::kClasses - 1>();
  }

private:
  static constexpr unsigned kEight = 8;
  // So many parts of long intervals wait before short ones are split: they stay in the cache.
  static constexpr unsigned kDrain = 1024;

  // Class 0 is kept as well and dropped after each batch: cheaper than a branch that nothing predicts.
  void wait(unsigned c, std::uint32_t a, std::uint32_t b, std::uint32_t level, double bound) {
    Waiting* const place = end_[c];
    place->a = a;
    place->b = c <= Search::kExact ? level : b;
    place->bound = bound;
    end_[c] = place + 1;
  }

  template <unsigned c>
  void grow() {
    if constexpr (c > Search::kExact) {
      while (end_[c] != first_[c]) {
        const auto some = static_cast<unsigned>(smaller<std::ptrdiff_t>(end_[c] - first_[c], kBatch));
        const Waiting* const taken = end_[c] -= some;
        for (unsigned i = 0; i < some; ++i) {
          batch_.interval[i] = {taken[i].a, taken[i].b};
          batch_.bound[i] = taken[i].bound;
        }
        search_.template find<c>(batch_, some);
        if constexpr (Search::is_short(c))
          batch_.divide_short(some);
        else
          batch_.divide(some);
        split<c>(some);
        // Long runs: what has just been looked at is still in the cache.
        if constexpr (c > Search::kExact + 1) {
          constexpr unsigned kPart = Search::part_class(c);
          if (end_[kPart] - first_[kPart] >= kBatch) grow<c - 1>();
        }
        if constexpr (Search::kExact > 0) {
          if (parts_ >= kDrain) grow<Search::kExact>();
        }
      }
      grow<c - 1>();
    } else if constexpr (c > 0) {
      if (end_[c] != first_[c]) grow_eights<c>();
      grow<c - 1>();
    } else {
      parts_ = 0;
    }
  }

  template <unsigned c>
  void split(unsigned some) {
    double* const q = q_;
    std::uint32_t* const depth = depth_;
    for (unsigned i = 0; i < some; ++i) {
      const auto [a, b] = batch_.interval[i];
      const std::uint32_t k = batch_.index[i];
      const double ratio = batch_.numerator[i];
      const std::uint32_t level = larger(depth[a], depth[b]) + 1;
      const double bound = smaller(ratio, batch_.bound[i]);
      q[k] = bound;
      depth[k] = level;
      if (ratio <= floor_) {
        stop(a, b, level, bound);
        continue;
      }
      wait(search_.template class_of_part<c>(a, k), a, k, level + 1, bound);
      wait(search_.template class_of_part<c>(k, b), k, b, level + 1, bound);
    }
    end_[0] = first_[0];
    parts_ += 2 * some;
  }

  // All that wait in an exact class; parts are of lower ones.
  template <unsigned c>
  void grow_eights() {
    Waiting* const end = end_[c];
    end_[c] = first_[c];
    for (Waiting* w = first_[c]; w < end; w += kEight) {
      const auto some = static_cast<unsigned>(smaller<std::ptrdiff_t>(end - w, kEight));
      for (unsigned i = some; i < kEight; ++i) w[i] = w[0];
      const Unsplit unsplit = search_.template split_eight<c>(w, floor_, parts_of_eight_);
      if ((unsplit.apart | unsplit.stopped) == 0 && some == kEight) {
#pragma GCC unroll 8
        for (unsigned i = 0; i < kEight; ++i) put<c>(i);
      } else {
        for (unsigned i = 0; i < some; ++i) {
          if ((unsplit.apart >> i & 1U) != 0)
            split_apart<c>(w[i]);
          else if ((unsplit.stopped >> i & 1U) != 0)
            stop(w[i].a, w[i].a + c + 1, w[i].level, parts_of_eight_.right[i].bound);
          else
            put<c>(i);
        }
      }
      end_[0] = first_[0];
    }
  }

  template <unsigned c>
  void put(unsigned i) {
    const Waiting right = parts_of_eight_.right[i];
    q_[right.a] = right.bound;
    depth_[right.a] = right.level - 1;
    if constexpr (c == 2) {
      const Waiting left = parts_of_eight_.left[i];
      q_[left.a] = left.bound;
      depth_[left.a] = left.level - 1;
    } else if constexpr (c > 2) {
      const std::uint32_t at = parts_of_eight_.at[i];
      *end_[at - 1]++ = parts_of_eight_.left[i];
      *end_[c - at]++ = right;
    }
  }

  template <unsigned c>
  void split_apart(const Waiting& w) {
    const std::uint32_t b = w.a + c + 1;
    batch_.interval[0] = {w.a, b};
    search_.find_apart(batch_);
    const double ratio = batch_.numerator[0] / batch_.denominator[0];
    const std::uint32_t k = batch_.index[0];
    const double bound = smaller(ratio, w.bound);
    q_[k] = bound;
    depth_[k] = w.level;
    if (ratio <= floor_) return stop(w.a, b, w.level, bound);
    wait(k - w.a - 1, w.a, k, w.level + 1, bound);
    wait(b - k - 1, k, b, w.level + 1, bound);
  }

  // An interval that is not split: all on its chord, or no farther than the floor.
  void stop(std::uint32_t a, std::uint32_t b, std::uint32_t level, double bound) {
    if (bound == 0) return bisect(a, b, level, q_, depth_);
    for (std::uint32_t k = a + 1; k < b; ++k) {
      q_[k] = bound;
      depth_[k] = level;
    }
  }

  Search& search_;
  double* q_; ///< squared distances in counts
  std::uint32_t* depth_;
  double floor_; ///< squared, counts
  Waiting* first_[Search::kClasses];
  Waiting* end_[Search::kClasses];
  unsigned parts_ = 0; ///< of long intervals, since the short ones were split last
  Parts parts_of_eight_;
  Batch batch_;
};

// The quotients of finite numbers by one divisor, each rounded once. With fused units two corrections by the remainder, which a
// fused product gives exactly, are faster than a division: the first leaves less than a unit in the last place, and then the
// second rounds as division does (Markstein, 1990).
class Quotients {
public:
  explicit Quotients(double by) : by_(by), reciprocal_(1.0 / by) {}
  double operator()(double x) const {
#if defined(__FMA__)
    const double near = x * reciprocal_;
    const double nearer = correct(x, near);
    return correct(x, nearer);
#else
    return x / by_;
#endif
  }

private:
  double correct(double x, double q) const {
    return __builtin_fma(__builtin_fma(-q, by_, x), reciprocal_, q);
  }
  double by_, reciprocal_;
};

// D = sqrt(RN(K) / RN(L)) * num / den, each step rounded once; end points are infinitely far.
inline void to_millimetres(const VectorJob& job) {
  const Quotients by_den(job.scale_den);
  double* const distance = job.distance;
  for (std::uint32_t i = 0; i < job.n; ++i) distance[i] = by_den(__builtin_sqrt(distance[i]) * job.scale_num);
  for (std::uint32_t r = 0; r < job.run_count; ++r) distance[job.runs[r].a] = distance[job.runs[r].b] = __builtin_inf();
}

template <class Search>
void grow_tree(const VectorJob& job, Search& search) {
  Tree<Search>(job, search);
  to_millimetres(job);
}

} // namespace
} // namespace scansion
