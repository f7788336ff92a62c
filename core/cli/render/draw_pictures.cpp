#include "pcm/cli/render/draw_pictures.h"

#include "pcm/cli/render/draw_legend.h"
#include "pcm/cli/render/request.h"
#include "pcm/cli/standstill.h"
#include "pcm/io/crs/height_unit.h"
#include "pcm/offscreen/offscreen.h"
#include "pcm/offscreen/scene.h"
#include "pcm/system/error.h"
#include "pcm/system/peak_memory.h"
#include "pcm/system/seconds.h"
#include "pcm/system/text.h"
#include "pcm/threads/thread_count.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <set>

namespace pcm::cli {
namespace {

using Clock = std::chrono::steady_clock;
using ops::Json;
using ops::RenderRequest;
using ops::Result;

struct Drawn {
    FrameReport report;
    double ms = 0;
    unsigned frames = 0;
    std::uint64_t uploaded_bytes = 0;
    std::uint64_t points_added = 0;  // sum over all frames
    std::uint64_t pixels = 0;        // number of pixels that differ from the background
};

class Job {
public:
    Job(const RenderRequest& request, const ProgressFunction& progress, const Offscreen& screen, OffscreenScene& scene)
        : screen_(screen),
          scene_(scene),
          style_(style_of(request)),
          options_(options_of(request)),
          background_(background_of(request)),
          progress_(progress)
    {
        screen_.clear(background_.colour);
        empty_ = screen_.read();
    }

    // `number` of `count`: for the progress.
    Drawn draw(const CameraFrame& camera, std::size_t number, std::size_t count)
    {
        const auto start = Clock::now();
        const Camera view = scene_.view_of(camera, screen_.width(), screen_.height());
        const std::uint64_t uploaded = scene_.l1_statistics().uploaded_bytes;
        scene_.forget();
        Drawn drawn;
        Standstill standstill;
        for (;;) {
            screen_.clear(background_.colour);
            drawn.report = scene_.draw(view, style_, options_);
            ++drawn.frames;
            if (!drawn.report.error.empty())
                throw Error(ErrorCode::io, {}, "the picture cannot be drawn: " + drawn.report.error);
            for (const CloudReport& cloud : drawn.report.clouds)
                if (!cloud.error.empty()) throw Error(ErrorCode::io, {}, "the picture cannot be drawn: " + cloud.error);
            if (!drawn.report.refining) break;
            const FrameReport& report = drawn.report;
            const std::string stage = report.smoothing ? "Smoothing, frame " + std::to_string(report.frames_averaged) +
                                                             " of " + std::to_string(report.smooth_frames)
                                                       : "Drawing, " + grouped(report.points_drawn) + " points";
            if (!progress_({stage, static_cast<double>(number) / static_cast<double>(count)}))
                throw Error(ErrorCode::cancelled, {}, "drawing was cancelled");
            const L1Statistics l1 = scene_.l1_statistics();
            drawn.points_added += drawn.report.points_added;
            standstill.look({drawn.report.points_drawn, l1.uploaded_bytes, scene_.loaded_bytes(), drawn.points_added,
                             drawn.report.nodes_missing, l1.refused, drawn.frames},
                            seconds_since(start));
            if (!drawn.report.repaint) scene_.wait();
        }
        drawn.ms = 1000 * seconds_since(start);
        drawn.uploaded_bytes = scene_.l1_statistics().uploaded_bytes - uploaded;
        return drawn;
    }

    // Writes the picture that was drawn last, and counts its pixels.
    void write(const std::filesystem::path& file, const std::vector<Legend>& legends, Drawn& drawn,
               Outcome& outcome) const
    {
        Image image = screen_.read();
        drawn.pixels = 0;
        for (std::size_t at = 0; at < image.rgba.size(); at += 4)
            drawn.pixels += std::memcmp(&image.rgba[at], &empty_.rgba[at], 4) != 0;
        if (background_.transparent) unpremultiply(image);
        if (!legends.empty()) draw_legends(image, legends);
        run_last_step(outcome, [&] { write_picture(file, image, background_); });
    }

private:
    const Offscreen& screen_;
    OffscreenScene& scene_;
    CloudStyle style_;
    RenderOptions options_;
    Background background_;
    const ProgressFunction& progress_;
    Image empty_;  // the background
};

// Every point in view is in the picture. Nothing is claimed of points that cannot be seen.
bool is_full(const Drawn& drawn)
{
    return drawn.report.full_resolution && (drawn.pixels > 0 || drawn.report.points_drawn == 0);
}

// All pictures together.
struct Summary {
    std::vector<std::filesystem::path> files;
    std::vector<Drawn> drawn;  // for each file
    std::set<std::string> notices;
    Outcome outcome;  // points_out: drawn in all pictures
    double longest_ms = 0, coarsest_px = 0;
    std::uint64_t most_points = 0, most_hidden = 0;
    unsigned least_averaged = ~0u, most_averaged = 1;  // frames of a picture
    std::size_t empty = 0;                             // pictures in which no pixel differs from the background
    bool full = true;

    void add(const Drawn& picture)
    {
        drawn.push_back(picture);
        std::uint64_t hidden = 0;
        for (const CloudReport& cloud : picture.report.clouds) {
            if (!cloud.notice.empty()) notices.insert(cloud.notice);
            hidden += cloud.points_hidden;
        }
        most_hidden = std::max(most_hidden, hidden);
        longest_ms = std::max(longest_ms, picture.ms);
        coarsest_px = std::max(coarsest_px, picture.report.screen_error_px);
        outcome.points_out += picture.report.points_drawn;
        most_points = std::max(most_points, picture.report.points_drawn);
        least_averaged = std::min(least_averaged, picture.report.frames_averaged);
        most_averaged = std::max(most_averaged, picture.report.frames_averaged);
        full = full && is_full(picture);
        empty += picture.pixels == 0;
    }
};

// What the colours show, of each cloud.
Json clouds_of(const FrameReport& report)
{
    Json clouds = Json::array();
    for (const CloudReport& cloud : report.clouds) {
        Json json{{"points_drawn", cloud.points_drawn},
                  {"points_hidden", cloud.points_hidden},
                  {"vertex_bytes", cloud.vertex_bytes},
                  {"colour", name_of(cloud.style.colour)}};
        if (cloud.style.colour == ColourMode::attribute) json["attribute"] = cloud.style.attribute;
        if (cloud.range) {
            json["ramp"] = traits_of(ramp_of(cloud.style)).name;
            json["range"] = {cloud.range->low, cloud.range->high};
            json["exponent"] = cloud.range->exponent;
        }
        for (std::size_t c = 0; c < 256; ++c)
            if (cloud.classes[c]) json["classes"].push_back(c);
        clouds.push_back(std::move(json));
    }
    return clouds;
}

Json pictures_of(const Summary& summary)
{
    Json pictures = Json::array();
    for (std::size_t i = 0; i < summary.files.size(); ++i) {
        const Drawn& drawn = summary.drawn[i];
        pictures.push_back({{"file", summary.files[i].string()},
                            {"points_drawn", drawn.report.points_drawn},
                            {"clouds", clouds_of(drawn.report)},
                            {"screen_error_px", drawn.report.screen_error_px},
                            {"full_resolution", is_full(drawn)},
                            {"pixels", drawn.pixels},
                            {"ms", drawn.ms},
                            {"frames", drawn.frames},
                            {"frames_averaged", drawn.report.frames_averaged},
                            {"uploaded_bytes", drawn.uploaded_bytes},
                            {"nodes_drawn", drawn.report.nodes_drawn},
                            {"programs", drawn.report.programs}});
    }
    return pictures;
}

// The number of frames whose means the pictures are, and whether it is less than was requested.
std::string mean_text(const Summary& summary, unsigned asked)
{
    if (asked <= 1) return {};
    std::string frames = std::to_string(summary.least_averaged);
    if (summary.most_averaged > summary.least_averaged) frames += " to " + std::to_string(summary.most_averaged);
    const std::string text = summary.most_averaged > 1 ? ", mean of " + frames + " frames" : ", one frame";
    return text + (summary.least_averaged < std::min(asked, most_smooth_frames) ? " (many points)" : "");
}

// What is in the pictures: all points in view, or which of them.
const char* contents_of(const Summary& summary, const Selection& limits)
{
    const bool conditions = !limits.where.empty(), clips = !limits.clips.empty();
    if (summary.empty == summary.files.size() && summary.most_points == 0)
        return summary.most_hidden > 0 && conditions ? "no point in view satisfies the conditions"
               : clips                               ? "no point of the clipped cloud is in view"
                                                     : "no point is in view";
    if (summary.empty == summary.files.size()) return "but no pixel differs from the background";
    if (!summary.full) return "as many points as requested";
    return conditions ? "every point in view that satisfies the conditions"
           : clips    ? "every point in view that is not clipped"
                      : "every point in view";
}

void describe(Result& result, const Summary& summary, const RenderRequest& request, const Offscreen& screen)
{
    const std::vector<std::filesystem::path>& files = summary.files;
    result.notes.assign(summary.notices.begin(), summary.notices.end());
    if (summary.most_hidden > 0 && !request.limits.where.empty())
        result.notes.push_back((files.size() > 1 ? "at most " : "") + grouped(summary.most_hidden) +
                               " points do not satisfy the conditions");
    if (files.size() > 1 && summary.empty > 0)
        result.notes.push_back("in " + std::to_string(summary.empty) +
                               " of the pictures no pixel differs from the background");
    const std::string points = grouped(summary.most_points) + " points, " + contents_of(summary, request.limits) +
                               mean_text(summary, request.options.smooth_frames);
    if (files.size() == 1)
        result.line(files.front().string() + ": " + points + ", in " + time_text(summary.outcome.seconds));
    else
        result.line(std::to_string(files.size()) + " pictures, " + files.front().string() + " to " +
                    files.back().string() + ": at most " + points + ", and " + time_text(summary.longest_ms / 1000) +
                    " each");
    result.line("drawn with " + screen.renderer());
}

Result result_of(const Summary& summary, const RenderRequest& request, const Offscreen& screen)
{
    Result result;
    result.input = request.trees;
    result.output = request.output;
    result.makes = ops::Makes::file;
    result.outcome = summary.outcome;
    result.accuracy = ops::exact_answer();
    if (summary.coarsest_px > 0)
        result.accuracy = {ops::ErrorKind::bound, summary.coarsest_px, "pixels",
                           "distances to points that are not drawn"};
    result.values["trees"] = request.trees;
    result.values["width"] = screen.width();
    result.values["height"] = screen.height();
    result.values["drawn_with"] = screen.renderer();
    result.values["pictures"] = pictures_of(summary);
    describe(result, summary, request, screen);
    return result;
}

// What was read of each tree.
Json reads_of(const OffscreenScene& scene)
{
    Json all = Json::array();
    for (const auto& cloud : scene.clouds()) {
        const TreeReads reads = cloud->tree()->reads();
        const Schema& schema = cloud->info().schema;
        all.push_back({{"attributes", schema.size()},
                       {"columns", names_of(reads.columns, schema)},
                       {"nodes", cloud->tree()->nodes().size()},
                       {"chunks", reads.chunks},
                       {"points", reads.points},
                       {"bytes", reads.bytes},
                       {"bytes_of_tree", cloud->info().bytes}});
    }
    return all;
}

// One for each tree; one where several mean the same.
std::vector<Legend> legends_of(const FrameReport& report, const OffscreenScene& scene)
{
    std::vector<Legend> legends;
    for (std::size_t t = 0; t < report.clouds.size(); ++t) {
        auto legend = legend_of(report.clouds[t], height_unit(scene.clouds()[t]->info().metadata));
        if (!legend) continue;
        const bool is_new = std::none_of(legends.begin(), legends.end(),
                                         [&](const Legend& other) { return other.lines() == legend->lines(); });
        if (is_new) legends.push_back(std::move(*legend));
    }
    return legends;
}

OffscreenScene open_scene(const RenderRequest& request)
{
    L1Options l1;
    l1.capacity_bytes = request.l1;
    l1.block_bytes =
        static_cast<std::uint32_t>(std::clamp<std::uint64_t>(request.l1, std::uint64_t(1) << 20, l1.block_bytes));
    L2Options l2;
    l2.capacity_bytes = request.l2;
    l2.threads = thread_count(request.threads);
    return OffscreenScene({request.trees.begin(), request.trees.end()}, l1, l2);
}

}  // namespace

Result draw_pictures(const RenderRequest& request, const ProgressFunction& progress)
{
    const auto start = Clock::now();
    // Before a tree is opened, so that wrong arguments are reported at once.
    const ops::PictureSize size = ops::parse_size(request.size);
    background_of(request);
    const CloudStyle style = style_of(request);
    if (request.path.empty()) files_of(request, 1);
    const Offscreen screen(size.width, size.height);
    OffscreenScene scene = open_scene(request);
    check_attributes(style, scene.clouds());
    scene.clip(request.limits.clips);
    const std::vector<CameraFrame> cameras = cameras_of(request, scene.clouds(), scene.box(), size);
    Summary summary;
    if (auto note = other_meaning(style, scene.clouds())) summary.notices.insert(*note);
    summary.files = files_of(request, cameras.size());
    const std::filesystem::path folder = summary.files.front().parent_path();
    if (!request.path.empty() && !folder.empty()) std::filesystem::create_directories(folder);

    Job job(request, progress, screen, scene);
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        Drawn drawn = job.draw(cameras[i], i, cameras.size());
        const auto legends = request.legend ? legends_of(drawn.report, scene) : std::vector<Legend>();
        job.write(summary.files[i], legends, drawn, summary.outcome);
        summary.add(drawn);
    }
    for (const auto& cloud : scene.clouds()) summary.outcome.points_in += cloud->info().points;
    summary.outcome.seconds = seconds_since(start);
    Result result = result_of(summary, request, screen);
    result.values["reads"] = reads_of(scene);
    return result;
}

}  // namespace pcm::cli
