#include "pcm/pick/describe_point.h"

#include "pcm/cloud/with_type.h"
#include "pcm/system/error.h"
#include "pcm/system/scaled_decimal.h"
#include "pcm/system/text.h"
#include "pcm/tree/source_rounding.h"

#include <algorithm>
#include <charconv>
#include <type_traits>

namespace pcm {
namespace {

template <class T>
std::string text_of(T raw, const Attribute& attribute)
{
    if (attribute.scale != 1 || attribute.offset != 0) {
        if constexpr (std::is_integral_v<T> && !std::is_same_v<T, std::uint64_t>)
            return decimal_text(raw, attribute.scale, attribute.offset);
        else
            return exact(static_cast<double>(raw) * attribute.scale + attribute.offset);
    }
    if constexpr (std::is_integral_v<T>) return std::to_string(raw);
    char digits[64];
    return std::string(digits, std::to_chars(digits, digits + sizeof digits, raw).ptr);
}

DescribedAttribute describe(const Column& column, const Attribute& attribute, std::size_t point)
{
    DescribedAttribute described;
    described.name = attribute.name;
    with_type(attribute.type, [&](auto zero) {
        const auto* raw = column.as<decltype(zero)>() + point * attribute.components;
        for (std::uint32_t c = 0; c < attribute.components; ++c) described.values.push_back(text_of(raw[c], attribute));
    });
    return described;
}

std::uint16_t level_of(const Node& node, std::uint32_t index)
{
    std::size_t level = 0;
    for (std::uint64_t end = 0; level < node.level_points.size(); ++level)
        if (index < (end += node.level_points[level])) break;
    return static_cast<std::uint16_t>(node.first_level + level);
}

}  // namespace

std::string DescribedAttribute::text() const
{
    std::string text;
    for (const std::string& value : values) text += (text.empty() ? "" : " ") + value;
    return text;
}

PointDescription describe_point(L2Cache& cache, const PointSizes& sizes, NodeId id, std::uint32_t index)
{
    const Tree& tree = cache.tree();
    const TreeInfo& info = tree.info();
    if (id >= tree.nodes().size() || index >= tree.node(id).points)
        throw Error(ErrorCode::invalid_argument, tree.folder(),
                    "there is no point " + std::to_string(index) + " in node " + std::to_string(id));
    ColumnSet columns = ColumnSet::whole(info.schema);
    PointDescription described;
    described.level = level_of(tree.node(id), index);
    L2Cache::Handle whole = cache.find(id, columns);
    Chunk chunk;
    std::size_t place = index;
    if (!whole) {
        auto part =
            cache.read_part(id, columns, [&](const Box3i&, std::uint16_t level) { return level == described.level; });
        if (part) {
            std::size_t before = 0, k = 0;
            while (k + 1 < part->first.size() && part->first[k + 1] <= index) before += part->count[k++];
            place = before + (index - part->first[k]);
            chunk = std::move(part->chunk);
        } else {
            whole = cache.get(id, columns);
        }
    }
    if (whole) chunk = *whole;
    const auto on_grid = chunk.positions->grid(place);
    const Vec3d unrounded = info.grid.to_source(on_grid);
    described.position = SourceRounding(info)(unrounded);
    for (std::size_t a = 0; a < 3; ++a)
        described.position_text[a] = described.position[a] == unrounded[a]
                                         ? decimal_text(on_grid[a], info.grid.scale[a], info.grid.offset[a])
                                         : exact(described.position[a]);
    std::vector<float> radii;
    sizes.find_radii(id, chunk, radii);
    described.spacing = static_cast<double>(radii[place]);
    described.grid_step = *std::max_element(info.grid.scale.begin(), info.grid.scale.end());
    for (std::size_t k = 0; k < info.schema.size(); ++k)
        described.attributes.push_back(describe(*chunk.attributes[k], info.schema[k], place));
    return described;
}

}  // namespace pcm
