#include "pcm/gl/frame_cost.h"

#include <algorithm>
#include <set>
#include <utility>

namespace pcm {
namespace {

// So many nodes are on their way into the picture at a time.
constexpr std::size_t rest_window = 64;

// Whether splats of their own sizes cover this spacing in all clouds.
bool has_no_gaps(const Frame& frame, double spacing_px)
{
    return std::all_of(frame.clouds.begin(), frame.clouds.end(),
                       [&](const FrameCloud& c) { return fill_of(spacing_px, c.style) == 0; });
}

}  // namespace

void begin_rest(Frame& frame, const SceneSelection& lod, const std::vector<std::vector<bool>>& drawn)
{
    PictureState::Rest& rest = *frame.picture.rest;
    DetailLimits everything;
    everything.target_px = -1;
    everything.point_budget = everything.page_budget = ~std::uint64_t(0);
    rest.all = select_scene(frame.trees(), everything);
    rest.begun = true;
    rest.added = lod.order.size();
    rest.held = lod.order.size();
    rest.points_of.assign(frame.clouds.size(), 0);
    if (std::any_of(frame.clouds.begin(), frame.clouds.end(), [](const FrameCloud& cloud) { return cloud.filled; })) {
        rest.behind = true;
        rest.added = 0;
        const FrameReport& report = frame.report;
        rest.shown_points = report.points_drawn;
        rest.shown_nodes = report.nodes_drawn;
        for (const CloudReport& cloud : report.clouds) rest.shown_points_of.push_back(cloud.points_drawn);
        rest.shown_error_px = report.screen_error_px;
        PictureState& p = frame.picture;
        p.next.prepare(p.target.width(), p.target.height(), p.asked_samples);
        p.next.bind();
        p.next.clear();
    }
    for (std::size_t i = 0; i < rest.added; ++i) {
        const SceneSelection::Place& place = rest.all.order[i];
        const FrameCloud& cloud = frame.clouds[place.tree];
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
    PictureState& p = frame.picture;
    PictureState::Rest& rest = *p.rest;
    FrameReport& report = frame.report;
    const auto node_at = [&](std::size_t i) -> const DetailNode& {
        const SceneSelection::Place& place = rest.all.order[i];
        return rest.all.trees[place.tree].wanted[place.index];
    };
    const auto cloud_at = [&](std::size_t i) -> FrameCloud& { return frame.clouds[rest.all.order[i].tree]; };

    // What a moving view will show again stays in L1, and what comes next has the rest of it.
    const auto pages_at = [&](std::size_t i) {
        const std::uint64_t per_page = L1Cache::points_per_page(cloud_at(i).format);
        return (cloud_at(i).tree->nodes()[node_at(i).node].points + per_page - 1) / per_page;
    };
    std::uint64_t pages = frame.l1.pages_available(frame.owners);
    for (std::size_t i = 0; i < rest.held; ++i) {
        frame.l1.use(cloud_at(i).feed->owner(), node_at(i).node);
        pages -= std::min(pages, pages_at(i));
    }
    std::vector<std::size_t> next;
    const auto consider = [&](std::size_t i) {
        const std::uint64_t needed = i < rest.held ? 0 : pages_at(i);
        if (!next.empty() && (next.size() >= rest_window || needed > pages)) return false;
        pages -= std::min(pages, needed);
        next.push_back(i);
        return true;
    };
    const bool first_time = rest.added < rest.all.order.size();
    if (first_time)
        for (std::size_t i = rest.added; i < rest.all.order.size() && consider(i); ++i) {
        }
    else
        for (std::size_t k = 0; k < rest.left_out.size() && consider(rest.left_out[k]); ++k) {
        }
    for (FrameCloud& cloud : frame.clouds) cloud.window.clear();
    for (const std::size_t i : next) {
        FrameCloud& cloud = cloud_at(i);
        const NodeId node = node_at(i).node;
        if (ChunkFeed::is_current(cloud.feed->find(node), cloud.format))
            frame.l1.use(cloud.feed->owner(), node);
        else if (!cloud.feed->has_failed(node))
            frame.want(rest.all.order[i].tree, {node});
    }
    for (std::size_t t = 0; t < frame.clouds.size(); ++t)
        if (frame.clouds[t].leader == t) frame.clouds[t].feed->load(frame.clouds[t].window, {}, frame.clouds[t].format);
    const Served served = frame.upload(rest.all);

    report.effective_point_budget = frame.options.point_budget;
    if (!next.empty()) {
        std::vector<SceneSelection::Place> places;
        for (const std::size_t i : next)
            if (ChunkFeed::is_current(cloud_at(i).feed->find(node_at(i).node), cloud_at(i).format))
                places.push_back(rest.all.order[i]);
        const FrameCost cost(frame, rest.all, places);
        const double time = p.budget.at_rest(frame.options.frame_budget_ms);
        const double available = time - std::min(report.upload_ms, time / 2);
        if (rest.behind) p.next.bind();
        timed(frame, [&](Strokes& strokes) {
            std::set<std::size_t> had;
            auto stroke = cost.strokes().begin();
            for (const std::size_t i : next) {
                FrameCloud& cloud = cloud_at(i);
                const DetailNode& node = node_at(i);
                const VertexEntry* const entry = cloud.feed->find(node.node);
                if (ChunkFeed::is_current(entry, cloud.format)) {
                    const FrameWork more = frame.work + cost.work(*stroke++, {});
                    if (frame.work.points > 0 &&
                        (more.points > frame.options.point_budget || p.budget.expected(more) > available))
                        break;
                    frame.work = more;
                    strokes.draw(cloud, node, *entry, 0, {});
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
                out.erase(std::remove_if(out.begin(), out.end(), [&](std::size_t i) { return had.count(i) != 0; }),
                          out.end());
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
    report.screen_error_px =
        std::min<double>(rest.behind ? rest.shown_error_px : error, std::max(p.target.width(), p.target.height()));
    report.full_resolution = rest.added == total && rest.left_out.empty();
    const bool more = rest.added < total;
    if (stuck && more) report.error = "the video memory is too small for the rest of the points in view";
    report.refining = more && !stuck;
    bool waits = false;
    for (FrameCloud& cloud : frame.clouds) waits = waits || cloud.feed->waits();
    report.repaint = report.refining && (!waits || report.points_added > 0 || served.uploaded > 0);
}

}  // namespace pcm
