#include "pcm/gl/draw/frame.h"

#include "pcm/gl/base/gl_state.h"
#include "pcm/view/pixel_offset.h"

#include <GL/glew.h>

#include <algorithm>
#include <cmath>

namespace pcm {
namespace {

// The spacing on the screen that a style's own splats are assumed to cover.
double spacing_covered(const CloudStyle& style)
{
    return traits_of(style.splats).shape == SplatShape::pixels
               ? static_cast<double>(style.point_size_px) / gl_tuning().splats.fill
               : 1;
}

}  // namespace

float fill_of(double spacing_px, const CloudStyle& style)
{
    if (spacing_px <= spacing_covered(style)) return 0;
    const SplatTuning& tuned = gl_tuning().splats;
    return static_cast<float>(std::ceil(tuned.fill * std::min(spacing_px, tuned.max_fill)));
}

Finish Frame::finish(bool fast) const
{
    const bool lies_in_surfaces =
        std::any_of(clouds.begin(), clouds.end(), [](const FrameCloud& cloud) { return cloud.format.shape; });
    return {options.eye_dome, fast, options.fill_gaps && lies_in_surfaces};
}

std::vector<TreeInView> Frame::trees() const
{
    std::vector<TreeInView> trees;
    for (const FrameCloud& cloud : clouds)
        trees.push_back({&cloud.tree->nodes(), &cloud.tree->info().grid, cloud.view,
                         cloud.clips.empty() ? nullptr : &cloud.clips.all(), false});
    return trees;
}

void Frame::read_nodes(const SceneSelection& selection, const SceneSelection* later)
{
    std::vector<std::vector<NodeId>> nodes(clouds.size());
    for (const SceneSelection* lacking : {&selection, later})
        for (std::size_t t = 0; lacking && t < clouds.size(); ++t)
            for (const DetailNode& node : lacking->trees[t].unread) nodes[clouds[t].leader].push_back(node.node);
    for (std::size_t t = 0; t < clouds.size(); ++t)
        if (clouds[t].leader == t) clouds[t].nodes->request(std::move(nodes[t]));
}

bool Frame::awaits_nodes(const SceneSelection& selection) const
{
    for (std::size_t t = 0; t < clouds.size(); ++t)
        if (!selection.trees[t].unread.empty() && clouds[t].nodes->seconds_to_retry() == 0) return true;
    return false;
}

std::size_t Frame::pages_read() const
{
    std::size_t pages = 0;
    for (const FrameCloud& cloud : clouds) pages += cloud.tree->nodes().pages_loaded();
    return pages;
}

bool Frame::waits() const
{
    return std::any_of(clouds.begin(), clouds.end(),
                       [](const FrameCloud& cloud) { return cloud.feed->waits() || cloud.nodes->waits(); });
}

DetailLimits Frame::current_limits()
{
    DetailLimits allowed;
    allowed.target_px = options.target_spacing_px;
    allowed.order = options.order;
    std::uint64_t roots = 0;
    allowed.page_points = L1Cache::points_per_page({});
    for (const FrameCloud& cloud : clouds) {
        if (!cloud.tree->nodes().empty()) roots += cloud.tree->nodes()[0].points;
        // Counted as if all entries had colour: entries of another style stay until their pages are needed.
        VertexFormat format = cloud.format;
        if (format.colour == ColourSource::none) format.colour = ColourSource::rgb;
        allowed.page_points = std::min(allowed.page_points, L1Cache::points_per_page(format));
    }
    // Without a limit of time nothing has to be learnt first.
    allowed.point_budget =
        std::isinf(options.frame_budget_ms) ? options.point_budget : picture.budget.points(roots, options.point_budget);
    report.effective_point_budget = allowed.point_budget;
    const std::uint64_t pages = l1.pages_available(owners);
    // The coarsest chunks are always allowed.
    const std::uint64_t least = roots / std::max<std::uint64_t>(1, allowed.page_points) + clouds.size();
    allowed.page_budget =
        std::min(pages, std::max(static_cast<std::uint64_t>(picture.page_share * static_cast<double>(pages)), least));
    return allowed;
}

void Frame::begin(const FrameCloud& cloud)
{
    splats.begin(shifted(cloud.view, offset), cloud.tree->info(), cloud.style, picture.target.reversed(),
                 picture.target.samples(), at_rest, cloud.values,
                 {cloud.clips.empty() ? nullptr : &cloud.clips, cloud.selected_colour, frame_of_mean});
}

void Frame::want(std::size_t item, const std::vector<NodeId>& nodes)
{
    std::vector<NodeId>& window = clouds[clouds[item].leader].window;
    const std::size_t most = gl_tuning().loading.window;
    for (const NodeId node : nodes)
        if (window.size() < most && std::find(window.begin(), window.end(), node) == window.end())
            window.push_back(node);
}

Served Frame::upload(const SceneSelection& selection)
{
    const double budget = converges
                              ? std::max(options.upload_budget_ms, picture.budget.at_rest(options.frame_budget_ms) / 2)
                              : options.upload_budget_ms;
    std::vector<std::size_t> turns;
    for (const SceneSelection::Place& place : selection.order) {
        const std::size_t leader = clouds[place.tree].leader;
        if (!clouds[leader].window.empty() && std::find(turns.begin(), turns.end(), leader) == turns.end())
            turns.push_back(leader);
    }
    Served sum;
    const auto begun = Clock::now();
    for (const std::size_t turn : turns) {
        // At least one is uploaded.
        const double left = std::max(0.0, budget - 1e3 * seconds_since(begun));
        if (left == 0 && sum.uploaded > 0) {
            sum.out_of_time = true;
            break;
        }
        FrameCloud& cloud = clouds[turn];
        const Served served = cloud.feed->upload(cloud.window, cloud.format, left);
        sum.uploaded += served.uploaded;
        sum.out_of_time = sum.out_of_time || served.out_of_time;
        sum.refused = sum.refused || served.refused;
    }
    report.upload_ms = 1e3 * seconds_since(begun);
    return sum;
}

void begin_strokes(Frame& frame)
{
    const RenderTarget& target = frame.picture.target;
    if (gl_has_clip_control())
        glClipControl(GL_LOWER_LEFT, target.reversed() ? GL_ZERO_TO_ONE : GL_NEGATIVE_ONE_TO_ONE);
    frame.picture.clock.begin();
}

void end_strokes(Frame& frame)
{
    PictureState& p = frame.picture;
    frame.work.at_rest = frame.costs_more();
    p.clock.end(frame.work);
    const auto measure = p.clock.take();
    if (p.unmeasured > 0)
        --p.unmeasured;
    else if (measure)
        (measure->work.at_rest ? p.rest_budget : p.budget).measured(measure->work, measure->milliseconds);
}

}  // namespace pcm
