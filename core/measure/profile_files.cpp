// Profiles as CSV and DXF.
#include "pcm/cad/dxf_file.h"
#include "pcm/measure/profile.h"
#include "pcm/system/error.h"
#include "pcm/system/new_output.h"
#include "pcm/system/output_file.h"
#include "pcm/system/text.h"

#include <array>
#include <charconv>
#include <cmath>

namespace pcm {
namespace {

template <class Number>
std::string text_of(Number number)
{
    std::array<char, 64> text;
    return {text.data(), std::to_chars(text.data(), text.data() + text.size(), number).ptr};
}

// In the attribute's unit, with all digits of its type.
std::string value_text(const Attribute& attribute, const Column& column, std::size_t place, std::uint32_t component)
{
    const std::size_t at = place * attribute.components + component;
    if (attribute.scale == 1 && attribute.offset == 0) {
        if (attribute.type == ScalarType::i64) return text_of(column.as<std::int64_t>()[at]);
        if (attribute.type == ScalarType::u64) return text_of(column.as<std::uint64_t>()[at]);
        if (attribute.type == ScalarType::f32) return text_of(column.as<float>()[at]);
    }
    return exact(column.value(place, component) * attribute.scale + attribute.offset);
}

std::vector<Attribute> attributes_of(const PointCloud& cloud, const std::vector<std::string>& names)
{
    std::vector<Attribute> attributes;
    for (const std::string& name : names)
        for (const Attribute& attribute : cloud.info().schema)
            if (attribute.name == name) attributes.push_back(attribute);
    return attributes;
}

Outcome write_csv(PointCloud& cloud, const ProfileOptions& options, const std::filesystem::path& file)
{
    const std::vector<Attribute> attributes = attributes_of(cloud, options.attributes);
    OutputFile output(file);
    std::string row = "station,offset,x,y,z";
    for (const Attribute& attribute : attributes)
        for (std::uint32_t c = 0; c < attribute.components; ++c)
            row +=
                "," + csv_field(attribute.components > 1 ? attribute.name + "." + std::to_string(c) : attribute.name);
    output.append(row + "\r\n");
    Outcome outcome =
        visit_profile(cloud, options, [&](const ProfilePoint& point, const PointView& view, std::size_t i) {
            row = exact(point.station) + "," + exact(point.offset);
            for (const double x : point.position) row += "," + exact(x);
            for (std::size_t k = 0; k < attributes.size(); ++k)
                for (std::uint32_t c = 0; c < attributes[k].components; ++c)
                    row += "," + value_text(attributes[k], view.column(k), view.index(i), c);
            output.append(row + "\r\n");
        });
    run_last_step(outcome, [&] { output.finish(); });
    return outcome;
}

Outcome write_dxf(PointCloud& cloud, const ProfileOptions& options, const std::filesystem::path& file,
                  const ProfileFileOptions& file_options)
{
    constexpr const char *points = "pcm_profile", *lines = "pcm_profile_line";
    DxfFile dxf(file, {{points, 7}, {lines, 1}});
    double lowest = std::numeric_limits<double>::infinity();
    Outcome outcome = visit_profile(cloud, options, [&](const ProfilePoint& point, const PointView&, std::size_t) {
        const double height = point.position[2] * file_options.exaggeration;
        lowest = std::min(lowest, height);
        dxf.point(points, file_options.in_place ? point.position : Vec3d{point.station, height, 0});
    });
    if (file_options.in_place)
        dxf.polyline(lines, options.line, false);
    else if (std::isfinite(lowest))
        dxf.line(lines, {0, lowest, 0}, {ProfileLine(options.line).length(), lowest, 0});
    run_last_step(outcome, [&] { dxf.finish(); });
    return outcome;
}

}  // namespace

Outcome write_profile(PointCloud& cloud, const ProfileOptions& options, const std::filesystem::path& file,
                      const ProfileFileOptions& file_options)
{
    const std::string extension = lower_extension(file);
    if (extension != ".csv" && extension != ".dxf")
        throw Error(ErrorCode::invalid_argument, file, "the extension says no format of profiles", "use .csv or .dxf");
    if (!(file_options.exaggeration > 0 && std::isfinite(file_options.exaggeration)))
        throw Error(ErrorCode::invalid_argument, file, "the exaggeration of heights is not above 0");
    check_output(file, file_options.overwrite);
    return extension == ".csv" ? write_csv(cloud, options, file) : write_dxf(cloud, options, file, file_options);
}

}  // namespace pcm
