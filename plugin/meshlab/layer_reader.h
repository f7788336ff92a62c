// Reads the vertices of an ordinary layer as a cloud in source coordinates.
#pragma once

#include "pcm/io/reader.h"
#include "plugin/meshlab/layer_source.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

class MeshModel;

namespace pcm::host {

struct LayerSelection {
    bool selected_only = false;
    // Which of MeshLab's vertex members to read, if the layer has them. Custom attributes are always read.
    bool colour = true, normal = true, quality = true, radius = true;
};

// A vertex that was not moved since it was loaded has the position of the file; any other has its position plus the
// document's origin, in double. Colours likewise. Attributes have the names and types of the file; an attribute with a
// value that does not fit its type becomes f32. Float attributes added by MeshLab's filters come after them. A layer
// that was not loaded by this plugin has rgb (u8), normal, intensity (from quality) and radius. The layer's matrix is
// not applied, as in MeshLab's own exporters.
//
// The layer must not change during the reader's lifetime. Throws Error(invalid_argument) for a layer without vertices,
// or without selected ones. GUI thread.
class LayerReader : public PointReader {
public:
    LayerReader(const MeshModel& layer, const LayerSelection& selection);

    const FileInfo& info() const override { return info_; }
    bool read(PointBatch& batch, std::size_t max_points) override;
    double fraction_read() const override;

    // Number of points whose position differs from the file's; all of them if there is no file.
    std::uint64_t moved() const { return moved_; }

private:
    struct Field {
        Attribute attribute;
        std::function<double(std::size_t vertex, std::uint32_t component)> value;  // raw
        // One per component, for 64-bit integers that double would round.
        std::vector<const std::int64_t*> whole;
    };

    std::function<double(std::size_t, std::uint32_t)> colour_values(const Attribute& attribute) const;
    bool find_custom_values(Field& field, const AttributePlace& place) const;
    bool find_values(Field& field, const AttributePlace& place, const LayerSelection& selection) const;
    void add_file_fields(const LayerSelection& selection);
    void add_member_fields(const MeshModel& layer, const LayerSelection& selection);
    void add_free_fields(const MeshModel& layer);
    void add_field(Field field, bool may_widen);
    Vec3d position(std::size_t vertex) const;
    bool is_unmoved(std::size_t vertex) const;
    void settle_positions();

    const MeshModel& layer_;
    std::shared_ptr<const LayerSource> source_;
    const KeptVertex* kept_ = nullptr;
    Vec3d origin_{};
    FileInfo info_;
    std::optional<Grid> source_grid_;    // the grid of the file that the layer came from
    std::vector<std::size_t> vertices_;  // indices of the vertices to read
    std::vector<Field> fields_;
    std::uint64_t moved_ = 0;
    std::size_t next_ = 0;
};

}  // namespace pcm::host
