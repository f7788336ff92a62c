#include "pcm/gl/draw/frame_cost.h"
#include "pcm/gl/tuning.h"
#include "pcm/view/motion.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace pcm {
namespace {

// Nodes in view that are not drawn leave gaps between the points of all their ancestors.
void find_gaps(FrameCloud& cloud, const DetailSelection& selection, const std::vector<bool>& drawn, bool fill)
{
    const std::size_t count = selection.wanted.size();
    cloud.residual.assign(count, 0.0f);
    cloud.gaps.assign(count, {});
    const NodeTable& nodes = cloud.tree->nodes();
    const auto leave = [&](const DetailNode& node) {
        if (node.ancestor == no_ancestor) return;
        float& residual = cloud.residual[node.ancestor];
        residual = std::max(residual, static_cast<float>(node.error_px));
        FrameCloud::Gap& gap = cloud.gaps[node.ancestor];
        gap.spacing = std::max(gap.spacing, nodes[node.parent].spacing);
        gap.spacing_px = std::max(gap.spacing_px, node.error_px);
    };
    for (std::size_t i = 0; i < count; ++i)
        if (!drawn[i]) leave(selection.wanted[i]);
    for (const DetailNode& node : selection.unread) leave(node);
    for (const DetailNode& node : selection.beyond) leave(node);
    for (std::size_t i = count; i-- > 0;) {
        const DetailNode& node = selection.wanted[i];
        FrameCloud::Gap& gap = cloud.gaps[i];
        if (node.ancestor != no_ancestor) {
            FrameCloud::Gap& above = cloud.gaps[node.ancestor];
            above.spacing = std::max(above.spacing, gap.spacing);
            above.spacing_px = std::max(above.spacing_px, gap.spacing_px);
        }
        if (!fill || fill_of(gap.spacing_px, cloud.style) == 0) gap = {};
    }
}

using DrawnOfTrees = std::vector<std::vector<bool>>;  // flags of each tree's `wanted`

// How many of the drawable chunks there is time for, from the first on. Sets gaps, the frame's work and `drawn` for
// these.
std::size_t fit_to_time(Frame& frame, const SceneSelection& selection, const FrameCost& cost, DrawnOfTrees& drawn)
{
    const std::vector<Stroke>& strokes = cost.strokes();
    FrameBudget& budget = frame.picture.budget;
    const auto take = [&](std::size_t count) {
        for (std::size_t s = 0; s < strokes.size(); ++s)
            drawn[strokes[s].place.tree][strokes[s].place.index] = s < count;
        for (std::size_t t = 0; t < frame.clouds.size(); ++t)
            find_gaps(frame.clouds[t], selection.trees[t], drawn[t], frame.options.fill_gaps);
        frame.work = {};
        for (std::size_t s = 0; s < count; ++s)
            frame.work =
                frame.work + cost.work(strokes[s], frame.clouds[strokes[s].place.tree].gaps[strokes[s].place.index]);
        return budget.expected(frame.work);
    };
    const double available = budget.available(frame.options.frame_budget_ms);
    // The coarsest chunks are always drawn, and as many others as bring the minimum number of points into the view.
    std::size_t fits = 0, count = strokes.size();
    const auto is_coarsest = [&](const Stroke& stroke) {
        return selection.trees[stroke.place.tree].wanted[stroke.place.index].ancestor == no_ancestor;
    };
    const double least_in_view = gl_tuning().budget.min_points_in_view;
    for (double seen = 0; fits < strokes.size() && (is_coarsest(strokes[fits]) || seen < least_in_view); ++fits)
        seen += cost.work(strokes[fits], {}).splats;
    double expected = take(count);
    if (expected > available && fits < count) {
        std::size_t fails = count;
        while (fits + 1 < fails) {
            const std::size_t middle = (fits + fails) / 2;
            (take(middle) <= available ? fits : fails) = middle;
        }
        count = fits;
        expected = take(count);
    }
    if (count == strokes.size()) {
        // The budget is in points of the tree: those that conditions hide cost nothing, and belong to the chunks.
        FrameWork chosen = frame.work;
        for (const Stroke& stroke : strokes) chosen.points += stroke.entry->hidden;
        budget.all(chosen, available / expected);
    } else {
        // Chunks still being loaded count too: they will be drawn.
        std::uint64_t points = 0;
        const SceneSelection::Place& left_out = strokes[count].place;
        for (const SceneSelection::Place& place : selection.order) {
            if (place.tree == left_out.tree && place.index == left_out.index) break;
            points +=
                frame.clouds[place.tree].tree->nodes()[selection.trees[place.tree].wanted[place.index].node].points;
        }
        budget.fewer(points);
    }
    for (FrameCloud& cloud : frame.clouds) cloud.filled = false;
    for (std::size_t s = 0; s < count; ++s) {
        FrameCloud& cloud = frame.clouds[strokes[s].place.tree];
        cloud.filled = cloud.filled || cloud.gaps[strokes[s].place.index].spacing > 0;
    }
    return count;
}

// Requests missing chunks, and those that a moving view will need later.
void load(Frame& frame, const SceneSelection& selection, const SceneSelection* later)
{
    const std::size_t count = frame.clouds.size();
    std::vector<std::vector<NodeId>> ahead(count);
    for (FrameCloud& cloud : frame.clouds) cloud.window.clear();
    for (std::size_t t = 0; t < count; ++t)
        frame.want(t, frame.clouds[t].feed->window_of(selection.trees[t], frame.clouds[t].current));
    for (std::size_t t = 0; later && t < count; ++t) {
        const FrameCloud& leader = frame.clouds[frame.clouds[t].leader];
        std::vector<NodeId>& of_leader = ahead[frame.clouds[t].leader];
        const auto nodes = leader.feed->ahead_of(later->trees[t], leader.window.size() + of_leader.size());
        of_leader.insert(of_leader.end(), nodes.begin(), nodes.end());
    }
    for (std::size_t t = 0; t < count; ++t) {
        FrameCloud& cloud = frame.clouds[t];
        if (cloud.leader == t) cloud.feed->load(cloud.window, ahead[t], cloud.format);
    }
}

bool can_converge(const Frame& frame)
{
    return frame.options.order == DetailOrder::error &&
           std::none_of(frame.clouds.begin(), frame.clouds.end(),
                        [](const FrameCloud& c) { return traits_of(c.style.colour).changes_with_detail; });
}

void adapt_page_share(PictureState& p, bool refused)
{
    const VideoMemoryTuning& tuned = gl_tuning().memory;
    p.page_share = refused ? std::max(tuned.min_share, tuned.after_refusal * p.page_share)
                           : std::min(tuned.max_share, tuned.after_success * p.page_share);
}

std::optional<SceneSelection> predicted(const Frame& frame)
{
    const PictureState& p = frame.picture;
    if (!frame.options.prefetch_frames || p.views.size() != frame.clouds.size()) return std::nullopt;
    std::vector<TreeInView> trees = frame.trees();
    bool moves = false;
    for (std::size_t t = 0; t < trees.size(); ++t)
        if (const auto later = predict(p.views[t], trees[t].view, frame.options.prefetch_frames)) {
            trees[t].view = *later;
            moves = true;
        }
    if (!moves) return std::nullopt;
    return select_scene(trees, frame.limits);
}

// Which chunks of each tree are in L1 with the attributes of their style.
void mark_current(Frame& frame, const SceneSelection& selection)
{
    for (std::size_t t = 0; t < frame.clouds.size(); ++t) {
        FrameCloud& cloud = frame.clouds[t];
        const std::vector<DetailNode>& wanted = selection.trees[t].wanted;
        cloud.current.assign(wanted.size(), false);
        for (std::size_t i = 0; i < wanted.size(); ++i)
            cloud.current[i] =
                cloud.feed->is_current(wanted[i].node, frame.l1.use(cloud.feed->owner(), wanted[i].node), cloud.format);
    }
}

DrawnOfTrees drawable(const Frame& frame, const SceneSelection& selection)
{
    DrawnOfTrees drawn(frame.clouds.size());
    for (std::size_t t = 0; t < frame.clouds.size(); ++t) {
        const DetailSelection& wanted = selection.trees[t];
        const DrawSet set = choose_drawable(
            wanted, [&](const DetailNode& node) { return frame.clouds[t].feed->find(node.node) != nullptr; });
        drawn[t].assign(wanted.wanted.size(), false);
        for (const std::uint32_t i : set.drawn) drawn[t][i] = true;
    }
    return drawn;
}

// The first `count` chunks.
void draw_chunks(Frame& frame, const SceneSelection& selection, const FrameCost& cost, std::size_t count)
{
    PictureState& p = frame.picture;
    FrameReport& report = frame.report;
    p.target.clear();
    p.kept.clear();
    report.clouds.resize(frame.clouds.size());
    timed(frame, [&](Strokes& strokes) {
        for (std::size_t s = 0; s < count; ++s) {
            const SceneSelection::Place& place = cost.strokes()[s].place;
            const VertexEntry& entry = *cost.strokes()[s].entry;
            const FrameCloud& cloud = frame.clouds[place.tree];
            const DetailNode& node = selection.trees[place.tree].wanted[place.index];
            const std::uint32_t clipped =
                strokes.draw(cloud, node, entry, cloud.residual[place.index], cloud.gaps[place.index]);
            ++report.nodes_drawn;
            report.clouds[place.tree].points_drawn += entry.points - clipped;
            report.clouds[place.tree].points_hidden += entry.hidden;
            p.kept.insert({frame.picture.key->items[place.tree].cloud, node.node});
        }
    });
    for (const CloudReport& cloud : report.clouds) report.points_drawn += cloud.points_drawn;
}

struct Progress {
    bool more_to_come = false;  // chunks or nodes that can be loaded are missing
    bool waits = false;         // some of them are being loaded
    bool all_current = true;    // what is drawn has the attributes of its style
    bool everything = true;     // every point in view is drawn
};

Progress progress_of(Frame& frame, const SceneSelection& selection, const DrawnOfTrees& drawn)
{
    Progress progress;
    FrameReport& report = frame.report;
    for (std::size_t t = 0; t < frame.clouds.size(); ++t) {
        FrameCloud& cloud = frame.clouds[t];
        const DetailSelection& wanted = selection.trees[t];
        report.nodes_wanted += wanted.wanted.size();
        for (std::size_t i = 0; i < wanted.wanted.size(); ++i) {
            cloud.current[i] =
                cloud.feed->is_current(wanted.wanted[i].node, cloud.feed->find(wanted.wanted[i].node), cloud.format);
            report.nodes_missing += !cloud.current[i];
            progress.all_current = progress.all_current && (cloud.current[i] || !drawn[t][i]);
            progress.everything = progress.everything && cloud.current[i] && drawn[t][i];
        }
        progress.everything = progress.everything && wanted.beyond.empty() && wanted.unread.empty();
        // Chunks that failed to load are missing at present and not waited for.
        progress.more_to_come = progress.more_to_come || cloud.feed->awaits_facts() ||
                                !cloud.feed->window_of(wanted, cloud.current).empty();
    }
    progress.more_to_come = progress.more_to_come || frame.awaits_nodes(selection);
    progress.waits = frame.waits();
    return progress;
}

}  // namespace

void draw_moving(Frame& frame, const SceneSelection& selection, bool resting)
{
    PictureState& p = frame.picture;
    FrameReport& report = frame.report;
    mark_current(frame, selection);
    const std::optional<SceneSelection> later = resting ? std::nullopt : predicted(frame);
    frame.read_nodes(selection, later ? &*later : nullptr);
    load(frame, selection, later ? &*later : nullptr);
    const Served served = frame.upload(selection);

    DrawnOfTrees drawn = drawable(frame, selection);
    std::vector<SceneSelection::Place> places;
    for (const SceneSelection::Place& place : selection.order)
        if (drawn[place.tree][place.index]) places.push_back(place);
    const FrameCost cost(frame, selection, places);
    const std::size_t count = fit_to_time(frame, selection, cost, drawn);
    const bool all_fit = count == places.size();
    for (std::size_t t = 0; t < frame.clouds.size(); ++t) {
        std::size_t next = 0;
        const DrawSet set = choose_drawable(selection.trees[t], [&](const DetailNode&) { return drawn[t][next++]; });
        report.screen_error_px = std::max(report.screen_error_px, set.error_px);
    }
    draw_chunks(frame, selection, cost, count);

    const Progress progress = progress_of(frame, selection, drawn);
    adapt_page_share(p, served.refused);
    // When video memory refuses, waiting does not help: it is full of chunks on the screen.
    const bool more_to_come = progress.more_to_come && !served.refused;
    const bool budget_grows = all_fit && selection.budget_reached &&
                              report.effective_point_budget < frame.options.point_budget &&
                              (p.budget.can_grow(frame.options.point_budget) || p.budget.is_to_be_measured(frame.work));
    // Also when the window is finished and the next one has not been requested.
    report.repaint =
        served.out_of_time || (budget_grows && !frame.options.converge) || (more_to_come && !progress.waits);
    report.refining = report.repaint || more_to_come;
    if (selection.order.empty() && selection.budget_reached)
        report.error = "the point budget or the video memory is too small for the first chunk of a cloud";
    // A view that will rest shows its full resolution when its splats are those of a resting view.
    const bool will_rest = frame.options.converge && can_converge(frame);
    const bool is_final = progress.everything && !(will_rest && report.nodes_drawn > 0 && differs_at_rest(frame));
    report.full_resolution = is_final;
    if (will_rest && !report.refining) {
        // Another frame of this view continues from here.
        report.refining = report.repaint = !is_final;
        if (frame.converges && progress.all_current) begin_rest(frame, selection, drawn);
    }
}

}  // namespace pcm
