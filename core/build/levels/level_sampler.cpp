#include "pcm/build/levels/level_sampler.h"

#include "pcm/bpc/chunk_codec.h"
#include "pcm/bpc/byte_order.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace pcm {
namespace {

constexpr double margin = 1e-9;  // bounds are computed with rounding and decide only by more than this
// The coarsest level has at least this many points where the cloud has: spacings with fewer are not worth a level.
constexpr std::uint64_t first_level_points = 512;
// Sampling ends when a quarter of the points is chosen: the step to the whole cloud is then like that between levels,
// as surfaces have four times the points at half the spacing. A few points in much denser places are not waited for.
constexpr double chosen_share = 0.1;
constexpr double waiting_share = 0.2;

}  // namespace

template <class Coord>
LevelSampler<Coord>::LevelSampler(const SortedPoints<Coord>& points, const Lattice& lattice, Sampling sampling,
                                  const std::filesystem::path& scratch, File::Mode mode)
    : points_(points),
      lattice_(lattice),
      sampling_(sampling),
      file_(scratch, mode),
      remove_(mode == File::Mode::create_new),
      bins_(points.bins())
{
    for (std::size_t a = 0; a < 3; ++a) squared_scale_[a] = lattice.scale[a] * lattice.scale[a];
}

template <class Coord>
LevelSampler<Coord>::~LevelSampler()
{
    std::error_code ignored;
    if (remove_) std::filesystem::remove(file_.path(), ignored);
}

template <class Coord>
void LevelSampler<Coord>::add_to(GivenLevels<Coord> given)
{
    given_ = std::move(given);
    sizes_.clear();
    for (const double spacing : given_.spacings) {
        if (spacing == 0) break;
        const int size = spacing > 0 ? std::ilogb(spacing / lattice_.spacing(0) * (1 + margin)) : -1;
        if (size < 0 || size > 62 || std::fabs(spacing / lattice_.spacing(size) - 1) > margin ||
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
    if (given_.list) {
        if (sampling_ == Sampling::grid) {
            for_each_bin(threads, [this](std::size_t bin) { sample_given_bin_by_grid(bin); });
        } else {
            for_each_bin(threads, [this](std::size_t bin) { bar_points(bin); });
            for (const int size : sizes_) pass(size, threads);
        }
        count_levels();
        return;
    }
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
    const int top = any ? std::min(62, lattice_.size_of_box<Coord>(low, high)) : 0;
    std::vector<int> sizes;
    if (sampling_ == Sampling::grid) {
        sample_by_grid(top, threads);
        // The sizes that are used, from how many points each would choose.
        for (int size = top; size >= 0; --size) {
            sizes.push_back(size);
            for (Bin& bin : bins_) {
                bin.chosen = 0;
                for (const List& list : bin.lists)
                    if (list.size >= size) bin.chosen += list.count;
            }
            if (fine_enough()) break;
        }
    } else {
        for (int size = top; size >= 0; --size) {
            fraction_ = 1 - std::ldexp(1.0, -static_cast<int>(sizes.size()) / 3);
            sizes.push_back(size);
            pass(size, threads);
            if (fine_enough()) break;
        }
    }
    choose_levels(sizes);
    count_levels();
}

template <class Coord>
bool LevelSampler<Coord>::fine_enough() const
{
    std::uint64_t all = 0, waiting = 0;
    for (std::size_t b = 0; b < bins_.size(); ++b) {
        const std::uint64_t points = points_.box(b).points;
        all += points;
        if (static_cast<double>(bins_[b].chosen) < chosen_share * static_cast<double>(points)) waiting += points;
    }
    return static_cast<double>(waiting) <= waiting_share * static_cast<double>(all);
}

template <class Coord>
void LevelSampler<Coord>::choose_levels(const std::vector<int>& sizes)
{
    // The first sizes, of a few points each, are one level.
    std::size_t first = 0;
    for (; first + 1 < sizes.size(); ++first) {
        std::uint64_t chosen = 0;
        for (const Bin& bin : bins_)
            for (const List& list : bin.lists)
                if (list.size >= sizes[first]) chosen += list.count;
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
            bin.histogram[static_cast<std::size_t>(std::max(0, sizes_[0] - list.size))] += list.count;
            chosen += list.count;
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
std::uint64_t LevelSampler<Coord>::write(const void* data, std::size_t bytes)
{
    std::uint64_t offset;
    {
        const std::lock_guard lock(mutex_);
        offset = end_;
        end_ += bytes;
    }
    file_.write_at(data, bytes, offset);
    return offset;
}

template <class Coord>
std::vector<std::uint8_t> LevelSampler<Coord>::read_bytes(std::size_t bin) const
{
    std::vector<std::uint8_t> bytes(points_.box(bin).points);
    file_.read_at(bytes.data(), bytes.size(), bins_[bin].bytes);
    return bytes;
}

template <class Coord>
std::vector<std::uint32_t> LevelSampler<Coord>::read(const List& list) const
{
    std::vector<std::uint32_t> indices(list.count);
    file_.read_at(indices.data(), indices.size() * sizeof indices[0], list.offset);
    if (checksum(indices.data(), indices.size() * sizeof indices[0]) != list.checksum)
        throw Error(ErrorCode::corrupt, file_.path(),
                    "what was written at byte " + std::to_string(list.offset) + " is not what is there now",
                    "the disk may be failing; build again");
    return indices;
}

template <class Coord>
std::vector<std::uint8_t> LevelSampler<Coord>::levels(std::size_t bin) const
{
    std::vector<std::uint8_t> levels(points_.box(bin).points, static_cast<std::uint8_t>(sizes_.size()));
    if (sampling_ == Sampling::grid) {
        if (levels.empty()) return levels;
        if (given_.list) return read_bytes(bin);
        typename SortedPoints<Coord>::Reader points(points_, bin);
        Point<Coord> before = points[0];
        levels[0] = 0;
        for (std::size_t i = 1; i < levels.size(); ++i) {
            const Point<Coord> p = points[i];
            const int size = parting_size(before, p, lattice_.finer);
            if (size >= sizes_.back()) levels[i] = static_cast<std::uint8_t>(std::max(0, sizes_[0] - size));
            before = p;
        }
        return levels;
    }
    for (const List& list : bins_[bin].lists)
        for (const std::uint32_t i : read(list))
            levels[i] = static_cast<std::uint8_t>(std::max(0, sizes_[0] - list.size));
    return levels;
}

template <class Coord>
void LevelSampler<Coord>::for_each_bin(unsigned threads, const std::function<void(std::size_t)>& work)
{
    Signal signal;
    Crew crew(signal);
    std::atomic<std::size_t> next{0};
    for (unsigned t = 0; t < threads; ++t)
        crew.add([&] {
            for (std::size_t b; !signal.stopped && (b = next++) < bins_.size();)
                if (points_.box(b).points > 0) work(b);
        });
    crew.join([&] {
        progress_(static_cast<double>(std::min(next.load(), bins_.size())) / static_cast<double>(bins_.size()));
    });
}

template <class Coord>
void LevelSampler<Coord>::sample_by_grid(int top, unsigned threads)
{
    for_each_bin(threads, [&](std::size_t b) {
        std::array<std::uint32_t, 65> chosen{};
        typename SortedPoints<Coord>::Reader points(points_, b);
        Point<Coord> before = points[0];
        chosen[static_cast<std::size_t>(top)] = 1;
        for (std::size_t i = 1; i < points.size(); ++i) {
            const Point<Coord> p = points[i];
            if (const int size = parting_size(before, p, lattice_.finer); size >= 0)
                ++chosen[static_cast<std::size_t>(std::min(size, top))];
            before = p;
        }
        for (int size = top; size >= 0; --size)
            if (const std::uint32_t count = chosen[static_cast<std::size_t>(size)])
                bins_[b].lists.push_back({size, 0, count, 0});
    });
}

template <class Coord>
void LevelSampler<Coord>::sample_given_bin_by_grid(std::size_t number)
{
    // A point is the first of its cell where no point before it is in that cell, and no given one before or after it:
    // the nearest ones in Morton order tell. Of three in order, the outer two are parted by the larger of the inner
    // partings.
    Bin& bin = bins_[number];
    const auto& box = points_.box(number);
    typename SortedPoints<Coord>::Reader reader(points_, number);
    std::vector<Point<Coord>> points;
    for (std::size_t i = 0; i < reader.size(); ++i) points.push_back(reader[i]);
    std::vector<std::int8_t> before(points.size(), 127),
        after(points.size(), 127);  // size that parts from the nearest given
    Point<Coord> low, high;         // the points' cells of the first level
    const std::array<int, 3> shifts = lattice_.shifts(sizes_[0]);
    for (std::size_t a = 0; a < 3; ++a) {
        const std::uint64_t inside = (std::uint64_t(1) << shifts[a]) - 1;
        low[a] = static_cast<Coord>(static_cast<std::uint64_t>(box.low[a]) & ~inside);
        high[a] = static_cast<Coord>(static_cast<std::uint64_t>(box.high[a]) | inside);
    }
    given_.list(low, high, 0, sizes_.size() - 1, [&](const Point<Coord>* given, std::size_t count) {
        for (std::size_t n = 0; n < count; ++n) {
            const auto at = std::lower_bound(points.begin(), points.end(), given[n], [&](const auto& p, const auto& q) {
                return morton_before(p, q, lattice_.finer);
            });
            const auto parted = [&](std::size_t i) {
                return static_cast<std::int8_t>(parting_size(points[i], given[n], lattice_.finer));
            };
            const auto i = static_cast<std::size_t>(at - points.begin());
            if (i < points.size()) before[i] = std::min(before[i], parted(i));
            if (i > 0) after[i - 1] = std::min(after[i - 1], parted(i - 1));
        }
    });
    std::vector<std::int8_t> parting(points.size(), 127);  // from the point before
    for (std::size_t i = 1; i < points.size(); ++i) {
        parting[i] = static_cast<std::int8_t>(parting_size(points[i - 1], points[i], lattice_.finer));
        before[i] = std::min(before[i], std::max(before[i - 1], parting[i]));
    }
    for (std::size_t i = points.size() - 1; i-- > 0;)
        after[i] = std::min(after[i], std::max(after[i + 1], parting[i + 1]));
    std::vector<std::uint8_t> levels(points.size(), static_cast<std::uint8_t>(sizes_.size()));
    std::vector<std::uint32_t> counts(sizes_.size(), 0);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const int size = std::min({before[i], after[i], parting[i]});
        if (size < sizes_.back()) continue;
        levels[i] = static_cast<std::uint8_t>(std::max(0, sizes_[0] - size));
        ++counts[levels[i]];
    }
    for (std::size_t level = 0; level < counts.size(); ++level)
        bin.lists.push_back({sizes_[level], 0, counts[level], 0});
    bin.bytes = write(levels.data(), levels.size());
}

template <class Coord>
double LevelSampler<Coord>::squared_distance_to(const Point<Coord>& p, const typename SortedPoints<Coord>::Box& box,
                                                bool farthest) const
{
    double sum = 0;
    for (std::size_t a = 0; a < 3; ++a) {
        const auto apart = [](Coord c, Coord d) { return static_cast<double>(c > d ? c - d : d - c); };
        double d = 0;
        if (farthest)
            d = std::max(apart(p[a], box.low[a]), apart(p[a], box.high[a]));
        else if (p[a] < box.low[a])
            d = apart(p[a], box.low[a]);
        else if (p[a] > box.high[a])
            d = apart(p[a], box.high[a]);
        sum += d * d * squared_scale_[a];
    }
    return sum;
}

template <class Coord>
double LevelSampler<Coord>::squared_distance_between(std::size_t bin, std::size_t other) const
{
    const auto &a = points_.box(bin), &b = points_.box(other);
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        double d = 0;
        if (a.high[k] < b.low[k]) d = static_cast<double>(b.low[k] - a.high[k]);
        if (b.high[k] < a.low[k]) d = static_cast<double>(a.low[k] - b.high[k]);
        sum += d * d * squared_scale_[k];
    }
    return sum;
}

template <class Coord>
void LevelSampler<Coord>::pass(int size, unsigned threads)
{
    // What a bin chooses depends on the bins nearer than the spacing that chose before it. Bins of one colour are not
    // near each other and go side by side; colours go one after the other: the same for any number of threads.
    const double squared = lattice_.spacing(size) * lattice_.spacing(size);
    // Found anew each time they are needed: at coarse spacings every bin is near every other, and lists of all would
    // take memory with the square of their number.
    const auto neighbours_of = [&](std::size_t b, std::size_t below) {
        std::vector<std::size_t> neighbours;
        for (std::size_t n = 0; n < below; ++n)
            if (n != b && points_.box(n).points && squared_distance_between(b, n) * (1 - margin) < squared)
                neighbours.push_back(n);
        return neighbours;
    };
    std::vector<std::size_t> colour(bins_.size(), 0);
    std::size_t colours = 0;
    std::vector<std::size_t> used_by;  // of each colour, the last bin that has a neighbour of it
    for (std::size_t b = 0; b < bins_.size(); ++b) {
        if (points_.box(b).points == 0) continue;
        for (const std::size_t n : neighbours_of(b, b)) used_by[colour[n]] = b;
        std::size_t c = 0;
        while (c < colours && used_by[c] == b) ++c;
        colour[b] = c;
        if (c == colours) {
            ++colours;
            used_by.push_back(bins_.size());
        }
    }
    std::vector<std::vector<std::size_t>> groups(colours);
    for (std::size_t b = 0; b < bins_.size(); ++b)
        if (points_.box(b).points) groups[colour[b]].push_back(b);
    std::atomic<std::size_t> done{0};
    const auto tick = [&] {
        const double inside =
            static_cast<double>(done.load()) / static_cast<double>(std::max<std::size_t>(1, bins_.size()));
        progress_(fraction_ + (1 - fraction_) * 0.2 * inside);
    };
    for (const std::vector<std::size_t>& group : groups) {
        if (group.size() == 1 || threads == 1) {
            for (const std::size_t b : group) {
                sample_bin(b, size, neighbours_of(b, bins_.size()));
                ++done;
                tick();
            }
            continue;
        }
        Signal signal;
        Crew crew(signal);
        std::atomic<std::size_t> next{0};
        for (unsigned t = 0; t < std::min<std::size_t>(threads, group.size()); ++t)
            crew.add([&] {
                for (std::size_t i; !signal.stopped && (i = next++) < group.size(); ++done)
                    sample_bin(group[i], size, neighbours_of(group[i], bins_.size()));
            });
        crew.join(tick);
    }
}

template <class Coord>
std::vector<Point<Coord>> LevelSampler<Coord>::given_near(std::size_t number, int size, std::size_t first_level,
                                                          std::size_t last_level,
                                                          typename SortedPoints<Coord>::Reader& points) const
{
    // Of those in the box only the ones in or beside a bucket in which the bin has points: a few a point, however many
    // there are.
    const auto& box = points_.box(number);
    Point<Coord> low, high;
    for (std::size_t a = 0; a < 3; ++a) {
        const double reach = std::ceil(lattice_.spacing(size) / lattice_.scale[a]) + 1;
        const auto most = std::numeric_limits<Coord>::max();
        const auto steps = reach < static_cast<double>(most) ? static_cast<Coord>(reach) : most;
        low[a] = box.low[a] > steps ? box.low[a] - steps : 0;
        high[a] = most - box.high[a] > steps ? box.high[a] + steps : most;
    }
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
    if (!barred.empty()) bins_[number].bytes = write(barred.data(), barred.size());
}

template <class Coord>
void LevelSampler<Coord>::sample_bin(std::size_t number, int size, const std::vector<std::size_t>& neighbours)
{
    Bin& bin = bins_[number];
    const auto& box = points_.box(number);
    const double spacing = lattice_.spacing(size);
    const double squared = spacing * spacing;
    if (bin.chosen == box.points) return;
    const auto covers_all = [&](const Point<Coord>& p) {
        return squared_distance_to(p, box, true) * (1 + margin) < squared;
    };

    std::vector<Point<Coord>> others;
    for (const Point<Coord>& p : bin.border)
        if (covers_all(p)) return;
    for (const std::size_t n : neighbours)
        for (const Point<Coord>& p : bins_[n].border) {
            if (covers_all(p)) return;
            if (squared_distance_to(p, box, false) * (1 - margin) < squared) others.push_back(p);
        }
    typename SortedPoints<Coord>::Reader points(points_, number);
    std::vector<std::uint32_t> own;
    if (!bin.lists.empty()) {
        std::vector<std::uint64_t> is_own(box.points / 64 + 1, 0);
        for (const List& list : bin.lists)
            for (const std::uint32_t i : read(list)) is_own[i / 64] |= std::uint64_t(1) << i % 64;
        own.reserve(bin.chosen);
        for (std::size_t word = 0; word < is_own.size(); ++word)
            for (std::uint64_t bits = is_own[word]; bits; bits &= bits - 1)
                own.push_back(static_cast<std::uint32_t>(word * 64 + static_cast<std::size_t>(__builtin_ctzll(bits))));
    }
    std::vector<std::uint8_t> barred;
    if (given_.list) {
        const auto given = given_near(number, size, 0, static_cast<std::size_t>(sizes_[0] - size), points);
        others.insert(others.end(), given.begin(), given.end());
        if (bin.bytes != no_bytes) barred = read_bytes(number);
    }

    const std::vector<std::uint32_t> found = PoissonPass<Coord>(points, lattice_, size, own, others).run(barred);
    if (!found.empty()) {
        const std::uint64_t offset = write(found.data(), found.size() * sizeof found[0]);
        bin.lists.push_back({size, offset, static_cast<std::uint32_t>(found.size()),
                             checksum(found.data(), found.size() * sizeof found[0])});
        bin.chosen += found.size();
    }
    // Neighbours only get fewer with smaller spacings: what is far from all of them now will not be asked for again.
    // Neighbours lie outside of the bin's own box, as a rule: then what is as deep in it as the spacing is far from
    // them.
    Point<Coord> inner_low = box.high, inner_high = box.low;
    for (std::size_t a = 0; a < 3; ++a) {
        const double reach = std::ceil(spacing / lattice_.scale[a]) + 1;
        if (!(reach < static_cast<double>(box.high[a] - box.low[a]) / 2)) continue;
        inner_low[a] = box.low[a] + static_cast<Coord>(reach);
        inner_high[a] = box.high[a] - static_cast<Coord>(reach);
    }
    const bool apart = std::none_of(neighbours.begin(), neighbours.end(),
                                    [&](std::size_t n) { return squared_distance_between(number, n) == 0; });
    const auto at_border = [&](const Point<Coord>& p) {
        bool inside = apart;
        for (std::size_t a = 0; a < 3; ++a) inside = inside && p[a] > inner_low[a] && p[a] < inner_high[a];
        if (inside) return false;
        for (const std::size_t n : neighbours)
            if (squared_distance_to(p, points_.box(n), false) * (1 - margin) < squared) return true;
        return false;
    };
    std::vector<Point<Coord>> border;
    for (const Point<Coord>& p : bin.border)
        if (at_border(p)) border.push_back(p);
    for (const std::uint32_t i : found)
        if (at_border(points[i])) border.push_back(points[i]);
    bin.border = std::move(border);
}

template <class Coord>
void LevelSampler<Coord>::save(ByteWriter& out) const
{
    out.put(end_);
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
            out.put(list.offset);
            out.put(list.count);
            out.put(list.checksum);
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
    end_ = in.get<std::uint64_t>();
    check(end_ <= file_.size());
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
        check(bin.bytes == no_bytes || (bin.bytes <= end_ && points_.box(b).points <= end_ - bin.bytes));
        const auto lists = in.get<std::uint64_t>();
        for (std::uint64_t i = 0; i < lists; ++i) {
            List list{};
            list.size = in.get<int>();
            list.offset = in.get<std::uint64_t>();
            list.count = in.get<std::uint32_t>();
            list.checksum = in.get<std::uint64_t>();
            check(sampling_ == Sampling::grid ||
                  (list.offset <= end_ && list.count <= (end_ - list.offset) / sizeof(std::uint32_t)));
            bin.lists.push_back(list);
        }
    }
}

template class LevelSampler<std::uint32_t>;
template class LevelSampler<std::uint64_t>;

}  // namespace pcm
