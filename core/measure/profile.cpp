#include "pcm/measure/profile.h"

#include "pcm/cloud/coordinates.h"
#include "pcm/cloud/exact_products.h"
#include "pcm/cloud/numbers.h"
#include "pcm/measure/placed_cloud.h"
#include "pcm/measure/refuse.h"
#include "pcm/system/error.h"
#include "pcm/system/seconds.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace pcm {
namespace {

Vec3d flat(const Vec3d& p) { return {p[0], p[1], 0}; }

void check(const ProfileOptions& options)
{
    require_coordinate("the width of the profile,", options.width);
    if (options.width < 0) refuse("the width of the profile is " + exact(options.width) + "; it is 0 or more");
    for (const auto& height : {options.lowest, options.highest})
        if (height && std::isnan(*height)) refuse("a height limit of the profile is not a number");
    if (options.lowest && options.highest && *options.lowest > *options.highest)
        refuse("the lowest height of the profile is above the highest one");
}

// The query for the points along segment `k`, and perhaps others nearby.
Query query_of(const PlacedCloud& cloud, const ProfileOptions& options, const ProfileLine& line, std::size_t k)
{
    Query query;
    const Box3d bounds = cloud.bounds();
    query.region = cloud.own_region(line.around(k, options.width, bounds.min[2], bounds.max[2]));
    query.level = options.level;
    query.where = options.where;
    query.clips = options.clips;
    query.attributes = options.attributes;
    if ((options.lowest || options.highest) && !options.placement) {
        query.box = Box3d{{-infinity, -infinity, options.lowest.value_or(-infinity)},
                          {infinity, infinity, options.highest.value_or(infinity)}};
    }
    return query;
}

// A cloud at its place is asked for these heights only.
bool is_between(double z, const ProfileOptions& options)
{
    return !options.placement || (z >= options.lowest.value_or(-infinity) && z <= options.highest.value_or(infinity));
}

// Progress of part `part` of `parts`.
ProgressFunction part_of(const ProgressFunction& progress, std::size_t part, std::size_t parts)
{
    if (!progress) return {};
    return [=](const ProgressUpdate& update) {
        ProgressUpdate whole = update;
        whole.stage = "Reading the profile";
        whole.fraction = (static_cast<double>(part) + update.fraction) / static_cast<double>(parts);
        whole.seconds_left = -1;
        return progress(whole);
    };
}

}  // namespace

ProfileLine::ProfileLine(const std::vector<Vec3d>& points)
{
    for (const Vec3d& p : points) {
        require_place("the point of the profile's line,", flat(p));
        if (points_.empty() || flat(p) != points_.back()) points_.push_back(flat(p));
    }
    if (points_.size() < 2)
        refuse("the line of the profile has no length in plan: two points at different places are needed");
    stations_.push_back(0);
    for (std::size_t i = 1; i < points_.size(); ++i)
        stations_.push_back(stations_.back() + pcm::length(points_[i] - points_[i - 1]));
    turns_.assign(points_.size(), 0);
    for (std::size_t i = 1; i + 1 < points_.size(); ++i)
        turns_[i] = exact_cross(points_[i] - points_[i - 1], points_[i + 1] - points_[i])[2];
}

std::optional<ProfilePoint> ProfileLine::locate(const Vec3d& position) const
{
    std::optional<ProfilePoint> found;
    double nearest = std::numeric_limits<double>::infinity();
    const Vec3d p = flat(position);
    for (std::size_t k = 0; k < segments(); ++k) {
        const double size = stations_[k + 1] - stations_[k];
        const Vec3d u = (points_[k + 1] - points_[k]) / size, d = p - points_[k];
        const double along = exact_dot(u, d), right = difference_of_products(u[1], d[0], u[0], d[1]);
        const bool cut = (k == 0 && along < 0) || (k + 1 == segments() && along > size);
        // At a corner both segments have the same distance to the bit, and the first one is taken.
        const double t = std::clamp(along, 0.0, size);
        const double distance = t == along ? std::fabs(right) : pcm::length(p - points_[along < 0 ? k : k + 1]);
        if (!(distance < nearest)) continue;
        nearest = distance;
        const double side = along > size && k + 1 < segments() && turns_[k + 1] != 0 ? turns_[k + 1] : right;
        found = ProfilePoint{stations_[k] + t, std::copysign(distance, side), position, static_cast<std::uint32_t>(k)};
        if (cut) found.reset();
    }
    return found;
}

Region ProfileLine::around(std::size_t segment, double width, double low, double high) const
{
    const Vec3d &a = points_[segment], &b = points_[segment + 1];
    const Vec3d u = (b - a) / pcm::length(b - a);
    // A margin for rounding: locate() decides.
    const double half_width = width / 2, margin = 1e-9 * (half_width + pcm::length(b - a)) +
                                                  1e-14 * std::max(largest_magnitude(a), largest_magnitude(b));
    const Vec3d centre{a[0] + (b[0] - a[0]) / 2, a[1] + (b[1] - a[1]) / 2, low + (high - low) / 2};
    return Region::oriented_box(centre, {u, {-u[1], u[0], 0}, {0, 0, 1}},
                                {pcm::length(b - a) / 2 + half_width + margin, half_width + margin,
                                 (high - low) / 2 + margin + 1e-9 * std::fabs(high - low)});
}

Outcome visit_profile(PointCloud& cloud, const ProfileOptions& options, const ProfileVisitor& visit)
{
    const auto start = std::chrono::steady_clock::now();
    const ProfileLine line(options.line);
    check(options);
    Outcome outcome;
    outcome.error_meaning = "every point of the cloud is nearer than this to one of the level, source units";
    const PlacedCloud placed(cloud, options.placement);
    if (options.level) outcome.error = placed.most_stretch() * level_spacing(*cloud.tree(), *options.level);
    for (std::size_t k = 0; k < line.segments() && cloud.info().points > 0; ++k) {
        Query query = query_of(placed, options, line, k);
        query.progress = part_of(options.progress, k, line.segments());
        PointCursor cursor = cloud.points(query);
        for (PointView view; cursor.getNextData(view);)
            for (std::size_t i = 0; i < view.size(); ++i) {
                const auto point = line.locate(placed.position(view, i));
                if (!point || point->segment != k || std::fabs(point->offset) > options.width / 2) continue;
                if (!is_between(point->position[2], options)) continue;
                visit(*point, view, i);
                ++outcome.points_out;
            }
        outcome.points_in += cursor.statistics().points_read;
    }
    outcome.seconds = seconds_since(start);
    return outcome;
}

namespace {

struct TooMany {};

ProfileSample read_sample(PointCloud& cloud, const ProfileOptions& options, std::size_t most)
{
    ProfileSample sample;
    std::vector<Attribute> attributes;
    for (const std::string& name : options.attributes)
        for (const Attribute& attribute : cloud.info().schema)
            if (attribute.name == name) attributes.push_back(attribute);
    std::size_t columns = 0;
    for (const Attribute& attribute : attributes) columns += attribute.components;
    sample.attributes.resize(columns);
    sample.outcome =
        visit_profile(cloud, options, [&](const ProfilePoint& point, const PointView& view, std::size_t i) {
            if (sample.points.size() == most) throw TooMany{};
            sample.points.push_back(point);
            auto column = sample.attributes.begin();
            for (std::size_t k = 0; k < attributes.size(); ++k)
                for (std::uint32_t c = 0; c < attributes[k].components; ++c, ++column)
                    column->push_back(view.value(i, k, c) * attributes[k].scale + attributes[k].offset);
        });
    return sample;
}

// What the index expects at a level: an upper estimate where there are conditions.
double expected_points(PointCloud& cloud, const ProfileOptions& options, const ProfileLine& line)
{
    const PlacedCloud placed(cloud, options.placement);
    double expected = 0;
    for (std::size_t k = 0; k < line.segments(); ++k)
        expected += cloud.estimate(query_of(placed, options, line, k)).points_expected;
    return expected;
}

}  // namespace

ProfileSample sample_profile(PointCloud& cloud, const ProfileOptions& options, std::size_t most)
{
    const ProfileLine line(options.line);
    const std::uint16_t levels = cloud.info().levels;
    if (levels == 0 || cloud.info().points == 0) return read_sample(cloud, options, most);
    const auto last = static_cast<std::uint16_t>(levels - 1);
    ProfileOptions at_level = options;
    for (std::uint16_t level = std::min(options.level.value_or(last), last);; --level) {
        at_level.level = level;
        if (level == last) at_level.level.reset();
        // Reading is stopped when there are too many; far too many are not begun.
        if (level > 0 && expected_points(cloud, at_level, line) > 4 * static_cast<double>(most)) continue;
        try {
            ProfileSample sample =
                read_sample(cloud, at_level, level ? most : std::max<std::size_t>(most, std::size_t{1} << 24));
            sample.level = at_level.level;
            return sample;
        } catch (const TooMany&) {
            if (level == 0) refuse("the coarsest level of the cloud has more points of the profile than fit in memory");
        }
    }
}

}  // namespace pcm
