#include "pcm/cluster/level_jobs.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/bpc/checksum.h"
#include "pcm/cluster/shared_record.h"
#include "pcm/cluster/stages.h"
#include "pcm/system/error.h"
#include "pcm/threads/for_each_index.h"

namespace pcm {

template <class Coord>
std::vector<unsigned> owners_of_bins(const TopTree<Coord>& top, const BinFiles<Coord>& bins, unsigned ranks)
{
    std::vector<std::size_t> order;
    std::vector<std::uint32_t> nodes{0};
    std::uint64_t points = 0, before = 0;
    while (!nodes.empty()) {
        const auto& node = top.nodes[nodes.back()];
        nodes.pop_back();
        if (node.children[0]) {
            nodes.insert(nodes.end(), {node.children[1], node.children[0]});
        } else {
            order.push_back(node.bin);
            points += bins.rows(node.bin);
        }
    }
    std::vector<unsigned> owner(bins.bins().points().bins(), 0);
    for (const std::size_t bin : order) {
        owner[bin] = static_cast<unsigned>(static_cast<double>(before) / static_cast<double>(points) * ranks);
        before += bins.rows(bin);
    }
    return owner;
}

template <class Coord>
void LevelFiles::choose(const Ingested& cloud, const TopTree<Coord>& top, BinFiles<Coord>& bins)
{
    for (std::size_t bin = 0; bin < points_.size(); ++bin) points_[bin] = bins.rows(bin);
    all_.jobs.begin(stage::levels);
    all_.jobs.begin(stage::levelled);
    const std::vector<std::byte> record =
        find_or_make(all_.team, all_.jobs, {stage::levelled}, [&] { return sample(cloud, top, bins); });
    ByteReader in(record.data(), record.size(), all_.work.folder);
    spacings_.resize(in.get<std::uint64_t>());
    for (double& spacing : spacings_) spacing = in.get<double>();
    for (auto& histogram : histograms_) {
        histogram.resize(spacings_.size());
        for (std::uint64_t& points : histogram) points = in.get<std::uint64_t>();
    }
}

// Returns what the record of all levels holds; each rank has written the levels of its bins.
template <class Coord>
std::vector<std::byte> LevelFiles::sample(const Ingested& cloud, const TopTree<Coord>& top, BinFiles<Coord>& bins)
{
    const unsigned threads = all_.work.bin_threads(cloud.layout, cloud.observed.points);
    LevelExchange<Coord> exchange(all_.team, owners_of_bins(top, bins, all_.team.size()));
    for (std::size_t bin = 0; bin < points_.size(); ++bin)
        if (points_[bin] > 0 && exchange.owns(bin)) bins.load(bin);
    LevelSampler<Coord> sampler(bins.bins().points(), Lattice(cloud.grid), all_.options.sampling,
                                all_.jobs.unfinished({stage::levels}));
    sampler.share(exchange);
    sampler.run(threads, [&](double fraction) { all_.work.watch.report("Choosing levels", 0.5 + 0.2 * fraction); });
    all_.work.space.take(sampler.bytes());
    for_each_index(
        points_.size(), threads,
        [&](std::size_t bin) {
            if (points_[bin] == 0 || !exchange.owns(bin) || all_.jobs.is_done({stage::levels, bin})) return;
            const std::vector<std::uint8_t> levels = sampler.levels(bin);
            ByteWriter record;
            record.put(checksum(levels.data(), levels.size()));
            const auto* const bytes = reinterpret_cast<const std::byte*>(levels.data());
            all_.jobs.write({stage::levels, bin}, {bytes, bytes + levels.size()}, record.bytes());
        },
        [&](std::size_t) { all_.work.watch.report("Choosing levels", 0.7); });
    ByteWriter record;
    record.put(static_cast<std::uint64_t>(sampler.spacings().size()));
    for (const double spacing : sampler.spacings()) record.put(spacing);
    for (std::size_t bin = 0; bin < points_.size(); ++bin)
        for (const std::uint64_t points : sampler.histogram(bin)) record.put(points);
    return std::move(record.bytes());
}

std::vector<std::uint8_t> LevelFiles::levels(std::size_t bin) const
{
    const std::vector<std::byte> record = all_.jobs.record({stage::levels, bin});
    const File file(all_.jobs.file({stage::levels, bin}), File::Mode::read);
    std::vector<std::uint8_t> levels(points_[bin]);
    file.read_at(levels.data(), levels.size(), 0);
    ByteReader in(record.data(), record.size(), file.path());
    if (in.get<std::uint64_t>() != checksum(levels.data(), levels.size())) throw scratch_changed(file.path(), 0);
    return levels;
}

#define PCM_INSTANTIATE(Coord)                                                                  \
    template void LevelFiles::choose(const Ingested&, const TopTree<Coord>&, BinFiles<Coord>&); \
    template std::vector<unsigned> owners_of_bins(const TopTree<Coord>&, const BinFiles<Coord>&, unsigned);
PCM_INSTANTIATE(std::uint32_t)
PCM_INSTANTIATE(std::uint64_t)
#undef PCM_INSTANTIATE

}  // namespace pcm
