#include "pcm/detect/assign_points.h"

#include "pcm/detect/border_cells.h"
#include "pcm/detect/shape_search.h"
#include "pcm/detect/tuning.h"
#include "pcm/detect/unit_parts.h"
#include "pcm/system/error.h"
#include "pcm/threads/for_each_index.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <map>
#include <set>
#include <utility>

namespace pcm {
namespace {

constexpr std::uint32_t unassigned = 0xffffffffu;
constexpr std::size_t most_kept_points = 256;

class UnitAssignment {
public:
    UnitAssignment(const ChosenPoints& points, const Box3i& box, SurfaceSample sample,
                   const std::vector<Hypothesis>& hypotheses, const AssignOptions& options)
        : points_(points),
          box_(box),
          hypotheses_(hypotheses),
          options_(options),
          lattice_(points.tree(), options.sample.cell),
          sample_(std::move(sample))
    {
    }

    // Adds the parts of interest, and returns how many points were looked at.
    std::uint64_t run(PointLabels* labels, PartNumbers& numbers, BorderCells& border, std::size_t unit,
                      UnitParts& result)
    {
        choose();
        connect();
        if (options_.sample.step > 0) connect_far();
        first_ = numbers.take(parts_.size());
        find_border(border);
        find_interior();
        find_continued();
        const std::uint64_t looked_at = labels ? give_labels(*labels) : 0;
        std::vector<UnitPart> kept;
        for (std::uint32_t k = 0; k < parts_.size(); ++k)
            if (at_border_[k] ||
                (parts_[k].points >= options_.least_points && parts_[k].sampled >= options_.least_sampled))
                kept.push_back({first_ + k, std::move(parts_[k])});
        for (auto& [a, b] : joined_) a += first_, b += first_;
        std::sort(joined_.begin(), joined_.end());
        joined_.erase(std::unique(joined_.begin(), joined_.end()), joined_.end());
        result.add(unit, kept, joined_);
        return looked_at;
    }

private:
    // The nearest surface of each point of the sample.
    void choose()
    {
        owner_.assign(sample_.size(), unassigned);
        std::vector<float> best(sample_.size(), std::numeric_limits<float>::max());
        const double cos_angle = std::cos(std::min(options_.normal_angle, pi / 2));
        for (std::uint32_t h = 0; h < hypotheses_.size(); ++h) {
            options_.sample.check();
            const Shape shape = shape_here(h);
            const double threshold = hypotheses_[h].threshold, least_cosine = hypotheses_[h].thin ? -1 : cos_angle;
            const Box3d box = reached_box(hypotheses_[h], options_.reach);
            for_points_near(sample_, box, shape, threshold, [&](std::uint32_t i) {
                const auto distance = static_cast<float>(distance_to(shape, sample_.at[i]) / threshold);
                if (!(distance < best[i]) || !fits(sample_, i, shape, threshold, least_cosine)) return;
                best[i] = distance;
                owner_[i] = h;
            });
        }
    }

    void connect()
    {
        part_.assign(sample_.size(), unassigned);
        std::vector<std::uint32_t> open;
        for (std::uint32_t seed = 0; seed < sample_.size(); ++seed) {
            if (owner_[seed] == unassigned || part_[seed] != unassigned) continue;
            const auto part = static_cast<std::uint32_t>(parts_.size());
            parts_.emplace_back();
            parts_.back().hypothesis = owner_[seed];
            part_[seed] = part;
            open.assign(1, seed);
            while (!open.empty()) {
                const std::uint32_t i = open.back();
                open.pop_back();
                const std::uint32_t* const near = sample_.neighbours(i);
                for (std::size_t k = 0; k < SurfaceSample::most_neighbours; ++k) {
                    const std::uint32_t j = near[k];
                    if (owner_[j] != owner_[seed]) continue;
                    if (part_[j] == unassigned) {
                        part_[j] = part;
                        open.push_back(j);
                    } else if (part_[j] != part) {  // an edge that leads only one way
                        joined_.push_back({part_[j], part});
                    }
                }
            }
        }
    }

    // By steps that are longer than the sample's edges: parts of one surface are joined where points of theirs are no
    // farther apart.
    void connect_far()
    {
        const double step = options_.sample.step;
        using Points = std::vector<std::uint32_t>;
        std::map<std::array<std::int64_t, 3>, std::map<std::uint32_t, Points>> cells;  // keyed by cell, then by part
        const auto cell_of = [&](const Vec3d& p) {
            std::array<std::int64_t, 3> cell{};
            for (std::size_t a = 0; a < 3; ++a) cell[a] = static_cast<std::int64_t>(std::floor(p[a] / step));
            return cell;
        };
        for (std::uint32_t i = 0; i < sample_.size(); ++i)
            if (part_[i] != unassigned) cells[cell_of(sample_.at[i])][part_[i]].push_back(i);
        std::set<std::pair<std::uint32_t, std::uint32_t>> joined;
        const auto are_near = [&](const Points& some, const Points& others) {
            for (const std::uint32_t i : some) {
                options_.sample.check();
                for (const std::uint32_t j : others)
                    if (squared_distance(sample_.at[i], sample_.at[j]) <= step * step) return true;
            }
            return false;
        };
        // Joins the parts of points in two cells; most parts are the only ones of their surface there.
        const auto join = [&](const std::pair<const std::uint32_t, Points>& a,
                              const std::pair<const std::uint32_t, Points>& b) {
            const auto parts = std::minmax(a.first, b.first);
            if (a.first != b.first && parts_[a.first].hypothesis == parts_[b.first].hypothesis &&
                !joined.count(parts) && are_near(a.second, b.second))
                joined.insert(parts);
        };
        for (const auto& [cell, parts] : cells)
            for (int n = 0; n < 27; ++n) {
                const auto other = cells.find({cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1});
                if (other == cells.end() || other->first < cell) continue;
                for (const auto& a : parts)
                    for (const auto& b : other->second) join(a, b);
            }
        joined_.insert(joined_.end(), joined.begin(), joined.end());
    }

    void find_border(BorderCells& border)
    {
        const Box3d box = points_.source_box(box_);
        const double zone = std::max(1.5 * options_.sample.cell, options_.sample.step);
        const Box3i& all = points_.tree().info().box;  // beyond which there is no unit
        std::vector<BorderCell> cells;
        at_border_.assign(parts_.size(), false);
        for (const auto& [key, i] : sample_.by_cell) {
            if (part_[i] == unassigned) continue;
            const Vec3d p = sample_.origin + sample_.at[i];
            bool near = false;
            for (std::size_t a = 0; a < 3; ++a)
                near = near || (box_.min[a] > all.min[a] && std::fabs(p[a] - box.min[a]) <= zone) ||
                       (box_.max[a] < all.max[a] && std::fabs(p[a] - box.max[a]) <= zone);
            if (!near) continue;
            cells.push_back({key, owner_[i], first_ + part_[i]});
            at_border_[part_[i]] = true;
        }
        border.add(cells);
        for (const auto& [a, b] : joined_) at_border_[a] = at_border_[b] = true;
    }

    void find_interior()
    {
        interior_.assign(sample_.size(), 1);
        for (std::uint32_t i = 0; i < sample_.size(); ++i) {
            const std::uint32_t* const near = sample_.neighbours(i);
            for (std::size_t k = 0; k < SurfaceSample::most_neighbours; ++k)
                if (owner_[near[k]] != owner_[i]) interior_[i] = 0;
        }
    }

    Shape shape_here(std::uint32_t hypothesis) const
    {
        Shape shape = hypotheses_[hypothesis].shape;
        shape.point = shape.point - sample_.origin;
        return shape;
    }

    // The distance of the surface at a point, rather than of the point with its noise.
    double mean_distance(std::uint32_t i, const Shape& shape) const
    {
        double sum = signed_distance(shape, sample_.at[i]);
        for (std::size_t k = 0; k < SurfaceSample::most_neighbours; ++k)
            sum += signed_distance(shape, sample_.at[sample_.neighbours(i)[k]]);
        return sum / (SurfaceSample::most_neighbours + 1);
    }

    // Whether the surface of the cloud continues smoothly next to point i, but not on the point's shape.
    bool goes_beyond(std::uint32_t i, const Shape& shape, double cos_angle) const
    {
        const std::uint32_t* const near = sample_.neighbours(i);
        NearMean own, beyond;
        own.add(sample_.at[i], shape);
        for (std::size_t k = 0; k < SurfaceSample::most_neighbours; ++k) {
            const std::uint32_t j = near[k];
            if (owner_[j] == owner_[i])
                own.add(sample_.at[j], shape);
            else if (is_beyond(i, j, shape, cos_angle))
                beyond.add(sample_.at[j], shape);
        }
        return beyond.count >= tuned_.min_neighbours && !is_above(own, beyond, shape, hypotheses_[owner_[i]].threshold);
    }

    // Whether point j, which is not the part's, is on a surface that point i's may continue as.
    bool is_beyond(std::uint32_t i, std::uint32_t j, const Shape& shape, double cos_angle) const
    {
        const Vec3d normal = normal_at(shape, sample_.at[j]);
        if (owner_[j] != unassigned)
            return std::fabs(dot(normal_at(shape_here(owner_[j]), sample_.at[j]), normal)) >= cos_angle;
        if (std::fabs(dot(sample_.normal_of(j), normal)) < cos_angle) return false;
        const double distance = std::fabs(mean_distance(j, shape)), threshold = hypotheses_[owner_[i]].threshold;
        return distance > tuned_.min_beyond * threshold && distance < tuned_.max_beyond * threshold;
    }

    // Whether most of the neighbours within the threshold belong to no surface.
    bool is_mixed(std::uint32_t i, const Shape& shape) const
    {
        const std::uint32_t* const near = sample_.neighbours(i);
        std::size_t own = 0, others = 0;
        for (std::size_t k = 0; k < SurfaceSample::most_neighbours; ++k) {
            const std::uint32_t j = near[k];
            if (owner_[j] == owner_[i])
                ++own;
            else if (owner_[j] == unassigned)
                others += distance_to(shape, sample_.at[j]) <= hypotheses_[owner_[i]].threshold;
        }
        return others > own;
    }

    // Points near a place of the shape: their mean, and that of their distances.
    struct NearMean {
        void add(const Vec3d& p, const Shape& shape)
        {
            sum = sum + p;
            distances += signed_distance(shape, p);
            ++count;
        }
        Vec3d mean() const { return sum / static_cast<double>(count); }
        double distance() const { return distances / static_cast<double>(count); }
        Vec3d sum{};
        double distances = 0;
        std::size_t count = 0;
    };

    // The other face of a plate lies above its points, where a surface that continues lies next to them.
    bool is_above(const NearMean& own, const NearMean& beyond, const Shape& shape, double threshold) const
    {
        const Vec3d apart = beyond.mean() - own.mean(), normal = normal_at(shape, own.mean());
        const double across = length(apart - dot(apart, normal) * normal);
        const double slope = std::tan(std::min(0.5 * options_.normal_angle, pi / 4));
        return std::fabs(beyond.distance() - own.distance()) > slope * across + tuned_.max_step * threshold;
    }

    void find_continued()
    {
        std::vector<std::size_t> some_of(parts_.size(), 0);  // one of how many points is kept
        for (const std::uint32_t part : part_)
            if (part != unassigned) ++some_of[part];
        for (std::size_t& count : some_of) count = 1 + count / most_kept_points;
        const double cos_angle = std::cos(std::min(0.5 * options_.normal_angle, pi / 2));
        for (std::uint32_t i = 0; i < sample_.size(); ++i) {
            if (part_[i] == unassigned || !sample_.inside[i]) continue;
            SurfacePart& part = parts_[part_[i]];
            if (part.hypothesis >= options_.some_from && part.some.size() < most_kept_points &&
                i % some_of[part_[i]] == 0)
                part.some.push_back(sample_.origin + sample_.at[i]);
            ++part.sampled;
            part.box.extend(sample_.origin + sample_.at[i]);
            const Shape shape = shape_here(owner_[i]);
            if (interior_[i]) {
                const double distance = signed_distance(shape, sample_.at[i]), mean = mean_distance(i, shape);
                part.squares += distance * distance;
                part.smooth_squares += mean * mean;
            } else {
                ++part.edge;
                part.continued += goes_beyond(i, shape, cos_angle);
                part.mixed += is_mixed(i, shape);
            }
        }
    }

    // The part of a point: that of the nearest surface among those of the point's cell and of the sample's neighbours.
    std::uint32_t label_of(const Vec3d& at, std::uint32_t i) const
    {
        std::uint32_t best = unassigned;
        double nearest = 1;
        const auto consider = [&](std::uint32_t j) {
            if (part_[j] == unassigned || part_[j] == best) return;
            const Hypothesis& surface = hypotheses_[owner_[j]];
            const double distance = distance_to(surface.shape, at) / surface.threshold;
            if (distance > nearest || (best != unassigned && distance == nearest)) return;
            nearest = distance;
            best = part_[j];
        };
        consider(i);
        const std::uint32_t* const near = sample_.neighbours(i);
        for (std::size_t k = 0; k < 6; ++k) consider(near[k]);
        if (best == unassigned) return 0;
        return (first_ + best + 1) | (best == part_[i] && interior_[i] ? interior_label : 0);
    }

    // Returns how many points were looked at.
    std::uint64_t give_labels(PointLabels& labels)
    {
        std::uint64_t looked_at = 0;
        points_.visit(box_, options_.sample.level, [&](const ChosenPoints::Some& some) {
            options_.sample.check();
            std::vector<std::uint32_t> numbers, given;
            looked_at += some.number.size();
            for (std::size_t i = 0; i < some.number.size(); ++i) {
                const auto cell = sample_.by_cell.find(SampleLattice::key_of(lattice_.cell_of(some.grid[i])));
                if (cell == sample_.by_cell.end()) continue;
                const std::uint32_t label = label_of(some.at[i], cell->second);
                if (label == 0) continue;
                numbers.push_back(some.number[i]);
                given.push_back(label);
                SurfacePart& part = parts_[(label & ~interior_label) - 1 - first_];
                ++part.points;
                part.box.extend(some.at[i]);
            }
            labels.set(some.node, numbers, given.data());
        });
        return looked_at;
    }

    const ChosenPoints& points_;
    const Box3i box_;
    const std::vector<Hypothesis>& hypotheses_;
    const AssignOptions& options_;
    const PieceTuning& tuned_ = detect_tuning().pieces;
    const SampleLattice lattice_;
    const SurfaceSample sample_;
    std::vector<std::uint32_t> owner_, part_;  // hypothesis and part of the sample's points, or `unassigned`
    std::vector<std::uint8_t> interior_;
    NumberPairs joined_;
    std::vector<SurfacePart> parts_;
    std::vector<bool> at_border_;  // one for each part
    std::uint32_t first_ = 0;
};

}  // namespace

bool is_piece(const SurfacePart& part, double threshold)
{
    const auto continued = static_cast<double>(part.continued),
               interior = static_cast<double>(part.sampled - part.edge);
    const double outline = std::sqrt(static_cast<double>(part.sampled));
    const PieceTuning& tuned = detect_tuning().pieces;
    const bool flat = part.squares < tuned.flat_rms * tuned.flat_rms * threshold * threshold * interior;
    return continued > tuned.min_edge * static_cast<double>(part.edge) &&
           part.smooth_squares > tuned.min_bend * tuned.min_bend * part.squares &&
           continued > (flat ? tuned.flat_outline : tuned.min_outline) * outline;
}

Vicinity vicinity_of(const Hypothesis& one, const AssignOptions& options)
{
    const double margin = options.sample.margin;
    Box3d box = reached_box(one, options.reach);
    for (std::size_t a = 0; a < 3; ++a) box.min[a] -= margin, box.max[a] += margin;
    return {box, one.shape, detect_tuning().pieces.max_beyond * one.threshold + margin};
}

AssignedPoints assign_points(const ChosenPoints& points, const std::vector<Box3i>& units,
                             const std::vector<Hypothesis>& hypotheses, const AssignOptions& options,
                             PointLabels* labels)
{
    PartNumbers numbers;
    BorderCells border;
    UnitParts parts(units.size());
    std::atomic<std::uint64_t> looked_at{0};
    for_each_index(
        units.size(), options.threads,
        [&](std::size_t u, const Stop& stop) {
            AssignOptions here = options;
            here.sample.check = [&] {
                stop.check();
                if (options.sample.check) options.sample.check();
            };
            for_each_sample(points, units[u], here.sample, [&](const Box3i& box, SurfaceSample sample) {
                looked_at += UnitAssignment(points, box, std::move(sample), hypotheses, here)
                                 .run(labels, numbers, border, u, parts);
            });
        },
        [&](std::size_t begun) { options.progress(static_cast<double>(begun) / static_cast<double>(units.size())); });
    AssignedPoints assigned = parts.together(border, options.least_points, options.least_sampled, options.most_some);
    assigned.next_number = numbers.take(0);
    assigned.looked_at = looked_at;
    return assigned;
}

}  // namespace pcm
