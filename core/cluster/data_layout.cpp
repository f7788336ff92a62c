#include "pcm/cluster/data_layout.h"

#include "pcm/bpc/byte_order.h"

namespace pcm {

void DataLayout::append(std::size_t file, const Run& run)
{
    if (files_.size() <= file) files_.resize(file + 1);
    auto& runs = files_[file];
    if (!runs.empty() && runs.back().source == run.source && runs.back().offset + runs.back().bytes == run.offset)
        runs.back().bytes += run.bytes;
    else
        runs.push_back(run);
}

void DataLayout::add(Draft& draft, std::uint64_t source)
{
    const Run run{source, draft.extent.offset, draft.extent.bytes};
    if (places_.is_in_front(draft)) {
        front_.push_back(&draft);
        sources_.emplace(&draft, run);
        return;
    }
    places_.place(draft, run.bytes);
    append(draft.extent.file, run);
}

void DataLayout::finish()
{
    sort_front(front_);
    std::uint64_t end = 0;
    for (Draft* draft : front_) {
        draft->extent.file = 0;
        draft->extent.offset = end;
        end += draft->extent.bytes;
        append(0, sources_.at(draft));
    }
}

std::vector<std::uint64_t> DataLayout::bytes() const
{
    std::vector<std::uint64_t> bytes;
    for (const auto& runs : files_) {
        bytes.push_back(0);
        for (const Run& run : runs) bytes.back() += run.bytes;
    }
    return bytes;
}

void DataLayout::save(ByteWriter& out) const
{
    out.put(static_cast<std::uint64_t>(files_.size()));
    for (const auto& runs : files_) {
        out.put(static_cast<std::uint64_t>(runs.size()));
        for (const Run& run : runs) {
            out.put(run.source);
            out.put(run.offset);
            out.put(run.bytes);
        }
    }
}

DataLayout DataLayout::load(ByteReader& in)
{
    DataLayout layout;
    layout.files_.resize(in.get<std::uint64_t>());
    for (auto& runs : layout.files_) {
        runs.resize(in.get<std::uint64_t>());
        for (Run& run : runs) {
            run.source = in.get<std::uint64_t>();
            run.offset = in.get<std::uint64_t>();
            run.bytes = in.get<std::uint64_t>();
        }
    }
    return layout;
}

}  // namespace pcm
