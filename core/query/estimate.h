// What a query will cost and find, said before a point is read.
#pragma once

#include "pcm/cache/l2_cache.h"
#include "pcm/query/query.h"

#include <cstdint>
#include <optional>

namespace pcm {

class ReadRates;

enum class EstimatePrecision {
    index,    // from the index alone, in memory
    headers,  // also from the headers of the chunks that the query cuts, which hold the boxes of their segments
};

struct Estimate {
    // No fewer and no more points are selected, conditions and all.
    std::uint64_t points_least = 0, points_most = 0;
    // As if points were spread evenly through the boxes that are cut, which are tight around them. Conditions on
    // attributes are not reckoned with.
    double points_expected = 0;
    bool conditions = false;          // there are conditions on attributes: expected is an upper guess
    std::uint64_t chunks = 0;         // that selected points can be in
    std::uint64_t chunks_cached = 0;  // of them in the cache
    std::uint64_t points_read = 0;    // that are decoded, at most
    std::uint64_t bytes = 0;          // to be read from disk, at most
    std::optional<double> seconds;    // at the rate of earlier reads of this cloud; none were measured when absent
    double own_seconds = 0;           // that the estimate took
};

// `columns` are those that the query reads. Throws what reading headers throws.
Estimate make_estimate(L2Cache& cache, const ReadRates& rates, const Query& query, const ColumnSet& columns,
                       EstimatePrecision precision);

}  // namespace pcm
