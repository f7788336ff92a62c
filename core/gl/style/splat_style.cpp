#include "pcm/gl/style/splat_style.h"

#include <algorithm>
#include <string_view>

namespace pcm {
namespace {

bool has(const Schema& schema, std::string_view name, std::uint32_t components)
{
    const auto i = schema.find(name);
    return i && schema[*i].components >= components;
}

void add(std::string* notice, const std::string& reason, const std::string& instead)
{
    if (!notice) return;
    if (!notice->empty()) *notice += "; ";
    *notice += reason + ": " + instead;
}

// What the colours of a style are made from.
std::string source_of(const CloudStyle& style)
{
    if (style.colour == ColourMode::attribute) return "attribute '" + style.attribute + "'";
    return traits_of(style.colour).absent;
}

std::string absent_text(const CloudStyle& style, const Schema& schema)
{
    if (style.colour != ColourMode::attribute) return "the cloud has no " + source_of(style);
    std::string names;
    for (const std::string& name : component_names(schema)) names += (names.empty() ? "" : ", ") + name;
    return (style.attribute.empty() ? "no attribute is named" : "the cloud has no " + source_of(style)) +
           (names.empty() ? "" : " (attributes: " + names + ")");
}

std::string blank_text(const CloudStyle& style)
{
    if (style.colour == ColourMode::height_intensity) return "the intensity shows no shape";
    return "all sampled points have the same " + source_of(style);
}

}  // namespace

bool operator==(const CloudStyle& a, const CloudStyle& b)
{
    return a.splats == b.splats && a.colour == b.colour && a.point_size_px == b.point_size_px &&
           a.radius_scale == b.radius_scale && a.uniform_colour == b.uniform_colour && a.attribute == b.attribute &&
           a.ramp == b.ramp && a.range == b.range && a.brightness == b.brightness && a.gamma == b.gamma &&
           std::equal(a.where.begin(), a.where.end(), b.where.begin(), b.where.end(),
                      [](const Condition& x, const Condition& y) { return x.text == y.text; });
}

ColourRamp ramp_of(const CloudStyle& style)
{
    if (style.ramp != ColourRamp::automatic) return style.ramp;
    return style.colour == ColourMode::intensity ? ColourRamp::grey : ColourRamp::viridis;
}

std::optional<AttributePlace> colour_place(const CloudStyle& style, const Schema& schema)
{
    const ColourSource source = traits_of(style.colour).source;
    if (source == ColourSource::none) return std::nullopt;
    if (source == ColourSource::attribute) return place_of(schema, style.attribute);
    if (!has(schema, attribute_of(source), components_of(source))) return std::nullopt;
    return AttributePlace{*schema.find(attribute_of(source)), 0};
}

CloudStyle usable_style(const CloudStyle& asked, const Schema& schema, std::string* notice,
                        const std::function<bool(const CloudStyle&)>& is_blank)
{
    if (notice) notice->clear();
    CloudStyle style = asked;
    // Every point has a size, which stands for its radius.
    style.splats = drawable_mode(asked.splats, true, has(schema, attribute_name::normal, 3), true);
    if (style.splats != asked.splats)
        add(notice, "the cloud has no normals", std::string(name_of(style.splats)) + " splats are drawn");
    std::string reasons;
    for (;;) {
        const ColourTraits& traits = traits_of(style.colour);
        const bool is_absent = traits.source != ColourSource::none && !colour_place(style, schema);
        if (traits.source == ColourSource::none || (!is_absent && !(is_blank && is_blank(style)))) {
            if (!reasons.empty()) add(notice, reasons, std::string(name_of(style.colour)) + " is shown");
            return style;
        }
        // Classes that nobody has asked for are not missed.
        if (style.colour == asked.colour || style.colour != ColourMode::classification)
            reasons += (reasons.empty() ? "" : ", ") + (is_absent ? absent_text(style, schema) : blank_text(style));
        style.colour = traits.when_absent;
        if (has_range(asked.colour)) style.range.reset();  // of another quantity
    }
}

}  // namespace pcm
