// pcmlab render: draws trees to PNG without a window. `pcmlab` starts it; exit codes are those of `pcmlab`.
#include "pcm/cli/render/arguments.h"
#include "pcm/cli/render/draw_legend.h"
#include "pcm/cli/render/radii.h"
#include "pcm/cli/standstill.h"
#include "pcm/io/crs/height_unit.h"
#include "pcm/offscreen/offscreen.h"
#include "pcm/offscreen/scene.h"
#include "pcm/system/error.h"
#include "pcm/system/peak_memory.h"
#include "pcm/system/seconds.h"
#include "pcm/threads/thread_count.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <memory>
#include <set>

namespace pcm::cli {
namespace {

using Clock = std::chrono::steady_clock;

struct Drawn {
    FrameReport report;
    double ms = 0;
    unsigned frames = 0;
    std::uint64_t uploaded_bytes = 0;
    std::uint64_t points_added = 0;  // by all frames
    std::uint64_t pixels = 0;        // of the picture that differ from the background
};

class Job {
public:
    Job(const RenderArguments& arguments, const Offscreen& screen, OffscreenScene& scene)
        : screen_(screen),
          scene_(scene),
          style_(style_of(arguments)),
          options_(options_of(arguments)),
          background_(background_of(arguments)),
          progress_(console_progress(arguments.common))
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
        run_last_step(outcome, [&] { write_png(file, image, background_.transparent); });
    }

private:
    const Offscreen& screen_;
    OffscreenScene& scene_;
    CloudStyle style_;
    RenderOptions options_;
    Background background_;
    ProgressFunction progress_;
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
    Outcome outcome;  // its warnings
    double seconds = 0, longest_ms = 0;
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

Json to_json(const Summary& summary, const RenderArguments& arguments, const Offscreen& screen)
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
                            {"uploaded_bytes", drawn.uploaded_bytes}});
    }
    Json json;
    json["trees"] = arguments.trees;
    json["width"] = screen.width();
    json["height"] = screen.height();
    json["drawn_with"] = screen.renderer();
    json["notes"] = summary.notices;
    json["seconds"] = summary.seconds;
    json["peak_rss_bytes"] = peak_memory_bytes();
    json["pictures"] = pictures;
    json["warnings"] = summary.outcome.warnings;
    return json;
}

// Of how many frames the pictures are means; less than was asked for is said.
std::string mean_text(const Summary& summary, unsigned asked)
{
    if (asked <= 1) return {};
    std::string frames = std::to_string(summary.least_averaged);
    if (summary.most_averaged > summary.least_averaged) frames += " to " + std::to_string(summary.most_averaged);
    const std::string text = summary.most_averaged > 1 ? ", mean of " + frames + " frames" : ", one frame";
    return text + (summary.least_averaged < std::min(asked, most_smooth_frames) ? " (many points)" : "");
}

void print(const Summary& summary, const RenderArguments& arguments, const Offscreen& screen)
{
    const std::vector<std::filesystem::path>& files = summary.files;
    for (const std::string& notice : summary.notices) std::printf("note: %s\n", notice.c_str());
    const bool clips = !arguments.clips.empty() || !arguments.clips_outside.empty();
    const char* const whole =
        summary.empty == files.size() && summary.most_points == 0
            ? (summary.most_hidden > 0 && !arguments.where.empty() ? "no point in view satisfies the conditions"
               : clips                                             ? "no point of the clipped cloud is in view"
                                                                   : "no point is in view")
        : summary.empty == files.size() ? "but no pixel differs from the background"
        : !summary.full                 ? "as many points as requested"
        : !arguments.where.empty()      ? "every point in view that satisfies the conditions"
        : clips                         ? "every point in view that is not clipped"
                                        : "every point in view";
    if (summary.most_hidden > 0 && !arguments.where.empty())
        std::printf("note: %s%s points do not satisfy the conditions\n", files.size() > 1 ? "at most " : "",
                    grouped(summary.most_hidden).c_str());
    if (files.size() > 1 && summary.empty > 0)
        std::printf("note: in %zu of the pictures no pixel differs from the background\n", summary.empty);
    const std::string mean = mean_text(summary, arguments.options.smooth_frames);
    if (files.size() == 1)
        std::printf("%s: %s points, %s%s, in %s\n", files.front().c_str(), grouped(summary.most_points).c_str(), whole,
                    mean.c_str(), time_text(summary.seconds).c_str());
    else
        std::printf("%zu pictures, %s to %s: at most %s points, %s%s, and %s each\n", files.size(),
                    files.front().c_str(), files.back().c_str(), grouped(summary.most_points).c_str(), whole,
                    mean.c_str(), time_text(summary.longest_ms / 1000).c_str());
    std::printf("drawn with %s, peak memory %s\n", screen.renderer().c_str(), bytes_text(peak_memory_bytes()).c_str());
}

// Of the trees; one where several mean the same.
std::vector<Legend> legends_of(const RenderArguments& arguments, const FrameReport& report, const OffscreenScene& scene)
{
    std::vector<Legend> legends;
    for (std::size_t t = 0; t < report.clouds.size() && arguments.legend; ++t) {
        auto legend = legend_of(report.clouds[t], height_unit(scene.clouds()[t]->info().metadata));
        if (!legend) continue;
        const bool is_new = std::none_of(legends.begin(), legends.end(),
                                         [&](const Legend& other) { return other.lines() == legend->lines(); });
        if (is_new) legends.push_back(std::move(*legend));
    }
    return legends;
}

int render(const RenderArguments& arguments)
{
    const auto start = Clock::now();
    const ops::PictureSize size = size_of(arguments);
    background_of(arguments);
    const CloudStyle style = style_of(arguments);
    std::vector<Clip> clips = clips_of(arguments);
    if (arguments.path.empty())
        files_of(arguments, 1);  // before a tree is opened: wrong arguments are reported at once
    L1Options l1;
    l1.capacity_bytes = arguments.l1;
    l1.block_bytes =
        static_cast<std::uint32_t>(std::clamp<std::uint64_t>(arguments.l1, std::uint64_t(1) << 20, l1.block_bytes));
    L2Options l2;
    l2.capacity_bytes = arguments.l2;
    l2.threads = thread_count(arguments.threads);
    const Offscreen screen(size.width, size.height);
    OffscreenScene scene({arguments.trees.begin(), arguments.trees.end()}, l1, l2);
    check_attributes(style, scene.clouds());
    scene.clip(std::move(clips));
    const std::vector<CameraFrame> cameras = cameras_of(arguments, scene.clouds(), scene.box(), size);
    Summary summary;
    if (auto note = other_meaning(style, scene.clouds())) summary.notices.insert(*note);
    summary.files = files_of(arguments, cameras.size());
    const std::filesystem::path folder = summary.files.front().parent_path();
    if (!arguments.path.empty() && !folder.empty()) std::filesystem::create_directories(folder);

    Job job(arguments, screen, scene);
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        Drawn drawn = job.draw(cameras[i], i, cameras.size());
        job.write(summary.files[i], legends_of(arguments, drawn.report, scene), drawn, summary.outcome);
        summary.add(drawn);
    }
    end_progress(arguments.common);
    summary.seconds = seconds_since(start);
    if (arguments.common.json)
        print_json(to_json(summary, arguments, screen));
    else
        print(summary, arguments, screen);
    return finished(summary.outcome);
}

Run add_render(Options& options)
{
    auto arguments = std::make_shared<RenderArguments>();
    add_to(options, *arguments);
    return [arguments] { return render(*arguments); };
}

}  // namespace
}  // namespace pcm::cli

int main(int argc, char** argv)
{
    using namespace pcm::cli;
    // pcmlab gives the command's name; under any other this program renders.
    if (argc > 0 && std::string(argv[0]) == "radii")
        return run_program({"pcmlab radii", "Radii of a tree's points by compute shaders", add_gpu_radii}, argc, argv);
    return run_program(
        {"pcmlab render", "Render trees to PNG, from a camera or along a camera path, without a window", add_render},
        argc, argv);
}
