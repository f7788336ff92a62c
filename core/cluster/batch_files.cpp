#include "pcm/cluster/batch_files.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/build/build_checkpoint.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <utility>

namespace pcm {

LateFacts LateFacts::since(const FileInfo& now, std::size_t notes, std::size_t blocks)
{
    return {{now.notes.begin() + static_cast<std::ptrdiff_t>(notes), now.notes.end()},
            {now.metadata.begin() + static_cast<std::ptrdiff_t>(blocks), now.metadata.end()}};
}

void LateFacts::save(ByteWriter& out) const
{
    out.put(static_cast<std::uint64_t>(notes.size()));
    for (const std::string& note : notes) out.put_string(note);
    out.put(static_cast<std::uint64_t>(metadata.size()));
    for (const Metadata& block : metadata) {
        out.put_string(block.key);
        out.put(static_cast<std::uint64_t>(block.value.size()));
        out.put_bytes(block.value.data(), block.value.size());
    }
}

LateFacts LateFacts::load(ByteReader& in)
{
    LateFacts facts;
    for (auto left = in.get<std::uint64_t>(); left > 0; --left) facts.notes.push_back(in.get_string());
    for (auto left = in.get<std::uint64_t>(); left > 0; --left) {
        Metadata block;
        block.key = in.get_string();
        const auto bytes = in.get<std::uint64_t>();
        const std::byte* const from = in.get_bytes(bytes);
        block.value.assign(from, from + bytes);
        facts.metadata.push_back(std::move(block));
    }
    return facts;
}

void LateFacts::add_to(FileInfo& info) const
{
    const auto add = [](const auto& from, auto& to) {
        for (const auto& item : from)
            if (std::find(to.begin(), to.end(), item) == to.end()) to.push_back(item);
    };
    add(notes, info.notes);
    add(metadata, info.metadata);
}

void save_batch(const BatchFacts& batch, const Scratch& scratch, ByteWriter& record)
{
    record.put(static_cast<std::uint8_t>(batch.kept));
    record.put(static_cast<std::uint8_t>(batch.rounded));
    save_observed(batch.observed, record);
    batch.late.save(record);
    BinRows::save(scratch, record);
}

BatchFacts take_batches(Team& team, const JobFolder& jobs, const char* stage, std::size_t batches, std::size_t bins,
                        BinRows& rows, FileInfo& info)
{
    ByteWriter mine;
    mine.put(std::uint8_t(1));
    for (std::size_t i = team.rank(); i < batches; i += team.size()) {  // each rank reads some
        const std::vector<std::byte> record = jobs.record({stage, i});
        if (record[0] == std::byte(0)) mine.bytes()[0] = std::byte(0);
        mine.put_bytes(record.data(), record.size());
    }
    const std::vector<Team::Bytes> all = team.gather(std::move(mine.bytes()));
    std::vector<ByteReader> in;
    BatchFacts together;
    const std::filesystem::path folder = jobs.file({stage}).parent_path();
    for (const Team::Bytes& bytes : all) {
        in.emplace_back(bytes.data(), bytes.size(), folder);
        together.kept = in.back().get<std::uint8_t>() && together.kept;
    }
    if (!together.kept) return together;
    rows.add_bins(bins);
    for (std::size_t i = 0; i < batches; ++i) {
        ByteReader& from = in[i % team.size()];
        from.get<std::uint8_t>();
        together.rounded = from.get<std::uint8_t>() || together.rounded;
        together.observed.merge(load_observed(from));
        LateFacts::load(from).add_to(info);
        const std::uint32_t file = rows.add_file(jobs.file({stage, i}));
        for (auto& [bin, piece] : BinRows::load(from, file)) {
            if (bin >= rows.bins())
                throw Error(ErrorCode::corrupt, jobs.file({stage, i}), "it has rows of unknown bins");
            rows.add(bin, std::move(piece));
        }
    }
    return together;
}

}  // namespace pcm
