// A cloud that is moved, rotated or scaled while it is read.
#pragma once

#include "pcm/cloud/affine.h"
#include "pcm/io/reader.h"

#include <array>
#include <memory>
#include <optional>
#include <string>

namespace pcm {

// Where the map only scales and shifts along the axes, gridded points keep their integers and get another grid;
// otherwise positions become doubles. An attribute `normal` of three floats is transformed by the inverse transpose, as
// planes are, and keeps its length; lengths (cloud/attribute_length.h) grow with
// the cube root of the volume, areas with its square, and so on. Metadata are kept; a note
// reports that where they state a coordinate system. One thread, as for the source.
class TransformedReader final : public PointReader {
public:
    // Throws Error(invalid_argument) for a map that is not finite or flattens space.
    TransformedReader(std::unique_ptr<PointReader> cloud, const Affine& map);

    const FileInfo& info() const override;
    bool read(PointBatch& batch, std::size_t max_points) override;
    bool seekable() const override { return cloud_->seekable(); }
    void seek(std::uint64_t index) override { cloud_->seek(index); }
    double fraction_read() const override { return cloud_->fraction_read(); }

private:
    const std::unique_ptr<PointReader> cloud_;
    const Affine map_;
    std::array<Vec3d, 3> of_normals_{};
    // For each attribute: what its values are multiplied by, and whether its scale and offset do that. Found anew when
    // the schema grows, as that of files read one after the other may.
    struct Growth {
        double factor = 1;
        bool by_scale = false;
    };
    Growth growth_of(const Attribute& attribute) const;
    void take_turn(double unit);

    double of_lengths_ = 1;
    std::optional<Grid> grid_;  // when points stay gridded
    std::string system_note_;
    mutable FileInfo info_;
    PointBatch from_;
};

}  // namespace pcm
