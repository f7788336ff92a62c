// What a build by many ranks sends and keeps, for clouds that no machine here holds: bins of a survey by the planner of
// the build, their owners, and their neighbours at each spacing; points are counted, not made.
//
//   simulate_scale POINTS BIN_POINTS RANKS...      a line of JSON for each number of ranks
//
// Model. Points lie evenly in the box of their bin, seen from above. A level of spacing s has `packing` / s^2 points on
// an area of 1 in all, which is the density of a maximal set of points that are s apart, and no more than there are. Of
// those that a level adds, each is sent to the owners of bins nearer to it than s.
#include "pcm/build/bins/strided_sample.h"
#include "pcm/build/bins/top_tree.h"
#include "pcm/build/levels/bin_neighbours.h"
#include "pcm/build/levels/lattice.h"
#include "pcm/system/peak_memory.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <random>
#include <set>

namespace {

using Coord = std::uint32_t;
using Cloud = std::vector<pcm::Point<Coord>>;
using Bins = pcm::SortedPoints<Coord>;

constexpr double packing = 0.70;  // disks of diameter s cover 0.547 of a plane that takes no more of them
constexpr double point_bytes = 3 * sizeof(Coord);
constexpr std::size_t sample_a_bin = 75;

// A flat survey, a third of it in strips that overlap: three times as dense.
Cloud survey(std::size_t count)
{
    std::mt19937_64 random(1);
    const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    Cloud points(count);
    for (pcm::Point<Coord>& p : points) {
        const double u = unit(), v = random() % 2 ? unit() : (std::floor(unit() * 8) + unit() / 4) / 8;
        p = {static_cast<Coord>(u * 4e9), static_cast<Coord>(v * 4e9),
             static_cast<Coord>(1e6 * (2 + std::sin(u * 90) + std::cos(v * 70)))};
    }
    return points;
}

double length(const Bins::Box& box, std::size_t axis)
{
    return static_cast<double>(box.high[axis]) - static_cast<double>(box.low[axis]) + 1;
}

double area(const Bins::Box& box) { return length(box, 0) * length(box, 1); }

// The part of a box that is nearer than `spacing` to the other, from above.
double area_near(const Bins::Box& box, const Bins::Box& other, double spacing)
{
    double product = 1;
    for (const std::size_t axis : {0, 1}) {
        const double low = std::max<double>(box.low[axis], other.low[axis] - spacing);
        const double high = std::min<double>(box.high[axis], other.high[axis] + spacing);
        product *= std::max(0.0, high - low);
    }
    return product;
}

double chosen(const Bins::Box& box, double spacing)
{
    return std::min(static_cast<double>(box.points), packing * area(box) / (spacing * spacing));
}

struct Level {
    double spacing;
    std::optional<pcm::BinNeighbours<Coord>::Lists> near;
    std::size_t groups;
};

void print(const Bins& bins, const std::vector<std::size_t>& order, const std::vector<Level>& levels, unsigned ranks)
{
    std::vector<unsigned> owner(bins.bins());
    for (std::size_t i = 0; i < order.size(); ++i) owner[order[i]] = static_cast<unsigned>(i * ranks / order.size());
    std::vector<double> sent(ranks);
    std::vector<std::set<unsigned>> partners(ranks);
    double to_all = 0;
    std::size_t exchanges = 0, broadcasts = 0;
    for (const Level& level : levels) {
        if (level.near)
            exchanges += level.groups;
        else
            broadcasts += ranks;
        for (std::size_t bin = 0; bin < bins.bins(); ++bin) {
            const Bins::Box& box = bins.box(bin);
            if (box.points == 0) continue;
            const double added = chosen(box, level.spacing) - chosen(box, 2 * level.spacing);
            if (!level.near) {
                to_all += added * point_bytes;
                continue;
            }
            std::map<unsigned, double> near;
            for (const std::uint32_t other : (*level.near)[bin])
                if (owner[other] != owner[bin]) near[owner[other]] += area_near(box, bins.box(other), level.spacing);
            for (const auto& [rank, its_area] : near) {
                sent[owner[bin]] += point_bytes * added * std::min(1.0, its_area / area(box));
                partners[owner[bin]].insert(rank);
            }
        }
    }
    double all = 0, most = 0, points = 0;
    std::size_t most_partners = 0;
    for (unsigned rank = 0; rank < ranks; ++rank) {
        all += sent[rank];
        most = std::max(most, sent[rank]);
        most_partners = std::max(most_partners, partners[rank].size());
    }
    for (std::size_t bin = 0; bin < bins.bins(); ++bin) points += static_cast<double>(bins.box(bin).points);
    std::printf(
        "{\"ranks\": %u, \"border_bytes\": %.3g, \"border_bytes_a_point\": %.2g, \"most_of_a_rank\": %.3g, "
        "\"most_partners\": %zu, \"exchanges\": %zu, \"bytes_to_all\": %.3g, \"broadcasts_at_most\": %zu}\n",
        ranks, all, all / points, most, most_partners, exchanges, to_all, broadcasts);
}

// The numbers of the bins in the order of the tree.
std::vector<std::size_t> in_order(const pcm::TopTree<Coord>& top)
{
    std::vector<std::size_t> order;
    std::vector<std::uint32_t> nodes{0};
    while (!nodes.empty()) {
        const auto& node = top.nodes[nodes.back()];
        nodes.pop_back();
        if (node.children[0])
            nodes.insert(nodes.end(), {node.children[1], node.children[0]});
        else
            order.push_back(node.bin);
    }
    return order;
}

// Bins are as large as the cuts let them be: boxes of the few points of a sample would have gaps between them.
void put_boxes(const Cloud& sample, const pcm::TopTree<Coord>& top, std::uint64_t points, std::size_t count, Bins& bins)
{
    std::vector<Bins::Box> cells(top.nodes.size());
    cells[0].low = cells[0].high = sample[0];
    std::vector<std::size_t> sampled(count, 0);
    for (const pcm::Point<Coord>& p : sample) {
        ++sampled[top.bin_of(p)];
        for (std::size_t a = 0; a < 3; ++a) {
            cells[0].low[a] = std::min(cells[0].low[a], p[a]);
            cells[0].high[a] = std::max(cells[0].high[a], p[a]);
        }
    }
    bins.resize(count);
    for (std::size_t n = 0; n < top.nodes.size(); ++n) {  // children follow their parents
        const auto& node = top.nodes[n];
        if (node.children[0]) {
            cells[node.children[0]] = cells[node.children[1]] = cells[n];
            cells[node.children[0]].high[node.axis] = node.value - 1;
            cells[node.children[1]].low[node.axis] = node.value;
            continue;
        }
        cells[n].points = static_cast<std::uint64_t>(static_cast<double>(sampled[node.bin]) /
                                                     static_cast<double>(sample.size()) * static_cast<double>(points));
        bins.set_box(node.bin, cells[n]);
    }
}

// From the coarsest that adds points to the finest of which not all points are chosen.
std::vector<Level> levels_of(const Bins& bins)
{
    const pcm::Lattice lattice;
    const pcm::BinNeighbours<Coord> neighbours(bins, lattice);
    std::vector<Level> levels;
    for (int size = 31; size >= 0; --size) {
        Level level{lattice.spacing(size), neighbours.lists(lattice.spacing(size)), 0};
        if (level.near) level.groups = neighbours.apart(*level.near).size();
        double all = 0, points = 0;
        for (std::size_t bin = 0; bin < bins.bins(); ++bin) {
            all += chosen(bins.box(bin), level.spacing);
            points += static_cast<double>(bins.box(bin).points);
        }
        levels.push_back(std::move(level));
        if (all > points / 2) break;  // the build stops here too: the rest is the finest level
    }
    return levels;
}

}  // namespace

int main(int count, char** argument)
{
    if (count < 4) return std::fprintf(stderr, "simulate_scale POINTS BIN_POINTS RANKS...\n"), 2;
    const auto points = static_cast<std::uint64_t>(std::strtod(argument[1], nullptr));
    const auto per_bin = std::max<std::uint64_t>(std::strtoull(argument[2], nullptr, 10), points >> 18);
    const std::uint64_t sampled = points / pcm::sample_stride(points);
    Cloud sample = survey(std::min<std::uint64_t>(sampled, points / per_bin * 4 / 3 * sample_a_bin + 1000));
    const auto start = std::chrono::steady_clock::now();
    pcm::TopTree<Coord> top;
    const std::size_t planned = pcm::TopPlanner<Coord>(top, {0, 0, 0}, per_bin).plan(0, sample, points, 0);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const std::filesystem::path file =
        std::filesystem::temp_directory_path() / ("simulate_scale." + std::to_string(std::random_device()()));
    Bins bins(file);
    put_boxes(sample, top, points, planned, bins);
    const std::vector<Level> levels = levels_of(bins);
    std::printf(
        "{\"points\": %.3g, \"bins\": %zu, \"levels\": %zu, \"plan_s_a_million_of_the_sample\": %.3f, "
        "\"sample_bytes_of_rank_0\": %.3g, \"peak_bytes\": %.3g}\n",
        static_cast<double>(points), planned, levels.size(), seconds / static_cast<double>(sample.size()) * 1e6,
        static_cast<double>(sampled) * point_bytes, static_cast<double>(pcm::peak_memory_bytes()));
    for (int a = 3; a < count; ++a) print(bins, in_order(top), levels, static_cast<unsigned>(std::atoi(argument[a])));
}
