#include "pcm/filter/attribute_pass.h"

#include "pcm/filter/two_surfaces.h"
#include "pcm/tree/point_size.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <memory>
#include <mutex>
#include <vector>

namespace pcm {
namespace {

struct Counts {
    std::uint64_t lines = 0, blobs = 0, too_few = 0, two_surfaces = 0, flipped = 0, limited = 0;
};

ScannerPlaces scanners_of(const NeighbourAttributeOptions& options, const TreeInfo& info)
{
    return options.orientation.rule == NormalOrientation::Rule::scanners ? ScannerPlaces(info.metadata, info.schema)
                                                                         : ScannerPlaces();
}

// Keeps the values of one unit, and writes them at its end.
class PassVisitor final : public NeighbourhoodVisitor {
public:
    PassVisitor(L2Cache& cache, const NeighbourAttributeOptions& options, const AttributePlaces& places,
                OrientationPropagation* propagation, std::mutex& mutex, NeighbourAttributeReport& report)
        : cache_(cache),
          wanted_(options.wanted),
          k_(options.neighbours),
          radius_limit_(options.radius_limit),
          orientation_(options.orientation),
          scanners_(scanners_of(options, cache.tree().info())),
          places_(places),
          propagation_(propagation),
          schema_(cache.tree().info().schema),
          grid_(cache.tree().info().grid),
          mutex_(mutex),
          report_(report)
    {
        written_.positions = false;
        for (const auto& place :
             {places.radius, places.normal, places.curvature, places.confidence, places.mean_distance})
            if (place) written_.attributes.set(*place);
    }
    ~PassVisitor() override
    {
        const std::lock_guard lock(mutex_);
        report_.lines += counts_.lines;
        report_.blobs += counts_.blobs;
        report_.too_few += counts_.too_few;
        report_.two_surfaces += counts_.two_surfaces;
        report_.flipped += counts_.flipped;
        report_.limited += counts_.limited;
    }

    void begin(const NeighbourhoodUnit& unit) override
    {
        if (places_.radius) radius_.resize(unit.points);
        if (places_.normal) normal_.resize(unit.points);
        if (places_.curvature) curvature_.resize(unit.points);
        if (wanted_.needs_shape()) confidence_.resize(unit.points);
        if (places_.mean_distance) mean_distance_.resize(unit.points);
        part_ = unit.parts.data();
        if (propagation_) {
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
            if (places_.radius) radius_[number] = static_cast<float>(values.radius);
            if (places_.normal)
                for (std::size_t a = 0; a < 3; ++a) normal_[number][a] = static_cast<float>(values.normal[a]);
            if (places_.curvature) curvature_[number] = static_cast<float>(values.curvature);
            if (wanted_.needs_shape()) confidence_[number] = static_cast<std::uint8_t>(values.confidence);
            if (places_.mean_distance) mean_distance_[number] = static_cast<float>(values.mean_distance);
            if (!propagation_) continue;
            add_border_neighbours(unit, some, i, values.normal);
            neighbours_.set(number, some.neighbours(i), some.squared(i), some.count(i));
            two_surfaces_[number] = values.confidence == NormalConfidence::good &&
                                    are_two_surfaces(found, values.normal, least_gap(values.normal));
        }
    }

    void end(const NeighbourhoodUnit& unit) override
    {
        std::sort(border_.begin(), border_.end());  // they came in the order of the search
        if (propagation_) {
            propagation_->add_unit(unit, neighbours_, normal_, two_surfaces_, border_);
            border_ = {};
            for (std::uint32_t n = 0; n < unit.points; ++n)
                if (two_surfaces_[n] && confidence_[n] == static_cast<std::uint8_t>(NormalConfidence::good))
                    confidence_[n] = static_cast<std::uint8_t>(NormalConfidence::two_surfaces);
        }
        for (const NeighbourhoodUnit::Part& part : unit.parts) {
            L2Cache::Edit edit = cache_.edit(part.node, written_);
            const auto put = [&](const std::optional<std::size_t>& place, const auto& values) {
                if (!place) return;
                using Value = typename std::decay_t<decltype(values)>::value_type;
                auto* const to = edit.column(*place).template as<Value>();
                for (std::size_t i = 0; i < part.indices.size(); ++i) to[part.indices[i]] = values[part.first + i];
            };
            put(places_.radius, radius_);
            if (places_.radius) limit_radii(part, edit.column(*places_.radius).as<float>());
            put(places_.curvature, curvature_);
            put(places_.confidence, confidence_);
            put(places_.mean_distance, mean_distance_);
            if (places_.normal) put_normals(part, edit.column(*places_.normal).as<float>());
            edit.mark_written();
        }
        if (wanted_.needs_shape())
            for (std::uint32_t n = 0; n < unit.points; ++n) count(confidence_[n]);
    }

private:
    // Heights along a normal that rounding to the grid may make of one.
    double least_gap(const Vec3d& normal) const
    {
        double step = 0;
        for (std::size_t a = 0; a < 3; ++a) step += std::fabs(normal[a]) * grid_.scale[a];
        return 2.5 * step;
    }

    void limit_radii(const NeighbourhoodUnit::Part& part, float* radii)
    {
        for (const std::uint32_t index : part.indices) {
            const double most = most_radius(*part.chunk, index, grid_, radius_limit_);
            if (!(radii[index] > most)) continue;
            radii[index] = static_cast<float>(most);
            ++counts_.limited;
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
        const std::size_t count = std::min(some.count(i), OrientationPropagation::voting_neighbours);
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
        return known_normal_of(*part_->chunk->attributes[place], schema_[place], part_->indices[number - part_->first]);
    }

    void put_normals(const NeighbourhoodUnit::Part& part, float* to)
    {
        for (std::size_t i = 0; i < part.indices.size(); ++i) {
            const std::uint32_t index = part.indices[i];
            std::array<float, 3> n = normal_[part.first + i];
            const Vec3d p = grid_.to_source(part.chunk->positions->grid(index));
            if (!propagation_ && is_to_turn(*part.chunk, index, {n[0], n[1], n[2]}, p)) {
                for (float& component : n) component = -component;
                ++counts_.flipped;
            }
            std::copy(n.begin(), n.end(), to + std::size_t(3) * index);
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
        counts_.lines += confidence == static_cast<std::uint8_t>(NormalConfidence::line);
        counts_.blobs += confidence == static_cast<std::uint8_t>(NormalConfidence::blob);
        counts_.too_few += confidence == static_cast<std::uint8_t>(NormalConfidence::too_few);
        counts_.two_surfaces += confidence == static_cast<std::uint8_t>(NormalConfidence::two_surfaces);
    }

    L2Cache& cache_;
    const WantedValues wanted_;
    const std::size_t k_;  // neighbours that values are computed from
    const double radius_limit_;
    const NormalOrientation orientation_;
    const ScannerPlaces scanners_;
    const AttributePlaces places_;
    OrientationPropagation* const propagation_;
    const Schema& schema_;
    const Grid& grid_;
    std::mutex& mutex_;  // guards the report
    NeighbourAttributeReport& report_;
    ColumnSet written_;
    const NeighbourhoodUnit::Part* part_ = nullptr;  // part of the last point that was looked at
    // By number in the unit.
    std::vector<float> radius_, curvature_, mean_distance_;
    std::vector<std::array<float, 3>> normal_;
    std::vector<std::uint8_t> confidence_, two_surfaces_;
    JoinedNeighbours neighbours_;
    std::deque<BorderNeighbour> border_;
    Counts counts_;
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
    const bool joins = options.wanted.normal && options.orientation.rule == NormalOrientation::Rule::consistent;
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

NeighbourhoodReport run_attribute_pass(L2Cache& cache, const NeighbourAttributeOptions& options,
                                       const AttributePlaces& places, OrientationPropagation* propagation, double end,
                                       NeighbourAttributeReport& report)
{
    NeighbourhoodOptions search = search_options(options, places);
    if (const auto scan = scanners_of(options, cache.tree().info()).attribute()) search.columns.attributes.set(*scan);
    search.end = end;
    std::mutex mutex;
    return for_each_neighbourhood(cache, search, [&] {
        return std::make_unique<PassVisitor>(cache, options, places, propagation, mutex, report);
    });
}

}  // namespace pcm
