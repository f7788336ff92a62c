#include "pcm/tree/column_shares.h"

#include "pcm/bpc/chunk_header.h"

#include <algorithm>

namespace pcm {
namespace {

constexpr double weight_of_newest = 0.1;
// Columns that are at least this share of what lies before their end are read with the rest of it.
constexpr double most = 0.5;
// An estimated end is moved by this much, so that a second read is rare.
constexpr double slack = 1.05;
constexpr std::uint64_t slack_bytes = 4096;

}  // namespace

void ColumnShares::learn(const BpcHeader& header)
{
    const auto all = static_cast<double>(header.total_bytes - header.header_bytes);
    if (all <= 0) return;
    std::vector<const BpcColumn*> columns = {&header.positions, header.sizes ? &*header.sizes : nullptr};
    for (const BpcColumn& column : header.attributes) columns.push_back(&column);
    const std::lock_guard lock(mutex_);
    const bool first = shares_.empty();
    if (columns.size() > shares_.size()) shares_.resize(columns.size());
    for (std::size_t k = 0; k < columns.size(); ++k) {
        if (!columns[k] || columns[k]->bytes == 0) continue;
        const double bytes = static_cast<double>(columns[k]->bytes) / all;
        const double end = static_cast<double>(columns[k]->offset + columns[k]->bytes - header.header_bytes) / all;
        Share& share = shares_[k];
        share.bytes = first ? bytes : share.bytes + weight_of_newest * (bytes - share.bytes);
        share.end = std::max(end, share.end + weight_of_newest * (end - share.end));
    }
}

ColumnShares::Sum ColumnShares::sum(const ColumnSet& columns) const
{
    Sum sum;
    for (std::size_t k = 0; k < shares_.size(); ++k) {
        const bool wanted = k == 0 ? columns.positions : k == 1 ? columns.sizes : columns.attributes.test(k - 2);
        if (!wanted) continue;
        sum.wanted += shares_[k].bytes;
        sum.end = std::max(sum.end, shares_[k].end);
    }
    return sum;
}

bool ColumnShares::are_most(const ColumnSet& columns) const
{
    const std::lock_guard lock(mutex_);
    return shares_.empty() || sum(columns).wanted >= most;
}

std::uint64_t ColumnShares::at_first(const Extent& extent, const ColumnSet& columns) const
{
    const std::uint64_t header = extent.header_bytes;
    std::uint64_t bytes = extent.bytes;
    if (const std::lock_guard lock(mutex_); !shares_.empty()) {
        const Sum columns_sum = sum(columns);
        if (columns_sum.wanted < most * columns_sum.end) return header;
        const double end = static_cast<double>(extent.bytes - header) * columns_sum.end * slack;
        bytes = std::min(extent.bytes, header + static_cast<std::uint64_t>(end) + slack_bytes);
    }
    return std::max(header, std::min(bytes, most_at_first));
}

}  // namespace pcm
