#include "plugin/overlay/overlay.h"

#include "pcm/remote/transfers.h"
#include "plugin/scene/text.h"

#include <QStringList>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pcm::host {

namespace {

// Two digits: one decimal below ten, none from there on.
std::string in_unit(std::uint64_t points, double unit)
{
    const double value = static_cast<double>(points) / unit;
    char text[32];
    std::snprintf(text, sizeof text, "%.*f", value < 9.95 ? 1 : 0, value);
    return text;
}

std::string megabytes(std::uint64_t bytes) { return grouped((bytes + (1u << 19)) >> 20); }

std::string cache_text(const CacheUse& cache)
{
    const std::uint64_t asked = cache.hits + cache.misses;
    return cache.name + ": " + megabytes(cache.used_bytes) + " of " + megabytes(cache.capacity_bytes) + " MB, " +
           (asked ? grouped(100 * cache.hits / asked) : "0") + " % hits";
}

std::string progress_text(const FrameReport& report, const std::vector<OverlayCloud>& clouds)
{
    std::uint64_t all = 0;
    for (const OverlayCloud& cloud : clouds) all += cloud.points;
    std::uint64_t hidden = 0;
    for (const CloudReport& cloud : report.clouds) hidden += cloud.points_hidden;
    const std::string less = hidden > 0 ? "; " + grouped(hidden) + " hidden by the conditions" : "";
    const bool clipped = std::any_of(clouds.begin(), clouds.end(), [](const OverlayCloud& c) { return c.clipped; });
    const std::string mean = report.smoothing ? ", smoothing: " + std::to_string(report.frames_averaged) + " of " +
                                                    std::to_string(report.smooth_frames) + "…"
                                              : "";
    if (report.full_resolution && clipped) return "all points in view shown" + mean + less;
    if (report.full_resolution)
        return (report.points_drawn + hidden < all ? "all points in view shown" : "all points shown") + mean + less;
    return amount_text(std::min(report.points_drawn, all), all) + (report.refining ? ", loading…" : "") + less;
}

// A number of points with two digits, or exactly.
std::string points_text(double points, bool exact)
{
    if (exact) return grouped(static_cast<std::uint64_t>(points));
    if (points >= 999'500) return "about " + in_unit(static_cast<std::uint64_t>(points), 1e6) + " M";
    const double step = points >= 100 ? std::pow(10, std::floor(std::log10(points)) - 1) : 1;
    return "about " + grouped(static_cast<std::uint64_t>(std::round(points / step) * step));
}

std::string clip_text(const std::vector<OverlayCloud>& clouds)
{
    bool clipped = false, known = true, exact = true;
    double hidden = 0;
    for (const OverlayCloud& cloud : clouds) {
        if (!cloud.clipped) continue;
        clipped = true;
        known = known && cloud.hidden_by_clip;
        if (!known) continue;
        hidden += cloud.hidden_by_clip->expected;
        exact = exact && cloud.hidden_by_clip->exact;
    }
    if (!clipped) return {};
    return known ? "clip box on: " + points_text(hidden, exact) + " points hidden" : "clip box on";
}

std::string selection_text(const std::vector<OverlayCloud>& clouds)
{
    std::uint64_t selected = 0;
    for (const OverlayCloud& cloud : clouds) selected += cloud.selected;
    return selected == 0 ? std::string() : grouped(selected) + (selected == 1 ? " point selected" : " points selected");
}

std::string quality_text(const FrameReport& report, double target_px)
{
    std::string text = brief(report.measured_ms > 0 ? report.measured_ms : report.frame_ms) + " ms per frame";
    if (report.screen_error_px > 0)
        text += "; screen error " + brief(report.screen_error_px) + " px (target " + brief(target_px) + ")";
    if (report.samples > 1) text += "; " + std::to_string(report.samples) + " samples per pixel";
    if (report.frames_averaged > 1) text += "; mean of " + std::to_string(report.frames_averaged) + " frames";
    return text;
}

void add(QStringList& lines, const std::string& line)
{
    const QString text = QString::fromStdString(line).toHtmlEscaped();
    if (!text.isEmpty() && !lines.contains(text)) lines << text;
}

}  // namespace

std::string amount_text(std::uint64_t drawn, std::uint64_t all)
{
    if (all < 1'000'000) return grouped(drawn) + " of " + grouped(all) + " points";
    const bool billions = all >= 1'000'000'000;
    const double unit = billions ? 1e9 : 1e6;
    return in_unit(drawn, unit) + " of " + in_unit(all, unit) + (billions ? " billion" : " M") + " points";
}

QString overlay_text(const FrameReport& report, const std::vector<OverlayCloud>& clouds, const OverlayDetails* details)
{
    if (clouds.empty()) return {};
    QStringList lines;
    add(lines, progress_text(report, clouds));
    add(lines, clip_text(clouds));
    add(lines, selection_text(clouds));
    add(lines, report.error.empty() && report.refining ? network_trouble() : report.error);
    for (const CloudReport& cloud : report.clouds) add(lines, cloud.error);
    for (const CloudReport& cloud : report.clouds) add(lines, cloud.notice);
    if (!details) return lines.join("<br>");
    add(lines, quality_text(report, details->target_spacing_px));
    for (std::size_t i = 0; clouds.size() > 1 && i < std::min(clouds.size(), report.clouds.size()); ++i)
        add(lines, clouds[i].layer.toStdString() + ": " + amount_text(report.clouds[i].points_drawn, clouds[i].points));
    for (const CacheUse& cache : details->caches) add(lines, cache_text(cache));
    return lines.join("<br>");
}

}  // namespace pcm::host
