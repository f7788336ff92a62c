#include "pcm/build/levels/level_sampler.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/build/levels/bin_border.h"
#include "pcm/build/levels/grid_levels.h"
#include "pcm/build/levels/points_near.h"
#include "pcm/build/levels/poisson_pass.h"
#include "pcm/build/levels/stop_rule.h"
#include "pcm/system/error.h"
#include "pcm/threads/for_each_index.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcm {

template <class Coord>
LevelSampler<Coord>::LevelSampler(const SortedPoints<Coord>& points, const Lattice& lattice, Sampling sampling,
                                  const std::filesystem::path& scratch, File::Mode mode)
    : points_(points),
      lattice_(lattice),
      sampling_(sampling),
      neighbours_(points, lattice),
      file_(scratch, mode),
      bins_(points.bins())
{
}

template <class Coord>
void LevelSampler<Coord>::add_to(GivenLevels<Coord> given)
{
    given_ = std::move(given);
    sizes_.clear();
    for (const double spacing : given_.spacings) {
        if (spacing == 0) break;
        const int size = spacing > 0 ? std::ilogb(spacing / lattice_.spacing(0) * (1 + distance_margin)) : -1;
        if (size < 0 || size > 62 || std::fabs(spacing / lattice_.spacing(size) - 1) > distance_margin ||
            (!sizes_.empty() && size != sizes_.back() - 1))
            throw Error(ErrorCode::invalid_argument, {},
                        "levels that are not on the ladder of spacings of the cloud's grid");
        sizes_.push_back(size);
    }
    if (sizes_.empty())
        throw Error(ErrorCode::invalid_argument, {}, "a cloud without levels that points could be added to");
}

template <class Coord>
void LevelSampler<Coord>::run(unsigned threads, const std::function<void(double)>& progress)
{
    progress_ = progress;
    if (given_.list)
        run_beside_given(threads);
    else if (sampling_ == Sampling::grid)
        run_by_grid(threads);
    else
        run_by_poisson(threads);
    count_levels();
}

template <class Coord>
void LevelSampler<Coord>::run_by_poisson(unsigned threads)
{
    std::vector<int> sizes;
    for (int size = coarsest_size(); size >= 0; --size) {
        fraction_ = 1 - std::ldexp(1.0, -static_cast<int>(sizes.size()) / 3);
        sizes.push_back(size);
        pass(size, threads);
        if (exchange_) share_lists(size);
        if (fine_enough()) break;
    }
    choose_sizes(sizes);
}

template <class Coord>
void LevelSampler<Coord>::run_by_grid(unsigned threads)
{
    const int top = coarsest_size();
    for_each_bin(threads, [&](std::size_t bin) {
        typename SortedPoints<Coord>::Reader points(points_, bin);
        const auto first = count_first_of_cells<Coord>(points, lattice_.finer, top);
        for (int size = top; size >= 0; --size)
            if (const std::uint32_t count = first[static_cast<std::size_t>(size)])
                bins_[bin].lists.push_back({size, {0, count, 0}});
    });
    for (int size = top; exchange_ && size >= 0; --size) share_lists(size);
    // How many sizes are used follows from how many points each would choose.
    std::vector<int> sizes;
    for (int size = top; size >= 0; --size) {
        sizes.push_back(size);
        for (Bin& bin : bins_) {
            bin.chosen = 0;
            for (const List& list : bin.lists)
                if (list.size >= size) bin.chosen += list.place.count;
        }
        if (fine_enough()) break;
    }
    choose_sizes(sizes);
}

template <class Coord>
void LevelSampler<Coord>::run_beside_given(unsigned threads)
{
    if (sampling_ == Sampling::grid) {
        for_each_bin(threads, [this](std::size_t bin) { sample_given_bin_by_grid(bin); });
        return;
    }
    for_each_bin(threads, [this](std::size_t bin) { bar_points(bin); });
    for (const int size : sizes_) pass(size, threads);
}

// The size of cells such that the whole cloud touches at most 8.
template <class Coord>
int LevelSampler<Coord>::coarsest_size() const
{
    bool any = false;
    Point<Coord> low{}, high{};
    for (std::size_t b = 0; b < bins_.size(); ++b) {
        const auto& box = points_.box(b);
        if (box.points == 0) continue;
        for (std::size_t a = 0; a < 3; ++a) {
            low[a] = any ? std::min(low[a], box.low[a]) : box.low[a];
            high[a] = any ? std::max(high[a], box.high[a]) : box.high[a];
        }
        any = true;
    }
    return any ? std::min(62, lattice_.size_of_box<Coord>(low, high)) : 0;
}

template <class Coord>
bool LevelSampler<Coord>::fine_enough() const
{
    StopRule rule;
    for (std::size_t b = 0; b < bins_.size(); ++b)
        if (points_.box(b).points) rule.see(points_.box(b).points, bins_[b].chosen);
    return rule.reached();
}

template <class Coord>
void LevelSampler<Coord>::choose_sizes(const std::vector<int>& sizes)
{
    // The first sizes, of a few points each, are one level: spacings with fewer are not worth one of their own.
    constexpr std::uint64_t first_level_points = 512;
    std::size_t first = 0;
    for (; first + 1 < sizes.size(); ++first) {
        std::uint64_t chosen = 0;
        for (const Bin& bin : bins_)
            for (const List& list : bin.lists)
                if (list.size >= sizes[first]) chosen += list.place.count;
        if (chosen >= first_level_points) break;
    }
    sizes_.assign(sizes.begin() + static_cast<std::ptrdiff_t>(first), sizes.end());
}

template <class Coord>
void LevelSampler<Coord>::count_levels()
{
    spacings_.clear();
    for (const int size : sizes_) spacings_.push_back(lattice_.spacing(size));
    spacings_.push_back(0);
    std::uint64_t rest = 0;
    for (std::size_t b = 0; b < bins_.size(); ++b) {
        Bin& bin = bins_[b];
        bin.histogram.assign(spacings_.size(), 0);
        std::uint64_t chosen = 0;
        for (const List& list : bin.lists) {
            if (list.size < sizes_.back()) continue;
            bin.histogram[static_cast<std::size_t>(std::max(0, sizes_[0] - list.size))] += list.place.count;
            chosen += list.place.count;
        }
        bin.histogram.back() = points_.box(b).points - chosen;
        rest += bin.histogram.back();
    }
    if (given_.list) {
        std::copy(given_.spacings.begin(), given_.spacings.begin() + static_cast<std::ptrdiff_t>(sizes_.size()),
                  spacings_.begin());
        if (given_.spacings.size() > sizes_.size()) return;  // it has a rest
    }
    if (rest == 0) {
        spacings_.pop_back();
        for (Bin& bin : bins_) bin.histogram.pop_back();
    }
}

template <class Coord>
std::vector<std::uint8_t> LevelSampler<Coord>::levels(std::size_t bin) const
{
    if (sampling_ == Sampling::grid) {
        if (points_.box(bin).points == 0) return {};
        if (given_.list) return file_.read(bins_[bin].bytes, points_.box(bin).points);
        typename SortedPoints<Coord>::Reader points(points_, bin);
        return grid_levels<Coord>(points, lattice_.finer, sizes_);
    }
    std::vector<std::uint8_t> levels(points_.box(bin).points, static_cast<std::uint8_t>(sizes_.size()));
    for (const List& list : bins_[bin].lists)
        for (const std::uint32_t i : file_.read(list.place))
            levels[i] = static_cast<std::uint8_t>(std::max(0, sizes_[0] - list.size));
    return levels;
}

template <class Coord>
void LevelSampler<Coord>::for_each_bin(unsigned threads, const std::function<void(std::size_t)>& work)
{
    for_each_index(
        bins_.size(), threads,
        [&](std::size_t bin) {
            if (points_.box(bin).points > 0 && owns(bin)) work(bin);
        },
        [&](std::size_t begun) { progress_(static_cast<double>(begun) / static_cast<double>(bins_.size())); });
}

template <class Coord>
void LevelSampler<Coord>::sample_given_bin_by_grid(std::size_t number)
{
    Bin& bin = bins_[number];
    typename SortedPoints<Coord>::Reader points(points_, number);
    const auto levels = grid_levels_beside<Coord>(points, points_.box(number), lattice_, sizes_, given_);
    std::vector<std::uint32_t> counts(sizes_.size() + 1, 0);
    for (const std::uint8_t level : levels) ++counts[level];
    for (std::size_t level = 0; level < sizes_.size(); ++level)
        bin.lists.push_back({sizes_[level], {0, counts[level], 0}});
    bin.bytes = file_.write(levels);
}

// What a bin chooses depends on the bins nearer than the spacing that chose before it.
template <class Coord>
void LevelSampler<Coord>::pass(int size, unsigned threads)
{
    if (const auto near = neighbours_.lists(lattice_.spacing(size)))
        pass_in_groups(size, threads, *near);
    else
        pass_one_by_one(size);
}

// Bins of one group are not near each other and are sampled in parallel, the groups one after the other: the same for
// any number of threads.
template <class Coord>
void LevelSampler<Coord>::pass_in_groups(int size, unsigned threads, const typename BinNeighbours<Coord>::Lists& near)
{
    if (exchange_) forget_far_borders(size, near);
    std::size_t done = 0;  // bins of earlier groups
    for (const std::vector<std::size_t>& all : neighbours_.apart(near)) {
        std::vector<std::size_t> group;
        for (const std::size_t bin : all)
            if (owns(bin)) group.push_back(bin);
        std::vector<std::pair<std::size_t, Found>> borders(exchange_ ? group.size() : 0);
        const auto sample = [&](std::size_t i) {
            const std::size_t bin = group[i];
            Found border = keep_border(bin, size, near[bin], sample_bin(bin, size, near[bin]));
            if (exchange_) borders[i] = {bin, std::move(border)};
        };
        const auto tick = [&](std::size_t begun) { report_pass(done + begun); };
        if (group.size() <= 1 || threads == 1)
            for (std::size_t i = 0; i < group.size(); ++i) {
                sample(i);
                tick(i + 1);
            }
        else
            for_each_index(group.size(), threads, sample, tick);
        if (exchange_)
            exchange_->send_borders(borders, near, neighbours_, points_, lattice_.spacing(size),
                                    [this](std::size_t bin, const Found& found) {
                                        auto& border = bins_[bin].border;
                                        border.insert(border.end(), found.begin(), found.end());
                                    });
        done += all.size();
    }
}

// Before a pass: of the other processes' bins, the points that this pass asks for are kept.
template <class Coord>
void LevelSampler<Coord>::forget_far_borders(int size, const typename BinNeighbours<Coord>::Lists& near)
{
    exchange_->connect(near);
    for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
        if (owns(bin) || bins_[bin].border.empty()) continue;
        if (!exchange_->touches(near[bin])) Found().swap(bins_[bin].border);
        keep_border(bin, size, near[bin], {});
    }
}

// At spacings at which most bins are near each other: few points are chosen, so that few bins have any, and only these
// are looked for. All chosen points are kept as if at the border. What an owner's run of bins chose, it sends to all.
template <class Coord>
void LevelSampler<Coord>::pass_one_by_one(int size)
{
    typename BinNeighbours<Coord>::Subset chosen(neighbours_);
    for (std::size_t bin = 0; bin < bins_.size(); ++bin)
        if (!bins_[bin].border.empty()) chosen.add(bin);
    const auto take = [&](std::size_t bin, const Found& found) {
        bins_[bin].border.insert(bins_[bin].border.end(), found.begin(), found.end());
        chosen.add(bin);
    };
    std::vector<std::pair<std::size_t, Found>> run;
    for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
        report_pass(bin);
        if (points_.box(bin).points > 0 && owns(bin)) {
            Found found = sample_bin(bin, size, chosen.near(bin, lattice_.spacing(size)));
            if (!found.empty()) {
                take(bin, found);
                if (exchange_) run.emplace_back(bin, std::move(found));
            }
        }
        if (!exchange_ || (bin + 1 < bins_.size() && exchange_->owner(bin + 1) == exchange_->owner(bin))) continue;
        exchange_->send_all(exchange_->owner(bin), run, take);
        run.clear();
    }
}

// The number of points of the other processes' lists of a size, as in a sample by grid.
template <class Coord>
void LevelSampler<Coord>::share_lists(int size)
{
    std::vector<std::uint64_t> counts(bins_.size(), 0);
    for (std::size_t bin = 0; bin < bins_.size(); ++bin)
        for (const List& list : bins_[bin].lists)
            if (list.size == size) counts[bin] = list.place.count;
    exchange_->share(counts);
    for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
        if (owns(bin) || counts[bin] == 0) continue;
        bins_[bin].lists.push_back({size, {0, static_cast<std::uint32_t>(counts[bin]), 0}});
        bins_[bin].chosen += counts[bin];
    }
}

template <class Coord>
void LevelSampler<Coord>::report_pass(std::size_t bins_done)
{
    const double inside = static_cast<double>(bins_done) / static_cast<double>(std::max<std::size_t>(1, bins_.size()));
    progress_(fraction_ + (1 - fraction_) * 0.2 * inside);
}

template <class Coord>
std::vector<Point<Coord>> LevelSampler<Coord>::given_near(std::size_t number, int size, std::size_t first_level,
                                                          std::size_t last_level,
                                                          typename SortedPoints<Coord>::Reader& points) const
{
    // Only those in or adjacent to a bucket in which the bin has points: a few per point.
    const auto& box = points_.box(number);
    const auto [low, high] = reach_of<Coord>(box, lattice_, lattice_.spacing(size));
    const PointsNear<Coord> near(points, lattice_, size);
    std::vector<Point<Coord>> found;
    given_.list(low, high, first_level, last_level, [&](const Point<Coord>* given, std::size_t count) {
        for (std::size_t n = 0; n < count; ++n)
            if (near(given[n])) found.push_back(given[n]);
    });
    return found;
}

template <class Coord>
void LevelSampler<Coord>::bar_points(std::size_t number)
{
    typename SortedPoints<Coord>::Reader points(points_, number);
    std::vector<std::uint8_t> barred;
    for (std::size_t level = 0; level < sizes_.size(); ++level) {
        const auto given = given_near(number, sizes_[level], level, level, points);
        if (given.empty()) continue;
        barred.resize(points.size(), 255);
        PoissonPass<Coord>(points, lattice_, sizes_[level], {}, given).mark(barred);
    }
    if (!barred.empty()) bins_[number].bytes = file_.write(barred);
}

// The points of a bin that earlier passes chose, ascending.
template <class Coord>
std::vector<std::uint32_t> LevelSampler<Coord>::chosen_in(const Bin& bin, std::uint64_t points) const
{
    std::vector<std::uint32_t> chosen;
    if (bin.lists.empty()) return chosen;
    std::vector<std::uint64_t> is_chosen(points / 64 + 1, 0);
    for (const List& list : bin.lists)
        for (const std::uint32_t i : file_.read(list.place)) is_chosen[i / 64] |= std::uint64_t(1) << i % 64;
    chosen.reserve(bin.chosen);
    for (std::size_t word = 0; word < is_chosen.size(); ++word)
        for (std::uint64_t bits = is_chosen[word]; bits; bits &= bits - 1)
            chosen.push_back(static_cast<std::uint32_t>(word * 64 + static_cast<std::size_t>(__builtin_ctzll(bits))));
    return chosen;
}

template <class Coord>
auto LevelSampler<Coord>::sample_bin(std::size_t number, int size, const std::vector<std::uint32_t>& neighbours)
    -> Found
{
    Bin& bin = bins_[number];
    const auto& box = points_.box(number);
    const double spacing = lattice_.spacing(size);
    const double squared = spacing * spacing;
    if (bin.chosen == box.points) return {};
    const auto covers_all = [&](const Point<Coord>& p) {
        return neighbours_.to_farthest(p, box) * (1 + distance_margin) < squared;
    };

    std::vector<Point<Coord>> others;
    for (const Point<Coord>& p : bin.border)
        if (covers_all(p)) return {};
    for (const std::uint32_t n : neighbours)
        for (const Point<Coord>& p : bins_[n].border) {
            if (covers_all(p)) return {};
            if (neighbours_.to_nearest(p, box) * (1 - distance_margin) < squared) others.push_back(p);
        }
    typename SortedPoints<Coord>::Reader points(points_, number);
    const std::vector<std::uint32_t> own = chosen_in(bin, box.points);
    std::vector<std::uint8_t> barred;
    if (given_.list) {
        const auto given = given_near(number, size, 0, static_cast<std::size_t>(sizes_[0] - size), points);
        others.insert(others.end(), given.begin(), given.end());
        if (bin.bytes != no_bytes) barred = file_.read(bin.bytes, box.points);
    }

    const std::vector<std::uint32_t> found = PoissonPass<Coord>(points, lattice_, size, own, others).run(barred);
    if (!found.empty()) {
        bin.lists.push_back({size, file_.write(found)});
        bin.chosen += found.size();
    }
    Found positions;
    positions.reserve(found.size());
    for (const std::uint32_t i : found) positions.push_back(points[i]);
    return positions;
}

// Keeps the chosen points that passes of smaller sizes may ask for: the ones nearer than the spacing to a
// neighbour. With smaller spacings there are only fewer neighbours.
template <class Coord>
auto LevelSampler<Coord>::keep_border(std::size_t number, int size, const std::vector<std::uint32_t>& neighbours,
                                      const Found& found) -> Found
{
    Bin& bin = bins_[number];
    const BinBorder<Coord> at_border(neighbours_, points_, lattice_, number, lattice_.spacing(size), neighbours);
    Found border, kept;
    for (const Point<Coord>& p : bin.border)
        if (at_border(p)) border.push_back(p);
    for (const Point<Coord>& p : found)
        if (at_border(p)) kept.push_back(p);
    border.insert(border.end(), kept.begin(), kept.end());
    bin.border = std::move(border);
    return kept;
}

template <class Coord>
void LevelSampler<Coord>::save(ByteWriter& out) const
{
    out.put(file_.bytes());
    out.put(static_cast<std::uint64_t>(spacings_.size()));
    for (const double spacing : spacings_) out.put(spacing);
    out.put(static_cast<std::uint64_t>(sizes_.size()));
    for (const int size : sizes_) out.put(size);
    out.put(static_cast<std::uint64_t>(bins_.size()));
    for (const Bin& bin : bins_) {
        for (const std::uint64_t points : bin.histogram) out.put(points);
        out.put(bin.bytes);
        out.put(static_cast<std::uint64_t>(bin.lists.size()));
        for (const List& list : bin.lists) {
            out.put(list.size);
            out.put(list.place.offset);
            out.put(list.place.count);
            out.put(list.place.checksum);
        }
    }
}

template <class Coord>
void LevelSampler<Coord>::load(ByteReader& in)
{
    const auto check = [&](bool holds) {
        if (!holds)
            throw Error(ErrorCode::corrupt, file_.path(), "the levels of an interrupted build do not fit its points");
    };
    const auto end = in.get<std::uint64_t>();
    check(file_.reopen(end));
    const auto spacings = in.get<std::uint64_t>();
    check(spacings <= 255);
    for (std::uint64_t i = 0; i < spacings; ++i) spacings_.push_back(in.get<double>());
    const auto sizes = in.get<std::uint64_t>();
    check(sizes <= spacings && sizes > 0);
    for (std::uint64_t i = 0; i < sizes; ++i) sizes_.push_back(in.get<int>());
    check(in.get<std::uint64_t>() == bins_.size());
    for (std::size_t b = 0; b < bins_.size(); ++b) {
        Bin& bin = bins_[b];
        for (std::uint64_t i = 0; i < spacings; ++i) bin.histogram.push_back(in.get<std::uint64_t>());
        bin.bytes = in.get<std::uint64_t>();
        check(bin.bytes == no_bytes || (bin.bytes <= end && points_.box(b).points <= end - bin.bytes));
        const auto lists = in.get<std::uint64_t>();
        for (std::uint64_t i = 0; i < lists; ++i) {
            List list{};
            list.size = in.get<int>();
            list.place.offset = in.get<std::uint64_t>();
            list.place.count = in.get<std::uint32_t>();
            list.place.checksum = in.get<std::uint64_t>();
            check(sampling_ == Sampling::grid ||
                  (list.place.offset <= end && list.place.count <= (end - list.place.offset) / sizeof(std::uint32_t)));
            bin.lists.push_back(list);
        }
    }
}

template class LevelSampler<std::uint32_t>;
template class LevelSampler<std::uint64_t>;

}  // namespace pcm
