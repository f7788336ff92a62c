#include "pcm/cluster/bin_rows.h"

#include "pcm/bpc/byte_order.h"

namespace pcm {

std::size_t BinRows::add_bins(std::size_t count)
{
    bins_.resize(bins_.size() + count);
    return bins_.size() - count;
}

std::uint32_t BinRows::add_file(std::filesystem::path path)
{
    files_.push_back(std::move(path));
    return static_cast<std::uint32_t>(files_.size() - 1);
}

void BinRows::add(std::size_t bin, Piece piece)
{
    bins_[bin].rows += piece.rows;
    bins_[bin].pieces.push_back(std::move(piece));
}

// A scratch file with one bin, of which the piece is all.
std::unique_ptr<Scratch> BinRows::open(const Piece& piece) const
{
    ByteWriter one;
    one.put(std::uint64_t(1));
    one.put_bytes(piece.place.data(), piece.place.size());
    const std::filesystem::path& path = files_[piece.file];
    ByteReader in(one.bytes().data(), one.size(), path);
    return std::make_unique<Scratch>(path, cloud_.layout, cloud_.schema, counted_, in);
}

std::vector<std::byte> BinRows::read(std::size_t bin) const
{
    std::vector<std::byte> all;
    all.reserve(rows(bin) * cloud_.layout.bytes);
    read(bin, [&](const std::vector<std::byte>& rows) { all.insert(all.end(), rows.begin(), rows.end()); });
    return all;
}

void BinRows::save(const Scratch& scratch, ByteWriter& out)
{
    std::uint64_t used = 0;
    for (std::size_t bin = 0; bin < scratch.bins(); ++bin) used += scratch.rows(bin) > 0;
    out.put(used);
    for (std::size_t bin = 0; bin < scratch.bins(); ++bin) {
        if (scratch.rows(bin) == 0) continue;
        ByteWriter place;
        scratch.save(bin, place);
        out.put(static_cast<std::uint64_t>(bin));
        out.put(scratch.rows(bin));
        out.put(static_cast<std::uint32_t>(place.size()));
        out.put_bytes(place.bytes().data(), place.size());
    }
}

std::vector<std::pair<std::size_t, BinRows::Piece>> BinRows::load(ByteReader& in, std::uint32_t file)
{
    std::vector<std::pair<std::size_t, Piece>> pieces;
    for (auto left = in.get<std::uint64_t>(); left > 0; --left) {
        const auto bin = in.get<std::uint64_t>();
        Piece piece;
        piece.file = file;
        piece.rows = in.get<std::uint64_t>();
        const auto bytes = in.get<std::uint32_t>();
        const std::byte* const from = in.get_bytes(bytes);
        piece.place.assign(from, from + bytes);
        pieces.emplace_back(bin, std::move(piece));
    }
    return pieces;
}

}  // namespace pcm
