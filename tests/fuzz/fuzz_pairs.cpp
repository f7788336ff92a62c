// Pairs of points as text. Accepted pairs are written again, and read back as the same numbers; a fit of them gives an
// answer or a refusal.

#include "pcm/align/pair_text.h"
#include "pcm/system/error.h"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

namespace {

bool same(const pcm::PointPair& a, const pcm::PointPair& b)
{
    return a.moving == b.moving && a.fixed == b.fixed && a.weight == b.weight;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    using namespace pcm;
    std::vector<PointPair> pairs;
    try {
        pairs = parse_pairs({reinterpret_cast<const char*>(data), size}, "input");
    } catch (const Error&) {
        return 0;
    }
    const std::vector<PointPair> again = parse_pairs(text_of(pairs), "again");
    if (again.size() != pairs.size()) std::abort();
    for (std::size_t i = 0; i < pairs.size(); ++i)
        if (!same(again[i], pairs[i])) std::abort();
    try {
        for (const double residual : fit_motion(pairs).residuals)
            if (std::isnan(residual)) std::abort();
    } catch (const Error&) {
    }
    return 0;
}
