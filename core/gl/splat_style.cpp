#include "pcm/gl/splat_style.h"

#include <string_view>

namespace pcm {
namespace {

bool has(const Schema& schema, std::string_view name, std::uint32_t components)
{
    const auto i = schema.find(name);
    return i && schema[*i].components >= components;
}

void tell(std::string* notice, const std::string& missing, const std::string& instead)
{
    if (!notice) return;
    if (!notice->empty()) *notice += "; ";
    *notice += "the cloud has no " + missing + ": " + instead;
}

}  // namespace

const char* name_of(SplatMode mode)
{
    switch (mode) {
        case SplatMode::constant:
            return "constant";
        case SplatMode::dynamic:
            return "dynamic";
        case SplatMode::affine:
            return "affine";
        case SplatMode::perspective:
            return "perspective";
    }
    return "";
}

const char* name_of(ColourMode mode)
{
    switch (mode) {
        case ColourMode::rgb:
            return "rgb";
        case ColourMode::intensity:
            return "intensity";
        case ColourMode::height:
            return "height";
        case ColourMode::classification:
            return "classification";
        case ColourMode::level:
            return "level";
        case ColourMode::error:
            return "error";
        case ColourMode::uniform:
            return "uniform";
    }
    return "";
}

CloudStyle usable_style(const CloudStyle& asked, const Schema& schema, std::string* notice)
{
    if (notice) notice->clear();
    CloudStyle style = asked;
    if (style.splats != SplatMode::constant && !has(schema, attribute_name::radius, 1)) {
        style.splats = SplatMode::constant;
        tell(notice, "radii", "constant splats are drawn");
    } else if ((style.splats == SplatMode::affine || style.splats == SplatMode::perspective) &&
               !has(schema, attribute_name::normal, 3)) {
        style.splats = SplatMode::dynamic;
        tell(notice, "normals", "dynamic splats are drawn");
    }
    const auto fall_back = [&](std::string_view name, std::uint32_t components, const char* missing,
                               ColourMode instead) {
        if (has(schema, name, components)) return;
        style.colour = instead;
        tell(notice, missing, std::string(name_of(instead)) + " is shown");
    };
    if (style.colour == ColourMode::rgb) fall_back(attribute_name::rgb, 3, "colours", ColourMode::intensity);
    if (style.colour == ColourMode::intensity) fall_back(attribute_name::intensity, 1, "intensity", ColourMode::height);
    if (style.colour == ColourMode::classification)
        fall_back(attribute_name::classification, 1, "classes", ColourMode::height);
    return style;
}

}  // namespace pcm
