#include "plugin/tools/measure/profile_data.h"

#include "pcm/system/text.h"
#include "pcm/view/point_colours.h"

#include <algorithm>
#include <cmath>

namespace pcm::host {

namespace {

constexpr QRgb grey = qRgb(90, 90, 90);

const Attribute* find(const Schema& schema, std::string_view name, std::uint32_t components)
{
    for (const Attribute& attribute : schema)
        if (attribute.name == name && attribute.components >= components) return &attribute;
    return nullptr;
}

// The largest value of the range that the values fill: 0 to 1, 0 to 255 or 0 to 65535.
double white_of(const std::vector<std::vector<double>>& columns)
{
    double largest = 0;
    bool whole = true;
    for (std::size_t k = 0; k < 3; ++k)
        for (const double value : columns[k]) {
            largest = std::max(largest, value);
            whole = whole && value == std::floor(value);
        }
    return largest > 255 ? 65535 : largest > 1 || whole ? 255 : 1;
}

void give_colours(ProfileData& data, const ProfileSample& sample, bool rgb)
{
    if (sample.attributes.empty()) return;
    const double white = rgb ? white_of(sample.attributes) : 1;
    const auto part = [&](std::size_t k, std::size_t i) {
        return static_cast<int>(std::lround(std::clamp(sample.attributes[k][i] / white, 0.0, 1.0) * 255));
    };
    for (std::size_t i = 0; i < data.points.size(); ++i) {
        if (rgb) {
            data.points[i].colour = qRgb(part(0, i), part(1, i), part(2, i));
        } else {
            const auto colour = class_colour(sample.attributes[0][i]);
            data.points[i].colour = qRgb(colour[0], colour[1], colour[2]);
        }
    }
}

QString words_of(const ProfileData& data, const ProfileSample& sample)
{
    QString words = QString::fromStdString(grouped(data.points.size())) + " points";
    if (sample.level)
        words += QString(
                     " of level %1, of more than a plot holds: every point of the cloud is nearer than %2 to one "
                     "of them. Exported files have all points.")
                     .arg(*sample.level)
                     .arg(QString::fromStdString(brief(sample.outcome.error)));
    if (!data.options.where.empty() || !data.options.clips.empty())
        words += sample.level ? " Hidden points are left out." : ", without those that the view hides";
    return words;
}

}  // namespace

void read_profile(ProfileData& data, std::size_t most, const ProgressFunction& progress)
{
    ProfileOptions options = data.options;
    options.progress = progress;
    const Schema& schema = data.cloud->info().schema;
    const bool rgb = find(schema, "rgb", 3) != nullptr;
    if (rgb)
        options.attributes = {"rgb"};
    else if (find(schema, "classification", 1))
        options.attributes = {"classification"};
    const ProfileSample sample = sample_profile(*data.cloud, options, most);
    data.points.clear();
    data.points.reserve(sample.points.size());
    for (const ProfilePoint& point : sample.points) data.points.push_back({point.station, point.position[2], grey});
    give_colours(data, sample, rgb);
    data.words = words_of(data, sample);
}

}  // namespace pcm::host
