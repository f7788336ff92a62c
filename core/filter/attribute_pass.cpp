#include "pcm/filter/attribute_pass.h"

#include "pcm/filter/two_surfaces.h"
#include "pcm/tree/point_size.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <memory>
#include <vector>

namespace pcm {
namespace {

ScannerPlaces scanners_of(const NeighbourAttributeOptions& options, const TreeInfo& info)
{
    return options.orientation.rule == NormalOrientation::Rule::scanners ? ScannerPlaces(info.metadata, info.schema)
                                                                         : ScannerPlaces();
}

// Keeps the values of one unit, and hands them on at its end.
class PassVisitor final : public NeighbourhoodVisitor {
public:
    PassVisitor(const TreeInfo& info, const NeighbourAttributeOptions& options, const AttributePlaces& places,
                UnitSink& sink)
        : info_(info),
          wanted_(options.wanted),
          k_(options.neighbours),
          radius_limit_(options.radius_limit),
          joins_(is_consistent(options)),
          orientation_(options.orientation),
          scanners_(scanners_of(options, info)),
          places_(places),
          sink_(sink)
    {
    }

    void begin(const NeighbourhoodUnit& unit) override
    {
        if (places_.radius) values_.radius.resize(unit.points);
        if (places_.normal) values_.normal.resize(unit.points);
        if (places_.curvature) values_.curvature.resize(unit.points);
        if (wanted_.needs_shape()) values_.confidence.resize(unit.points);
        if (places_.mean_distance) values_.mean_distance.resize(unit.points);
        values_.counts = {};
        part_ = unit.parts.data();
        if (joins_) {
            two_surfaces_.assign(unit.points, 0);
            neighbours_.resize(unit.points);
            border_.clear();
        }
    }

    void visit(const NeighbourhoodUnit& unit, const Neighbourhoods& some) override
    {
        Vec3d known{};
        for (std::size_t i = 0; i < some.size(); ++i) {
            const std::uint32_t number = some.number(i);
            if (places_.known_normal) known = known_normal(unit, number);
            const OnePointsNeighbours found{some.dx(i), some.dy(i), some.dz(i), some.squared(i),
                                            std::min(some.count(i), k_)};
            const PointValues values = values_of(found, wanted_, places_.known_normal ? &known : nullptr);
            if (places_.radius) values_.radius[number] = static_cast<float>(values.radius);
            if (places_.normal)
                for (std::size_t a = 0; a < 3; ++a) values_.normal[number][a] = static_cast<float>(values.normal[a]);
            if (places_.curvature) values_.curvature[number] = static_cast<float>(values.curvature);
            if (wanted_.needs_shape()) values_.confidence[number] = static_cast<std::uint8_t>(values.confidence);
            if (places_.mean_distance) values_.mean_distance[number] = static_cast<float>(values.mean_distance);
            if (!joins_) continue;
            add_border_neighbours(unit, some, i, values.normal);
            neighbours_.set(number, some.neighbours(i), some.squared(i), some.count(i));
            two_surfaces_[number] = values.confidence == NormalConfidence::good &&
                                    are_two_surfaces(found, values.normal, least_gap(values.normal));
        }
    }

    void end(const NeighbourhoodUnit& unit) override
    {
        if (joins_) join(unit);
        for (const NeighbourhoodUnit::Part& part : unit.parts) {
            if (places_.radius) limit_radii(part);
            if (places_.normal && !joins_) turn_normals(part);
        }
        for (const std::uint8_t confidence : values_.confidence) count(confidence);
        sink_.take(unit, values_);
    }

    void skip(std::size_t unit) override { sink_.skip(unit); }

private:
    // Heights along a normal that rounding to the grid may make of one.
    double least_gap(const Vec3d& normal) const
    {
        double step = 0;
        for (std::size_t a = 0; a < 3; ++a) step += std::fabs(normal[a]) * info_.grid.scale[a];
        return 2.5 * step;
    }

    void join(const NeighbourhoodUnit& unit)
    {
        std::sort(border_.begin(), border_.end());  // they came in the order of the search
        values_.orientation = join_unit(info_, unit, neighbours_, values_.normal, two_surfaces_, border_);
        border_ = {};
        for (std::uint32_t n = 0; n < unit.points; ++n)
            if (two_surfaces_[n] && values_.confidence[n] == static_cast<std::uint8_t>(NormalConfidence::good))
                values_.confidence[n] = static_cast<std::uint8_t>(NormalConfidence::two_surfaces);
    }

    void limit_radii(const NeighbourhoodUnit::Part& part)
    {
        for (std::size_t i = 0; i < part.indices.size(); ++i) {
            const double most = most_radius(*part.chunk, part.indices[i], info_.grid, radius_limit_);
            float& radius = values_.radius[part.first + i];
            if (!(radius > most)) continue;
            radius = static_cast<float>(most);
            ++values_.counts.limited;
        }
    }

    // Sets part_ to the part that has a number.
    void find_part(const NeighbourhoodUnit& unit, std::uint32_t number)
    {
        if (number < part_->first || number - part_->first >= part_->indices.size()) part_ = &unit.part_of(number);
    }

    void add_border_neighbours(const NeighbourhoodUnit& unit, const Neighbourhoods& some, std::size_t i,
                               const Vec3d& normal)
    {
        const std::uint32_t* const numbers = some.neighbours(i);
        const std::size_t count = std::min(some.count(i), voting_neighbours);
        for (std::size_t j = 0; j < count; ++j) {
            if (numbers[j] < unit.points) continue;
            const bool across = is_across({some.dx(i)[j], some.dy(i)[j], some.dz(i)[j]}, normal);
            border_.push_back({some.number(i), across, unit.place_of(numbers[j])});
        }
    }

    Vec3d known_normal(const NeighbourhoodUnit& unit, std::uint32_t number)
    {
        find_part(unit, number);
        const std::size_t place = *places_.known_normal;
        return known_normal_of(*part_->chunk->attributes[place], info_.schema[place],
                               part_->indices[number - part_->first]);
    }

    void turn_normals(const NeighbourhoodUnit::Part& part)
    {
        for (std::size_t i = 0; i < part.indices.size(); ++i) {
            std::array<float, 3>& n = values_.normal[part.first + i];
            const Vec3d p = info_.grid.to_source(part.chunk->positions->grid(part.indices[i]));
            if (!is_to_turn(*part.chunk, part.indices[i], {n[0], n[1], n[2]}, p)) continue;
            for (float& component : n) component = -component;
            ++values_.counts.flipped;
        }
    }

    bool is_to_turn(const Chunk& chunk, std::uint32_t index, const Vec3d& normal, const Vec3d& p) const
    {
        if (orientation_.rule != NormalOrientation::Rule::scanners) return is_to_flip(orientation_, normal, p);
        const Vec3d* const scanner = scanners_.of(chunk, index);
        return scanner && is_to_flip({NormalOrientation::Rule::viewpoint, *scanner}, normal, p);
    }

    void count(std::uint8_t confidence)
    {
        values_.counts.lines += confidence == static_cast<std::uint8_t>(NormalConfidence::line);
        values_.counts.blobs += confidence == static_cast<std::uint8_t>(NormalConfidence::blob);
        values_.counts.too_few += confidence == static_cast<std::uint8_t>(NormalConfidence::too_few);
        values_.counts.two_surfaces += confidence == static_cast<std::uint8_t>(NormalConfidence::two_surfaces);
    }

    const TreeInfo& info_;
    const WantedValues wanted_;
    const std::size_t k_;  // neighbours that values are computed from
    const double radius_limit_;
    const bool joins_;  // points, so that normals are consistent
    const NormalOrientation orientation_;
    const ScannerPlaces scanners_;
    const AttributePlaces places_;
    UnitSink& sink_;
    const NeighbourhoodUnit::Part* part_ = nullptr;  // part of the last point that was looked at
    UnitAttributes values_;
    std::vector<std::uint8_t> two_surfaces_;  // keyed by number in the unit
    JoinedNeighbours neighbours_;
    std::deque<BorderNeighbour> border_;
};

// How the pass searches neighbours.
NeighbourhoodOptions search_options(const NeighbourAttributeOptions& options, const AttributePlaces& places)
{
    NeighbourhoodOptions search;
    search.neighbours = options.neighbours;
    search.max_distance = options.max_distance;
    if (places.known_normal) search.columns.attributes.set(*places.known_normal);
    search.columns.sizes = options.wanted.radius && options.radius_limit > 0;
    // Joining points to pieces takes memory, too, and at least as many neighbours as it joins.
    const bool joins = is_consistent(options);
    search.numbers = joins;
    if (joins && search.neighbours > 0) search.neighbours = std::max(search.neighbours, JoinedNeighbours::most);
    search.memory_bytes = options.memory_bytes / (joins ? 4 : 3);
    search.unit_points = options.unit_points;
    search.threads = options.threads;
    search.backend = options.backend;
    search.progress = options.progress;
    search.stage = "Computing " + noun_of(options.wanted);
    return search;
}

}  // namespace

Vec3d known_normal_of(const Column& column, const Attribute& attribute, std::size_t point)
{
    Vec3d n;
    for (std::uint32_t c = 0; c < 3; ++c) n[c] = column.value(point, c) * attribute.scale + attribute.offset;
    const double size = length(n);
    return size > 0 && std::isfinite(size) ? n / size : Vec3d{0, 0, 0};
}

double most_radius(const Chunk& chunk, std::size_t point, const Grid& grid, double limit)
{
    const std::uint8_t code = limit > 0 && chunk.sizes ? chunk.sizes->as<std::uint8_t>()[point] : unknown_size;
    if (code == unknown_size) return std::numeric_limits<double>::infinity();
    return limit * point_size(code, least_point_size(grid));
}

void AttributeCounts::add_to(NeighbourAttributeReport& report) const
{
    report.lines += lines;
    report.blobs += blobs;
    report.too_few += too_few;
    report.two_surfaces += two_surfaces;
    report.flipped += flipped;
    report.limited += limited;
}

NeighbourhoodReport run_attribute_pass(L2Cache& cache, const NeighbourAttributeOptions& options,
                                       const AttributePlaces& places, UnitSink& sink, double end,
                                       const std::function<std::size_t()>& next_unit)
{
    const TreeInfo& info = cache.tree().info();
    NeighbourhoodOptions search = search_options(options, places);
    if (const auto scan = scanners_of(options, info).attribute()) search.columns.attributes.set(*scan);
    search.end = end;
    search.next_unit = next_unit;
    return for_each_neighbourhood(cache, search,
                                  [&] { return std::make_unique<PassVisitor>(info, options, places, sink); });
}

}  // namespace pcm
