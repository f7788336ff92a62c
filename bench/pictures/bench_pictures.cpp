// Draws the frames of a camera path and writes them as PNG; run.py starts it, and compares.
//   bench_pictures reference TREE --path FILE --out FOLDER [options]    each frame complete, however long it takes
//   bench_pictures replay TREE --path FILE --out FOLDER [options]       each frame once, at the pace of a display, as a
//       viewer has it
//   bench_pictures views TREE --path FILE --out FOLDER [options]        the camera arrives, and stays:
//       frames with "rest" are drawn while the camera still moves, and again until nothing is to be added
//   bench_pictures --sweep NAME... views TREE ...                       its figures for several values of a tuned
//   number bench_pictures about                                                what it draws with
// Each prints a line of JSON with lists that have an entry for each frame (references: for each picture). Pictures are
// transparent where nothing is drawn.
#include "bench/caches/row.h"
#include "bench/sweep/sweep.h"

#include "pcm/offscreen/offscreen.h"
#include "pcm/offscreen/scene.h"
#include "pcm/system/error.h"

#include <GL/glew.h>
#include <CLI/CLI.hpp>

#include <cstdio>
#include <exception>
#include <limits>
#include <map>
#include <numeric>
#include <thread>

namespace {

using namespace pcm;
using namespace pcm::bench;

constexpr double megabyte = 1 << 20;

struct Arguments {
    std::string tree, path, size = "640x480";
    std::vector<std::string> sweeps;
    std::filesystem::path out;
    double l1_mb = 512, l2_mb = 512, frame_budget_ms = 0, pace_ms = 33, longest_s = 120;
    unsigned loaders = 2, passes = 1, every = 1;
    bool to_target = false;
    CloudStyle style;
    RenderOptions options;
    int width = 0, height = 0;
};

std::map<std::string, SplatMode> modes()
{
    std::map<std::string, SplatMode> modes;
    for (const SplatTraits& row : splat_modes()) modes[row.name] = row.mode;
    return modes;
}

const std::map<std::string, DetailOrder> orders{{"error", DetailOrder::error}, {"depth", DetailOrder::depth}};

class Player {
public:
    explicit Player(const Arguments& arguments)
        : a_(arguments),
          screen_(a_.width, a_.height),
          scene_({a_.tree}, l1_options(), l2_options()),
          path_(CameraPath::read(a_.path).placed(scene_.box()))
    {
        std::filesystem::create_directories(a_.out);
    }

    void draw_references(Row& row)
    {
        RenderOptions options = a_.options;
        options.converge = !a_.to_target;
        options.frame_budget_ms = a_.to_target ? std::numeric_limits<double>::infinity() : 250;
        options.upload_budget_ms = 50;
        options.prefetch_frames = 0;
        for (std::size_t i = 0; i < path_.frames.size(); ++i) {
            if (!kept(i)) continue;
            const auto start = Clock::now();
            scene_.forget();
            FrameReport report = frame(path_.frames[i], options);
            while (report.refining) {
                if (seconds_since(start) > a_.longest_s)
                    throw std::runtime_error("frame " + std::to_string(i + 1) + " is not complete after " +
                                             std::to_string(a_.longest_s) + " s");
                if (!report.repaint) scene_.wait();
                report = frame(path_.frames[i], options);
            }
            if (options.converge && !report.full_resolution)
                throw std::runtime_error("frame " + std::to_string(i + 1) + " ended without every point in view");
            write(numbered(i + 1) + ".png", screen_.read());
            row["points_drawn"].push_back(report.points_drawn);
            row["complete_ms"].push_back(1000 * seconds_since(start));
        }
    }

    // The pictures of the last pass; they are kept in memory until then, so that the disk is not in the way.
    void replay(Row& row)
    {
        RenderOptions options = a_.options;
        options.converge = false;
        options.frame_budget_ms = a_.frame_budget_ms > 0 ? a_.frame_budget_ms : std::numeric_limits<double>::infinity();
        warm_up(options);
        std::vector<Image> pictures;
        for (unsigned pass = 1; pass <= a_.passes; ++pass) {
            const bool last = pass == a_.passes;
            for (std::size_t i = 0; i < path_.frames.size(); ++i) {
                const auto start = Clock::now();
                const L1Statistics before = scene_.l1_statistics();
                const FrameReport report = frame(path_.frames[i], options);
                const double ms = 1000 * seconds_since(start);
                const L1Statistics after = scene_.l1_statistics();
                if (last) {
                    row["frame_ms"].push_back(ms);
                    row["draw_ms"].push_back(report.frame_ms);
                    row["measured_ms"].push_back(report.measured_ms);
                    row["points_drawn"].push_back(report.points_drawn);
                    row["screen_error_px"].push_back(report.screen_error_px);
                    row["uploaded_bytes"].push_back(after.uploaded_bytes - before.uploaded_bytes);
                    row["uploaded_chunks"].push_back(after.compulsory_misses + after.capacity_misses -
                                                     before.compulsory_misses - before.capacity_misses);
                    row["upload_ms"].push_back(1000 * (after.upload_seconds - before.upload_seconds));
                    row["nodes_missing"].push_back(report.nodes_missing);
                    if (kept(i)) pictures.push_back(screen_.read());
                }
                std::this_thread::sleep_until(start + std::chrono::duration_cast<Clock::duration>(
                                                          std::chrono::duration<double, std::milli>(a_.pace_ms)));
            }
        }
        row["l1_allocated_mb"] = static_cast<double>(scene_.l1_statistics().allocated_bytes) / megabyte;
        row["loaded_mb"] = static_cast<double>(scene_.loaded_bytes()) / megabyte;
        for (std::size_t i = 0, next = 0; i < path_.frames.size(); ++i)
            if (kept(i)) write(numbered(i + 1) + ".png", pictures[next++]);
    }

    // At each frame with `rest`, of the last pass: NNNN-moving.png, as the camera arrives, and NNNN-rest.png, when the
    // picture is complete; with the library's own budgets where none is given. Processor times are those of all
    // threads: of a frame while the camera moves (the mean of those since the last rest), and from the first frame at
    // rest to the last.
    void stay(Row& row)
    {
        RenderOptions options = a_.options;
        if (a_.frame_budget_ms > 0) options.frame_budget_ms = a_.frame_budget_ms;
        for (unsigned pass = 1; pass <= a_.passes; ++pass) {
            std::size_t rests = 0;
            std::vector<double> moving;
            for (std::size_t i = 0; i < path_.frames.size(); ++i) {
                double start = processor_seconds();
                FrameReport report = frame(path_.frames[i], options);
                moving.push_back(processor_seconds() - start);
                if (!path_.frames[i].rest) continue;
                ++rests;
                const bool last = pass == a_.passes;
                if (last) {
                    row["moving_cpu_seconds"].push_back(mean(moving));
                    row["moving_points"].push_back(report.points_drawn);
                    row["moving_error_px"].push_back(report.screen_error_px);
                    write(numbered(rests) + "-moving.png", screen_.read());
                }
                moving.clear();
                start = processor_seconds();
                const unsigned frames = complete(path_.frames[i], options, report);
                if (!last) continue;
                row["rest_cpu_seconds"].push_back(processor_seconds() - start);
                row["rest_points"].push_back(report.points_drawn);
                row["rest_frames"].push_back(frames);
                row["frames_averaged"].push_back(report.frames_averaged);
                write(numbered(rests) + "-rest.png", screen_.read());
            }
        }
    }

    std::string renderer() const { return screen_.renderer(); }

private:
    static double mean(const std::vector<double>& values)
    {
        return ratio(std::accumulate(values.begin(), values.end(), 0.0), static_cast<double>(values.size()));
    }

    // Draws the frame again until the picture is complete; how often. At least once.
    unsigned complete(const CameraFrame& camera, const RenderOptions& options, FrameReport& report)
    {
        const auto start = Clock::now();
        unsigned frames = 0;
        do {
            if (seconds_since(start) > a_.longest_s)
                throw std::runtime_error("a view is not complete after " + std::to_string(a_.longest_s) + " s");
            if (frames && !report.repaint) scene_.wait();
            report = frame(camera, options);
            ++frames;
        } while (report.refining);
        return frames;
    }

    bool kept(std::size_t frame) const { return frame % a_.every == a_.every - 1; }

    L1Options l1_options() const
    {
        L1Options l1;
        l1.capacity_bytes = static_cast<std::uint64_t>(a_.l1_mb * megabyte);
        return l1;
    }
    L2Options l2_options() const
    {
        L2Options l2;
        l2.capacity_bytes = static_cast<std::uint64_t>(a_.l2_mb * megabyte);
        l2.threads = a_.loaders;
        return l2;
    }

    FrameReport frame(const CameraFrame& camera, const RenderOptions& options)
    {
        screen_.clear({0, 0, 0, 0});
        FrameReport report = scene_.draw(scene_.view_of(camera, a_.width, a_.height), a_.style, options);
        glFinish();
        if (!report.error.empty()) throw std::runtime_error("a frame could not be drawn: " + report.error);
        if (!report.clouds.empty() && !report.clouds.front().notice.empty())
            throw std::runtime_error(report.clouds.front().notice);
        return report;
    }

    // Shaders are built by the first frames, which look at the path's first camera until something is there: a viewer
    // opens so, too.
    void warm_up(const RenderOptions& options)
    {
        const auto start = Clock::now();
        for (FrameReport report; report.points_drawn == 0 && seconds_since(start) < a_.longest_s;
             scene_.wait(std::chrono::milliseconds(10)))
            report = frame(path_.frames.front(), options);
        for (int i = 0; i < 8; ++i) frame(path_.frames.front(), options);
    }

    static std::string numbered(std::size_t number)
    {
        char text[32];
        std::snprintf(text, sizeof text, "%04zu", number);
        return text;
    }
    void write(const std::string& name, Image image) const
    {
        unpremultiply(image);
        write_png(a_.out / name, image);
    }

    const Arguments& a_;
    Offscreen screen_;
    OffscreenScene scene_;
    CameraPath path_;
};

void add_options(CLI::App& app, Arguments& a)
{
    app.add_option("tree", a.tree, "Tree folder")->required()->check(CLI::ExistingDirectory);
    app.add_option("--path", a.path, "Camera path, JSON")->required()->check(CLI::ExistingFile);
    app.add_option("--out", a.out, "Folder for the pictures")->required();
    app.add_option("--every", a.every, "The last of every N frames is kept as a picture")
        ->capture_default_str()
        ->check(CLI::Range(1, 1000000));
    app.add_option("--size", a.size, "Size of the pictures, pixels")->capture_default_str();
    app.add_option("--splats", a.style.splats, "What points are drawn as")->transform(CLI::CheckedTransformer(modes()));
    app.add_option("--radius-scale", a.style.radius_scale, "Factor on the radii of splats")->capture_default_str();
    app.add_option("--point-size", a.style.point_size_px, "Size of constant splats, pixels")->capture_default_str();
    app.add_option("--eye-dome", a.options.eye_dome, "Strength of eye-dome lighting; 0: none")->capture_default_str();
    app.add_option("--samples", a.options.samples, "A pixel")->capture_default_str()->check(CLI::Range(1, 8));
    app.add_option("--converge", a.options.smooth_frames, "A complete picture is the mean of this number of frames")
        ->capture_default_str()
        ->check(CLI::Range(1, 256));
    app.add_option("--target-px", a.options.target_spacing_px, "Maximum distance of points on screen")
        ->capture_default_str();
    app.add_option("--l1-mb", a.l1_mb, "Capacity of L1, MiB")->capture_default_str()->check(CLI::Range(1.0, 1e6));
    app.add_option("--l2-mb", a.l2_mb, "Capacity of L2, MiB")->capture_default_str()->check(CLI::Range(1.0, 1e6));
    app.add_option("--loaders", a.loaders, "Threads that load for L2")->capture_default_str()->check(CLI::Range(1, 64));
    app.add_option("--longest-s", a.longest_s, "That a complete picture is waited for")
        ->capture_default_str()
        ->check(CLI::PositiveNumber);
}

// A row of a sweep: means over the frames with "rest". A player of its own, for which the value counts.
std::vector<std::string> figures_of_views(const Arguments& a)
{
    Row row;
    Player(a).stay(row);
    if (row.empty()) throw std::runtime_error(a.path + " has no frame with \"rest\", which views draws");
    const auto cell = [&](const char* key, double factor) {
        double sum = 0;
        for (const auto& value : row.at(key)) sum += value.get<double>();
        return text_of_value(factor * sum / static_cast<double>(std::max<std::size_t>(1, row.at(key).size())));
    };
    return {cell("moving_cpu_seconds", 1000), cell("moving_points", 1), cell("moving_error_px", 1),
            cell("rest_cpu_seconds", 1),      cell("rest_frames", 1),   cell("frames_averaged", 1)};
}

Row about_this()
{
    Row row;
    row["gl"] = Offscreen().renderer();
    for (const SplatTraits& mode : splat_modes()) row["splats"].push_back(mode.name);
    return row;
}

Row row_of(const Arguments& a, void (Player::*draw)(Row&))
{
    Row row;
    Player player(a);
    const double cpu = processor_seconds();
    const auto start = Clock::now();
    (player.*draw)(row);
    row["seconds"] = seconds_since(start);
    row["cpu_seconds"] = processor_seconds() - cpu;
    row["gl"] = player.renderer();
    return row;
}

// Does what the parsed subcommand asks for.
void run(const std::string& command, Arguments& a)
{
    const std::vector<Sweep> sweeps = read_sweeps(a.sweeps);
    if (!a.sweeps.empty() && sweeps.empty()) return;  // the names were listed
    if (command.empty()) throw std::runtime_error("a subcommand was expected: about, reference, views or replay");
    if (!sweeps.empty() && command != "views") throw std::runtime_error("--sweep draws the figures of views alone");
    if (command != "about" && std::sscanf(a.size.c_str(), "%5dx%5d", &a.width, &a.height) != 2)
        throw std::runtime_error("--size: WIDTHxHEIGHT in pixels was expected, not " + a.size);
    for (const Sweep& sweep : sweeps)
        print_sweep(
            sweep, {"CPU ms, moving", "points, moving", "pixels apart", "CPU s, at rest", "frames at rest", "averaged"},
            [&] { return figures_of_views(a); });
    if (!sweeps.empty()) return;
    const Row row = command == "about" ? about_this()
                                       : row_of(a, command == "reference" ? &Player::draw_references
                                                   : command == "views"   ? &Player::stay
                                                                          : &Player::replay);
    std::printf("%s\n", row.dump().c_str());
}

}  // namespace

int main(int argc, char** argv)
{
    CLI::App app("Draws the frames of a camera path; prints one line of JSON.");
    app.require_subcommand(0, 1);
    app.fallthrough();
    Arguments a;
    app.add_option("--sweep", a.sweeps,
                   "Tuned values whose figures views prints: NAME or NAME=FROM:TO:STEPS; 'list' prints the names");
    app.add_subcommand("about", "What it draws with");
    CLI::App* const reference = app.add_subcommand("reference", "Each frame complete");
    add_options(*reference, a);
    reference->add_flag("--to-target", a.to_target, "Complete is what --target-px asks for, not every point in view");
    CLI::App* const views = app.add_subcommand("views", "Frames with \"rest\": on arrival, and complete");
    add_options(*views, a);
    CLI::App* const replay = app.add_subcommand("replay", "Each frame once, at a pace");
    add_options(*replay, a);
    replay->add_option("--order", a.options.order, "error: best first; depth: the root first")
        ->transform(CLI::CheckedTransformer(orders));
    replay->add_flag("--plain{false}", a.options.fill_gaps,
                     "Splats of their own sizes only, whatever gaps are between them");
    replay
        ->add_option("--frame-budget-ms", a.frame_budget_ms, "0: none, and no feedback from the time that frames take")
        ->capture_default_str()
        ->check(CLI::NonNegativeNumber);
    views->add_option("--frame-budget-ms", a.frame_budget_ms, "0: the library's default")
        ->capture_default_str()
        ->check(CLI::NonNegativeNumber);
    replay->add_option("--upload-ms", a.options.upload_budget_ms, "Time of a frame for uploads")->capture_default_str();
    replay->add_option("--prefetch-frames", a.options.prefetch_frames, "That a moving camera is loaded ahead for")
        ->capture_default_str();
    replay->add_option("--pace-ms", a.pace_ms, "A frame takes at least this long")
        ->capture_default_str()
        ->check(CLI::NonNegativeNumber);
    for (CLI::App* const command : {views, replay}) {
        command->add_option("--point-budget", a.options.point_budget, "Most points of a frame")->capture_default_str();
        command->add_option("--passes", a.passes, "Number of passes along the path; the last one is measured")
            ->capture_default_str()
            ->check(CLI::Range(1, 100));
    }
    CLI11_PARSE(app, argc, argv);
    try {
        const std::vector<CLI::App*> parsed = app.get_subcommands();
        run(parsed.empty() ? "" : parsed.front()->get_name(), a);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_pictures: %s\n", error.what());
        return 1;
    }
}
