#include "pcm/tree/read_together.h"

#include "pcm/bpc/chunk_bytes.h"

#include <algorithm>

namespace pcm {

bool follows(const Extent& last, const Extent& next)
{
    const std::uint64_t end = last.offset + last.bytes;
    return last.bytes > 0 && next.bytes > 0 && next.file == last.file && next.offset >= end &&
           next.offset - end <= join_gap;
}

std::vector<std::size_t> read_together(const std::vector<Extent>& extents)
{
    const Extent& first = extents.front();
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < extents.size(); ++i)
        if (extents[i].file == first.file && extents[i].bytes > 0) order.push_back(i);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return extents[a].offset < extents[b].offset; });
    const auto at = std::find(order.begin(), order.end(), std::size_t{0});
    if (at == order.end()) return {0};
    const auto end_of = [&](std::size_t i) { return extents[i].offset + extents[i].bytes; };
    // From the first one on forward, then back, as long as the next chunk is near and there is room.
    auto from = at, to = at + 1;
    std::uint64_t begin = first.offset, end = end_of(0);
    const auto fits = [&](std::uint64_t begins, std::uint64_t ends) { return ends - begins <= most_read_together; };
    for (; to != order.end() && follows(extents[*(to - 1)], extents[*to]) && fits(begin, end_of(*to)); ++to)
        end = end_of(*to);
    for (; from != order.begin() && follows(extents[*(from - 1)], extents[*from]) &&
           fits(extents[*(from - 1)].offset, end);
         --from)
        begin = extents[*(from - 1)].offset;
    return {from, to};
}

}  // namespace pcm
