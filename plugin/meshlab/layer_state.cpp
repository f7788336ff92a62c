#include "plugin/meshlab/layer_state.h"

#include "plugin/meshlab/meshlab.h"
#include "plugin/meshlab/vertex_attributes.h"

#include <algorithm>
#include <cstring>
#include <vector>

namespace pcm::host {

namespace {

class Hash {
public:
    void add(std::uint64_t word)
    {
        value_ = (value_ ^ word) * 0x9E3779B97F4A7C15u;
        value_ ^= value_ >> 29;
    }
    void add(float number) { add(std::uint64_t(bits_of(number))); }
    void add(double number)
    {
        std::uint64_t bits;
        std::memcpy(&bits, &number, sizeof bits);
        add(bits);
    }
    void add(const vcg::Point3f& p, std::uint32_t more)
    {
        add(std::uint64_t(bits_of(p[0])) | std::uint64_t(bits_of(p[1])) << 32);
        add(std::uint64_t(bits_of(p[2])) | std::uint64_t(more) << 32);
    }
    void add(const vcg::Point3d& p, std::uint32_t more)
    {
        for (int a = 0; a < 3; ++a) add(p[a]);
        add(std::uint64_t(more));
    }
    std::uint64_t value() const { return value_; }

private:
    static std::uint32_t bits_of(float number)
    {
        std::uint32_t bits;
        std::memcpy(&bits, &number, sizeof bits);
        return bits;
    }

    std::uint64_t value_ = 0xCBF29CE484222325u;
};

// The values of all attributes of MeshLab's scalar, which its functions can write.
std::vector<const Scalarm*> scalar_attributes(const MeshModel& layer)
{
    std::vector<const Scalarm*> attributes;
    for (const vcg::PointerToAttribute& entry : layer.cm.vert_attr)
        if (const auto* values = find_vertex_attribute<Scalarm>(layer, entry._name)) attributes.push_back(values);
    return attributes;
}

}  // namespace

LayerCounts counts_of(const MeshModel& layer)
{
    return {static_cast<std::size_t>(layer.cm.vn), static_cast<std::size_t>(layer.cm.fn),
            static_cast<std::size_t>(layer.cm.en)};
}

LayerState state_of(const MeshModel& layer, Watched watched, std::size_t most)
{
    const auto& vertices = layer.cm.vert;
    LayerState state{static_cast<std::size_t>(layer.cm.vn), static_cast<std::size_t>(layer.cm.fn + layer.cm.en), 0};
    const bool all = watched == Watched::vertices;
    const bool quality = all && layer.hasDataMask(MeshModel::MM_VERTQUALITY);
    const bool radius = all && layer.hasDataMask(MeshModel::MM_VERTRADIUS);
    const auto attributes = all ? scalar_attributes(layer) : std::vector<const Scalarm*>();
    const std::size_t step = std::max<std::size_t>(1, vertices.size() / std::max<std::size_t>(most, 1));
    Hash hash;
    hash.add(std::uint64_t(vertices.size()));
    hash.add(std::uint64_t(attributes.size()));
    for (std::size_t i = 0; i < vertices.size(); i += step) {
        const auto& vertex = vertices[i];
        const auto& colour = vertex.cC();
        hash.add(vertex.cP(), std::uint32_t(colour[0]) | std::uint32_t(colour[1]) << 8 |
                                  std::uint32_t(colour[2]) << 16 | std::uint32_t(vertex.IsD()) << 24);
        if (all) hash.add(vertex.cN(), 0);
        if (quality) hash.add(vertex.cQ());
        if (radius) hash.add(vertex.cR());
        for (const Scalarm* values : attributes) hash.add(values[i]);
    }
    state.hash = hash.value();
    return state;
}

}  // namespace pcm::host
