#include "gl/renderer.h"

#include "gl/gl_state.h"
#include "gl/picture_state.h"
#include "gl/splat_pass.h"
#include "gl/vertex_format.h"
#include "view/motion.h"

#include <GL/glew.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <utility>

namespace pcm {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start)
{
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// So many nodes of a resting view are on their way into the picture at a time.
constexpr std::size_t rest_window = 64;

// Splats of this many times the spacing leave few gaps between the points of a level, which lie no nearer than the spacing and leave no
// disc of that radius empty. Beyond `largest_fill` pixels a picture says nothing whatever its splats are.
constexpr double fill_of_spacing = 1.43;
constexpr double largest_fill = 32;

// The spacing on the screen that a style's own splats are taken to cover.
double spacing_covered(const CloudStyle& style)
{
    return style.splats == SplatMode::constant ? static_cast<double>(style.point_size_px) / fill_of_spacing : 1;
}

}  // namespace

struct Renderer::Impl {
    std::shared_ptr<L1Cache> l1;
    SplatPass splats;
    Compositor compositor;

    // One item, ready for a frame.
    struct Cloud {
        ChunkFeed* feed;
        const Tree* tree;
        View view;
        CloudStyle style;
        VertexFormat format;
        std::vector<bool> current;      // of its `wanted`: in L1 with the attributes of the style
        std::vector<NodeId> window;     // to be loaded
        std::vector<float> residual;    // of its `wanted`: the largest error of what is in view below and not drawn, pixels
        float fill_px = 0;              // see ChunkLook::least_px
        bool refused = false;
    };

    struct Frame {
        Clock::time_point start = Clock::now();
        Picture::Impl& picture;
        const RenderOptions& options;
        std::vector<Cloud> clouds;
        std::vector<L1Cache::Owner> owners;
        DetailLimits limits;
        FrameReport report;
        double drawing_ms = 0;  // where the clock waits for it
    };

    // --- what to draw -----------------------------------------------------------------------------------------------

    static std::vector<TreeInView> trees_of(const std::vector<Cloud>& clouds)
    {
        std::vector<TreeInView> trees;
        for (const Cloud& cloud : clouds) trees.push_back({&cloud.tree->nodes(), &cloud.tree->info().grid, cloud.view});
        return trees;
    }

    DetailLimits limits_of(Frame& frame) const
    {
        Picture::Impl& p = frame.picture;
        DetailLimits limits;
        limits.target_px = frame.options.target_spacing_px;
        limits.order = frame.options.order;
        std::uint64_t roots = 0;
        limits.page_points = L1Cache::points_per_page({});
        for (const Cloud& cloud : frame.clouds) {
            if (!cloud.tree->nodes().empty()) roots += cloud.tree->nodes()[0].points;
            // Counted as if all entries had colour: those of another style stay until there is need for their room.
            VertexFormat format = cloud.format;
            if (format.colour == VertexColour::none) format.colour = VertexColour::rgb;
            limits.page_points = std::min(limits.page_points, L1Cache::points_per_page(format));
        }
        limits.point_budget = p.budget.points(frame.options.frame_budget_ms, roots, frame.options.point_budget);
        frame.report.effective_point_budget = limits.point_budget;
        const std::uint64_t pages = l1->pages_available(frame.owners);
        // The coarsest chunks in any case.
        const std::uint64_t least = roots / std::max<std::uint64_t>(1, limits.page_points) + frame.clouds.size();
        limits.page_budget = std::min(pages, std::max(static_cast<std::uint64_t>(p.page_share * static_cast<double>(pages)), least));
        return limits;
    }

    // --- loading ----------------------------------------------------------------------------------------------------

    // Uploads what has come, for the cloud first that lacks what is worth most.
    static Served upload(Frame& frame, const SceneSelection& selection)
    {
        std::vector<std::size_t> turns;
        for (const SceneSelection::Place& place : selection.order)
            if (!frame.clouds[place.tree].window.empty() && std::find(turns.begin(), turns.end(), place.tree) == turns.end())
                turns.push_back(place.tree);
        Served sum;
        const auto start = Clock::now();
        for (const std::size_t turn : turns) {
            // One is uploaded whatever it takes.
            const double left = std::max(0.0, frame.options.upload_budget_ms - milliseconds_since(start));
            if (left == 0 && sum.uploaded > 0) {
                sum.out_of_time = true;
                break;
            }
            Cloud& cloud = frame.clouds[turn];
            const Served served = cloud.feed->upload(cloud.window, cloud.format, left);
            sum.uploaded += served.uploaded;
            sum.out_of_time = sum.out_of_time || served.out_of_time;
            sum.refused = sum.refused || served.refused;
        }
        frame.report.upload_ms = milliseconds_since(start);
        return sum;
    }

    // What of each tree is there; asks for what is not, and for what a moving view will need.
    static void load(Frame& frame, const SceneSelection& selection, const SceneSelection* later)
    {
        for (std::size_t t = 0; t < frame.clouds.size(); ++t) {
            Cloud& cloud = frame.clouds[t];
            cloud.window = cloud.feed->window_of(selection.trees[t], cloud.current);
            std::vector<NodeId> ahead;
            if (later) ahead = cloud.feed->ahead_of(later->trees[t], cloud.window.size());
            cloud.feed->load(cloud.window, ahead, cloud.format);
        }
    }

    // --- drawing ----------------------------------------------------------------------------------------------------

    // Draws entries one after the other; neighbours of one cloud share what is set once.
    class Strokes {
    public:
        Strokes(Impl& impl, Frame& frame) : impl_(impl), frame_(frame) {}
        ~Strokes()
        {
            if (cloud_) impl_.splats.end();
        }
        void draw(const Cloud& cloud, const DetailNode& node, const VertexEntry& entry, float residual, float fill_px)
        {
            if (cloud_ != &cloud) {
                if (cloud_) impl_.splats.end();
                cloud_ = &cloud;
                const RenderTarget& target = frame_.picture.target;
                impl_.splats.begin(cloud.view, cloud.tree->info(), cloud.style, target.reversed(), target.samples());
            }
            ChunkLook look;
            look.level = static_cast<float>(cloud.tree->nodes()[node.node].first_level);
            look.error_px = residual;
            look.least_px = fill_px;
            impl_.splats.draw(entry, look);
            points += entry.points;
        }
        std::uint64_t points = 0;

    private:
        Impl& impl_;
        Frame& frame_;
        const Cloud* cloud_ = nullptr;
    };

    template <class Draw>
    void timed(Frame& frame, const Draw& draw)
    {
        Picture::Impl& p = frame.picture;
        const GLenum mode = p.target.reversed() ? GL_ZERO_TO_ONE : GL_NEGATIVE_ONE_TO_ONE;
        if (gl_has_clip_control()) glClipControl(GL_LOWER_LEFT, mode);
        glDepthFunc(p.target.reversed() ? GL_GREATER : GL_LESS);
        p.clock.begin();
        const auto start = Clock::now();
        {
            Strokes strokes(*this, frame);
            draw(strokes);
            frame.report.points_added = strokes.points;
        }
        p.clock.end(frame.report.points_added);
        if (p.clock.waits()) frame.drawing_ms = milliseconds_since(start);
        const auto measure = p.clock.take();
        if (p.unmeasured > 0)
            --p.unmeasured;
        else if (measure)
            p.budget.measured(measure->points, measure->milliseconds);
    }

    // What a view that has moved, or whose chunks are still coming, shows.
    void draw_moving(Frame& frame, const SceneSelection& selection, bool resting)
    {
        Picture::Impl& p = frame.picture;
        FrameReport& report = frame.report;
        for (std::size_t t = 0; t < frame.clouds.size(); ++t) {
            Cloud& cloud = frame.clouds[t];
            const DetailSelection& wanted = selection.trees[t];
            cloud.current.assign(wanted.wanted.size(), false);
            for (std::size_t i = 0; i < wanted.wanted.size(); ++i)
                cloud.current[i] = ChunkFeed::is_current(l1->use(cloud.feed->owner(), wanted.wanted[i].node), cloud.format);
        }
        const std::optional<SceneSelection> later = resting ? std::nullopt : predicted(frame);
        load(frame, selection, later ? &*later : nullptr);
        const Served served = upload(frame, selection);

        std::vector<std::vector<bool>> drawn(frame.clouds.size());
        for (std::size_t t = 0; t < frame.clouds.size(); ++t) {
            Cloud& cloud = frame.clouds[t];
            const DetailSelection& wanted = selection.trees[t];
            const DrawSet set =
                choose_drawable(wanted, [&](const DetailNode& node) { return cloud.feed->find(node.node) != nullptr; });
            report.screen_error_px = std::max(report.screen_error_px, set.error_px);
            drawn[t].assign(wanted.wanted.size(), false);
            for (const std::uint32_t i : set.drawn) drawn[t][i] = true;
            cloud.residual.assign(wanted.wanted.size(), 0.0f);
            const auto leave = [&](const DetailNode& node) {
                if (node.ancestor == no_ancestor) return;
                float& residual = cloud.residual[node.ancestor];
                residual = std::max(residual, static_cast<float>(node.error_px));
            };
            for (std::size_t i = 0; i < wanted.wanted.size(); ++i)
                if (!drawn[t][i]) leave(wanted.wanted[i]);
            double left_out = 0;  // best first leaves out what has about the same error everywhere
            for (const DetailNode& node : wanted.beyond) {
                leave(node);
                if (std::isfinite(node.error_px)) left_out = std::max(left_out, node.error_px);
            }
            cloud.fill_px = frame.options.fill_gaps ? fill_of(left_out, cloud.style) : 0;
        }

        p.target.clear();
        p.kept.clear();
        report.clouds.resize(frame.clouds.size());
        timed(frame, [&](Strokes& strokes) {
            for (const SceneSelection::Place& place : selection.order) {
                const Cloud& cloud = frame.clouds[place.tree];
                if (!drawn[place.tree][place.index]) continue;
                const DetailNode& node = selection.trees[place.tree].wanted[place.index];
                const VertexEntry* const entry = cloud.feed->find(node.node);
                if (!entry) continue;
                strokes.draw(cloud, node, *entry, cloud.residual[place.index], cloud.fill_px);
                ++report.nodes_drawn;
                report.clouds[place.tree].points_drawn += entry->points;
                p.kept.insert({frame.picture.key->items[place.tree].cloud, node.node});
            }
        });
        report.points_drawn = report.points_added;

        bool more_to_come = false, waits = false, all_current = true, everything = true;
        for (std::size_t t = 0; t < frame.clouds.size(); ++t) {
            Cloud& cloud = frame.clouds[t];
            const DetailSelection& wanted = selection.trees[t];
            report.nodes_wanted += wanted.wanted.size();
            for (std::size_t i = 0; i < wanted.wanted.size(); ++i) {
                cloud.current[i] = ChunkFeed::is_current(cloud.feed->find(wanted.wanted[i].node), cloud.format);
                report.nodes_missing += !cloud.current[i];
                all_current = all_current && (cloud.current[i] || !drawn[t][i]);
                everything = everything && cloud.current[i] && drawn[t][i];
            }
            everything = everything && wanted.beyond.empty();
            // What failed is missing for the time being and not waited for.
            more_to_come = more_to_come || !cloud.feed->window_of(wanted, cloud.current).empty();
            waits = waits || cloud.feed->waits();
        }
        adapt_page_share(p, served.refused);
        // When video memory refuses, waiting helps nothing: it is full of what is on the screen.
        more_to_come = more_to_come && !served.refused;
        const bool budget_grows = selection.budget_reached && report.effective_point_budget < frame.options.point_budget &&
                                  p.budget.can_grow(frame.options.frame_budget_ms, frame.options.point_budget);
        // Also when the window is through and the next one has not been asked for.
        report.repaint = served.out_of_time || (budget_grows && !frame.options.converge) || (more_to_come && !waits);
        report.refining = report.repaint || more_to_come;
        if (selection.order.empty() && selection.budget_reached)
            report.error = "the point budget or the video memory is too small for the first chunk of a cloud";
        report.full_resolution = everything;
        if (frame.options.converge && !report.refining && can_converge(frame)) {
            // Another frame of this view goes on from here.
            report.refining = report.repaint = !everything;
            if (resting && all_current) begin_rest(frame, selection, drawn);
        }
    }

    // Whole pixels; 0 where the style's own splats do.
    static float fill_of(double spacing_px, const CloudStyle& style)
    {
        if (spacing_px <= spacing_covered(style)) return 0;
        return static_cast<float>(std::ceil(fill_of_spacing * std::min(spacing_px, largest_fill)));
    }

    // Whether splats of their own sizes cover this spacing in all clouds.
    static bool has_no_gaps(const Frame& frame, double spacing_px)
    {
        return std::all_of(frame.clouds.begin(), frame.clouds.end(), [&](const Cloud& c) { return fill_of(spacing_px, c.style) == 0; });
    }

    static bool can_converge(const Frame& frame)
    {
        // What a chunk's colour shows changes with what is drawn below it.
        return frame.options.order == DetailOrder::error &&
               std::none_of(frame.clouds.begin(), frame.clouds.end(), [](const Cloud& c) { return c.style.colour == ColourMode::error; });
    }

    static void adapt_page_share(Picture::Impl& p, bool refused)
    {
        p.page_share = refused ? std::max(0.05, 0.9 * p.page_share) : std::min(p.most_page_share, 1.01 * p.page_share);
    }

    static std::optional<SceneSelection> predicted(const Frame& frame)
    {
        const Picture::Impl& p = frame.picture;
        if (!frame.options.prefetch_frames || p.views.size() != frame.clouds.size()) return std::nullopt;
        std::vector<TreeInView> trees = trees_of(frame.clouds);
        bool moves = false;
        for (std::size_t t = 0; t < trees.size(); ++t)
            if (const auto later = predict(p.views[t], trees[t].view, frame.options.prefetch_frames)) {
                trees[t].view = *later;
                moves = true;
            }
        if (!moves) return std::nullopt;
        return select_scene(trees, frame.limits);
    }

    // --- a view that rests ------------------------------------------------------------------------------------------

    // The target holds all of `lod` that can be had; what follows is added to it.
    static void begin_rest(Frame& frame, const SceneSelection& lod, const std::vector<std::vector<bool>>& drawn)
    {
        Picture::Impl::Rest& rest = *frame.picture.rest;
        DetailLimits everything;
        everything.target_px = -1;
        everything.point_budget = everything.page_budget = ~std::uint64_t(0);
        rest.all = select_scene(trees_of(frame.clouds), everything);
        rest.begun = true;
        rest.added = lod.order.size();
        rest.held = lod.order.size();
        rest.points_of.assign(frame.clouds.size(), 0);
        if (std::any_of(frame.clouds.begin(), frame.clouds.end(), [](const Cloud& cloud) { return cloud.fill_px > 0; })) {
            rest.behind = true;
            rest.added = 0;
            const FrameReport& report = frame.report;
            rest.shown_points = report.points_drawn;
            rest.shown_nodes = report.nodes_drawn;
            for (const CloudReport& cloud : report.clouds) rest.shown_points_of.push_back(cloud.points_drawn);
            rest.shown_error_px = report.screen_error_px;
            Picture::Impl& p = frame.picture;
            p.next.prepare(p.target.width(), p.target.height(), p.asked_samples);
            p.next.bind();
            p.next.clear();
        }
        for (std::size_t i = 0; i < rest.added; ++i) {
            const SceneSelection::Place& place = rest.all.order[i];
            const Cloud& cloud = frame.clouds[place.tree];
            const VertexEntry* const entry = cloud.feed->find(rest.all.trees[place.tree].wanted[place.index].node);
            if (!entry || !drawn[place.tree][place.index]) {
                rest.left_out.push_back(i);
                continue;
            }
            ++rest.nodes;
            rest.points += entry->points;
            rest.points_of[place.tree] += entry->points;
        }
    }

    void draw_resting(Frame& frame)
    {
        Picture::Impl& p = frame.picture;
        Picture::Impl::Rest& rest = *p.rest;
        FrameReport& report = frame.report;
        const auto node_at = [&](std::size_t i) -> const DetailNode& {
            const SceneSelection::Place& place = rest.all.order[i];
            return rest.all.trees[place.tree].wanted[place.index];
        };
        const auto cloud_at = [&](std::size_t i) -> Cloud& { return frame.clouds[rest.all.order[i].tree]; };

        // What a moving view will show again stays in L1, and what comes next has the rest of it.
        const auto pages_at = [&](std::size_t i) {
            const std::uint64_t per_page = L1Cache::points_per_page(cloud_at(i).format);
            return (cloud_at(i).tree->nodes()[node_at(i).node].points + per_page - 1) / per_page;
        };
        std::uint64_t pages = l1->pages_available(frame.owners);
        for (std::size_t i = 0; i < rest.held; ++i) {
            l1->use(cloud_at(i).feed->owner(), node_at(i).node);
            pages -= std::min(pages, pages_at(i));
        }
        std::vector<std::size_t> next;
        const auto consider = [&](std::size_t i) {
            const std::uint64_t needed = pages_at(i);
            if (!next.empty() && (next.size() >= rest_window || needed > pages)) return false;
            pages -= std::min(pages, needed);
            next.push_back(i);
            return true;
        };
        const bool first_time = rest.added < rest.all.order.size();
        if (first_time)
            for (std::size_t i = rest.added; i < rest.all.order.size() && consider(i); ++i) {}
        else
            for (std::size_t k = 0; k < rest.left_out.size() && consider(rest.left_out[k]); ++k) {}
        for (Cloud& cloud : frame.clouds) cloud.window.clear();
        for (const std::size_t i : next) {
            Cloud& cloud = cloud_at(i);
            const NodeId node = node_at(i).node;
            if (ChunkFeed::is_current(cloud.feed->find(node), cloud.format))
                l1->use(cloud.feed->owner(), node);
            else if (!cloud.feed->has_failed(node) && cloud.window.size() < ChunkFeed::window_size)
                cloud.window.push_back(node);
        }
        for (Cloud& cloud : frame.clouds) cloud.feed->load(cloud.window, {}, cloud.format);
        const Served served = upload(frame, rest.all);

        std::uint64_t budget = p.budget.points(frame.options.frame_budget_ms, 1, frame.options.point_budget);
        report.effective_point_budget = budget;
        if (!next.empty()) {
            if (rest.behind) p.next.bind();
            timed(frame, [&](Strokes& strokes) {
                std::set<std::size_t> had;
                for (const std::size_t i : next) {
                    Cloud& cloud = cloud_at(i);
                    const DetailNode& node = node_at(i);
                    const VertexEntry* const entry = cloud.feed->find(node.node);
                    const bool ready = ChunkFeed::is_current(entry, cloud.format);
                    if (ready && strokes.points > 0 && strokes.points + entry->points > budget) break;
                    if (ready) {
                        strokes.draw(cloud, node, *entry, 0, 0);
                        ++rest.nodes;
                        rest.points += entry->points;
                        rest.points_of[rest.all.order[i].tree] += entry->points;
                        had.insert(i);
                    } else if (first_time) {
                        // One after the other, so that of points at equal depth the same one is seen each time.
                        if (!cloud.feed->has_failed(node.node)) break;
                        rest.left_out.push_back(i);
                    }
                    if (first_time) ++rest.added;
                }
                if (!first_time) {
                    auto& out = rest.left_out;
                    out.erase(std::remove_if(out.begin(), out.end(), [&](std::size_t i) { return had.count(i) != 0; }), out.end());
                }
            });
        }
        // Others hold on to video memory that was reckoned with: then the room of what a moving view wants is needed too.
        const bool refused = served.refused && served.uploaded == 0 && report.points_added == 0;
        const bool stuck = refused && rest.held == 0;
        if (refused) rest.held /= 2;

        const std::size_t total = rest.all.order.size();
        double error = rest.added < total ? node_at(rest.added).error_px : 0;
        for (const std::size_t i : rest.left_out) error = std::max(error, node_at(i).error_px);
        if (rest.behind && (rest.added == total || has_no_gaps(frame, node_at(rest.added).error_px))) {
            std::swap(p.target, p.next);
            rest.behind = false;
        }
        report.clouds.resize(frame.clouds.size());
        for (std::size_t t = 0; t < frame.clouds.size(); ++t)
            report.clouds[t].points_drawn = rest.behind ? rest.shown_points_of[t] : rest.points_of[t];
        report.points_drawn = rest.behind ? rest.shown_points : rest.points;
        report.nodes_drawn = rest.behind ? rest.shown_nodes : rest.nodes;
        report.nodes_wanted = total;
        report.nodes_missing = total - rest.nodes;
        report.screen_error_px = std::min<double>(rest.behind ? rest.shown_error_px : error, std::max(p.target.width(), p.target.height()));
        report.full_resolution = rest.added == total && rest.left_out.empty();
        const bool more = rest.added < total;
        if (stuck && more) report.error = "the video memory is too small for the rest of the points in view";
        report.refining = more && !stuck;
        bool waits = false;
        for (Cloud& cloud : frame.clouds) waits = waits || cloud.feed->waits();
        report.repaint = report.refining && (!waits || report.points_added > 0 || served.uploaded > 0);
    }

    // --- a frame ----------------------------------------------------------------------------------------------------

    FrameReport draw(Picture::Impl& p, const View& scene, const std::vector<SceneItem>& items, const RenderOptions& options)
    {
        Frame frame{Clock::now(), p, options, {}, {}, {}, {}, 0};
        FrameReport& report = frame.report;
        PictureKey key{scene.modelview, scene.projection,        scene.width,   scene.height,
                       options.target_spacing_px, options.converge, options.fill_gaps, options.order, {}};
        std::vector<CloudReport> clouds;
        for (const SceneItem& item : items) {
            Cloud cloud{};
            const DrawnCloud::Impl& drawn = *item.cloud->impl_;
            cloud.feed = drawn.feed.get();
            cloud.tree = &drawn.cloud->cache().tree();
            CloudReport about;
            about.style = cloud.style = usable_style(item.style, drawn.cloud->info().schema, &about.notice);
            clouds.push_back(std::move(about));
            cloud.format = format_of(cloud.style);
            cloud.view = scene;
            cloud.view.origin = item.origin;
            if (item.placement != identity_matrix) cloud.view.modelview = product(scene.modelview, item.placement);
            key.items.push_back({drawn.serial, item.origin, item.placement, cloud.style});
            frame.owners.push_back(cloud.feed->owner());
            frame.clouds.push_back(std::move(cloud));
        }
        const bool shows = std::any_of(frame.clouds.begin(), frame.clouds.end(), [](const Cloud& c) { return Frustum::of(c.view).has_value(); });
        if (!shows) {
            p.forget();
            report.clouds = std::move(clouds);
            return report;
        }

        const GlStateGuard state;
        state.set_plain();
        p.asked_samples = std::max(1u, options.samples);
        if (p.target.prepare(scene.width, scene.height, p.asked_samples)) {
            p.next.release();
            p.forget();
        }
        report.samples = p.target.samples();
        if (!p.key || !key.looks_as(*p.key)) {
            p.unmeasured = 2;
            p.budget.forget();
        }
        const bool resting = p.key && *p.key == key;
        p.key = std::move(key);
        p.target.bind();
        l1->begin_frame(frame.owners);

        if (!resting) p.rest.reset();
        if (p.rest && p.rest->begun) {
            draw_resting(frame);
        } else if (resting && options.converge) {
            if (!p.rest) {
                p.rest.emplace();
                p.rest->lod = select_scene(trees_of(frame.clouds), limits_of(frame));
            }
            draw_moving(frame, p.rest->lod, true);
        } else {
            frame.limits = limits_of(frame);
            if (!resting)
                frame.limits.kept = [&p](std::uint32_t tree, NodeId node) { return p.kept.count({p.key->items[tree].cloud, node}) != 0; };
            draw_moving(frame, select_scene(trees_of(frame.clouds), frame.limits), resting);
        }
        p.views.clear();
        for (const Cloud& cloud : frame.clouds) p.views.push_back(cloud.view);

        compositor.draw(p.target, p.resolved, state, scene.projection, options.eye_dome);
        if (p.clock.waits()) glFinish();
        report.measured_ms = p.budget.last_measured_ms();
        for (std::size_t t = 0; t < clouds.size(); ++t) {
            clouds[t].points_drawn = report.clouds[t].points_drawn;
            clouds[t].error = frame.clouds[t].feed->error();
            if (!clouds[t].error.empty()) report.error = clouds[t].error;
        }
        report.clouds = std::move(clouds);
        report.frame_ms = milliseconds_since(frame.start);
        if (p.unmeasured == 0) p.budget.measured_overhead(p.clock.waits() ? report.frame_ms - frame.drawing_ms : report.upload_ms);
        return report;
    }
};

// --- the public face ------------------------------------------------------------------------------------------------

DrawnCloud::DrawnCloud(std::shared_ptr<PointCloud> cloud, std::shared_ptr<L1Cache> l1) : impl_(std::make_unique<Impl>())
{
    static std::atomic<std::uint64_t> serials{0};
    impl_->serial = ++serials;
    impl_->cloud = std::move(cloud);
    impl_->l1 = std::move(l1);
    impl_->feed = std::make_unique<ChunkFeed>(impl_->cloud, impl_->l1);
}

DrawnCloud::~DrawnCloud() = default;

void DrawnCloud::set_wake(std::function<void()> wake) { impl_->feed->set_wake(std::move(wake)); }
void DrawnCloud::release() { impl_->feed->release(); }
const std::shared_ptr<PointCloud>& DrawnCloud::cloud() const { return impl_->cloud; }
const std::shared_ptr<L1Cache>& DrawnCloud::l1() const { return impl_->l1; }

Picture::Picture() : impl_(std::make_unique<Impl>()) {}
Picture::~Picture() = default;
Picture::Picture(Picture&&) noexcept = default;
Picture& Picture::operator=(Picture&&) noexcept = default;

void Picture::invalidate() { impl_->forget(); }

void Picture::release()
{
    impl_->target.release();
    impl_->next.release();
    impl_->resolved.release();
    impl_->clock.release();
    impl_->forget();
}

Renderer::Renderer(std::shared_ptr<L1Cache> l1) : impl_(std::make_unique<Impl>()) { impl_->l1 = std::move(l1); }
Renderer::~Renderer() = default;

FrameReport Renderer::draw(Picture& picture, const View& view, const std::vector<SceneItem>& items, const RenderOptions& options)
{
    FrameReport report;
    if (!gl_functions_loaded()) {
        report.error = "OpenGL 3.3 is not available: its functions are not loaded (glewInit), or the driver lacks them";
        return report;
    }
    drain_gl_errors();
    std::string failure;
    try {
        report = impl_->draw(*picture.impl_, view, items, options);
    } catch (const std::exception& error) {
        failure = error.what();
        picture.invalidate();
    }
    const std::string gl_errors = drain_gl_errors();
    if (!gl_errors.empty()) report.error = "OpenGL error while drawing: " + gl_errors;
    if (!failure.empty()) report.error = failure;
    return report;
}

void Renderer::release()
{
    impl_->splats.release();
    impl_->compositor.release();
}

const std::shared_ptr<L1Cache>& Renderer::l1() const { return impl_->l1; }

}  // namespace pcm
