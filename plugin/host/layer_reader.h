// The vertices of an ordinary layer as a cloud in source coordinates, for whatever takes a PointReader.
#pragma once

#include "plugin/host/layer_source.h"
#include "pcm/io/reader.h"

#include <common/interfaces.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

namespace pcm::host {

struct LayerSelection {
    bool selected_only = false;
    // Which of MeshLab's members to take, where the layer has them; custom attributes are always taken.
    bool colour = true, normal = true, quality = true, radius = true;
};

// Positions are the file's own where a vertex still is where we put it, else its position plus the document's origin in
// double; likewise colours. Attributes have the file's names and types while every value fits the type, else f32; float
// attributes that MeshLab's filters have added come after them. Without a file (a layer not from us): rgb u8, normal,
// quality as intensity, radius. The layer's matrix is not applied, as in MeshLab's own exporters.
//
// The layer must not change while this lives. Throws Error(invalid_argument) when there is nothing to read.
class LayerReader : public PointReader {
public:
    LayerReader(const MeshModel& layer, const LayerSelection& selection);

    const FileInfo& info() const override { return info_; }
    bool read(PointBatch& batch, std::size_t max_points) override;
    double fraction_read() const override;

    // Points that are not where the file had them (all of them, without a file).
    std::uint64_t moved() const { return moved_; }

private:
    struct Field {
        Attribute attribute;
        std::function<double(std::size_t vertex, std::uint32_t component)> value;  // raw
        // For 64-bit numbers that double would round; one a component.
        std::vector<const std::int64_t*> whole;
    };

    void add_file_fields(const MeshModel& layer, const LayerSelection& selection);
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
    std::optional<Grid> source_grid_;    // of the file that the layer came from
    std::vector<std::size_t> vertices_;  // which of the layer's
    std::vector<Field> fields_;
    std::uint64_t moved_ = 0;
    std::size_t next_ = 0;
};

}  // namespace pcm::host
