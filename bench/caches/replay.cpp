// A camera path, drawn offscreen: what both caches do for a viewer.
#include "bench/caches/modes.h"
#include "bench/caches/storage.h"

#include "pcm/gl/draw/renderer.h"
#include "pcm/offscreen/offscreen.h"
#include "pcm/view/camera_path.h"

#include <GL/glew.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace pcm::bench {
namespace {

template <class Enum>
using Names = std::array<std::pair<const char*, Enum>, 2>;

constexpr Names<L1Policy> policies{{{"lru", L1Policy::lru}, {"naive", L1Policy::naive}}};
constexpr Names<L1Container> containers{{{"hash", L1Container::hash_map}, {"ordered", L1Container::ordered_map}}};

template <class Enum>
Enum value_of(const std::string& text, const Names<Enum>& names)
{
    for (const auto& [name, value] : names)
        if (text == name) return value;
    throw std::runtime_error("there is no '" + text + "' here");
}

template <class Enum>
const char* name_of(Enum value, const Names<Enum>& names)
{
    for (const auto& [name, other] : names)
        if (value == other) return name;
    return "";
}

L1Options l1_options(const Settings& settings)
{
    L1Options options;
    options.capacity_bytes = settings.l1_bytes;
    options.block_bytes = settings.block_bytes;
    options.policy = value_of(settings.policy, policies);
    options.container = value_of(settings.container, containers);
    return options;
}

struct Drawn {
    std::vector<double> frame_ms, draw_ms, points, error_px, rest_ms;
    double wanted = 0, found = 0,
           missing = 0;  // nodes, summed over the frames of the path; found: in L1 when they were asked for
    unsigned given_up = 0;
};

class Player {
public:
    Player(const Settings& settings, std::shared_ptr<PointCloud> cloud, const Offscreen& screen)
        : settings_(settings),
          screen_(screen),
          l1_(std::make_shared<L1Cache>(l1_options(settings))),
          cloud_(cloud, l1_),
          renderer_(l1_),
          box_(cloud->info().bounds()),
          origin_(cloud->info().grid.offset)
    {
        // What to draw depends on the view alone and not on how quick the machine is; and it is what a moving view
        // wants.
        options_.frame_budget_ms = 1e6;
        options_.converge = false;
        options_.point_budget = settings.point_budget;
        options_.target_spacing_px = settings.target_px;
        options_.upload_budget_ms = settings.upload_ms;
    }
    ~Player()
    {
        picture_.release();
        renderer_.release();
        cloud_.release();
        l1_->release();
    }
    Player(const Player&) = delete;
    Player& operator=(const Player&) = delete;

    const L1Cache& l1() const { return *l1_; }

    // Shaders are built by the first frame that draws; it shows nothing of the cloud.
    void warm_up()
    {
        CameraFrame away;
        for (std::size_t a = 0; a < 3; ++a) {
            away.eye[a] = box_.max[a] + 10 * (box_.extent(a) + 1);
            away.target[a] = away.eye[a] + 1;
        }
        away.angle = 30;
        for (int i = 0; i < 2; ++i) frame(away);
    }

    void play(const CameraPath& path, Drawn& drawn)
    {
        for (std::size_t i = 0; i < path.frames.size(); ++i) {
            const auto start = Clock::now();
            const std::uint64_t hits_before = l1_->statistics().hits;
            FrameReport report = frame(path.frames[i]);
            drawn.found += static_cast<double>(l1_->statistics().hits - hits_before);
            drawn.frame_ms.push_back(1000 * seconds_since(start));
            drawn.draw_ms.push_back(report.frame_ms);
            drawn.points.push_back(static_cast<double>(report.points_drawn));
            drawn.error_px.push_back(report.screen_error_px);
            drawn.wanted += static_cast<double>(report.nodes_wanted);
            drawn.missing += static_cast<double>(report.nodes_missing);
            if (path.frames[i].rest || i + 1 == path.frames.size()) {
                while (report.refining && seconds_since(start) < settings_.longest_rest_s) {
                    if (!report.repaint) std::this_thread::sleep_for(std::chrono::milliseconds(1));
                    report = frame(path.frames[i]);
                }
                drawn.rest_ms.push_back(1000 * seconds_since(start));
                drawn.given_up += report.refining;
            } else {
                std::this_thread::sleep_until(start +
                                              std::chrono::duration_cast<Clock::duration>(
                                                  std::chrono::duration<double, std::milli>(settings_.pace_ms)));
            }
        }
    }

private:
    FrameReport frame(const CameraFrame& at)
    {
        screen_.clear();
        SceneItem item;
        item.cloud = &cloud_;
        item.origin = origin_;
        const FrameReport report =
            renderer_.draw(picture_, view_of(at, origin_, box_, settings_.width, settings_.height), {item}, options_);
        if (!report.error.empty()) throw std::runtime_error("a frame could not be drawn: " + report.error);
        glFinish();
        return report;
    }

    const Settings& settings_;
    const Offscreen& screen_;
    std::shared_ptr<L1Cache> l1_;
    DrawnCloud cloud_;
    Renderer renderer_;
    Picture picture_;
    Box3d box_;
    Vec3d origin_;
    RenderOptions options_;
};

void put_caches(Row& row, const L1Statistics& l1, const L2Statistics& l2, const Drawn& drawn)
{
    const auto number = [](std::uint64_t n) { return static_cast<double>(n); };
    // L1 is asked for each node that a frame wants. A miss is counted when the chunk comes: a moving camera that waits
    // for one asks in vain more often, and what comes while it rests is counted too.
    const double wanted = drawn.wanted;
    const double l1_misses = number(l1.compulsory_misses + l1.capacity_misses);
    row["l1_wanted"] = wanted;
    row["l1_hits"] = l1.hits;
    row["l1_compulsory"] = l1.compulsory_misses;
    row["l1_capacity"] = l1.capacity_misses;
    row["l1_forced"] = l1.forced_misses;
    row["l1_forced_rate"] = ratio(number(l1.forced_misses), wanted);
    put_load_times(row, "l1_load", l1.upload_times);
    row["l1_evictions"] = l1.evictions;
    row["l1_refused"] = l1.refused;
    row["l1_hit_rate"] = ratio(drawn.found, wanted);
    row["l1_compulsory_rate"] = ratio(number(l1.compulsory_misses), wanted);
    row["l1_capacity_rate"] = ratio(number(l1.capacity_misses), wanted);
    row["l1_load_ms_mean"] = ratio(1000 * l1.upload_seconds, l1_misses);
    row["l1_uploaded_mb"] = number(l1.uploaded_bytes) / 1e6;
    row["l1_mb_s"] = ratio(number(l1.uploaded_bytes) / 1e6, l1.upload_seconds);
    row["l1_allocated_mb"] = number(l1.allocated_bytes) / 1e6;
    row["l1_page_use"] = ratio(number(l1.resident_bytes), number(l1.allocated_bytes));
    // L2 is asked for what L1 lacks. A chunk that had to be loaded is found when it has come: found ones less loaded
    // ones were there.
    const double l2_misses = number(l2.compulsory_misses + l2.capacity_misses),
                 asked = std::max(number(l2.hits), l2_misses);
    row["l2_asked"] = asked;
    row["l2_compulsory"] = l2.compulsory_misses;
    row["l2_capacity"] = l2.capacity_misses;
    row["l2_forced"] = l2.forced_misses;
    row["l2_evictions"] = l2.evictions;
    row["l2_hit_rate"] = asked > 0 ? 1 - l2_misses / asked : 0;
    row["l2_compulsory_rate"] = ratio(number(l2.compulsory_misses), asked);
    row["l2_capacity_rate"] = ratio(number(l2.capacity_misses), asked);
    row["l2_forced_rate"] = ratio(number(l2.forced_misses), asked);
    row["l2_load_ms_mean"] = ratio(1000 * l2.load_seconds, number(l2.load_times.count()));
    row["l2_loaded_mb"] = number(l2.loaded_bytes) / 1e6;
    row["l2_mb_s"] = ratio(number(l2.loaded_bytes) / 1e6, l2.load_seconds);
    put_load_times(row, "l2_load", l2.load_times);
}

}  // namespace

std::string gl_renderer(std::string& why)
{
    try {
        return Offscreen(16, 16).renderer();
    } catch (const std::exception& error) {
        why = error.what();
        return {};
    }
}

void put_l1_defaults(Row& row)
{
    const L1Options options;
    row["l1_mb"] = static_cast<double>(options.capacity_bytes) / (1 << 20);
    row["block_mb"] = static_cast<double>(options.block_bytes) / (1 << 20);
    row["policy"] = name_of(options.policy, policies);
    row["container"] = name_of(options.container, containers);
    row["point_budget"] = RenderOptions().point_budget;
}

void measure_replay(const Settings& settings, Row& row)
{
    const CameraPath read = CameraPath::read(settings.path);
    const Offscreen screen(settings.width, settings.height);
    prepare_storage(settings, row);
    L2Options l2;
    l2.capacity_bytes = settings.l2_bytes;
    l2.threads = settings.l2_threads;
    const auto cloud = PointCloud::open(settings.tree, l2);
    const CameraPath path = read.placed(cloud->info().bounds());
    Player player(settings, cloud, screen);
    player.warm_up();

    Drawn drawn;
    const double cpu = processor_seconds();
    const auto start = Clock::now();
    for (unsigned pass = 0; pass < settings.passes; ++pass) player.play(path, drawn);
    row["seconds"] = seconds_since(start);
    row["cpu_seconds"] = processor_seconds() - cpu;
    row["frames"] = drawn.frame_ms.size();
    row["frame_ms_median"] = quantile(drawn.frame_ms, 0.5);
    row["frame_ms_p99"] = quantile(drawn.frame_ms, 0.99);
    row["draw_ms_median"] = quantile(drawn.draw_ms, 0.5);
    row["points_drawn_median"] = quantile(drawn.points, 0.5);
    row["screen_error_px_median"] = quantile(drawn.error_px, 0.5);
    row["missing_rate"] = ratio(drawn.missing, drawn.wanted);
    row["converged_ms_median"] = quantile(drawn.rest_ms, 0.5);
    row["converged_ms_max"] = quantile(drawn.rest_ms, 1);
    row["given_up"] = drawn.given_up;
    put_caches(row, player.l1().statistics(), cloud->cache().statistics(), drawn);
    row["gl"] = screen.renderer();
}

}  // namespace pcm::bench
