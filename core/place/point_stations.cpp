#include "pcm/place/point_stations.h"

#include "pcm/cloud/attribute.h"
#include "pcm/io/scans.h"
#include "pcm/place/tuning.h"

#include <algorithm>
#include <cmath>

namespace pcm {
namespace {

// A station has many points, even among the coarsest ones; numbers of few points name something else.
bool may_be_stations(std::vector<double> values)
{
    const std::size_t points = values.size();
    std::sort(values.begin(), values.end());
    const auto different = static_cast<std::size_t>(std::unique(values.begin(), values.end()) - values.begin());
    return different > 1 && different * place_tuning().stations.min_points <= points;
}

bool have_several_places(const std::vector<Metadata>& metadata)
{
    const std::map<std::uint32_t, Vec3d> places = scan_positions(metadata);
    return std::any_of(places.begin(), places.end(),
                       [&](const auto& scan) { return scan.second != places.begin()->second; });
}

std::vector<double> coarse_values(const Tree& tree, std::size_t attribute)
{
    std::vector<double> values;
    ColumnSet columns;
    columns.positions = false;
    columns.attributes.set(attribute);
    const Attribute& row = tree.info().schema[attribute];
    const std::size_t most_parts = place_tuning().stations.max_parts;
    std::size_t parts = 0;
    for (NodeId node : tree.part_roots()) {
        if (node == no_node || parts++ >= most_parts) continue;
        const Chunk chunk = tree.read_chunk(node, columns);
        for (std::uint32_t i = 0; i < chunk.points; ++i)
            values.push_back(chunk.attributes[attribute]->value(i) * row.scale + row.offset);
    }
    return values;
}

}  // namespace

PointStations::PointStations(const Tree& tree)
{
    const Schema& schema = tree.info().schema;
    for (const std::string name : {scan_attribute, "point_source_id"}) {
        const auto place = schema.find(name);
        if (!place || schema[*place].components != 1) continue;
        are_stated_ = name == scan_attribute && have_several_places(tree.info().metadata);
        if (!are_stated_ && !may_be_stations(coarse_values(tree, *place))) continue;
        source_ = StationSource::attribute;
        attribute_ = name;
        place_ = *place;
        return;
    }
    const auto place = schema.find(attribute_name::gps_time);
    if (!place || schema[*place].components != 1) return;
    place_ = *place;
    scale_ = schema[*place].scale;
    offset_ = schema[*place].offset;
    look_at_times(coarse_values(tree, *place));
}

void PointStations::look_at_times(std::vector<double> times)
{
    times.erase(std::remove_if(times.begin(), times.end(), [](double t) { return !std::isfinite(t); }), times.end());
    if (times.size() < 2) return;
    const StationTuning& tuned = place_tuning().stations;
    std::sort(times.begin(), times.end());
    const double mean = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
    const double gap = std::max(tuned.min_gap, tuned.mean_gaps * mean);
    for (std::size_t i = 1; i < times.size(); ++i)
        if (times[i] - times[i - 1] >= gap) begins_.push_back((times[i] + times[i - 1]) / 2);
    if ((begins_.size() + 1) * tuned.min_points > times.size()) begins_.clear();
    if (begins_.empty()) return;
    source_ = StationSource::time_gaps;
    attribute_ = attribute_name::gps_time;
}

ColumnSet PointStations::columns() const
{
    ColumnSet columns;
    if (source_ != StationSource::none) columns.attributes.set(place_);
    return columns;
}

std::uint32_t PointStations::at(const Chunk& chunk, std::size_t i) const
{
    if (source_ == StationSource::none) return 0;
    const double value = chunk.attributes[place_]->value(i);
    if (source_ == StationSource::attribute) return static_cast<std::uint32_t>(value);
    const auto after = std::upper_bound(begins_.begin(), begins_.end(), value * scale_ + offset_);
    return static_cast<std::uint32_t>(after - begins_.begin());
}

}  // namespace pcm
