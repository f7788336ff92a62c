#include "pcm/filter/combined_attributes.h"

#include "pcm/system/error.h"

#include <algorithm>
#include <array>

namespace pcm {
namespace {

constexpr std::array categorical_names = {
    // LAS
    "classification", "return_number", "number_of_returns", "scan_direction_flag", "edge_of_flight_line", "synthetic",
    "key_point", "withheld", "overlap", "scanner_channel", "user_data", "point_source_id", "wave_packet_descriptor",
    "wave_packet_offset", "wave_packet_size", "extra_bytes",
    // E57 and PTX
    "scan", "rowIndex", "columnIndex", "returnIndex", "isIntensityInvalid", "isColorInvalid", "isTimeStampInvalid",
    "row", "column",
    // Others
    "label", "object", "segment", "instance", "class", "ring", "outlier", "normal_confidence", "source_id", "source"};

bool is_integer(ScalarType type) { return type != ScalarType::f32 && type != ScalarType::f64; }

bool holds(const std::vector<std::string>& names, const std::string& name)
{
    return std::find(names.begin(), names.end(), name) != names.end();
}

std::size_t attribute_of(const Schema& schema, const std::string& name)
{
    if (const auto found = schema.find(name)) return *found;
    std::string all;
    for (const Attribute& attribute : schema) all += (all.empty() ? "" : ", ") + attribute.name;
    throw Error(ErrorCode::invalid_argument, {}, "there is no attribute '" + name + "'",
                all.empty() ? "the cloud has no attributes" : "the cloud has " + all);
}

}  // namespace

bool is_categorical(std::string_view name)
{
    return std::find(categorical_names.begin(), categorical_names.end(), name) != categorical_names.end();
}

std::vector<Combination> combinations_of(const Schema& schema, const std::vector<std::string>& by_majority,
                                         const std::vector<std::string>& by_mean)
{
    for (const std::string& name : by_majority) {
        if (!is_integer(schema[attribute_of(schema, name)].type))
            throw Error(ErrorCode::invalid_argument, {},
                        "'" + name + "' has floating-point values; only integers have a majority");
        if (holds(by_mean, name))
            throw Error(ErrorCode::invalid_argument, {},
                        "'" + name + "' is to be combined both by majority and by mean", "name it once");
    }
    for (const std::string& name : by_mean) attribute_of(schema, name);
    std::vector<Combination> result;
    for (const Attribute& attribute : schema) {
        const bool majority =
            holds(by_majority, attribute.name) ||
            (is_integer(attribute.type) && is_categorical(attribute.name) && !holds(by_mean, attribute.name));
        const bool direction =
            attribute.name == attribute_name::normal && attribute.components == 3 && !is_integer(attribute.type);
        result.push_back(majority ? Combination::majority : direction ? Combination::direction : Combination::mean);
    }
    return result;
}

}  // namespace pcm
