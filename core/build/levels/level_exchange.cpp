#include "pcm/build/levels/level_exchange.h"

#include "pcm/bpc/byte_order.h"

#include <algorithm>
#include <cstring>
#include <filesystem>

namespace pcm {
namespace {

template <class Coord>
void put_points(ByteWriter& out, std::size_t bin, const std::vector<Point<Coord>>& points)
{
    if (points.empty()) return;
    out.put(static_cast<std::uint32_t>(bin));
    out.put(static_cast<std::uint32_t>(points.size()));
    out.put_bytes(points.data(), points.size() * sizeof points[0]);
}

template <class Coord>
void take_points(const Team::Bytes& bytes, const typename LevelExchange<Coord>::Take& take)
{
    ByteReader in(bytes.data(), bytes.size(), {});
    while (in.left() > 0) {
        const auto bin = in.get<std::uint32_t>();
        std::vector<Point<Coord>> points(in.get<std::uint32_t>());
        const std::size_t size = points.size() * sizeof points[0];
        std::memcpy(points.data(), in.get_bytes(size), size);
        take(bin, points);
    }
}

}  // namespace

template <class Coord>
void LevelExchange<Coord>::connect(const Near& near)
{
    std::vector<bool> is_near(team_.size());
    for (std::size_t bin = 0; bin < near.size(); ++bin)
        if (owns(bin))
            for (const std::uint32_t other : near[bin]) is_near[owner_[other]] = true;
    ranks_.clear();
    for (unsigned rank = 0; rank < team_.size(); ++rank)
        if (is_near[rank] && rank != team_.rank()) ranks_.push_back(rank);
    team_.connect(ranks_);
}

template <class Coord>
bool LevelExchange<Coord>::touches(const std::vector<std::uint32_t>& near) const
{
    return std::any_of(near.begin(), near.end(), [this](std::uint32_t bin) { return owns(bin); });
}

template <class Coord>
void LevelExchange<Coord>::send_borders(const std::vector<std::pair<std::size_t, Found>>& chosen, const Near& near,
                                        const BinNeighbours<Coord>& neighbours, const SortedPoints<Coord>& points,
                                        double spacing, const Take& take)
{
    std::vector<ByteWriter> out(ranks_.size());
    const double squared = spacing * spacing;
    for (const auto& [bin, found] : chosen)
        for (std::size_t r = 0; r < ranks_.size(); ++r) {
            Found wanted;
            for (const Point<Coord>& p : found)
                if (std::any_of(near[bin].begin(), near[bin].end(), [&, rank = ranks_[r]](std::uint32_t other) {
                        return owner_[other] == rank &&
                               neighbours.to_nearest(p, points.box(other)) * (1 - distance_margin) < squared;
                    }))
                    wanted.push_back(p);
            put_points<Coord>(out[r], bin, wanted);
        }
    std::vector<Team::Bytes> bytes;
    for (ByteWriter& of_rank : out) bytes.push_back(std::move(of_rank.bytes()));
    for (const Team::Bytes& received : team_.exchange(std::move(bytes))) take_points<Coord>(received, take);
}

template <class Coord>
void LevelExchange<Coord>::send_all(unsigned from, const std::vector<std::pair<std::size_t, Found>>& chosen,
                                    const Take& take)
{
    ByteWriter out;
    if (from == team_.rank())
        for (const auto& [bin, found] : chosen) put_points<Coord>(out, bin, found);
    const Team::Bytes bytes = team_.broadcast(from, std::move(out.bytes()));
    if (from != team_.rank()) take_points<Coord>(bytes, take);
}

template <class Coord>
void LevelExchange<Coord>::share(std::vector<std::uint64_t>& of_bins)
{
    ByteWriter out;
    for (std::size_t bin = 0; bin < of_bins.size(); ++bin)
        if (owns(bin)) out.put(of_bins[bin]);
    const std::vector<Team::Bytes> all = team_.gather(std::move(out.bytes()));
    std::vector<ByteReader> in;
    for (const Team::Bytes& bytes : all) in.emplace_back(bytes.data(), bytes.size(), std::filesystem::path());
    for (std::size_t bin = 0; bin < of_bins.size(); ++bin) of_bins[bin] = in[owner_[bin]].template get<std::uint64_t>();
}

template class LevelExchange<std::uint32_t>;
template class LevelExchange<std::uint64_t>;

}  // namespace pcm
