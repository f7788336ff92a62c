#include "pcm/filter/result_attributes.h"

#include "pcm/cloud/attribute_length.h"
#include "pcm/cloud/attribute_names.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace pcm {
namespace {

std::string type_text(const Attribute& attribute)
{
    std::string text(name_of(attribute.type));
    if (attribute.components > 1) text += " x " + std::to_string(attribute.components);
    if (attribute.scale != 1 || attribute.offset != 0) text += ", scaled";
    return text;
}

[[noreturn]] void refuse_type(const std::filesystem::path& folder, const Attribute& present, const Attribute& attribute)
{
    throw Error(ErrorCode::invalid_argument, folder,
                "the attribute '" + attribute.name + "' exists with another type (" + type_text(present) +
                    "); the computed values are " + type_text(attribute),
                "convert the cloud to a tree without this attribute first");
}

bool is_of_type(const Attribute& present, const Attribute& attribute)
{
    return present.type == attribute.type && present.components == attribute.components && present.scale == 1 &&
           present.offset == 0;
}

// The place of the attribute that has the name; none where none has it.
std::optional<std::size_t> place_of_type(const Tree& tree, const Schema& schema, const Attribute& attribute)
{
    const auto place = schema.find(attribute.name);
    if (place && !is_of_type(schema[*place], attribute)) refuse_type(tree.folder(), schema[*place], attribute);
    return place;
}

// Whether an attribute of the tree has the description; cut as LAS does, where the tree came from such a file.
bool is_described_as(const Attribute& present, const std::string& description)
{
    constexpr std::size_t most_las_bytes = 32;
    return !description.empty() && (present.description == description ||
                                    present.description == shortened_description(description, most_las_bytes));
}

// Names of LAS, and those that the library reads.
constexpr std::array<std::string_view, 23> standard_names{"classification",
                                                          "intensity",
                                                          "return_number",
                                                          "number_of_returns",
                                                          "scan_direction_flag",
                                                          "synthetic",
                                                          "edge_of_flight_line",
                                                          "key_point",
                                                          "withheld",
                                                          "overlap",
                                                          "scan_angle",
                                                          "scanner_channel",
                                                          "scan_angle_rank",
                                                          "user_data",
                                                          "point_source_id",
                                                          "gps_time",
                                                          "rgb",
                                                          "nir",
                                                          "alpha",
                                                          "normal",
                                                          "radius",
                                                          "extra_bytes",
                                                          "label"};

}  // namespace

void check_may_write(const Tree& tree, const Attribute& attribute, bool overwrite)
{
    const Schema& schema = tree.info().schema;
    const auto place = schema.find(attribute.name);
    if (place && !is_of_type(schema[*place], attribute)) refuse_type(tree.folder(), schema[*place], attribute);
    if (overwrite) return;
    const char* const advice = "choose another name, or overwrite it";
    if (place && !is_described_as(schema[*place], attribute.description))
        throw Error(ErrorCode::invalid_argument, tree.folder(),
                    "the attribute '" + attribute.name +
                        "' exists already and was not made by this operation: its values would be lost",
                    advice);
    if (std::find(standard_names.begin(), standard_names.end(), attribute.name) != standard_names.end())
        throw Error(ErrorCode::invalid_argument, tree.folder(),
                    "'" + attribute.name + "' is a standard name, whose values have another meaning", advice);
}

Attribute selection_attribute(const std::string& name)
{
    return {name, ScalarType::u8, 1, 1, 0, "pcmlab: 1 selected, 0 not"};
}

Attribute outlier_attribute()
{
    return {std::string(attribute_name::outlier), ScalarType::u8, 1, 1, 0, "pcmlab: 1 outlier, 0 not"};
}

Attribute primitive_attribute(const std::string& name)
{
    return {name, ScalarType::u32, 1, 1, 0, "pcmlab: number of primitive"};
}

std::size_t place_for(TreeChanges& changes, const Attribute& attribute)
{
    const auto tree = changes.tree();
    const auto place = place_of_type(*tree, tree->info().schema, attribute);
    return place ? *place : changes.add_attribute(attribute);
}

std::size_t place_for(const Tree& tree, Schema& schema, const Attribute& attribute)
{
    if (const auto place = place_of_type(tree, schema, attribute)) return *place;
    check_new_name(attribute.name);
    schema.add(attribute);
    return schema.size() - 1;
}

}  // namespace pcm
