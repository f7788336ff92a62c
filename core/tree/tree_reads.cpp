#include "pcm/tree/tree_reads.h"

#include "pcm/system/work_done.h"

namespace pcm {

std::vector<std::string> names_of(const ColumnSet& columns, const Schema& schema)
{
    std::vector<std::string> names;
    if (columns.positions) names.emplace_back("positions");
    if (columns.sizes) names.emplace_back("sizes");
    for (std::size_t a = 0; a < schema.size(); ++a)
        if (columns.attributes.test(a)) names.push_back(schema[a].name);
    return names;
}

void TreeReadCounter::add(const Chunk& chunk, std::uint64_t bytes)
{
    count_points_read(chunk.points);
    const std::lock_guard<std::mutex> lock(mutex_);
    ++reads_.chunks;
    reads_.points += chunk.points;
    reads_.bytes += bytes;
    reads_.columns |= chunk.columns();
}

TreeReads TreeReadCounter::reads() const
{
    const std::lock_guard<std::mutex> lock(mutex_);
    return reads_;
}

}  // namespace pcm
