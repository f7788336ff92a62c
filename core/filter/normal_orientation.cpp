#include "pcm/filter/normal_orientation.h"

#include "pcm/io/scans.h"

namespace pcm {

ScannerPlaces::ScannerPlaces(const std::vector<Metadata>& metadata, const Schema& schema)
    : positions_(scan_positions(metadata)), attribute_(schema.find(scan_attribute))
{
    if (attribute_ && schema[*attribute_].components != 1) attribute_.reset();
    if (!attribute_ && positions_.size() != 1) positions_.clear();
}

const Vec3d* ScannerPlaces::of(const Chunk& chunk, std::size_t point) const
{
    if (!attribute_) return positions_.empty() ? nullptr : &positions_.begin()->second;
    const auto found = positions_.find(static_cast<std::uint32_t>(chunk.attributes[*attribute_]->value(point)));
    return found == positions_.end() ? nullptr : &found->second;
}

}  // namespace pcm
