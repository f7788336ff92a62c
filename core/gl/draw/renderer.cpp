#include "pcm/gl/draw/renderer.h"

#include "pcm/gl/base/gl_state.h"
#include "pcm/gl/draw/frame.h"
#include "pcm/gl/draw/smoothing.h"
#include "pcm/gl/tuning.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"
#include "pcm/view/seen_points.h"

#include <GL/glew.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <utility>

namespace pcm {

struct Renderer::Impl {
    // Limits for a cloud, source units. Squares do not occur, but products with pixels, angles and factors on radii do.
    static constexpr double least_extent = 1e-33, largest_extent = 1e30;
    // Limit for a cloud's corners in eye space and in clip space, and the projection: a narrow angle is seen from far.
    static constexpr double largest_in_view = 1e35;
    std::shared_ptr<L1Cache> l1;
    SplatPass splats;
    Compositor compositor;

    // Items of one cloud share its vertices, which have the attributes of all their styles.
    static void share_format(Frame& frame, FrameCloud& cloud)
    {
        VertexFormat& former = frame.clouds[cloud.leader].format;
        if (former.colour != ColourSource::none && cloud.format.colour != ColourSource::none &&
            (former.colour != cloud.format.colour || former.attribute != cloud.format.attribute))
            throw Error(ErrorCode::unsupported, {}, "one cloud is shown twice, in the colours of two attributes",
                        "give it another DrawnCloud for the second, or the same colours");
        if (former.filter != cloud.format.filter)
            throw Error(ErrorCode::unsupported, {}, "one cloud is shown twice, with other conditions or clips",
                        "give it another DrawnCloud for the second, or the same conditions and clips");
        if (former.colour == ColourSource::none) {
            former.colour = cloud.format.colour;
            former.attribute = cloud.format.attribute;
        }
        former.radius = former.radius || cloud.format.radius;
        former.normal = former.normal || cloud.format.normal;
        former.shape = former.shape || cloud.format.shape;
        for (FrameCloud& other : frame.clouds)
            if (other.leader == cloud.leader) other.format = former;
        cloud.format = former;
    }

    // Vertices are floats relative to their chunk, in source units.
    static void require_floats(const TreeInfo& info)
    {
        if (info.points == 0) return;
        const Box3d box = info.bounds();
        const double longest = std::max({box.extent(0), box.extent(1), box.extent(2)});
        if (longest == 0 || (longest >= least_extent && longest <= largest_extent)) return;
        throw Error(ErrorCode::unsupported, {},
                    "the cloud's extent is " + brief(longest) +
                        ": pictures are computed in single precision, which extents from " + brief(least_extent) +
                        " to " + brief(largest_extent) + " allow",
                    "scale it with 'pcmlab transform --scale'");
    }

    // So are the view's matrices, and what comes of them. Where they are not finite no point is in view.
    static void require_floats(const Camera& view, const Box3d& box)
    {
        if (!is_finite(view.modelview) || !is_finite(view.projection)) return;
        double largest = 0;
        for (const double v : view.projection) largest = std::max(largest, std::fabs(v));
        for (unsigned corner = 0; corner < 8; ++corner) {
            std::array<double, 4> place{0, 0, 0, 1};
            for (std::size_t a = 0; a < 3; ++a) place[a] = (corner >> a & 1u ? box.max : box.min)[a] - view.origin[a];
            for (const Matrix4d* const matrix : {&view.modelview, &view.projection}) {
                std::array<double, 4> next{};
                for (std::size_t r = 0; r < 4; ++r)
                    for (std::size_t c = 0; c < 4; ++c) next[r] += (*matrix)[c * 4 + r] * place[c];
                place = next;
                for (const double v : place) largest = std::max(largest, std::fabs(v));
            }
        }
        if (largest > largest_in_view)
            throw Error(
                ErrorCode::unsupported, {},
                "the view reaches " + brief(largest) +
                    " units from the eye: pictures are computed in single precision, which allows " +
                    brief(largest_in_view),
                "move the camera nearer or widen its angle, or scale the cloud with 'pcmlab transform --scale'");
    }

    // Sets style, values and format of a cloud; what is reported of these.
    static CloudReport look_of(FrameCloud& cloud, const CloudStyle& asked, const Schema& schema)
    {
        CloudReport report;
        ChunkFeed& feed = *cloud.feed;
        cloud.style = usable_style(asked, schema, &report.notice, [&](const CloudStyle& style) {
            // With a range of its own a value is useful where it is the same everywhere.
            if (has_range(asked.colour) && style.range) return false;
            // Classes that are asked for are shown, whatever they are.
            const bool is_fallback = style.colour != asked.colour;
            if (style.colour == ColourMode::classification && !is_fallback) return false;
            const CloudFact* const fact = feed.fact_of(style);
            return fact && (fact->is_blank ||
                            (is_fallback && style.colour == ColourMode::height_intensity && !fact->has_shape));
        });
        const CloudFact* fact = cloud.style.colour == ColourMode::classification ? nullptr : feed.fact_of(cloud.style);
        const Colouring colouring = traits_of(cloud.style.colour).colouring;
        if (colouring == Colouring::shaded_height) {
            cloud.values.shade_exponent = fact ? fact->range.exponent : 1;
            CloudStyle heights = cloud.style;
            heights.colour = ColourMode::height;
            fact = feed.fact_of(heights);
        }
        if (fact && has_range(cloud.style.colour)) {
            cloud.values.range = cloud.style.range.value_or(fact->range);
            cloud.values.stored_low = fact->range.low;
            cloud.values.stored_high = fact->range.high;
        } else if (colouring == Colouring::height) {
            cloud.values.range = cloud.style.range;
        }
        cloud.format = feed.format_of(cloud.style, cloud.clips.by_point(), report.notice);
        report.style = cloud.style;
        report.vertex_bytes = cloud.format.stride();
        report.range = cloud.values.range;
        return report;
    }

    // Adds an item to the frame; what is reported of its cloud.
    CloudReport add(Frame& frame, PictureKey& key, const Camera& scene, const SceneItem& item) const
    {
        if (!item.cloud || item.cloud->l1() != l1)
            throw Error(ErrorCode::invalid_argument, {},
                        "a scene's item has no cloud, or one of another L1 than the renderer's");
        require_floats(item.cloud->cloud()->info());
        FrameCloud cloud{};
        const DrawnCloud::Impl& drawn = *item.cloud->impl_;
        cloud.feed = drawn.feed.get();
        cloud.nodes = drawn.nodes.get();
        cloud.tree = &drawn.cloud->cache().tree();
        cloud.leader = frame.clouds.size();
        for (std::size_t t = frame.clouds.size(); t-- > 0;)
            if (frame.clouds[t].feed == cloud.feed) cloud.leader = t;
        cloud.clips = ViewClips(item.clips);
        cloud.selected_colour = item.selected_colour;
        const auto selected = item.selected && item.selected->belongs_to(*cloud.tree) ? item.selected : nullptr;
        if (cloud.leader == frame.clouds.size()) {
            cloud.feed->begin_frame();
            cloud.feed->select(selected);
        } else if (cloud.feed->selected() != selected) {
            throw Error(ErrorCode::unsupported, {}, "one cloud is shown twice, with other selected points",
                        "give it another DrawnCloud for the second, or the same selected points");
        }
        CloudReport report = look_of(cloud, item.style, drawn.cloud->info().schema);
        cloud.view = scene;
        cloud.view.origin = item.origin;
        if (item.placement != identity_matrix) cloud.view.modelview = product(scene.modelview, item.placement);
        if (drawn.cloud->info().points > 0) require_floats(cloud.view, drawn.cloud->info().bounds());
        key.items.push_back({drawn.serial, item.origin, item.placement, cloud.style, cloud.values, cloud.clips.text(),
                             selected, item.selected_colour});
        if (cloud.leader == frame.clouds.size())
            frame.owners.push_back(cloud.feed->owner());
        else
            share_format(frame, cloud);
        frame.clouds.push_back(std::move(cloud));
        return report;
    }

    // As the limits say, but never so that hardly anything is in view.
    static SceneSelection select_moving(Frame& frame, DetailLimits& limits)
    {
        SceneSelection selection =
            select_scene_seen(frame.trees(), limits, gl_tuning().budget.min_points_in_view, frame.options.point_budget);
        frame.report.effective_point_budget = limits.point_budget;
        return selection;
    }

    // Into the picture's target; once more, for the mean, into its `next`. Whether the picture is that of the frame
    // before.
    bool draw_clouds(Frame& frame, const Camera& scene, PictureKey key) const
    {
        PictureState& p = frame.picture;
        p.asked_samples = std::max(1u, frame.options.samples);
        if (p.target.prepare(scene.width, scene.height, p.asked_samples)) {
            p.next.release();
            p.forget();
        }
        frame.report.samples = p.target.samples();
        if (!p.key || !key.looks_as(*p.key)) {
            p.unmeasured = gl_tuning().budget.unmeasured_frames;
            p.budget.forget();
            p.rest_budget.forget();
        }
        const bool resting = p.key && *p.key == key;
        p.key = std::move(key);
        frame.converges = resting && frame.options.converge;
        p.target.bind();
        l1->begin_frame(frame.owners);

        if (!resting) p.rest.reset();
        begin_smoothing(frame, resting);
        if (p.rest && p.rest->begun) {
            frame.again ? draw_for_mean(frame) : draw_resting(frame);
        } else {
            if (frame.again) {
                p.next.prepare(scene.width, scene.height, p.asked_samples);
                std::swap(p.target, p.next);
                p.target.bind();
            }
            draw_within_limits(frame, resting);
            if (frame.again) std::swap(p.target, p.next);
        }
        p.views.clear();
        for (const FrameCloud& cloud : frame.clouds) p.views.push_back(cloud.view);
        return resting;
    }

    // A view that moves, or rests without having all that it shows while it moves.
    static void draw_within_limits(Frame& frame, bool resting)
    {
        PictureState& p = frame.picture;
        if (frame.converges) {
            if (!p.rest || p.rest->lod.lacks_nodes()) {
                p.rest.emplace();
                DetailLimits limits = frame.current_limits();
                p.rest->lod = select_moving(frame, limits);
            }
            draw_moving(frame, p.rest->lod, true);
            return;
        }
        frame.limits = frame.current_limits();
        if (!resting)
            frame.limits.kept = [&p](std::uint32_t tree, NodeId node) {
                return p.kept.count({p.key->items[tree].cloud, node}) != 0;
            };
        draw_moving(frame, select_moving(frame, frame.limits), resting);
    }

    FrameReport draw(PictureState& p, const Camera& scene, const std::vector<SceneItem>& items,
                     const RenderOptions& options)
    {
        Frame frame{p, options, *l1, splats};
        FrameReport& report = frame.report;
        PictureKey key{
            scene.modelview,   scene.projection, scene.width, scene.height, options.target_spacing_px, options.converge,
            options.fill_gaps, options.order,    {}};
        std::vector<CloudReport> clouds;
        for (const SceneItem& item : items) clouds.push_back(add(frame, key, scene, item));
        const bool shows = std::any_of(frame.clouds.begin(), frame.clouds.end(),
                                       [](const FrameCloud& c) { return Frustum::of(c.view).has_value(); });
        if (!shows) {
            p.forget();
            report.clouds = std::move(clouds);
            return report;
        }

        const GlStateGuard state;
        state.set_plain();
        const bool resting = draw_clouds(frame, scene, std::move(key));
        const bool moves = options.converge && !frame.at_rest && report.refining;
        end_smoothing(frame, resting, compositor, scene.projection);
        if (const unsigned frames = frames_shown(p); frames > 1)
            compositor.draw_mean(p.sum, frames, p.target, state);
        else
            compositor.draw(p.target, p.resolved, p.shades, state, scene.projection, frame.finish(moves));
        if (p.clock.waits()) glFinish();
        report.measured_ms = frame.costs().last_measured_ms();
        for (std::size_t t = 0; t < clouds.size(); ++t) {
            clouds[t].points_drawn = report.clouds[t].points_drawn;
            clouds[t].points_hidden = report.clouds[t].points_hidden;
            if (clouds[t].style.colour == ColourMode::classification)
                clouds[t].classes = frame.clouds[t].feed->classes();
            clouds[t].error = frame.clouds[t].feed->error();
            if (clouds[t].error.empty()) clouds[t].error = frame.clouds[t].nodes->error();
            if (!clouds[t].error.empty()) report.error = clouds[t].error;
            report.retry_seconds = sooner(report.retry_seconds, frame.clouds[t].feed->seconds_to_retry());
            report.retry_seconds = sooner(report.retry_seconds, frame.clouds[t].nodes->seconds_to_retry());
        }
        report.clouds = std::move(clouds);
        report.programs = splats.programs() + compositor.programs();
        report.frame_ms = 1e3 * seconds_since(frame.start);
        const double more_uploads = frame.converges ? std::max(0.0, report.upload_ms - options.upload_budget_ms) : 0;
        if (p.unmeasured == 0) p.budget.measured_overhead(report.frame_ms - frame.drawing_ms - more_uploads);
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
    impl_->nodes = std::make_unique<NodeLoader>(impl_->cloud->tree()->nodes(), gl_tuning().loading.retry_after);
}

DrawnCloud::~DrawnCloud() = default;

void DrawnCloud::set_wake(std::function<void()> wake)
{
    impl_->feed->set_wake(wake);
    impl_->nodes->set_wake(std::move(wake));
}
void DrawnCloud::release() { impl_->feed->release(); }
const std::shared_ptr<PointCloud>& DrawnCloud::cloud() const { return impl_->cloud; }
const std::shared_ptr<L1Cache>& DrawnCloud::l1() const { return impl_->l1; }

Picture::Picture() : impl_(std::make_unique<PictureState>()) {}
Picture::~Picture() = default;
Picture::Picture(Picture&&) noexcept = default;
Picture& Picture::operator=(Picture&&) noexcept = default;

void Picture::invalidate() { impl_->forget(); }

void Picture::release()
{
    impl_->target.release();
    impl_->next.release();
    impl_->resolved.release();
    impl_->shades.release();
    impl_->sum.release();
    impl_->clock.release();
    impl_->forget();
}

Renderer::Renderer(std::shared_ptr<L1Cache> l1) : impl_(std::make_unique<Impl>()) { impl_->l1 = std::move(l1); }
Renderer::~Renderer() = default;

FrameReport Renderer::draw(Picture& picture, const Camera& view, const std::vector<SceneItem>& items,
                           const RenderOptions& options)
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
