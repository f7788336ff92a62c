// What a query will find and cost, estimated before any point is read.
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
    // Bounds of the number of selected points; they hold with conditions on attributes too.
    std::uint64_t points_least = 0, points_most = 0;
    // If points were spread evenly through the boxes that the query cuts, which are tight around the points. Conditions
    // on attributes are not taken into account.
    double points_expected = 0;
    bool conditions = false;          // there are conditions on attributes: points_expected is an upper estimate
    std::uint64_t chunks = 0;         // number of chunks that may have selected points
    std::uint64_t chunks_cached = 0;  // the ones of them that the cache holds
    std::uint64_t points_read = 0;    // to be decoded, at most
    std::uint64_t bytes = 0;          // to be read from disk, at most
    std::optional<double> seconds;    // at the rate of earlier reads of this cloud; absent before the first read
    double own_seconds = 0;           // time that the estimate took
};

// `columns` are the ones that the query reads. Throws what reading headers throws.
Estimate make_estimate(L2Cache& cache, const ReadRates& rates, const Query& query, const ColumnSet& columns,
                       EstimatePrecision precision);

}  // namespace pcm
