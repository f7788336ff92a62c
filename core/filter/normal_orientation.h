// Which of the two sides of a surface its normals point to.
#pragma once

#include "pcm/bpc/chunk.h"
#include "pcm/cloud/attribute.h"
#include "pcm/cloud/metadata.h"
#include "pcm/cloud/vector.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace pcm {

struct NormalOrientation {
    enum class Rule : std::uint8_t {
        consistent,  // the same side along each surface: see orientation_propagation.h
        direction,   // to the half space of a vector: n . vector >= 0
        viewpoint,   // towards a point, where the scanner stood
        scanners,    // each towards where its own scan was made (ScannerPlaces)
    };
    Rule rule = Rule::consistent;
    Vec3d vector{0, 0, 1};  // a direction, not 0; or a viewpoint, source coordinates
};

// Where the scanner of each point stood: by the attribute `scan`, and the poses that PTX and E57 files leave in the
// metadata. Any number of threads.
class ScannerPlaces {
public:
    ScannerPlaces() = default;  // no scanner is known
    ScannerPlaces(const std::vector<Metadata>& metadata, const Schema& schema);

    bool empty() const { return positions_.empty(); }
    const std::optional<std::size_t>& attribute() const { return attribute_; }  // attribute that chunks need
    // Null: it is not known.
    const Vec3d* of(const Chunk& chunk, std::size_t point) const;

private:
    std::map<std::uint32_t, Vec3d> positions_;
    std::optional<std::size_t> attribute_;  // none: the cloud is one scan
};

// Whether the normal of the point `p` has to be turned around, by a direction or a viewpoint. Normals at a right angle
// to the rule stay.
inline bool is_to_flip(const NormalOrientation& orientation, const Vec3d& normal, const Vec3d& p)
{
    const bool to_point = orientation.rule == NormalOrientation::Rule::viewpoint;
    return dot(normal, to_point ? orientation.vector - p : orientation.vector) < 0;
}

}  // namespace pcm
