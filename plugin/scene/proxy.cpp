#include "plugin/scene/proxy.h"

#include "pcm/view/point_colours.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>

namespace pcm::host {

namespace {

constexpr std::array<std::uint8_t, 3> uncoloured{191, 191, 191};

struct Sample {
    std::vector<Vec3d> positions;
    Column colour;
};

// Every `stride`-th point of a level. Points within a chunk are in Morton order, so a stride keeps the sample even.
Sample sample_level(PointCloud& cloud, std::uint16_t level, std::uint64_t stride, const std::string& attribute)
{
    Sample sample;
    Query query;
    query.level = level;
    if (!attribute.empty()) query.attributes = {attribute};
    std::vector<std::byte> raw;
    std::uint64_t number = 0;
    auto cursor = cloud.points(query);
    PointView view;
    while (cursor.getNextData(view)) {
        if (!attribute.empty() && sample.colour.size() == 0)
            sample.colour = Column(view.column(0).type(), view.column(0).components());
        for (std::size_t i = 0; i < view.size(); ++i, ++number) {
            if (number % stride != 0) continue;
            sample.positions.push_back(view.position(i));
            if (attribute.empty()) continue;
            const Column& column = view.column(0);
            const std::byte* from = column.data() + view.index(i) * column.point_bytes();
            raw.insert(raw.end(), from, from + column.point_bytes());
        }
    }
    sample.colour.resize(attribute.empty() ? 0 : sample.positions.size());
    if (!raw.empty()) std::memcpy(sample.colour.data(), raw.data(), raw.size());
    return sample;
}

std::array<float, 3> local(const Vec3d& p, const Vec3d& origin)
{
    return {static_cast<float>(p[0] - origin[0]), static_cast<float>(p[1] - origin[1]),
            static_cast<float>(p[2] - origin[2])};
}

// The spacing of every `stride`-th point of a level, `points` altogether. A level that has all points has no spacing of
// its own.
double spacing_of(PointCloud& cloud, std::uint16_t level, std::uint64_t stride, std::size_t points)
{
    const double spacing = cloud.tree()->level_summaries()[level].spacing;
    if (spacing > 0) return spacing * std::sqrt(static_cast<double>(stride));
    return cloud.info().bounds().diagonal() / std::sqrt(static_cast<double>(std::max<std::size_t>(points, 1)));
}

// The extreme points that are not in the sample. Without this a cloud that is its own sample has more points than there
// are, and a corner of a cloud is there up to three times.
void add_extremes(Proxy& proxy, const TreeInfo& info, const Vec3d& origin)
{
    std::vector<ProxyPoint> missing;
    for (const Vec3i& extreme : info.extremes) {
        const ProxyPoint point{local(info.grid.to_source(extreme), origin), uncoloured};
        const auto is_there = [&](const ProxyPoint& other) { return other.position == point.position; };
        if (std::none_of(missing.begin(), missing.end(), is_there)) missing.push_back(point);
    }
    for (const ProxyPoint& point : proxy.points)
        missing.erase(std::remove_if(missing.begin(), missing.end(),
                                     [&](const ProxyPoint& other) { return other.position == point.position; }),
                      missing.end());
    proxy.points.insert(proxy.points.end(), missing.begin(), missing.end());
}

}  // namespace

std::vector<std::array<std::uint8_t, 3>> colours_of(const Column& column, bool is_rgb)
{
    const auto kind = is_rgb ? ColourSource::rgb : ColourSource::intensity;
    std::vector<std::uint8_t> rgba;
    make_colours(column, ColourScale::of(column, kind), rgba);
    std::vector<std::array<std::uint8_t, 3>> colours(column.size());
    for (std::size_t i = 0; i < colours.size(); ++i) colours[i] = {rgba[4 * i], rgba[4 * i + 1], rgba[4 * i + 2]};
    return colours;
}

bool is_black(const Column& column)
{
    for (std::size_t i = 0; i < column.size(); ++i)
        for (std::uint32_t c = 0; c < column.components(); ++c)
            if (column.value(i, c) != 0) return false;
    return true;
}

Proxy make_proxy(PointCloud& cloud, const Vec3d& origin, std::uint64_t most)
{
    const TreeInfo& info = cloud.info();
    const Tree& tree = *cloud.tree();
    const std::uint16_t level = tree.level_with_at_most(most);
    const std::uint64_t available = tree.points_to_level(level);
    const std::uint64_t stride = std::max<std::uint64_t>(1, (available + most - 1) / std::max<std::uint64_t>(most, 1));

    Proxy proxy;
    proxy.origin = origin;
    Sample sample;
    bool sampled = false, coloured = false;
    const auto rgb = info.schema.find(attribute_name::rgb);
    if (rgb && info.schema[*rgb].components >= 3) {
        sample = sample_level(cloud, level, stride, std::string(attribute_name::rgb));
        sampled = coloured = proxy.has_rgb = !is_black(sample.colour);
    }
    if (!sampled) {
        coloured = info.schema.find(attribute_name::intensity).has_value();
        sample = sample_level(cloud, level, stride, coloured ? std::string(attribute_name::intensity) : std::string());
    }
    std::vector<std::array<std::uint8_t, 3>> colours;
    if (coloured) colours = colours_of(sample.colour, proxy.has_rgb);

    proxy.is_whole = sample.positions.size() == info.points;
    if (!proxy.is_whole) proxy.spacing = spacing_of(cloud, level, stride, sample.positions.size());
    proxy.points.reserve(sample.positions.size() + info.extremes.size());
    for (std::size_t i = 0; i < sample.positions.size(); ++i)
        proxy.points.push_back({local(sample.positions[i], origin), coloured ? colours[i] : uncoloured});
    if (info.points > 0 && !proxy.is_whole) add_extremes(proxy, info, origin);
    return proxy;
}

}  // namespace pcm::host
