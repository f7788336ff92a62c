#include "pcm/gl/draw/frame_cost.h"
#include "pcm/gl/tuning.h"

#include <algorithm>
#include <set>
#include <utility>

namespace pcm {
namespace {

// Whether splats of their own sizes fill gaps of this spacing in all clouds.
bool has_no_gaps(const Frame& frame, double spacing_px)
{
    return std::all_of(frame.clouds.begin(), frame.clouds.end(),
                       [&](const FrameCloud& c) { return fill_of(spacing_px, c.style) == 0; });
}

// Selects all nodes in view that have been read; those that the picture shows already come first.
void select_everything(const Frame& frame, PictureState::Rest& rest, const SceneSelection& shown)
{
    DetailLimits everything;
    everything.target_px = -1;
    everything.point_budget = everything.page_budget = ~std::uint64_t(0);
    rest.pages_read = frame.pages_read();
    SceneSelection selection = select_scene(frame.trees(), everything);
    put_first(shown, selection);
    rest.all = std::move(selection);
}

}  // namespace

bool differs_at_rest(const Frame& frame)
{
    return std::any_of(frame.clouds.begin(), frame.clouds.end(), [&](const FrameCloud& cloud) {
        return cloud.filled ||
               (!frame.options.paraboloids && traits_of(cloud.style.splats).shape == SplatShape::sphere);
    });
}

void begin_rest(Frame& frame, const SceneSelection& lod, const std::vector<std::vector<bool>>& drawn)
{
    PictureState::Rest& rest = *frame.picture.rest;
    select_everything(frame, rest, lod);
    rest.begun = true;
    rest.added = lod.order.size();
    rest.held = lod.order.size();
    rest.points_of.assign(frame.clouds.size(), 0);
    rest.hidden_of.assign(frame.clouds.size(), 0);
    if (differs_at_rest(frame)) {
        rest.behind = true;
        rest.added = 0;
        const FrameReport& report = frame.report;
        rest.shown_points = report.points_drawn;
        rest.shown_nodes = report.nodes_drawn;
        for (const CloudReport& cloud : report.clouds) {
            rest.shown_points_of.push_back(cloud.points_drawn);
            rest.shown_hidden_of.push_back(cloud.points_hidden);
        }
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
    }
    if (rest.behind) return;
    rest.points = frame.report.points_drawn;
    for (std::size_t t = 0; t < frame.clouds.size(); ++t) {
        rest.points_of[t] = frame.report.clouds[t].points_drawn;
        rest.hidden_of[t] = frame.report.clouds[t].points_hidden;
    }
}

namespace {

// One frame of a view that rests.
class RestingFrame {
public:
    RestingFrame(Frame& frame, PictureState::Rest& rest) : frame_(frame), rest_(rest), report_(frame.report)
    {
        frame.at_rest = true;
        // Until it is known: at least as much as in a moving view.
        if (frame.picture.rest_budget.last_measured_ms() == 0) frame.picture.rest_budget = frame.picture.budget;
    }

    void draw()
    {
        const bool stuck = add_next();
        const double error = error_px();
        show_when_without_gaps();
        fill_report(error);
        if (stuck && has_more()) report_.error = "the video memory is too small for the rest of the points in view";
        report_.refining = (has_more() || can_add_left_out() || frame_.awaits_nodes(rest_.all)) && !stuck;
        report_.repaint = report_.refining && goes_on();
    }

    // For the mean, while `shown` is complete.
    bool draw_again(PictureState::Rest& shown, bool& possible)
    {
        possible = !add_next() && rest_.left_out.empty();
        RestingFrame(frame_, shown).fill_report(0);
        report_.refining = possible;
        report_.repaint = possible && goes_on();
        return possible && !has_more();
    }

private:
    const SceneSelection::Place& place_at(std::size_t i) const { return rest_.all.order[i]; }
    const DetailNode& node_at(std::size_t i) const
    {
        return rest_.all.trees[place_at(i).tree].wanted[place_at(i).index];
    }
    FrameCloud& cloud_at(std::size_t i) const { return frame_.clouds[place_at(i).tree]; }
    std::size_t total() const { return rest_.all.order.size(); }
    bool has_more() const { return rest_.added < total(); }
    // What could not be loaded at first is loaded again some time later.
    bool can_add_left_out() const
    {
        return std::any_of(rest_.left_out.begin(), rest_.left_out.end(), [this](std::size_t i) {
            return is_current(i) || !cloud_at(i).feed->has_failed(node_at(i).node);
        });
    }
    std::uint64_t pages_at(std::size_t i) const
    {
        const std::uint64_t per_page = L1Cache::points_per_page(cloud_at(i).format);
        return (cloud_at(i).tree->nodes()[node_at(i).node].points + per_page - 1) / per_page;
    }
    bool is_current(std::size_t i) const
    {
        const FrameCloud& cloud = cloud_at(i);
        return cloud.feed->is_current(node_at(i).node, cloud.feed->find(node_at(i).node), cloud.format);
    }

    // Whether video memory refuses what is next.
    bool add_next()
    {
        choose_next();
        load_next();
        served_ = frame_.upload(rest_.all);
        report_.effective_point_budget = frame_.options.point_budget;
        if (!next_.empty()) draw_next();
        return yield_held(served_);
    }

    // Whether another frame would do more than wait.
    bool goes_on() const { return !frame_.waits() || report_.points_added > 0 || served_.uploaded > 0; }

    // The nodes that are drawn next, as far as L1 has room for them in addition to those that a moving view will show
    // again: these stay.
    void choose_next()
    {
        const std::size_t most = gl_tuning().loading.rest_window;
        std::uint64_t pages = frame_.l1.pages_available(frame_.owners);
        for (std::size_t i = 0; i < rest_.held; ++i) {
            frame_.l1.use(cloud_at(i).feed->owner(), node_at(i).node);
            pages -= std::min(pages, pages_at(i));
        }
        const auto consider = [&](std::size_t i) {
            const std::uint64_t needed = i < rest_.held ? 0 : pages_at(i);
            if (!next_.empty() && (next_.size() >= most || needed > pages)) return false;
            pages -= std::min(pages, needed);
            next_.push_back(i);
            return true;
        };
        if (first_time_)
            for (std::size_t i = rest_.added; i < total() && consider(i); ++i) {
            }
        else
            for (std::size_t k = 0; k < rest_.left_out.size() && consider(rest_.left_out[k]); ++k) {
            }
    }

    void load_next()
    {
        for (FrameCloud& cloud : frame_.clouds) cloud.window.clear();
        for (const std::size_t i : next_) {
            FrameCloud& cloud = cloud_at(i);
            const NodeId node = node_at(i).node;
            if (is_current(i))
                frame_.l1.use(cloud.feed->owner(), node);
            else if (!cloud.feed->has_failed(node))
                frame_.want(place_at(i).tree, {node});
        }
        for (std::size_t t = 0; t < frame_.clouds.size(); ++t) {
            const FrameCloud& cloud = frame_.clouds[t];
            if (cloud.leader == t) cloud.feed->load(cloud.window, {}, cloud.format);
        }
    }

    void draw_next()
    {
        PictureState& p = frame_.picture;
        std::vector<SceneSelection::Place> places;
        for (const std::size_t i : next_)
            if (is_current(i)) places.push_back(place_at(i));
        const FrameCost cost(frame_, rest_.all, places);
        const double time = p.budget.at_rest(frame_.options.frame_budget_ms);
        const double available = time - std::min(report_.upload_ms, time / 2);
        if (rest_.behind) p.next.bind();
        timed(frame_, [&](Strokes& strokes) {
            std::set<std::size_t> drawn;
            auto stroke = cost.strokes().begin();
            for (const std::size_t i : next_) {
                if (is_current(i)) {
                    const FrameWork more = frame_.work + cost.work(*stroke++, {});
                    if (frame_.work.points > 0 &&
                        (more.points > frame_.options.point_budget || frame_.costs().expected(more) > available))
                        break;
                    frame_.work = more;
                    add(i, strokes);
                    drawn.insert(i);
                } else if (first_time_) {
                    // In order, so that among points at equal depth the same one is visible each time.
                    if (!cloud_at(i).feed->has_failed(node_at(i).node)) break;
                    rest_.left_out.push_back(i);
                }
                if (first_time_) ++rest_.added;
            }
            if (first_time_) return;
            auto& out = rest_.left_out;
            out.erase(std::remove_if(out.begin(), out.end(), [&](std::size_t i) { return drawn.count(i) != 0; }),
                      out.end());
        });
    }

    void add(std::size_t i, Strokes& strokes)
    {
        const FrameCloud& cloud = cloud_at(i);
        const VertexEntry& entry = *cloud.feed->find(node_at(i).node);
        const std::uint32_t drawn = entry.points - strokes.draw(cloud, node_at(i), entry, 0, {});
        ++rest_.nodes;
        rest_.points += drawn;
        rest_.points_of[place_at(i).tree] += drawn;
        rest_.hidden_of[place_at(i).tree] += entry.hidden;
    }

    // Another client may hold video memory that this view counted on: then the pages of what a moving view will show
    // are needed too. Returns whether there are none left to give.
    bool yield_held(const Served& served)
    {
        const bool refused = served.refused && served.uploaded == 0 && report_.points_added == 0;
        const bool stuck = refused && rest_.held == 0;
        if (refused) rest_.held /= 2;
        return stuck;
    }

    double error_px() const
    {
        double error = has_more() ? node_at(rest_.added).error_px : 0;
        for (const std::size_t i : rest_.left_out) error = std::max(error, node_at(i).error_px);
        for (const DetailSelection& tree : rest_.all.trees)
            if (!tree.unread.empty()) error = std::max(error, tree.unread.front().error_px);
        return error;
    }

    void show_when_without_gaps()
    {
        if (!rest_.behind) return;
        if (has_more() && !has_no_gaps(frame_, node_at(rest_.added).error_px)) return;
        std::swap(frame_.picture.target, frame_.picture.next);
        rest_.behind = false;
    }

    void fill_report(double error)
    {
        report_.clouds.resize(frame_.clouds.size());
        for (std::size_t t = 0; t < frame_.clouds.size(); ++t) {
            report_.clouds[t].points_drawn = rest_.behind ? rest_.shown_points_of[t] : rest_.points_of[t];
            report_.clouds[t].points_hidden = rest_.behind ? rest_.shown_hidden_of[t] : rest_.hidden_of[t];
        }
        report_.points_drawn = rest_.behind ? rest_.shown_points : rest_.points;
        report_.nodes_drawn = rest_.behind ? rest_.shown_nodes : rest_.nodes;
        report_.nodes_wanted = total();
        report_.nodes_missing = total() - rest_.nodes;
        const RenderTarget& target = frame_.picture.target;
        report_.screen_error_px =
            std::min<double>(rest_.behind ? rest_.shown_error_px : error, std::max(target.width(), target.height()));
        report_.full_resolution = !has_more() && rest_.left_out.empty() && !rest_.all.lacks_nodes();
    }

    Frame& frame_;
    PictureState::Rest& rest_;
    FrameReport& report_;
    const bool first_time_ = rest_.added < rest_.all.order.size();  // else those are drawn that could not be loaded
    std::vector<std::size_t> next_;                                 // places in rest_.all.order
    Served served_{};
};

}  // namespace

void draw_resting(Frame& frame)
{
    PictureState::Rest& rest = *frame.picture.rest;
    if (rest.all.lacks_nodes()) {
        frame.read_nodes(rest.all);
        // When what is known is drawn, and all that was asked for has come: each time all nodes in view are looked at.
        if (rest.added == rest.all.order.size() && !frame.waits() && rest.pages_read != frame.pages_read())
            select_everything(frame, rest, rest.all);
    }
    RestingFrame(frame, rest).draw();
}

bool draw_again(Frame& frame, PictureState::Rest& again, bool& possible)
{
    return RestingFrame(frame, again).draw_again(*frame.picture.rest, possible);
}

}  // namespace pcm
