#include "pcm/cluster/division_jobs.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/build/bins/divide_bins.h"
#include "pcm/build/build_checkpoint.h"
#include "pcm/cluster/share_jobs.h"
#include "pcm/cluster/stages.h"

#include <map>

namespace pcm {
namespace {

// A bin that was divided by itself: bin 0 and node 0 are its own there.
template <class Coord>
struct DividedBin {
    TopTree<Coord> top;
    std::vector<Division> divisions;
    std::size_t bins = 0;
    std::map<std::size_t, BinRows::Piece> pieces;
};

template <class Coord>
class DivisionJobs {
public:
    DivisionJobs(const TeamWork& all, const Ingested& cloud, TopTree<Coord>& top, BinRows& rows)
        : all_(all),
          cloud_(cloud),
          top_(top),
          rows_(rows),
          finer_(axis_shift(cloud.grid)),
          bin_points_(all.work.bin_points(cloud.observed.points))
    {
    }

    void run()
    {
        std::vector<std::size_t> large;
        for (std::size_t bin = 0; bin < rows_.bins(); ++bin)
            if (is_large_bin(rows_.rows(bin), bin_points_)) large.push_back(bin);
        if (large.empty()) return;
        all_.jobs.begin(stage::divisions);
        share_jobs(
            all_.team, count_divisions, large.size(), 1,
            [&](std::size_t i) {
                if (!all_.jobs.is_done({stage::divisions, large[i]})) divide(large[i]);
            },
            [&](std::size_t) { all_.work.watch.report("Sorting points into bins", 0.4); });
        for (const std::size_t bin : large) divided_.emplace(bin, load(bin));
        number_again();
    }

private:
    void divide(std::size_t bin)
    {
        const JobFolder::Key job{stage::divisions, bin};
        const std::filesystem::path path = all_.jobs.unfinished(job);
        ByteWriter record;
        std::uint64_t bytes;
        {
            const ProgressFunction silent;
            Workspace work(path.parent_path(), all_.work.memory_bytes, all_.work.chunk_points, all_.work.threads,
                           silent);
            Bins<Coord> alone;
            alone.scratch = std::make_shared<Scratch>(path, cloud_.layout, cloud_.schema, all_.work.space);
            alone.scratch->add_bins(1);
            Scratch::Work packing;
            rows_.read(bin, [&](const std::vector<std::byte>& rows) {
                alone.scratch->append(0, rows.data(), rows.size() / cloud_.layout.bytes, packing);
            });
            const std::vector<Division> divisions = divide_large_bins(alone, work, finer_, bin_points_);
            save_top(alone.top, record);
            record.put(static_cast<std::uint64_t>(divisions.size()));
            for (const Division& division : divisions) {
                record.put(division.node);
                record.put(division.first_node);
                record.put(static_cast<std::uint64_t>(division.first_bin));
            }
            record.put(static_cast<std::uint64_t>(alone.scratch->bins()));
            BinRows::save(*alone.scratch, record);
            bytes = alone.scratch->bytes();
        }
        all_.jobs.finish(job, path, bytes, record.bytes());
    }

    DividedBin<Coord> load(std::size_t bin)
    {
        const std::filesystem::path path = all_.jobs.file({stage::divisions, bin});
        const std::vector<std::byte> record = all_.jobs.record({stage::divisions, bin});
        ByteReader in(record.data(), record.size(), path);
        DividedBin<Coord> divided;
        divided.top = load_top<Coord>(in);
        for (auto left = in.get<std::uint64_t>(); left > 0; --left) {
            Division division{};
            division.node = in.get<std::uint32_t>();
            division.first_node = in.get<std::uint32_t>();
            division.first_bin = in.get<std::uint64_t>();
            divided.divisions.push_back(division);
        }
        divided.bins = in.get<std::uint64_t>();
        for (auto& [number, piece] : BinRows::load(in, rows_.add_file(path)))
            divided.pieces.emplace(number, std::move(piece));
        return divided;
    }

    // The divisions of all bins in the order in which one process makes them: node by node, new ones last.
    void number_again()
    {
        struct Origin {
            DividedBin<Coord>* bin = nullptr;
            std::uint32_t node = 0;  // in it
        };
        std::vector<Origin> origins(top_.nodes.size());
        for (std::uint32_t n = 0; n < top_.nodes.size(); ++n) {
            if (top_.nodes[n].children[0]) continue;
            const std::size_t bin = top_.nodes[n].bin;
            if (!origins[n].bin) {
                const auto divided = divided_.find(bin);
                if (divided == divided_.end()) continue;
                origins[n].bin = &divided->second;
            }
            DividedBin<Coord>& from = *origins[n].bin;
            for (std::size_t d = 0; d < from.divisions.size(); ++d) {
                if (from.divisions[d].node != origins[n].node) continue;
                add(n, from, d);
                for (std::uint32_t l = from.divisions[d].first_node; origins.size() < top_.nodes.size(); ++l)
                    origins.push_back({&from, l});
                rows_.forget(bin);
            }
        }
    }

    // Division `d` of a divided bin, below node `n`.
    void add(std::uint32_t n, DividedBin<Coord>& from, std::size_t d)
    {
        const Division& division = from.divisions[d];
        const bool last = d + 1 == from.divisions.size();
        const auto end_node =
            last ? static_cast<std::uint32_t>(from.top.nodes.size()) : from.divisions[d + 1].first_node;
        const std::size_t end_bin = last ? from.bins : from.divisions[d + 1].first_bin;
        const auto first_node = static_cast<std::uint32_t>(top_.nodes.size());
        const std::size_t first_bin = rows_.add_bins(end_bin - division.first_bin);
        const auto moved = [&](std::uint32_t child) { return first_node + (child - division.first_node); };
        const auto& own = from.top.nodes[division.node];
        top_.nodes[n].axis = own.axis;
        top_.nodes[n].value = own.value;
        for (const std::size_t side : {0, 1}) top_.nodes[n].children[side] = moved(own.children[side]);
        for (std::uint32_t l = division.first_node; l < end_node; ++l) {
            auto node = from.top.nodes[l];
            if (node.children[0] && node.children[0] < end_node) {
                for (std::uint32_t& child : node.children) child = moved(child);
            } else {  // a bin, which a later division may divide
                node = {};
                node.bin = first_bin + (from.top.nodes[l].bin - division.first_bin);
            }
            top_.nodes.push_back(node);
        }
        for (std::size_t bin = division.first_bin; bin < end_bin; ++bin)
            if (const auto piece = from.pieces.find(bin); piece != from.pieces.end())
                rows_.add(first_bin + (bin - division.first_bin), std::move(piece->second));
    }

    const TeamWork& all_;
    const Ingested& cloud_;
    TopTree<Coord>& top_;
    BinRows& rows_;
    const AxisShift finer_;
    const std::uint64_t bin_points_;
    std::map<std::size_t, DividedBin<Coord>> divided_;
};

}  // namespace

template <class Coord>
void divide_bins(const TeamWork& team_work, const Ingested& cloud, TopTree<Coord>& top, BinRows& rows)
{
    DivisionJobs<Coord>(team_work, cloud, top, rows).run();
}

template void divide_bins(const TeamWork&, const Ingested&, TopTree<std::uint32_t>&, BinRows&);
template void divide_bins(const TeamWork&, const Ingested&, TopTree<std::uint64_t>&, BinRows&);

}  // namespace pcm
