#include "pcm/cluster/batches.h"

#include <algorithm>

namespace pcm {
namespace {

constexpr std::uint64_t least_batch = 3125, most_batch = 3'200'000;  // 50,000, the usual chunk of LAZ, by powers of two
constexpr std::uint64_t usual_batches = 48;

}  // namespace

std::vector<Batch> batches_of(const std::vector<std::uint64_t>& points_of_files, std::uint64_t size)
{
    std::vector<Batch> batches;
    std::uint64_t first = 0, end = 0;  // the next batch
    const auto finish = [&] {
        if (end > first) batches.push_back({first, end});
        first = end;
    };
    for (const std::uint64_t points : points_of_files) {
        if (end - first + points > size) finish();
        const std::uint64_t end_of_file = end + points;
        while (end_of_file - end > size) {
            end += size;
            finish();
        }
        end = end_of_file;
    }
    finish();
    return batches;
}

std::uint64_t batch_size(std::uint64_t points)
{
    std::uint64_t size = least_batch;
    while (size < most_batch && size * usual_batches < points) size *= 2;
    return size;
}

}  // namespace pcm
